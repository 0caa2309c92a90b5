// SPDX-License-Identifier: Apache-2.0
// Radius and area fraction of equal circles on the places of hard discs, from the corona that they make
// around a lamp. Light diffracted by s (the change of the transverse direction cosines) has, in colour c,
//     L_c(s) = A_c integral of P(lambda) r_c(lambda)/lambda^2 J(2 pi s/lambda) dlambda + b_c + d_c s,
// J as in `optics::ScattererLayer`; A_c (exposure, white balance) and the light that is not the corona's, b_c
// and d_c, are unknowns of every colour.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "aureole/instrument/corona/corona.h"
#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole {

/// Largest area fraction that is tried.
inline constexpr double kMaxFittedFraction = 0.68;

/// Means over rings around the lamp in steps of s, without outliers.
struct ScatteredProfile {
  double step = 0;
  std::vector<double> s;                        ///< mean of each ring
  std::vector<std::array<double, 3>> mean, sd;  ///< linear R, G, B and the standard errors of the means
};

struct PaneGeometry {
  double pane_m = 0;      ///< distance of the pane along the axis; 0: at the camera
  double lamp_m = 0;      ///< of the lamp; 0: far away
  double slab_index = 0;  ///< of a pane whose reflection dims the light; 0: none
};

/// Rings from `inner` to the largest that the picture shows for a good part, at most s = 0.5. Channels at or
/// above `clip` leave their ring out.
ScatteredProfile scattered_profile(const Image& linear, const PinholeCamera& camera, Direction lamp,
                                   const PictureParts& parts, const PaneGeometry& geometry, double inner,
                                   double clip);

/// The model's three colours without factors, at s = i step; the lamp is a disc of angular radius `blur`.
class CoronaModel {
public:
  CoronaModel(const LampSpectrum& lamp, double largest_s, double blur);
  /// Sets radius (m) and area fraction.
  void set(double radius, double area_fraction);
  /// Linear between the steps, each of which is computed when it is first asked for.
  std::array<double, 3> at(double s);

private:
  using Colour = std::array<double, 3>;
  struct Line {
    double inverse_m, rgb[3];
  };
  /// Values at the steps of s, computed when they are first asked for.
  struct Table {
    std::vector<Colour> values;
    std::vector<char> known;
  };
  /// Makes g_ hold the values up to `largest_u`.
  void tabulate(double area_fraction, double largest_u);
  const Colour& sharp(size_t i);    ///< of a small lamp
  const Colour& blurred(size_t i);  ///< of the disc

  std::vector<Line> lines_;
  double largest_s_, step_, blur_;
  std::vector<std::array<double, 2>> disc_;  ///< points that stand for equal parts of the lamp
  double radius_ = 0, tabulated_ = -1;
  std::vector<double> g_;                    ///< circle_transform^2 S' at steps of u
  std::vector<optics::HardDiscWave> waves_;  ///< at the same steps, for any area fraction
  Table sharp_, blurred_;
};

struct CoronaFit {
  double radius = 0, radius_error = 0;  ///< m, standard error
  double area_fraction = 0, area_fraction_error = 0;
  double correlation = 0;  ///< of the two errors
  bool fraction_fixed = false;
  double residual = 0;                       ///< RMS, relative to the profile's range
  std::vector<std::array<double, 3>> model;  ///< at the profile's rings
};

/// Throws Error where no ring stands out of the smooth light.
CoronaFit fit_corona(const ScatteredProfile& profile, CoronaModel& model);

/// Angle of an extremum of one colour (0 R, 1 G, 2 B, 3 luminance).
struct RingAngle {
  double angle_deg = 0;
  bool maximum = true;
  int colour = 1;
};
/// "2.79:max:G, 4.2deg:min": kind alternates from max and colour is Y where they are left out. Throws Error.
std::vector<RingAngle> parse_ring_angles(const std::string& text);

/// Angles of the n-th maximum and minimum of a colour beyond the centre are those listed, in order. With one
/// angle the area fraction is `fixed_fraction`, as with several if that is not negative.
CoronaFit fit_ring_angles(const std::vector<RingAngle>& rings, const LampSpectrum& lamp, double error_deg,
                          double fixed_fraction);

}  // namespace aureole
