// SPDX-License-Identifier: Apache-2.0
#include "harness/path_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aureole::testing {

namespace {

using Kind = OracleVertex::Kind;
constexpr double kInf = std::numeric_limits<double>::infinity();

/// The unit direction from a vertex to another one; at most one of the two is the sky.
Double3 direction(const OracleVertex& a, const OracleVertex& b) {
  if (b.kind == Kind::sky) return b.p;
  if (a.kind == Kind::sky) return -a.p;
  return normalize(b.p - a.p);
}

/// The squared distance that turns solid angles into areas; 1 for the sky, whose measure is the solid angle.
double squared_distance(const OracleVertex& a, const OracleVertex& b) {
  if (a.kind == Kind::sky || b.kind == Kind::sky) return 1;
  const Double3 to = b.p - a.p;
  return dot(to, to);
}

/// The cosine of a surface with a direction; 1 where there is no surface.
double cosine(const OracleVertex& v, const Double3& d) {
  return v.kind == Kind::surface ? std::abs(dot(v.rectangle->normal(), d)) : 1;
}

/// The part of a cosine to the power n that lies around the mirror direction.
double phong_lobe(const Double3& n, const Double3& from, const Double3& to, double exponent) {
  const double c = dot(n * (2 * dot(n, from)) - from, to);
  return c > 0 ? std::pow(c, exponent) / (2 * M_PI) : 0;
}

double triangle_solid_angle(const Double3& a, const Double3& b, const Double3& c) {
  // By the angles between the planes of the sides (Girard).
  const auto angle = [](const Double3& at, const Double3& u, const Double3& v) {
    const Double3 m = cross(at, u), n = cross(at, v);
    return std::atan2(length(cross(m, n)), dot(m, n));
  };
  return angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - M_PI;
}

}  // namespace

double PathOracle::scattering(const OracleVertex& v, const Double3& from, const Double3& to,
                              double nm) const {
  if (v.kind == Kind::medium) return scene_.fog->scattering(nm) * direction_pdf(v, from, to, nm);
  const Double3 n = v.rectangle->normal();
  const Material& m = v.rectangle->material;
  if (!(dot(n, from) > 0 && dot(n, to) > 0)) return 0;
  switch (m.kind) {
    case Material::Kind::lambert:
      return m.reflectance(nm) / M_PI;
    case Material::Kind::phong: {
      const double e = m.exponent(nm);
      return m.reflectance(nm) / M_PI + m.glossy(nm) * (e + 2) * phong_lobe(n, from, to, e);
    }
    case Material::Kind::mirror:
      return m.reflectance(nm) / dot(n, to);
  }
  return 0;
}

double PathOracle::direction_pdf(const OracleVertex& v, const Double3& from, const Double3& to,
                                 double nm) const {
  if (v.kind == Kind::medium) {
    const double g = scene_.fog->mean_cosine, c = -dot(from, to);
    return (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * c, 1.5));
  }
  const Double3 n = v.rectangle->normal();
  const Material& m = v.rectangle->material;
  if (!(dot(n, from) > 0 && dot(n, to) > 0)) return 0;
  switch (m.kind) {
    case Material::Kind::lambert:
      return dot(n, to) / M_PI;
    case Material::Kind::phong: {
      const double e = m.exponent(nm), share = m.diffuse_share(nm);
      return share * dot(n, to) / M_PI + (1 - share) * (e + 1) * phong_lobe(n, from, to, e);
    }
    case Material::Kind::mirror:
      return 1;
  }
  return 0;
}

