// SPDX-License-Identifier: Apache-2.0
// Fits radius and area fraction of circular scatterers, arranged like hard discs in equilibrium, to the corona
// around a light source. Light diffracted by s (the change of the transverse direction cosines) has, in colour
// c, the radiance
//     L_c(s) = A_c integral of P(lambda) r_c(lambda)/lambda^2 J(2 pi s/lambda) dlambda + b_c + d_c s,
// with J as in `optics::ScattererLayer` for equal scatterers, and as in `optics::ScattererMixture` with
// correlated sizes for scatterers of several sizes. Unknowns of every colour are A_c (exposure, white balance),
// and b_c and d_c for light from other sources.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "aureole/instrument/corona/corona.h"
#include "aureole/optics/arrangement/equilibrium_structure_factor.h"
#include "aureole/optics/arrangement/hard_disc_mixture.h"
#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole {

/// Upper bound of the area fraction in fits.
inline constexpr double kMaxFittedFraction = optics::kMaxEquilibriumFraction;

/// Means over rings around the source in steps of s, without outliers.
struct ScatteredProfile {
  double step = 0;
  std::vector<double> s;                        ///< position s of each ring, as the mean of its pixels
  std::vector<std::array<double, 3>> mean, sd;  ///< linear R, G, B, and standard errors of the means
};

struct PaneGeometry {
  double pane_m = 0;      ///< distance of the pane along the axis [m]; 0: at the camera
  double lamp_m = 0;      ///< distance of the light source [m]; 0: at infinity
  double slab_index = 0;  ///< IOR of a pane that dims light by Fresnel reflection; 0: none
};

/// Measures rings from `inner` up to s = 0.5, or up to the largest ring of which a sufficient part is
/// visible. A ring with a channel at or above `clip` is excluded.
ScatteredProfile scattered_profile(const Image& linear, const PinholeCamera& camera, Direction lamp,
                                   const PictureParts& parts, const PaneGeometry& geometry, double inner,
                                   double clip);

/// Circular scatterers of one size, of a log-normal distribution of sizes, or of two sizes.
struct CoronaScatterers {
  double radius = 0;         ///< radius [m]; the median of a distribution, or the first of two sizes
  double area_fraction = 0;  ///< area fraction covered by all scatterers
  double spread = 0;         ///< standard deviation of ln(radius)
  double second_radius = 0;  ///< [m]
  double second_share = 0;   ///< fraction of the covered area that scatterers of the second size cover
};

/// The model's three colours without factors, at s = i step, for a light source that is a disc of angular
/// radius `blur`.
class CoronaModel {
public:
  /// Positions of hard discs in equilibrium, or positions by the theory that `correlated_scatterers` uses by
  /// default. Near an area fraction of 0.5 the first ring of the theory is 3.5 % fainter.
  enum class Positions { equilibrium, percus_yevick };
  CoronaModel(const LampSpectrum& lamp, double largest_s, double blur,
              Positions positions = Positions::equilibrium);
  void set(const CoronaScatterers& scatterers);
  /// Interpolates linearly between the steps, each of which is computed on first use.
  std::array<double, 3> at(double s);

private:
  using Colour = std::array<double, 3>;
  struct Line {
    double inverse_m, rgb[3];
  };
  /// Values at the steps of s, computed on first use.
  struct Table {
    std::vector<Colour> values;
    std::vector<char> known;
  };
  /// Extends g_ up to `largest_u`.
  void tabulate(const CoronaScatterers& scatterers, double largest_u);
  /// Returns J at u, up to a constant factor, for the sizes in `sizes_`.
  double mixture_intensity(double u) const;
  /// Returns by how much 1/S' of equal discs is larger than in the theory (S' the static structure factor).
  double correction(double u, double area_fraction) const;
  const Colour& sharp(size_t i);    ///< colour for a point source
  const Colour& blurred(size_t i);  ///< colour for a disc-shaped source

  std::vector<Line> lines_;
  double largest_s_, step_, blur_;
  Positions positions_;
  std::vector<std::array<double, 2>> disc_;  ///< points of the disc that represent equal areas
  /// A size relative to `radius_`, its share of the number of scatterers, and the class whose scatterers have
  /// one structure factor.
  struct Size {
    double radius, number;
    int size_class;
  };
  double radius_ = 0, tabulated_ = -1, step_u_ = 0;
  std::vector<Size> sizes_;  ///< sizes of the scatterers; empty for scatterers of one size
  std::optional<optics::HardDiscMixture> mixture_;
  std::vector<double> g_;  ///< J at steps of u, up to a constant factor
  /// at the steps of u, for the structure factor at any area fraction
  std::vector<optics::HardDiscWave> waves_;
  Table sharp_, blurred_;
};

/// Sizes that a fit allows; all allow a radius and an area fraction.
enum class CoronaSizes { one, spread, two };

/// Values with their standard errors; lengths in m.
struct CoronaFit {
  double radius = 0, radius_error = 0;  ///< radius; of two sizes the one that covers more area
  double area_fraction = 0, area_fraction_error = 0;
  double spread = 0, spread_error = 0;
  double second_radius = 0, second_radius_error = 0;
  double second_share = 0, second_share_error = 0;
  double second_correlation = 0;  ///< correlation of the errors of the second radius and the area fraction
  double correlation = 0;         ///< correlation of the errors of radius and area fraction
  bool fraction_fixed = false;
  double residual = 0;                       ///< RMS of the residuals, relative to the profile's range
  std::vector<std::array<double, 3>> model;  ///< values of the model at the profile's rings
};

/// Rings hardly depend on a spread of sizes below this; fits then return 0.
inline constexpr double kMinFittedSpread = 0.02;

/// Largest RMS of the residuals of a good fit, over the range of the profile. Above it the model does not describe the
/// picture; fits of good pictures have 1.5 %.
inline constexpr double kGoodResidual = 0.03;
/// Largest RMS of the residuals of a good fit of several sizes; fits of good pictures have 0.4 %.
inline constexpr double kGoodResidualOfSizes = 0.01;

/// Fits the profile. Throws Error if no ring is significant above the smooth light.
CoronaFit fit_corona(const ScatteredProfile& profile, CoronaModel& model,
                     CoronaSizes sizes = CoronaSizes::one);

/// Angle of an extremum of one colour (0 R, 1 G, 2 B, 3 luminance).
struct RingAngle {
  double angle_deg = 0;
  bool maximum = true;
  int colour = 1;
};
/// Parses a list such as "2.79:max:G, 4.2deg:min". If omitted, the type alternates starting with max, and the
/// colour is Y. Throws Error.
std::vector<RingAngle> parse_ring_angles(const std::string& text);

/// Fits radius and area fraction to listed angles: the n-th angle of a kind and colour is the n-th extremum
/// from the centre. With one angle, or if `fixed_fraction` is not negative, the area fraction is
/// `fixed_fraction`.
CoronaFit fit_ring_angles(const std::vector<RingAngle>& rings, const LampSpectrum& lamp, double error_deg,
                          double fixed_fraction,
                          CoronaModel::Positions positions = CoronaModel::Positions::equilibrium);

}  // namespace aureole
