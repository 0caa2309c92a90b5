// SPDX-License-Identifier: Apache-2.0
// The luminous intensity of a luminaire by direction, tabulated over two angles as goniophotometers measure it
// (CIE 121-1996, "The photometry and goniophotometry of luminaires").
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace aureole::optics {

/// A vector in the coordinates of a luminaire: +z is the direction of both angles zero, which is straight down
/// for a luminaire of type C.
using LuminaireVector = std::array<double, 3>;

/// The three systems of photometric coordinates, which differ by the axis that all half-planes share.
enum class PhotometricType {
  /// The vertical axis across the beam, for headlamps and signals: horizontal angle about it, vertical angle
  /// from the horizon.
  a,
  /// The horizontal axis across the beam, for floodlights: vertical angle about it, horizontal angle from the
  /// plane across it.
  b,
  c  ///< The axis along the beam, for luminaires of rooms and roads: angle C about it, angle gamma from it.
};

/// The axis that the half-planes share, and the directions at a right angle to it at azimuths of 0 and 90 degrees.
/// The axes may be left-handed.
struct PhotometricAxes {
  LuminaireVector pole, zero, quarter;
};

/// The axes of a type. For types A and B +y is up and a positive horizontal angle is to the right of an observer who
/// looks along the beam, at -x (LM-63-2002, section 3: clockwise). For type C, C = 0 is +x, and C increases
/// counter-clockwise as seen from above, so that C = 90 degrees is -y.
PhotometricAxes photometric_axes(PhotometricType type);

/// Intensities [cd] over azimuth and polar angle, bilinear between the angles of the table.
class IntensityDistribution {
public:
  /// `azimuths` [degrees] increase, from 0 to 360 for a full circle; a single one means symmetry about the pole.
  /// `polar_angles` [degrees] increase within [0, 180]. `candela` has a row of polar angles for each azimuth. The
  /// intensity is zero outside both ranges. Throws std::domain_error for other input.
  IntensityDistribution(const PhotometricAxes& axes, std::vector<double> azimuths,
                        std::vector<double> polar_angles, std::vector<double> candela);

  /// Returns the intensity [cd] in a direction, a vector of any length except zero.
  double intensity(const LuminaireVector& direction) const;
  /// Intensity [cd] at an azimuth and a polar angle [degrees].
  double at(double azimuth, double polar_angle) const;
  /// The unit vector at an azimuth and a polar angle [degrees].
  LuminaireVector direction(double azimuth, double polar_angle) const;

  /// Luminous flux [lm] between two polar angles [degrees]: the exact integral of the bilinear intensities.
  double flux(double from_polar = 0, double to_polar = 180) const;
  /// Largest intensity of the table [cd].
  double maximum() const;
  /// Largest angle [rad] between +z and a direction of positive intensity, found at the corners of the table's cells.
  double widest_angle() const;

  const PhotometricAxes& axes() const { return axes_; }
  const std::vector<double>& azimuths() const { return azimuths_; }
  const std::vector<double>& polar_angles() const { return polar_angles_; }
  bool is_rotational() const { return azimuths_.size() == 1; }
  double value(std::size_t azimuth, std::size_t polar) const {
    return candela_[azimuth * polar_angles_.size() + polar];
  }
  void scale(double factor);

private:
  PhotometricAxes axes_;
  std::vector<double> azimuths_, polar_angles_, candela_;
};

}  // namespace aureole::optics
