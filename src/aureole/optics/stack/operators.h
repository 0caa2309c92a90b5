// SPDX-License-Identifier: Apache-2.0
// Reflection and transmission operators of a part of a stack as matrices over channels, for one azimuthal
// mode, and the composition of parts (van de Hulst 1980, Multiple Light Scattering, chapter 4; Plass,
// Kattawar & Catchings 1973, Appl. Opt. 12, 314). Internal to the library, since it includes Eigen.
//
// Matrices act on x = sqrt(e) L, with e the channel's etendue and L = I/n^2 its basic radiance. In this form
// reciprocity is symmetry: reflection matrices are symmetric, and the two transmission matrices are
// transposes of each other. sqrt(e) x is a flux. Mode m of a function of azimuth is the mean of the function
// times cos(m phi).
#pragma once

#include <Eigen/LU>
#include <functional>
#include <vector>

#include "aureole/optics/stack/stack_channels.h"

namespace aureole::optics {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// Matrix product and inverse, compiled once. Eigen's operator * and inverse() are templates that are compiled
// anew for each type of expression. An argument that is an expression is evaluated first.
Matrix product(const Matrix& a, const Matrix& b);
Matrix inverse(const Matrix& a);

struct Operators {
  Matrix r_above;  ///< reflection of light from above: symmetric, over the channels of the medium above
  /// transmission from the channels above to the channels below; its transpose is the transmission from below
  Matrix t_down;
  Matrix r_below;

  /// Composes two parts with all interreflections between them.
  static Operators stacked(const Operators& upper, const Operators& lower);
};

/// Light between two parts, per column of light incident on the upper part from above and on the lower part
/// from below.
struct FieldBetween {
  Matrix down, up;
  FieldBetween(const Operators& upper, const Operators& lower, const Matrix& from_above,
               const Matrix& from_below);
};

/// A layer of one material: optical thickness, albedo and moments of the phase function, after delta-M
/// scaling if that is used.
class UniformLayer {
public:
  UniformLayer(const Channels& channels, double index, double albedo, std::vector<double> moments);

  Operators operators(double optical_thickness, int mode) const;

  /// Matrices A and B of dx_down/dtau = -A x_down + B x_up; the equation for x_up is the mirror image.
  struct Rates {
    Matrix sum, difference;  ///< sum A + B and difference A - B
  };
  Rates rates(int mode) const;
  bool scatters(int mode) const;

private:
  Operators attenuation(double optical_thickness) const;
  int count_;
  double albedo_;
  std::vector<double> moments_;
  Vector mu_, root_etendue_;
  double scale_;  ///< factor albedo/(4 pi n^2)
  Vector forward_;
};

/// Returns the operators of a flat interface for unpolarised light: the Fresnel reflectance of each channel,
/// 1 under total internal reflection.
Operators smooth_interface(const Channels& channels, double index_above, double index_below);

/// Returns the reflection of the fraction `reflectance` of all flux, uniformly into all directions; nothing
/// is transmitted.
Operators lambertian_substrate(const Channels& channels, double index, double reflectance, int mode);

/// Returns the reflection matrices of a substrate with this BRDF, by azimuthal mode, averaged over the ranges
/// of both channels. Where that gives a narrow lobe an excess, it is removed: no channel reflects more than
/// it receives.
std::vector<Matrix> substrate_kernels(const Channels& channels, double index,
                                      const std::function<double(double, double, double)>& brdf, int modes);

Vector root_etendues(const Channels& channels, double index);

}  // namespace aureole::optics
