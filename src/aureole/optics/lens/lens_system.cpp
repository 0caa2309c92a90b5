// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/lens/lens_system.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace aureole::optics {

namespace {

using Vector3 = std::array<double, 3>;

double inner(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Where a ray, whose coordinates are relative to the vertex, hits a surface: the distance along it.
std::optional<double> distance_to(const LensSurface& s, const LensRay& ray) {
  const auto& [o, d] = ray;
  if (std::abs(d[2]) < 1e-9) return {};
  const double to_plane = -o[2] / d[2];
  if (s.curvature == 0 && s.even.empty()) return to_plane;
  double t = to_plane;
  if (s.curvature != 0) {
    // The conic x^2 + y^2 + (1 + k) z^2 - 2 z / c = 0. Of its two points the one near the vertex counts, which is found
    // without loss of digits from the plane z = 0.
    const Vector3 p{o[0] + d[0] * to_plane, o[1] + d[1] * to_plane, 0};
    const double k1 = 1 + s.conic, c = s.curvature;
    const double a = c * (d[0] * d[0] + d[1] * d[1] + k1 * d[2] * d[2]);
    const double b = c * (p[0] * d[0] + p[1] * d[1]) - d[2];
    const double e = c * (p[0] * p[0] + p[1] * p[1]);
    const double root = b * b - a * e;
    if (root < 0) return {};
    t = to_plane + e / (-b + std::copysign(std::sqrt(root), -b));
  }
  if (s.even.empty()) return t;
  // Newton's iteration on z - sag(r) along the ray.
  constexpr int kMostSteps = 50;
  for (int step = 0; step < kMostSteps; ++step) {
    const double x = o[0] + d[0] * t, y = o[1] + d[1] * t, z = o[2] + d[2] * t, r = std::hypot(x, y);
    const auto height = LensSystem::sag(s, r);
    if (!height) return {};
    const double slope = r > 0 ? (*height)[1] * (x * d[0] + y * d[1]) / r : 0;
    const double change = (z - (*height)[0]) / (d[2] - slope);
    t -= change;
    if (!std::isfinite(t)) return {};
    if (std::abs(change) < 1e-12 * (1 + std::abs(t))) return t;
  }
  return {};
}

/// Heights and reduced angles (n u) of two paraxial rays: the columns of a system matrix.
struct ParaxialMatrix {
  double a = 1, b = 0, c = 0, d = 1;  // y' = a y + b nu, nu' = c y + d nu

  void refract(double power) { c -= power * a, d -= power * b; }
  void transfer(double reduced) { a += reduced * c, b += reduced * d; }
};

}  // namespace

LensSystem::LensSystem(std::vector<LensSurface> surfaces) : surfaces_(std::move(surfaces)) {
  std::size_t stops = 0;
  double z = 0;
  if (surfaces_.empty()) throw std::domain_error("a lens needs at least one surface");
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const LensSurface& s = surfaces_[i];
    bool finite = std::isfinite(s.curvature) && std::isfinite(s.conic) && std::isfinite(s.thickness);
    for (const double e : s.even) finite &= std::isfinite(e);
    if (!finite)
      throw std::domain_error("surface " + std::to_string(i + 1) + " has a number that is not finite");
    if (!(s.semi_diameter > 0 && std::isfinite(s.semi_diameter)))
      throw std::domain_error("surface " + std::to_string(i + 1) + " needs a positive diameter");
    if (!sag(s, s.semi_diameter))
      throw std::domain_error("surface " + std::to_string(i + 1) +
                              " ends before its diameter: its radius of curvature is too small for it");
    if (s.is_stop) stop_ = i, ++stops;
    vertices_.push_back(z);
    z += s.thickness;
  }
  vertices_.push_back(z);
  if (stops != 1)
    throw std::domain_error(stops == 0 ? "the lens needs a stop"
                                       : "the lens has several stops; it needs one");
}

void LensSystem::set_film(double z) {
  vertices_.back() = z;
  surfaces_.back().thickness = z - vertices_[surfaces_.size() - 1];
}

std::optional<std::array<double, 2>> LensSystem::sag(const LensSurface& s, double r) {
  const double c = s.curvature, r2 = r * r, below = 1 - (1 + s.conic) * c * c * r2;
  if (below < 0) return {};
  const double root = std::sqrt(below);
  std::array<double, 2> result{c * r2 / (1 + root), root > 0 ? c * r / root : 0};
  double power = r2 * r;  // r^3
  for (std::size_t i = 0; i < s.even.size(); ++i, power *= r2) {
    result[0] += s.even[i] * power * r;
    result[1] += s.even[i] * power * double(2 * i + 4);
  }
  return result;
}

