// SPDX-License-Identifier: Apache-2.0
// What stacks do with light of all directions: the tables of layered materials.
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
    /// Of a beam of irradiance 1 along each of them. What passes is 0 where there is a substrate.
    std::vector<double> scattered;         ///< light that leaves in directions of its own, on either side
    std::vector<double> mirrored, passed;  ///< light that was not scattered
  };
  Side above, below;  ///< below: empty where there is a substrate
  int azimuths = 0;
  /// f/n_o^2 in 1/sr, f as radiance per irradiance and n_o the index where it goes, without unscattered light:
  /// by incident cosine, outgoing cosine, azimuth. The same with both exchanged: light from below that passes
  /// is `transmitted` with its first two places exchanged.
  std::vector<double> reflected_above, transmitted, reflected_below;
};

/// Of stacks that differ in absorption, scattering, phase functions and the substrate's reflectances only,
/// such as one at several wavelengths. Azimuth 0 is where light goes that continues in its own half-plane.
/// Each stack is one unit of work for `parallel`.
std::vector<StackKernels> stack_kernels(std::span<const StackDescription> stacks,
                                        const DiscreteOrdinates& method, std::span<const double> azimuths,
                                        const ParallelFor& parallel = serial_for);

/// Streams with which each side of a stack of these indices has at least so many directions.
int streams_for_directions(const StackDescription& stack, int directions);

/// How many pairs of directions the kernels of a stack have: each holds a number for each azimuth.
std::size_t kernel_pairs(const StackDescription& stack, int streams);

}  // namespace aureole::optics
