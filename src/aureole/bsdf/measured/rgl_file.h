// SPDX-License-Identifier: Apache-2.0
// The content of a `.bsdf` file of RGL's material database: J. Dupuy and W. Jakob, "An adaptive parameterization for
// efficient material acquisition and rendering", ACM TOG 37(6), 2018.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace aureole {

/// An isotropic or anisotropic BRDF that was measured spectrally or in linear sRGB. Half vectors m and directions have
/// the coordinates (u, v) = (sqrt(2 theta / pi), (phi + pi) / (2 pi)) in the unit square. Tables are rows of v with
/// columns of u.
struct RglFile {
  /// A table over the unit square, or one for each pair of azimuth and angle of incidence.
  struct Table {
    std::size_t height = 0, width = 0;
    std::vector<float> values;
  };
  std::string description;
  /// azimuths and angles of incidence [rad], increasing; up to two azimuths: isotropic
  std::vector<float> phi_i, theta_i;
  std::vector<float> nm;  ///< wavelengths [nm], increasing; empty: the channels are red, green, blue
  Table ndf;              ///< distribution of half vectors (microfacet normals) D(m) [1/sr]
  Table sigma;            ///< projected area of the microfacets, by the direction of incidence
  /// distribution of visible normals in the square of m, for each azimuth and angle of incidence
  Table vndf;
  /// pdf of points of the square that the vndf maps to half vectors, for each azimuth and angle
  Table luminance;
  /// f |cos theta_o| by azimuth, angle, channel, row and column, at points that the vndf maps to half vectors; in units of
  /// D(m) / (4 sigma(i)) if `is_relative`.
  std::vector<float> spectra;
  bool is_relative = true;  ///< the file's field `jacobian`

  bool is_isotropic() const { return phi_i.size() <= 2; }
  std::size_t channels() const { return nm.empty() ? 3 : nm.size(); }
};

/// Faults of a file that are noted, not errors.
struct RglNotes {
  /// number of values of `spectra` below zero: noise, or colours outside of sRGB's gamut
  std::size_t negative_spectra = 0;
};

/// Reads a `.bsdf` file. Throws Error located at the file.
RglFile read_rgl_file(const std::filesystem::path& file, RglNotes& notes);

/// Returns the bytes of a `.bsdf` file with this content, as other programs read it.
std::string rgl_file_content(const RglFile& file);

}  // namespace aureole