bool LensSystem::passes_stop(double x, double y, double semi) const {
  if (blades_ < 3) return x * x + y * y <= semi * semi;
  // Within the regular polygon whose corners lie on the circle.
  const double sector = 2 * std::numbers::pi / blades_;
  double angle = std::fmod(std::atan2(y, x) - blade_angle_, sector);
  if (angle < 0) angle += sector;
  return std::hypot(x, y) * std::cos(angle - 0.5 * sector) <= semi * std::cos(0.5 * sector);
}

std::optional<double> LensSystem::follow(LensRay& ray, std::span<const double> indices, double nm,
                                         bool forward) const {
  const std::size_t count = surfaces_.size();
  double transmittance = 1;
  for (std::size_t step = 0; step < count; ++step) {
    const std::size_t i = forward ? step : count - 1 - step;
    const LensSurface& s = surfaces_[i];
    LensRay local = ray;
    local.o[2] -= vertices_[i];
    const auto t = distance_to(s, local);
    if (!t) return {};
    Vector3 p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = local.o[k] + local.d[k] * *t;
    const double r = std::hypot(p[0], p[1]);
    if (!(r <= s.semi_diameter) || (s.is_stop && !passes_stop(p[0], p[1], s.semi_diameter))) return {};
    ray.o = {p[0], p[1], p[2] + vertices_[i]};
    const double before = i == 0 ? 1 : indices[i - 1], behind = indices[i];
    const double n1 = forward ? before : behind, n2 = forward ? behind : before;
    if (n1 == n2) continue;
    // The normal against the ray.
    const double slope = (*sag(s, r))[1];
    Vector3 n{r > 0 ? -slope * p[0] / r : 0, r > 0 ? -slope * p[1] / r : 0, 1};
    const double scale = (inner(n, ray.d) > 0 ? -1 : 1) / std::sqrt(inner(n, n));
    for (double& x : n) x *= scale;
    const double cos1 = -inner(n, ray.d), ratio = n1 / n2, square = 1 - ratio * ratio * (1 - cos1 * cos1);
    if (!(square > 0)) return {};
    const double cos2 = std::sqrt(square);
    for (std::size_t k = 0; k < 3; ++k) ray.d[k] = ratio * ray.d[k] + (ratio * cos1 - cos2) * n[k];
    const double norm = 1 / std::sqrt(inner(ray.d, ray.d));
    for (double& x : ray.d) x *= norm;
    if (s.coating_index != 1)
      transmittance *= coated_transmittance(n1, n2, cos1, s.coating_index, s.coating_nm, nm);
  }
  return transmittance;
}

double coated_transmittance(double n1, double n2, double cos1, double layer, double layer_nm, double nm) {
  if (layer == 1) return 1;
  const auto cosine = [&](double n) {
    const double s = n1 * n1 / (n * n) * (1 - cos1 * cos1);
    return std::sqrt(std::complex<double>(1 - s));
  };
  const std::complex<double> cos2 = cosine(n2);
  if (cos2.real() == 0) return 0;
  // Amplitude of reflection for both polarisations.
  using Complex = std::complex<double>;
  const auto reflection = [](double na, Complex ca, double nb, Complex cb, bool p) -> Complex {
    return p ? (nb * ca - na * cb) / (nb * ca + na * cb) : (na * ca - nb * cb) / (na * ca + nb * cb);
  };
  double reflectance = 0;
  for (const bool p : {false, true}) {
    Complex r;
    if (layer == 0) {
      r = reflection(n1, cos1, n2, cos2, p);
    } else {
      const Complex cos_layer = cosine(layer);
      const Complex r1 = reflection(n1, cos1, layer, cos_layer, p),
                    r2 = reflection(layer, cos_layer, n2, cos2, p);
      const double thickness = layer_nm / (4 * layer);
      const Complex phase = std::exp(Complex(0, 4 * std::numbers::pi / nm * layer * thickness) * cos_layer);
      r = (r1 + r2 * phase) / (1.0 + r1 * r2 * phase);
    }
    reflectance += 0.5 * std::norm(r);
  }
  return 1 - reflectance;
}

ParaxialLens LensSystem::paraxial(std::span<const double> indices) const {
  ParaxialMatrix all, before, behind;
  double n = 1;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const LensSurface& s = surfaces_[i];
    const double power = (indices[i] - n) * s.curvature;
    // The stop of a refracting surface counts before it.
    if (i == stop_) before = all, behind = ParaxialMatrix();
    all.refract(power);
    if (i >= stop_) behind.refract(power);
    n = indices[i];
    if (i + 1 == surfaces_.size()) break;
    all.transfer(s.thickness / n);
    if (i >= stop_) behind.transfer(s.thickness / n);
  }
  if (std::abs(all.c) < 1e-12)
    throw std::domain_error("the lens has no focal length: parallel light leaves it parallel");
  const double last = vertices_[surfaces_.size() - 1], semi = surfaces_[stop_].semi_diameter;
  ParaxialLens p;
  p.focal_length = -1 / all.c;
  p.back_focus = last - n * all.a / all.c;
  p.front_focus = all.d / all.c;
  // The stop's centre is conjugate with the centres of both pupils. The elements before it image the stop by the ray
  // through its centre: a y + b nu = 0 in front.
  p.entrance_pupil = before.a != 0 ? before.b / before.a : std::numeric_limits<double>::infinity();
  p.entrance_semi = before.a != 0 ? std::abs(semi / before.a) : std::numeric_limits<double>::infinity();
  p.exit_pupil = last - (behind.d != 0 ? n * behind.b / behind.d : -std::numeric_limits<double>::infinity());
  p.exit_semi = behind.d != 0 ? std::abs(semi / behind.d) : std::numeric_limits<double>::infinity();
  return p;
}

