// SPDX-License-Identifier: Apache-2.0
#include "harness/path_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "aureole/emitter/light.h"
#include "aureole/shape/shape.h"

namespace aureole::testing {

namespace {

/// Of estimates, relative to the largest over the wavelengths: the integrators compute in float.
constexpr double kTolerance = 1e-3;
/// Rays begin and end up to 1e-6 off the surfaces. Of a vertex that lies this close to a neighbour, or to the
/// plane of its surface, that changes cosines by a part of the tolerance.
constexpr double kNear = 1e-2;

}  // namespace

PathCheck::PathCheck(const ClosedFormScene& scene, PathOracle oracle, int max_depth)
    : scene_(scene), oracle_(std::move(oracle)), max_depth_(std::size_t(max_depth)) {
  pinhole_ = {Kind::pinhole, scene.camera.p};
}

void PathCheck::begin(const Path& path) {
  path_ = path;
  light_.clear(), sensor_.assign(1, pinhole_);
  of_sensor_ = false;
  connected_.clear(), hits_.clear();
  pixel_ = splats_ = {};
}

OraclePath PathCheck::joined(OraclePath path, std::size_t count) const {
  for (std::size_t i = count; i-- > 0;) path.push_back(sensor_[i]);
  return path;
}

void PathCheck::arrive(const PathEvent& e) {
  // A walk from the sensor begins with depth 0, one from a light with depth 1.
  of_sensor_ = of_sensor_ || e.depth == 0;
  OraclePath& walk = of_sensor_ ? sensor_ : light_;
  ray_start_ = std::size_t(e.depth) + of_sensor_;
  ASSERT_EQ(walk.size(), ray_start_);
  if (e.kind == PathEvent::Kind::medium) {
    walk.push_back({Kind::medium, Double3(e.p)});
  } else if (e.kind == PathEvent::Kind::surface) {
    const std::string id = e.point->shape->id();
    if (id == "fog") return;  // its box is no vertex
    walk.push_back({Kind::surface, Double3(e.p), &scene_.rectangles.at(std::stoul(id.substr(1)))});
  }
}

OracleVertex PathCheck::light_at(const PathEvent& e) const {
  if (e.infinite) return {Kind::sky, Double3(e.d)};
  const Double3 p(e.p);
  constexpr double kRounding = 1e-5;
  if (scene_.point && length(p - scene_.point->p) < kRounding) return {Kind::point_light, scene_.point->p};
  for (const Rectangle& r : scene_.rectangles) {
    const double above = dot(p - r.center, r.normal());
    if (r.radiance && std::abs(above) < kRounding &&
        length(p - r.center) < length(r.half_x + r.half_y) + kRounding)
      return {Kind::surface, p - r.normal() * above, &r};
  }
  ADD_FAILURE() << "there is no light: " << to_string(e);
  return {Kind::sky, {0, 0, 1}};
}

void PathCheck::compare_visibility(const OracleVertex& a, const OracleVertex& b, const PathEvent& e) {
  const std::optional<bool> visible = oracle_.visible(a, b);
  if (visible) {
    EXPECT_EQ(*visible, e.open) << to_string(e);
  }
  counts_.occluded += !e.open;
}

void PathCheck::compare(const OraclePath& path, const PathEvent& e, bool is_splat) {
  for (int i = 0; i < kWavelengths; ++i) (is_splat ? splats_ : pixel_)[size_t(i)] += double(e.estimate[i]);
  if (oracle_.nearest_distance(path) < kNear) {
    ++counts_.near;
    return;
  }
  const Wavelengths& w = path_.wavelengths;
  const PerWavelength expected = oracle_.estimate(path, w, is_splat);
  const double largest = *std::max_element(expected.begin(), expected.end());
  for (int i = 0; i < kWavelengths; ++i)
    ASSERT_NEAR(e.estimate[i], expected[size_t(i)], kTolerance * largest)
        << to_string(e) << ", a path of " << path.size() - 1 << " segments at " << w.nm[i]
        << " nm; logged / expected = " << e.estimate[i] / expected[size_t(i)];
  double least = HUGE_VAL, most = 0;
  for (int j = 0; j < kWavelengths; ++j) {
    double sum = 0;
    for (const double p : oracle_.pdfs(path, w.nm[j], w)) sum += p;
    least = std::min(least, sum), most = std::max(most, sum);
  }
  counts_.spectral += most > 1.1 * least;
  counts_.mirror +=
      std::any_of(path.begin(), path.end(), [](const OracleVertex& v) { return v.is_mirror(); });
}

void PathCheck::connect(const PathEvent& e) {
  OraclePath path;
  if (e.vertex > 0)
    path.assign(light_.begin(), light_.begin() + e.vertex + 1);
  else
    path.push_back(light_at(e));
  if (e.along_ray) path.push_back({Kind::medium, Double3(e.from)});
  const std::size_t from_light = path.size();
  path = joined(path, e.along_ray ? ray_start_ : sensor_.size());
  if (e.vertex > 0) connected_.insert({e.vertex, sensor_.size() - 1});
  const std::size_t end = e.along_ray ? from_light - 1 : from_light;
  compare_visibility(path[end - 1], path[end], e);
  if (!e.open) return;
  ++(e.vertex > 0 ? counts_.vertex : e.along_ray ? counts_.along : counts_.light);
  compare(path, e, false);
}

void PathCheck::see(const PathEvent& e) {
  ++counts_.seen;
  if (oracle_.method() == PathOracle::Method::ptracer)  // what the ray of the sensor hits
    return compare({oracle_.hit(pinhole_.p, Double3(path_.ray.d)), pinhole_}, e, false);
  // The line of sight begins at the sensor or at a mirror.
  const OracleVertex light = light_at(e);
  std::size_t count = sensor_.size();
  const auto begins_at = [&](const OracleVertex& v) {
    return v.is_mirror() && length(normalize(light.p - v.p) - Double3(e.d)) < 1e-4;
  };
  while (count > 1 && !begins_at(sensor_[count - 1])) --count;
  compare(joined({light}, count), e, false);
}

void PathCheck::operator()(const PathEvent& e) {
  switch (e.kind) {
    case PathEvent::Kind::start: {
      PathEvent towards = e;
      towards.infinite = e.light->is_infinite(), towards.d = -e.d;
      light_.assign(1, light_at(towards));
      return;
    }
    case PathEvent::Kind::surface:
    case PathEvent::Kind::medium:
    case PathEvent::Kind::escape:
      return arrive(e);
    case PathEvent::Kind::emission:
      ++counts_.hit;
      ASSERT_EQ(sensor_.size(), std::size_t(e.depth) + !e.infinite);
      if (!e.infinite) hits_.insert(std::size_t(e.depth));
      return compare(joined({light_at(e)}, std::size_t(e.depth)), e, false);
    case PathEvent::Kind::connection:
      return connect(e);
    case PathEvent::Kind::sensor: {
      connected_.insert({light_.size() - 1, 0});
      compare_visibility(light_.back(), pinhole_, e);
      if (!e.open) return;
      ++counts_.sensor;
      const auto film = oracle_.film_position(light_.back().p);
      EXPECT_NEAR(e.film.x, film[0], 1e-3);
      EXPECT_NEAR(e.film.y, film[1], 1e-3);
      OraclePath path = light_;
      path.push_back(pinhole_);
      return compare(path, e, true);
    }
    case PathEvent::Kind::other:
      return see(e);
    default:
      FAIL() << to_string(e);
  }
}

void PathCheck::expect_found(bool is_found, const OraclePath& path, std::size_t i) const {
  if (is_found || path.size() - 1 > max_depth_) return;
  if (i > 0 && (path[i - 1].is_mirror() || path[i].is_mirror())) return;
  const double nm = path_.wavelengths.nm[0];
  EXPECT_FALSE(oracle_.is_on_film(path[path.size() - 2].p) && oracle_.nearest_distance(path) > kNear &&
               oracle_.contribution(path, nm) > 0)
      << "a path of " << path.size() - 1 << " segments is not found by " << i << " vertices from the light";
}

void PathCheck::find_missing() const {
  using Method = PathOracle::Method;
  for (std::size_t i = 1; i < light_.size(); ++i)
    for (std::size_t j = 0; j < (oracle_.method() == Method::bdpt ? sensor_.size() : 1); ++j) {
      const OraclePath from_light(light_.begin(), light_.begin() + std::ptrdiff_t(i) + 1);
      expect_found(connected_.contains({i, j}), joined(from_light, j + 1), i + 1);
    }
  // Lines of sight find what they have begun, whatever the walk does.
  if (oracle_.method() == Method::path && scene_.fog) return;
  for (std::size_t j = 1; j < sensor_.size(); ++j)
    if (sensor_[j].rectangle && sensor_[j].rectangle->radiance)
      expect_found(hits_.contains(j), joined({}, j + 1), 0);
}

void PathCheck::end(const Path& path, const std::vector<Splat>& splats) {
  PerWavelength splatted{};
  for (const Splat& s : splats)
    for (std::size_t i = 0; i < kWavelengths; ++i) splatted[i] += double(s.estimate[int(i)]);
  for (std::size_t i = 0; i < kWavelengths; ++i) {
    EXPECT_NEAR(path.result.estimate[int(i)], pixel_[i], 1e-5 * pixel_[i]) << "the log lacks an estimate";
    EXPECT_NEAR(splatted[i], splats_[i], 1e-5 * splats_[i]) << "the log lacks a splat";
  }
  find_missing();
}

}  // namespace aureole::testing
