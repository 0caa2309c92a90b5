// SPDX-License-Identifier: Apache-2.0
// Projection of Gaussian splats: Zwicker, Pfister, van Baar & Gross 2001, "EWA volume splatting"; Kerbl, Kopanas, Leimkuehler &
// Drettakis 2023, "3D Gaussian splatting for real-time radiance field rendering", equation 5.
#include "aureole/integrator/splat/splat_projector.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

namespace {

double dot_of(const SplatVector& a, const SplatVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SplatVector times(const Transform::Matrix& m, const SplatVector& v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}
SplatVector transformed(const Transform::Matrix& m, const Vec3& p) {
  const SplatVector v = times(m, {double(p.x), double(p.y), double(p.z)});
  return {v.x + m[0][3], v.y + m[1][3], v.z + m[2][3]};
}

/// A symmetric 2 x 2 matrix.
struct Covariance {
  double xx = 0, xy = 0, yy = 0;
  double determinant() const { return xx * yy - xy * xy; }
};

/// The reach of the curve |(A, B)| = k D relative to the centre, with the rows of A and B and the gradient d
/// of D. The curve is an ellipse where the dual conic C has C33 < 0; the lines x = t and y = t that touch it
/// are the roots of C_ii - 2 t C_i3 + t^2 C33. Returns false where it is no ellipse.
bool ellipse_reach(const SplatFootprint& f, double k, SplatReach& reach) {
  const double a0 = double(f.a0), a1 = double(f.a1), b0 = double(f.b0), b1 = double(f.b1), d0 = double(f.d0),
               d1 = double(f.d1);
  const double det = a0 * b1 - a1 * b0;
  // G = M^-1 M^-T of M = [[a0, a1], [b0, b1]].
  const double gxx = (b1 * b1 + a1 * a1) / (det * det), gyy = (b0 * b0 + a0 * a0) / (det * det),
               gxy = -(b1 * b0 + a1 * a0) / (det * det);
  const double gx = gxx * d0 + gxy * d1, gy = gxy * d0 + gyy * d1, c33 = d0 * gx + d1 * gy - 1 / (k * k);
  if (!(c33 < 0)) return false;
  const auto roots = [&](double gii, double gi, double& low, double& high) {
    const double root = std::sqrt(std::max(0., gi * gi - gii * c33));
    low = (-gi + root) / c33, high = (-gi - root) / c33;
  };
  roots(gxx, gx, reach.x0, reach.x1);
  roots(gyy, gy, reach.y0, reach.y1);
  return std::isfinite(reach.x0) && std::isfinite(reach.x1) && std::isfinite(reach.y0) &&
         std::isfinite(reach.y1);
}

/// Sets the quadratic form of a footprint by the inverse of a covariance of (u, v) = (sx dx + sy dy, tx dx + ty dy). Returns
/// false if it has no area.
bool set_form(const Covariance& c, double sx, double sy, double tx, double ty, SplatFootprint& f) {
  // The exponent is that of the Cholesky factor of the inverse.
  const double det = c.determinant();
  if (!(det > 0) || !std::isfinite(det)) return false;
  const double a = c.yy / det, b = -c.xy / det, root = std::sqrt(a), rest = std::sqrt(1 / c.yy);
  const double v = b / root;
  f.a0 = float(root * sx + v * tx), f.a1 = float(root * sy + v * ty);
  f.b0 = float(rest * tx), f.b1 = float(rest * ty);
  return std::isfinite(f.a0) && std::isfinite(f.a1) && std::isfinite(f.b0) && std::isfinite(f.b1);
}

}  // namespace

SplatProjector::SplatProjector(const SplatMedium& medium, const SplatSettings& settings,
                               const SplatConventions& conventions, const PinholeView& view,
                               const FilmPart& part)
    : cloud_(medium.cloud()), settings_(settings), conventions_(conventions), view_(view) {
  to_camera_ = (view.to_camera * medium.to_world()).matrix();
  turn_ = medium.to_world().orthogonal_part().inverse().matrix();
  to_world_ = medium.to_world().matrix();
  const auto back = view.to_camera.inverse().matrix();
  eye_ = {back[0][3], back[1][3], back[2][3]};
  near_ = double(std::max(settings.near, view.near));
  const float by_format = cloud_.hints.cutoff > 0 ? cloud_.hints.cutoff : 10.f / 3;
  cutoff_ = double(settings.cutoff > 0 ? settings.cutoff : settings.blends() ? by_format : 1.f);
  compensates_ = settings.compensation == SplatSettings::Compensation::on ||
                 (settings.compensation == SplatSettings::Compensation::file && cloud_.hints.antialiased);
  // Tangents at the borders of the picture, with a margin of the picture's own half width (as in gsplat, for any centre).
  const double f = double(view.focal), margin = double(settings.jacobian_limit) - 1;
  const double half_x = 0.5 * double(part.width) / f, half_y = 0.5 * double(part.height) / f;
  lower_x_ = -(double(view.center.x) - double(part.left)) / f - margin * half_x;
  upper_x_ = (double(part.left) + double(part.width) - double(view.center.x)) / f + margin * half_x;
  lower_y_ = -double(view.center.y) / f - margin * half_y;
  upper_y_ = (double(part.height) - double(view.center.y)) / f + margin * half_y;
}

SplatProjector::Outcome SplatProjector::project(std::size_t i, SplatFootprint& f, float& depth,
                                                SplatReach& reach) const {
  const SplatVector p = transformed(to_camera_, cloud_.positions[i]);
  if (!(p.z > near_ && p.z < double(view_.far))) return Outcome::outside;
  const double focal = double(view_.focal), distance = std::sqrt(dot_of(p, p));
  f.x = float(double(view_.center.x) + focal * p.x / p.z),
  f.y = float(double(view_.center.y) + focal * p.y / p.z);
  if (!std::isfinite(f.x) || !std::isfinite(f.y) || !std::isfinite(float(distance))) return Outcome::outside;
  f.distance = float(distance);
  depth = conventions_.sorting == SplatHints::Sorting::camera_distance ? f.distance : float(p.z);
  f.d0 = f.d1 = 0;
  f.weight = cloud_.opacities[i];

  // Columns of the matrix that maps the unit sphere to the splat in camera space.
  const auto& r = cloud_.rotations[i];
  const double w = double(r[0]), x = double(r[1]), y = double(r[2]), z = double(r[3]);
  SplatVector axes[3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                         {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                         {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const double scale = double(cloud_.scales[i][k]);
    const SplatVector a = times(to_camera_, axes[k]);
    axes[k] = {a.x * scale, a.y * scale, a.z * scale};
    longest = std::max(longest, std::sqrt(dot_of(axes[k], axes[k])));
  }
  f.range = float(double(settings_.depth_range) * longest);
  if (settings_.footprint == SplatSettings::Footprint::point) {
    f.x = std::floor(f.x) + 0.5f, f.y = std::floor(f.y) + 0.5f;
    f.a0 = f.a1 = f.b0 = f.b1 = 0, f.weight = 1, f.min_exponent = 0;
    reach = {-0.5, 0.5, -0.5, 0.5};
  } else if (const Outcome outcome = set_footprint(p, distance, axes, f, reach);
             outcome != Outcome::visible) {
    return outcome;
  }
  f.reach_y = float(std::max(-reach.y0, reach.y1) * (1 + 1e-6));
  return Outcome::visible;
}

SplatProjector::Outcome SplatProjector::set_footprint(const SplatVector& p, double distance,
                                                      const SplatVector axes[3], SplatFootprint& f,
                                                      SplatReach& reach) const {
  using Footprint = SplatSettings::Footprint;
  const double focal = double(view_.focal);
  Covariance c;
  const auto add_axes = [&](const SplatVector& row_x, const SplatVector& row_y) {
    for (int k = 0; k < 3; ++k) {
      const double u = dot_of(row_x, axes[k]), v = dot_of(row_y, axes[k]);
      c.xx += u * u, c.xy += u * v, c.yy += v * v;
    }
  };
  bool has_form;
  double area_ratio = 1;
  const auto dilate = [&](double variance) {
    const double before = std::max(0., c.determinant());
    c.xx += variance, c.yy += variance;
    area_ratio = std::sqrt(before / c.determinant());
  };
  if (conventions_.projection == SplatHints::Projection::tangential) {
    const SplatVector n{p.x / distance, p.y / distance, p.z / distance};
    const Frame frame = Frame::from_normal({float(n.x), float(n.y), float(n.z)});
    const SplatVector e{double(frame.s.x), double(frame.s.y), double(frame.s.z)},
        g{double(frame.t.x), double(frame.t.y), double(frame.t.z)};
    add_axes(e, g);
    dilate(double(settings_.dilation) * distance * distance / (focal * focal));
    const double unit = p.z / focal, slope = p.z / (focal * distance);
    has_form = set_form(c, unit * e.x, unit * e.y, unit * g.x, unit * g.y, f);
    f.d0 = float(n.x * slope), f.d1 = float(n.y * slope);
  } else if (settings_.footprint == Footprint::gaussian) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, std::sqrt(dot_of(axes[k], axes[k])));
    const double deviation = longest * focal / p.z;
    c.xx = c.yy = deviation * deviation;
    has_form = set_form(c, 1, 0, 0, 1, f);
  } else {
    const double tx = std::clamp(p.x / p.z, lower_x_, upper_x_),
                 ty = std::clamp(p.y / p.z, lower_y_, upper_y_), scale = focal / p.z;
    add_axes({scale, 0, -scale * tx}, {0, scale, -scale * ty});
    dilate(double(settings_.dilation));
    has_form = set_form(c, 1, 0, 0, 1, f);
  }
  if (!has_form) return Outcome::no_area;
  double k = cutoff_;
  if (settings_.blends()) {
    if (compensates_) f.weight *= float(area_ratio);
    if (!(f.weight > 0) || f.weight < settings_.opacity_limit) return Outcome::outside;
    if (settings_.opacity_limit > 0)
      k = std::min(k, std::sqrt(2 * std::log(double(f.weight) / double(settings_.opacity_limit))));
  } else if (settings_.footprint == Footprint::ewa) {
    // height of the convolution of a Gaussian of height 1 with one of area 1
    f.weight = float(area_ratio);
  } else {
    f.weight = 1;
    if (settings_.footprint == Footprint::disc) k = 1;
  }
  f.min_exponent = float(-0.5 * k * k);
  constexpr double kEverywhere = 1e9;
  if (!(k > 0)) k = 1e-3;
  if (!ellipse_reach(f, k * (1 + 1e-5), reach))
    reach = {-kEverywhere, kEverywhere, -kEverywhere, kEverywhere};
  return Outcome::visible;
}

void SplatProjector::set_color(std::size_t i, SplatFootprint& f) const {
  SplatVector p = transformed(to_world_, cloud_.positions[i]);
  p = {p.x - eye_.x, p.y - eye_.y, p.z - eye_.z};
  const SplatVector d = times(turn_, p);
  const double scale = 1 / std::sqrt(dot_of(d, d));
  float functions[16];
  eval_harmonics(cloud_.degree, {float(d.x * scale), float(d.y * scale), float(d.z * scale)}, functions);
  const Vec3 c = harmonic_color(cloud_.harmonics_of(i), functions, cloud_.coefficients());
  for (int k = 0; k < 3; ++k) {
    f.color[k] = std::max(0.f, c[k]);
    // Interpolation of points is linear in light.
    if (!settings_.blends() && conventions_.colors == SplatHints::Colors::srgb)
      f.color[k] = srgb_decode(f.color[k]);
  }
}

}  // namespace aureole
