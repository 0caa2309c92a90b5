// SPDX-License-Identifier: Apache-2.0
// `SplatCloud`: Gaussian splats or points as a file states them, in one set of conventions for all formats.
//
// A splat is a Gaussian of the standard deviations `scale` along three axes, which the unit quaternion
// `rotation` rotates to the axes of the cloud, with an opacity in [0, 1] and a colour by direction in
// spherical harmonics (Kerbl, Kopanas, Leimkuehler & Drettakis 2023, "3D Gaussian splatting for real-time
// radiance field rendering"). The cloud's axes are right-handed: x to the right, y up, z back to the viewer
// (RUB).
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "aureole/core/unfilled.h"
#include "aureole/math/vec.h"

namespace aureole {

/// Conventions by which an integrator should show the splats of a file, where the file or its format states
/// them.
struct SplatHints {
  enum class Sorting { z_depth, camera_distance };
  enum class Projection { perspective, tangential };
  /// Encoding of the colours that are blended.
  enum class Colors { srgb, linear };

  Sorting sorting = Sorting::z_depth;
  Projection projection = Projection::perspective;
  Colors colors = Colors::srgb;
  float cutoff = 0;  ///< Mahalanobis distance at which a splat ends; 0: the format states none
  /// whether the splats were trained with opacities that are compensated for the dilation (Mip-Splatting)
  bool antialiased = false;

  bool operator==(const SplatHints&) const = default;
};

struct SplatCloud {
  enum class Kind { gaussians, points };

  Kind kind = Kind::gaussians;
  UnfilledVector<Vec3> positions;
  /// Standard deviations, in the unit of the positions. Of points: the radius, twice, and 0 along the normal, which is
  /// the third axis; or the radius three times where there are no normals. 0 where the file states no radius.
  UnfilledVector<Vec3> scales;
  UnfilledVector<std::array<float, 4>> rotations;  ///< unit quaternions w, x, y, z
  UnfilledVector<float> opacities;
  /// Coefficients of real spherical harmonics, `coefficients()` colours per splat in the order of l and then of m:
  /// red, green and blue of the first, then of the second. The colour is 1/2 plus their sum (math of
  /// spherical_harmonics.h).
  int degree = 0;
  UnfilledVector<float> harmonics;
  bool has_normals = false;  ///< whether points have normals

  SplatHints hints;
  /// format of the file: "PLY of 3D Gaussian splatting", ".splat", "SPZ, version 3", ...
  std::string format;
  std::string axes;                                  ///< the file's own axes, such as "RDF"
  std::vector<std::filesystem::path> further_files;  ///< files with numbers, besides the one that was named
  /// notes on data that have no effect, are repaired or left out, with counts
  std::vector<std::string> notes;

  std::size_t size() const { return positions.size(); }
  std::size_t coefficients() const { return std::size_t((degree + 1) * (degree + 1)); }
  const float* harmonics_of(std::size_t i) const { return harmonics.data() + 3 * coefficients() * i; }
  /// Sets the number of splats and the degree of the harmonics. The caller must then write all numbers.
  void resize(std::size_t count, int new_degree);
  std::size_t memory_bytes() const;
};

struct SplatFileOptions {
  /// The axes of the file, instead of those of its format: three letters, R or L, U or D, B or F, the directions in
  /// which x, y and z increase. Empty: the axes of the format.
  std::string axes;
  float radius = 0;        ///< radius of points without radii
  float radius_scale = 1;  ///< factor of the radii of points
};

/// Returns the names of axes that `SplatFileOptions::axes` accepts.
const std::vector<std::string>& splat_axes();

/// Reads a file of Gaussian splats or points: PLY (of 3D Gaussian splatting, or points with colours, normals and radii),
/// `.splat`, `.spz` of the versions 1 to 4, glTF (`.gltf`, `.glb`) with KHR_gaussian_splatting, text of OpenUSD (`.usda`). The
/// content decides, but for `.splat`, which has no signature. Throws Error located at the file. Memory is bounded by the size of the file and
/// `require_content`.
SplatCloud read_splat_file(const std::filesystem::path& file, const SplatFileOptions& options = {});

/// Returns a cloud with its numbers in the axes `axes` (`SplatFileOptions::axes`), as a file with those axes
/// stores them.
SplatCloud turned_axes(const SplatCloud& cloud, const std::string& axes);

/// Whether a file begins like one of these formats; PLY files count if they contain splats. Throws Error if
/// the file cannot be read.
bool is_splat_file(const std::filesystem::path& file);

}  // namespace aureole