double LensSystem::paraxial_image(std::span<const double> indices, double object) const {
  double y = std::isinf(object) ? 1 : object, nu = std::isinf(object) ? 0 : 1, n = 1;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    nu -= (indices[i] - n) * surfaces_[i].curvature * y;
    n = indices[i];
    if (i + 1 < surfaces_.size()) y += surfaces_[i].thickness / n * nu;
  }
  return vertices_[surfaces_.size() - 1] - n * y / nu;
}

Spot object_spot(const LensSystem& lens, std::span<const double> indices, double nm, double field,
                 double object, int rays) {
  const ParaxialLens p = lens.paraxial(indices);
  Spot spot;
  double x_sum = 0, y_sum = 0;
  // The pupil may wander at large angles: the grid is half as large again, and the stop decides.
  constexpr double kMargin = 1.5;
  const double reach = kMargin * p.entrance_semi;
  for (int j = 0; j < rays; ++j)
    for (int i = 0; i < rays; ++i) {
      const double x = reach * (2 * (i + 0.5) / rays - 1), y = reach * (2 * (j + 0.5) / rays - 1);
      const double back = 10 + std::abs(p.entrance_pupil) + 2 * lens.surfaces()[0].semi_diameter;
      LensRay ray{{x, y, p.entrance_pupil}, {0, std::sin(field), std::cos(field)}};
      if (std::isinf(object)) {
        for (std::size_t k = 0; k < 3; ++k) ray.o[k] -= ray.d[k] * back / ray.d[2];
      } else {
        const double along = p.entrance_pupil + object, below = along * std::tan(field),
                     norm = std::hypot(x, y + below, along);
        ray = {{0, -below, -object}, {x / norm, (y + below) / norm, along / norm}};
      }
      spot.launched += x * x + y * y <= p.entrance_semi * p.entrance_semi;
      const auto t = lens.trace(ray, indices, nm);
      if (!t) continue;
      const double to_film = (lens.film() - ray.o[2]) / ray.d[2];
      spot.points.push_back({ray.o[0] + ray.d[0] * to_film, ray.o[1] + ray.d[1] * to_film});
      x_sum += spot.points.back()[0], y_sum += spot.points.back()[1];
      spot.transmittance += *t;
    }
  if (spot.points.empty()) return spot;
  const double count = double(spot.points.size());
  spot.centroid = {x_sum / count, y_sum / count};
  spot.transmittance /= count;
  double squares = 0;
  for (const auto& q : spot.points)
    squares += std::pow(q[0] - spot.centroid[0], 2) + std::pow(q[1] - spot.centroid[1], 2);
  spot.rms_radius = std::sqrt(squares / count);
  return spot;
}

double best_focus(const LensSystem& lens, std::span<const double> indices, double nm, double object) {
  const ParaxialLens p = lens.paraxial(indices);
  // On the axis the spot is symmetric: rays in one half-plane, weighted by their radius in the pupil, are enough. The
  // sum of (y + z u)^2 is least at z = -sum(y u)/sum(u^2).
  constexpr int kRays = 200;
  double yu = 0, uu = 0;
  for (int i = 0; i < kRays; ++i) {
    const double r = p.entrance_semi * (i + 0.5) / kRays;
    LensRay ray;
    if (std::isinf(object)) {
      ray = {{0, r, std::min(p.entrance_pupil, 0.0) - 1 - 2 * lens.surfaces()[0].semi_diameter}, {0, 0, 1}};
    } else {
      const double along = p.entrance_pupil + object, norm = std::hypot(r, along);
      ray = {{0, 0, -object}, {0, r / norm, along / norm}};
    }
    if (!lens.trace(ray, indices, nm)) continue;
    const double u = ray.d[1] / ray.d[2], y = ray.o[1] - u * ray.o[2];
    yu += r * y * u, uu += r * u * u;
  }
  if (!(uu > 0)) throw std::domain_error("no light passes the lens along its axis");
  return -yu / uu;
}

}  // namespace aureole::optics