std::pair<double, double> PathOracle::in_fog(const Double3& o, const Double3& d, double t_max) const {
  double begin = 0, end = t_max;
  const double origin[] = {o.x, o.y, o.z}, along[] = {d.x, d.y, d.z};
  const double lower[] = {scene_.fog->lower.x, scene_.fog->lower.y, scene_.fog->lower.z},
               upper[] = {scene_.fog->upper.x, scene_.fog->upper.y, scene_.fog->upper.z};
  for (int i = 0; i < 3; ++i) {
    const double a = (lower[i] - origin[i]) / along[i], b = (upper[i] - origin[i]) / along[i];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return {begin, end};
}

double PathOracle::transmittance(const OracleVertex& a, const OracleVertex& b, double nm) const {
  if (!scene_.fog) return 1;
  if (a.kind == Kind::sky) return transmittance(b, a, nm);
  const double far = b.kind == Kind::sky ? kInf : std::sqrt(squared_distance(a, b));
  const auto [begin, end] = in_fog(a.p, direction(a, b), far);
  return end > begin ? std::exp(-extinction(nm) * (end - begin)) : 1;
}

double PathOracle::arrival(const OracleVertex& from, const OracleVertex& to, double nm) const {
  const double pdf =
      cosine(to, direction(from, to)) / squared_distance(from, to) * transmittance(from, to, nm);
  return to.kind == Kind::medium ? pdf * extinction(nm) : pdf;
}

double PathOracle::sensor_direction_pdf(const Double3& d) const {
  const Pinhole& c = scene_.camera;
  const double cos = dot(d, c.forward), size = c.pixel_size();
  return 1 / (cos * cos * cos * size * size * c.width * c.height);
}

std::array<double, 2> PathOracle::film_position(const Double3& p) const {
  const Pinhole& c = scene_.camera;
  const Double3 to = p - c.p;
  const double z = dot(to, c.forward) * c.pixel_size();
  return {0.5 * c.width - dot(to, c.left) / z, 0.5 * c.height - dot(to, c.up) / z};
}

bool PathOracle::is_on_film(const Double3& p) const {
  const auto [x, y] = film_position(p);
  const bool before = dot(p - scene_.camera.p, scene_.camera.forward) > 0.01;
  return before && x > 0.01 && y > 0.01 && x < scene_.camera.width - 0.01 && y < scene_.camera.height - 0.01;
}

double PathOracle::contribution(const OraclePath& path, double nm) const {
  const OracleVertex& light = path[0];
  double f = 1;
  if (light.kind == Kind::surface) {
    const bool front = dot(light.rectangle->normal(), direction(light, path[1])) > 0;
    f = front ? (*light.rectangle->radiance)(nm) : 0;
  } else {
    f = light.kind == Kind::sky ? (*scene_.sky)(nm) : scene_.point->intensity(nm);
  }
  const std::size_t last = path.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    const OracleVertex &a = path[i], &b = path[i + 1];
    const Double3 d = direction(a, b);
    f *= cosine(a, d) * cosine(b, d) / squared_distance(a, b) * transmittance(a, b, nm);
    if (i > 0) f *= scattering(a, direction(a, path[i - 1]), d, nm);
  }
  return f * sensor_direction_pdf(direction(path[last], path[last - 1]));
}

double PathOracle::power_probability(const OracleVertex& light) const {
  // The spectra of all lights of a scene are multiples of one: its value at a wavelength stands for the power
  // in it.
  constexpr double kAnywhere = 550;
  double chosen = 0, all = 0;
  for (const Rectangle& r : scene_.rectangles) {
    if (!r.radiance) continue;
    const double power = M_PI * r.area() * (*r.radiance)(kAnywhere);
    all += power;
    if (light.rectangle == &r) chosen = power;
  }
  if (scene_.point) {
    const double power = 4 * M_PI * scene_.point->intensity(kAnywhere);
    all += power;
    if (light.kind == Kind::point_light) chosen = power;
  }
  if (scene_.sky) {
    const double r = sky_disc_radius(), power = 4 * M_PI * M_PI * r * r * (*scene_.sky)(kAnywhere);
    all += power;
    if (light.kind == Kind::sky) chosen = power;
  }
  return chosen / all;
}

double PathOracle::sky_disc_radius() const {
  Double3 lower{kInf, kInf, kInf}, upper{-kInf, -kInf, -kInf};
  const auto extend = [&](const Double3& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  };
  for (const Rectangle& r : scene_.rectangles)
    for (int a = -1; a <= 1; a += 2)
      for (int b = -1; b <= 1; b += 2) extend(r.center + r.half_x * a + r.half_y * b);
  if (scene_.fog) extend(scene_.fog->lower), extend(scene_.fog->upper);
  return 0.5 * length(upper - lower);
}

double PathOracle::from_light(const OraclePath& path, std::size_t i, double nm) const {
  const OracleVertex& light = path[0];
  if (i == 0) {
    const double choice = power_probability(light);
    if (light.kind == Kind::surface) return choice / light.rectangle->area();
    return light.kind == Kind::sky ? choice / (4 * M_PI) : choice;
  }
  const OracleVertex& from = path[i - 1];
  const Double3 d = direction(from, path[i]);
  double leaving;
  if (i > 1)
    leaving = direction_pdf(from, direction(from, path[i - 2]), d, nm);
  else if (light.kind == Kind::surface)
    leaving = std::max(dot(light.rectangle->normal(), d), 0.) / M_PI;
  else if (light.kind == Kind::sky)
    leaving = 1 / (M_PI * sky_disc_radius() * sky_disc_radius());  // per area across the direction
  else
    leaving = 1 / (4 * M_PI);
  return leaving * arrival(from, path[i], nm);
}

