// SPDX-License-Identifier: Apache-2.0
// Reflection and transmission of a part of a stack as matrices over channels, for one azimuthal mode, and how
// parts are put on top of one another (van de Hulst 1980, Multiple Light Scattering, chapter 4; Plass,
// Kattawar & Catchings 1973, Appl. Opt. 12, 314). Inside of the library only: here is Eigen.
//
// Matrices act on x = sqrt(e) L, e the channel's etendue and L = I/n^2 its basic radiance. In this form
// reciprocity is symmetry: the matrices of reflection are symmetric, those of transmission each other's
// transpose. sqrt(e) x is a flux. Mode m of a function of azimuth is the mean of it times cos(m phi).
#pragma once

#include <Eigen/LU>
#include <functional>
#include <vector>

#include "aureole/optics/stack/stack_channels.h"

namespace aureole::optics {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// Eigen's operator and inverse() are compiled anew for each kind of expression that they are a part of, with
// all their loops; these once. An argument that is an expression is evaluated first.
Matrix product(const Matrix& a, const Matrix& b);
Matrix inverse(const Matrix& a);

struct Operators {
  Matrix r_above;  ///< of light from above: symmetric, the channels of the medium above
  Matrix t_down;   ///< from the channels above to those below; of light from below it is the transpose
  Matrix r_below;

  /// Light from above on this that comes down on `lower`: t_down or r_below times it is what one sees.
  static Operators stacked(const Operators& upper, const Operators& lower);
};

/// Light between two parts, from what falls on the upper one from above and on the lower one from below
/// (columns).
struct FieldBetween {
  Matrix down, up;
  FieldBetween(const Operators& upper, const Operators& lower, const Matrix& from_above,
               const Matrix& from_below);
};

/// A layer of one material: optical thickness, albedo and moments of the phase function, scaled if they are
/// to be.
class UniformLayer {
public:
  UniformLayer(const Channels& channels, double index, double albedo, std::vector<double> moments);

  Operators operators(double optical_thickness, int mode) const;

  /// A and B of dx_down/dtau = -A x_down + B x_up, and the same upward.
  struct Rates {
    Matrix sum, difference;  ///< A + B, A - B
  };
  Rates rates(int mode) const;
  bool scatters(int mode) const;

private:
  Operators attenuation(double optical_thickness) const;
  int count_;
  double albedo_;
  std::vector<double> moments_;
  Vector mu_, root_etendue_;
  double scale_;  ///< albedo/(4 pi n^2)
  Vector forward_;
};

/// A flat interface of unpolarised light: Fresnel's reflectance for each channel, 1 where it ends.
Operators smooth_interface(const Channels& channels, double index_above, double index_below);

/// Reflects the share `reflectance` of all flux into all directions alike. Nothing passes.
Operators lambertian_substrate(const Channels& channels, double index, double reflectance, int mode);

/// Reflection matrices of a substrate with this BRDF, by azimuthal mode, averaged over the ranges of both
/// channels. A narrow lobe is scaled down where averaging would let a channel reflect more than it receives.
std::vector<Matrix> substrate_kernels(const Channels& channels, double index,
                                      const std::function<double(double, double, double)>& brdf, int modes);

Vector root_etendues(const Channels& channels, double index);

}  // namespace aureole::optics
