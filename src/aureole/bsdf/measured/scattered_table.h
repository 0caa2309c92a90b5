// SPDX-License-Identifier: Apache-2.0
// A BSDF that was measured for any set of outgoing directions, resampled to a grid of half vectors.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "aureole/bsdf/measured/bilinear_warp.h"
#include "aureole/bsdf/measured/spectral_nodes.h"
#include "aureole/math/vec.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Measured values of a text table: f [1/sr] without a cosine.
struct ScatteredMeasurements {
  struct Direction {
    /// angles of both directions [degrees], from the normal and from the x axis; theta_o > 90: transmitted
    double theta_i, phi_i, theta_o, phi_o;
    int line;
  };
  std::vector<Direction> directions;
  std::vector<float> values;  ///< for each direction and channel
  std::vector<float> errors;  ///< standard uncertainties of the values, or none
  std::vector<double> nm;     ///< wavelengths; empty: one channel for all, or red, green, blue
  std::size_t channels = 0;
  std::size_t negative = 0;  ///< number of values below zero, which count as zero
};

/// Reads a table with the columns theta_i, theta_o, optionally phi_i and phi_o, and values: wavelengths ("550nm"), "r", "g"
/// and "b", or one column "f". Columns such as "u(550nm)" have standard uncertainties; all values or none need one. `has_cosine`: values are f cos(theta_o), as radiant intensities are. Throws Error located
/// at the line.
ScatteredMeasurements read_scattered_measurements(const std::filesystem::path& file, bool has_cosine);

/// Values for pairs of directions on the sides of +z: reflected, or transmitted and mirrored to positive z. Outgoing
/// directions are triangulated in the projected disc (Delaunay) and interpolated linearly; outside of the
/// triangulation the value of the nearest direction is used. Between directions of incidence, values of equal
/// half vectors are interpolated.
class ScatteredTable {
public:
  ScatteredTable() = default;
  /// Resamples one half of the measurements: `transmitted` chooses between reflection and transmission;
  /// without any the table is empty. Throws Error located at `file`.
  ScatteredTable(const ScatteredMeasurements& measured, bool transmitted, const std::string& file,
                 const SpectralGrid& grid);

  bool empty() const { return values_.empty(); }
  bool is_isotropic() const { return is_isotropic_; }
  /// Whether the measured azimuths covered half of the circle and were mirrored.
  bool was_mirrored() const { return was_mirrored_; }
  /// f at the wavelengths of a spectral table.
  Spectrum spectrum(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const;
  /// f of a table with one channel or three; one channel is returned three times.
  std::array<float, 3> colour(const Vec3& wi, const Vec3& wo) const;
  /// The mean of the channels.
  float mean(const Vec3& wi, const Vec3& wo) const;
  std::size_t bytes() const { return values_.size() * sizeof(float); }

private:
  /// Calls visit(node, weight) for the nodes around a pair of directions.
  template <class Visit>
  void visit_nodes(const Vec3& wi, const Vec3& wo, Visit&& visit) const;

  bool is_isotropic_ = true, was_mirrored_ = false;
  SliceNodes nodes_;
  std::size_t stride_ = 0;
  SpectralNodes wavelengths_;
  std::vector<float> values_;  ///< values by slice, row, column and channel
};

}  // namespace aureole
