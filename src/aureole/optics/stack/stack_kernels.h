// SPDX-License-Identifier: Apache-2.0
// Reflection and transmission of stacks between all directions, tabulated for layered materials.
#pragma once

#include <span>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/stack/plane_stack.h"

namespace aureole::optics {

/// Scattering of a stack between directions of its two sides, above and below. The directions are those of
/// the quadrature, the normal and a nearly grazing one. Cosines are in the medium of the side, in increasing
/// order.
struct StackKernels {
  struct Side {
    std::vector<double> cosines;
    /// Fractions for a beam of irradiance 1 along each direction. `passed` is 0 if there is a substrate.
    std::vector<double> scattered;         ///< scattered light that leaves on either side
    std::vector<double> mirrored, passed;  ///< unscattered light that is reflected and transmitted
    /// Irradiance on a substrate by light that arrives for the first time; empty without a substrate.
    std::vector<double> reached;
  };
  Side above, below;  ///< scattering from either side; `below` is empty if there is a substrate
  int azimuths = 0;
  /// For diffuse upward light from a substrate: the fraction that the layers return, and the fraction that
  /// leaves.
  double returned = 0, left = 0;
  /// Scattered light f/n_o^2 in 1/sr, by incident cosine, outgoing cosine and azimuth, with f the radiance
  /// per irradiance and n_o the index on the outgoing side. It is symmetric in the two directions:
  /// transmission from below is `transmitted` with its first two indices exchanged.
  std::vector<double> reflected_above, transmitted, reflected_below;
};

/// Computes the kernels of stacks with equal numbers of layers, equal kinds of interfaces and equal outer
/// indices, such as one stack at several wavelengths. Azimuth 0 is the half-plane in which incident light
/// continues. Indices of layers may differ as long as the outer directions are equal
/// (`have_same_directions`); rough interfaces are then computed for each stack, which is slower. Each stack
/// is one task of `parallel`.
std::vector<StackKernels> stack_kernels(std::span<const StackDescription> stacks,
                                        const DiscreteOrdinates& method, std::span<const double> azimuths,
                                        const ParallelFor& parallel = serial_for);

/// Whether the quadrature directions on both sides are equal for two stacks. Indices of layers may differ
/// where they are above those of both sides.
bool have_same_directions(const StackDescription& a, const StackDescription& b);

/// Returns the number of streams with which each side of a stack has at least this many directions.
int streams_for_directions(const StackDescription& stack, int directions);

/// Returns the number of pairs of directions in the kernels of a stack, each with one number per azimuth.
std::size_t kernel_pairs(const StackDescription& stack, int streams);

}  // namespace aureole::optics
