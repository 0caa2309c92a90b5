// SPDX-License-Identifier: Apache-2.0
// Scattering of a sheet between patches of directions, as writers of Radiance's XML files need it: estimated by samples of the
// BSDF and by even directions.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "aureole/instrument/measured/scattering_probe.h"

namespace aureole {

/// A partition of the hemisphere into patches of projected solid angle `projected(k)`.
struct DirectionPatches {
  std::size_t count = 0;
  std::function<Vec3(std::size_t, Vec2)> sample;  ///< a direction even in projected solid angle, z >= 0
  std::function<std::size_t(const Vec3&)> at;     ///< the patch of a direction with z >= 0; `count`: none
  std::function<double(std::size_t)> projected;   ///< projected solid angle of a patch [sr]
};

/// Mean f [1/sr] from each patch of incidence to each patch of the outgoing hemisphere, for light on the sides of +z (index 0) and
/// -z (1), reflected and transmitted, with delta lobes: the visible range under CIE D65 for the observer of CIE 1931.
struct SheetScattering {
  std::size_t outgoing = 0;
  /// by index 2 side + transmitted; each has a row of `outgoing` values for each incident patch
  std::array<std::vector<double>, 4> f;
};
/// `incident` patches give the direction towards the light; it is turned by 180 degrees about the normal, so that undeviated light
/// stays in the patch of equal number. `samples` of the BSDF are taken for each incident patch and side, and `even` directions
/// for each pair of patches; the balance heuristic (Veach 1995) combines them. With `prefers_even` samples count for delta lobes
/// alone, which has less noise in small patches, unless even directions miss 3 % of the light. With `is_reciprocal`, which says so
/// of the BSDF, and equal partitions of both hemispheres f(i, o) and f(o, i) become the mean of their estimates; a probe that makes
/// reciprocal evaluates both directions of the light. Throws Error where the grid holds nothing of the visible range.
SheetScattering estimate_sheet(const ScatteringProbe& probe, const DirectionPatches& incident,
                               const DirectionPatches& outgoing, int samples, int even, bool prefers_even,
                               bool is_reciprocal);

/// The head of an XML file of WINDOW's schema up to the definition of its data, which `data` completes, and a block of numbers.
std::string window_file_head(const std::string& name, const std::string& manufacturer,
                             const std::string& data);
std::string window_file_block(const std::string& bases, const std::string& direction, const std::string& kind,
                              const std::string& numbers);
inline constexpr const char* kWindowFileEnd = "</Layer>\n</Optical>\n</WindowElement>\n";

}  // namespace aureole
