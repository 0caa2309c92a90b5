// SPDX-License-Identifier: Apache-2.0
// Reflection and transmission by stacks between all directions: the tables of layered materials.
#pragma once

#include <span>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/stack/plane_stack.h"

namespace aureole::optics {

/// Scattering of a stack between directions of two sides, above and below. Directions are those of the
/// method's quadrature, and normal and nearly grazing ones; cosines rise, in the medium of the side.
struct StackKernels {
  struct Side {
    std::vector<double> cosines;
    /// Results for a beam of irradiance 1 along each cosine. `passed` is 0 where there is a substrate.
    std::vector<double> scattered;         ///< light that leaves in directions of its own, on either side
    std::vector<double> mirrored, passed;  ///< light that was not scattered
    /// Irradiance on a substrate, first arrivals alone; empty where there is none.
    std::vector<double> reached;
  };
  Side above, below;  ///< below: empty where there is a substrate
  int azimuths = 0;
  /// Of diffuse light that goes up from a substrate: the share returned by the layers, and the share that
  /// leaves.
  double returned = 0, left = 0;
  /// f/n_o^2 in 1/sr, f as radiance per irradiance and n_o the index where it goes, without unscattered
  /// light: by incident cosine, outgoing cosine, azimuth. The same with both exchanged: light from below that
  /// passes is `transmitted` with its first two places exchanged.
  std::vector<double> reflected_above, transmitted, reflected_below;
};

/// Of stacks that have as many layers and interfaces of one kind, and the same indices on both sides, such as
/// one at several wavelengths. Azimuth 0 is where light goes that continues in its own half-plane. The
/// indices of layers may differ as long as the directions outside stay the same (`have_same_directions`);
/// rough interfaces are then made for each stack, which takes its time. Each stack is one unit of work for
/// `parallel`.
std::vector<StackKernels> stack_kernels(std::span<const StackDescription> stacks,
                                        const DiscreteOrdinates& method, std::span<const double> azimuths,
                                        const ParallelFor& parallel = serial_for);

/// Whether the quadrature of both sides is the same for two stacks. Indices of layers may differ that are
/// above those of both sides.
bool have_same_directions(const StackDescription& a, const StackDescription& b);

/// Streams with which each side of a stack of these indices has at least so many directions.
int streams_for_directions(const StackDescription& stack, int directions);

/// How many pairs of directions the kernels of a stack have: each holds a number for each azimuth.
std::size_t kernel_pairs(const StackDescription& stack, int streams);

}  // namespace aureole::optics