double PathOracle::from_sensor(const OraclePath& path, std::size_t i, double nm) const {
  const OracleVertex &from = path[i + 1], &to = path[i];
  if (to.kind == Kind::point_light) return 0;
  const Double3 d = direction(from, to);
  const double leaving = from.kind == Kind::pinhole
                             ? sensor_direction_pdf(d)
                             : direction_pdf(from, direction(from, path[i + 2]), d, nm);
  return leaving * arrival(from, to, nm);
}

double PathOracle::light_sampling(const OraclePath& path) const {
  const OracleVertex &light = path[0], &from = path[1];
  const Double3 facing = from.kind == Kind::surface ? from.rectangle->normal() : Double3{};
  const double choice = probabilities_.of_connection(from.p, facing, light);
  const Double3 d = direction(from, light);
  if (light.kind == Kind::point_light) return choice;
  if (light.kind == Kind::sky)
    return choice * (from.kind == Kind::surface ? cosine(from, d) / M_PI : 1 / (4 * M_PI));
  // Uniform in area from far away, else in solid angle: what is far, the first of the two triangles decides.
  const Rectangle& r = *light.rectangle;
  const double diagonal = 4 * (dot(r.half_x, r.half_x) + dot(r.half_y, r.half_y));
  const Double3 to_centroid = r.center - (r.half_x + r.half_y) * (1. / 3) - from.p;
  if (diagonal < 1.5 * dot(to_centroid, to_centroid)) return choice / r.area();
  const auto corner = [&](int a, int b) {
    return normalize(r.center + r.half_x * a + r.half_y * b - from.p);
  };
  const double solid_angle = triangle_solid_angle(corner(-1, -1), corner(1, -1), corner(1, 1)) +
                             triangle_solid_angle(corner(-1, -1), corner(1, 1), corner(-1, 1));
  return choice / solid_angle * cosine(light, d) / squared_distance(from, light);
}

double PathOracle::pdf(const OraclePath& path, std::size_t s, double nm) const {
  const std::size_t last = path.size() - 1;
  // No technique connects a light with the pinhole, or anything with a mirror.
  if (s >= 1 && (last < 2 || path[s - 1].is_mirror() || path[s].is_mirror())) return 0;
  double p = 1;
  if (s == 1)
    p = light_sampling(path);
  else
    for (std::size_t i = 0; i < s; ++i) p *= from_light(path, i, nm);
  for (std::size_t i = s; i < last; ++i) p *= from_sensor(path, i, nm);
  return p;
}

double PathOracle::equiangular(const OraclePath& path, const Wavelengths& w) const {
  // The rules of integrator/path.cpp and transport/segment.h: only early in the path, and near the light.
  const OracleVertex &light = path[0], &at = path[1], &from = path[2];
  if (!scene_.fog || light.kind == Kind::sky || at.kind != Kind::medium || path.size() - 3 >= 8) return 0;
  const Double3 d = direction(from, at);
  const OracleVertex behind = hit(from.p, d);
  const double far = behind.kind == Kind::sky ? kInf : std::sqrt(squared_distance(from, behind));
  const auto [begin, end] = in_fog(from.p, d, far);
  Double3 pivot = light.p;
  double radius = 0;
  if (light.kind == Kind::surface) {
    pivot = light.rectangle->center;
    radius = length(light.rectangle->half_x + light.rectangle->half_y);
  }
  const Double3 o = from.p + d * begin;
  const double nearest = dot(pivot - o, d), t_max = end - begin;
  const double distance = std::max(length(pivot - o - d * nearest), radius);
  double sigma = 0;
  for (int j = 0; j < kWavelengths; ++j) sigma += extinction(w.nm[j]) / kWavelengths;
  if (!(sigma * distance < 1) || !(sigma * std::clamp(nearest, 0., t_max) < 4)) return 0;
  const double angle = std::atan((t_max - nearest) / distance) - std::atan(-nearest / distance);
  const double along = length(at.p - o) - nearest;
  return distance / (angle * (distance * distance + along * along));
}

