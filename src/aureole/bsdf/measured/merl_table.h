// SPDX-License-Identifier: Apache-2.0
// Isotropic BRDFs in the format of the MERL database: W. Matusik, H. Pfister, M. Brand and L. McMillan, "A data-driven
// reflectance model", ACM TOG 22(3), 2003; angles of S. Rusinkiewicz, "A new change of variables for efficient BRDF
// representation", EGWR 1998.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "aureole/math/vec.h"

namespace aureole {

/// A table of linear sRGB over the angle theta_h between half vector and normal (bins of equal sqrt(theta_h)), the angle
/// theta_d between direction and half vector, and the azimuth phi_d about the half vector, which covers 180 degrees where
/// the table is reciprocal by construction, or 360.
class MerlTable {
public:
  /// Throws Error located at the file.
  explicit MerlTable(const std::filesystem::path& file);

  /// f [1/sr] of the three channels; both directions lie above the surface. With `is_linear` f is
  /// interpolated between the centres of the bins; else it is the value of the bin, as the database's own
  /// program reads it.
  std::array<float, 3> rgb(const Vec3& wi, const Vec3& wo, bool is_linear) const;
  /// Number of bins with a negative channel, which have no measurement and count as black.
  std::size_t missing() const { return missing_; }
  std::size_t bins() const { return half_ * difference_ * azimuths_; }
  bool is_full_circle() const { return is_full_circle_; }
  std::size_t bytes() const { return values_.size() * sizeof(float); }

private:
  std::size_t half_ = 0, difference_ = 0, azimuths_ = 0;
  bool is_full_circle_ = false;
  std::size_t missing_ = 0;
  std::vector<float> values_;  ///< values by theta_h, theta_d, phi_d and channel
};

}  // namespace aureole