std::vector<double> PathOracle::pdfs(const OraclePath& path, double nm, const Wavelengths& w) const {
  const std::size_t last = path.size() - 1;
  if (method_ == Method::ptracer)
    return {last == 1 ? pdf(path, 0, nm) / transmittance(path[0], path[1], nm) : pdf(path, last, nm)};
  std::vector<double> result;
  if (method_ == Method::bdpt) {
    for (std::size_t s = 0; s <= last; ++s) result.push_back(pdf(path, s, nm));
    return result;
  }
  // Where light sampling cannot find a light behind fog, `path` follows a line of sight: only that, and
  // surely.
  const bool only_seen = scene_.fog && path[0].kind == Kind::surface && (last == 1 || path[1].is_mirror());
  if (only_seen) return {pdf(path, 0, nm) / transmittance(path[0], path[1], nm)};
  result = {pdf(path, 0, nm), pdf(path, 1, nm)};
  if (last >= 2) {
    if (const double position = equiangular(path, w); position > 0) {
      double p = light_sampling(path) * position / squared_distance(path[1], path[2]);
      const Double3 d = direction(path[2], path[1]);
      p *= last == 2 ? sensor_direction_pdf(d) : direction_pdf(path[2], direction(path[2], path[3]), d, nm);
      for (std::size_t i = 2; i < last; ++i) p *= from_sensor(path, i, nm);
      result.push_back(p);
    }
  }
  return result;
}

PerWavelength PathOracle::estimate(const OraclePath& path, const Wavelengths& w, bool is_splat) const {
  double sum = 0;
  for (int j = 0; j < kWavelengths; ++j)
    for (const double p : pdfs(path, w.nm[j], w)) sum += p;
  const double area = is_splat ? scene_.camera.width * scene_.camera.height : 1;
  PerWavelength result;
  for (int i = 0; i < kWavelengths; ++i)
    result[size_t(i)] = area * contribution(path, w.nm[i]) / (w.pdf[i] * sum);
  return result;
}

OracleVertex PathOracle::hit(const Double3& o, const Double3& d) const {
  constexpr double kSkipped = 1e-5;  // the surface that the ray leaves
  double nearest = kInf;
  OracleVertex result{Kind::sky, d};
  for (const Rectangle& r : scene_.rectangles) {
    const Double3 n = r.normal();
    const double t = dot(r.center - o, n) / dot(d, n);
    const Double3 at = o + d * t - r.center;
    if (t > kSkipped && t < nearest && std::abs(dot(at, r.half_x)) <= dot(r.half_x, r.half_x) &&
        std::abs(dot(at, r.half_y)) <= dot(r.half_y, r.half_y)) {
      nearest = t;
      result = {Kind::surface, o + d * t, &r};
    }
  }
  return result;
}

double PathOracle::nearest_distance(const OraclePath& path) const {
  double least = kInf;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const OracleVertex &a = path[i], &b = path[i + 1];
    const Double3 d = direction(a, b);
    least = std::min(least, std::sqrt(squared_distance(a, b)) * std::min(cosine(a, d), cosine(b, d)));
  }
  // Equiangular sampling finds the distance of the light from the ray as a difference of squares, which loses
  // digits.
  if (method_ == Method::path && path[0].kind == Kind::point_light && path[1].kind == Kind::medium)
    least = std::min(least, 0.1 * length(cross(path[0].p - path[1].p, direction(path[2], path[1]))));
  return least;
}

std::optional<bool> PathOracle::visible(const OracleVertex& a, const OracleVertex& b) const {
  if (a.kind == Kind::sky) return visible(b, a);
  constexpr double kMargin = 1e-3;
  const Double3 d = direction(a, b);
  const double far = b.kind == Kind::sky ? kInf : std::sqrt(squared_distance(a, b));
  bool is_sure = true;
  for (const Rectangle& r : scene_.rectangles) {
    if (a.rectangle == &r || b.rectangle == &r) continue;  // plane: it does not occlude itself
    const Double3 n = r.normal();
    const double t = dot(r.center - a.p, n) / dot(d, n);
    const Double3 at = a.p + d * t - r.center;
    const double x = std::abs(dot(at, r.half_x)) / dot(r.half_x, r.half_x),
                 y = std::abs(dot(at, r.half_y)) / dot(r.half_y, r.half_y);
    if (!(t > -kMargin && t < far + kMargin && x < 1 + kMargin && y < 1 + kMargin)) continue;
    if (t > kMargin && t < far - kMargin && x < 1 - kMargin && y < 1 - kMargin) return false;
    is_sure = false;
  }
  if (!is_sure) return {};
  return true;
}

}  // namespace aureole::testing
