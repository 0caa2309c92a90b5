// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/curves.h"

#include <algorithm>
#include <cstring>

#include "aureole/emitter/emitter.h"
#include "aureole/shape/mesh_file.h"

namespace aureole {

namespace {

constexpr double kPiD = 3.14159265358979323846;

/// The inside of a curve is not seen (as Mitsuba 3): a ray that starts within, or enters at an open end,
/// passes.
void reject_inside(const RTCFilterFunctionNArguments* args) {
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const float facing = RTCHitN_Ng_x(args->hit, args->N, i) * RTCRayN_dir_x(args->ray, args->N, i) +
                         RTCHitN_Ng_y(args->hit, args->N, i) * RTCRayN_dir_y(args->ray, args->N, i) +
                         RTCHitN_Ng_z(args->hit, args->N, i) * RTCRayN_dir_z(args->ray, args->N, i);
    if (facing > 0) args->valid[i] = 0;
  }
}

}  // namespace

Curves::Curves(const Properties& properties, std::uint32_t points_per_segment, RTCGeometryType type)
    : UnsampledShape(properties), points_per_segment_(points_per_segment), type_(type) {
  if (emitter())
    throw Error(emitter()->properties().where(), "a curve cannot be an emitter; use a cylinder or a mesh");
  read(properties);
}

void Curves::read(const Properties& properties) {
  const MeshFile file(properties);
  const auto m = properties.get_transform("to_world").matrix();
  std::size_t start = 0;  // of the present curve
  const auto finish_curve = [&](const char* at) {
    const std::size_t n = points_.size() - start;
    if (n > 0 && n < points_per_segment_)
      throw file.error_at(at, "a curve needs at least " + std::to_string(points_per_segment_) +
                                  " control points, the one before this line has " + std::to_string(n));
    for (std::size_t i = start; i + points_per_segment_ <= points_.size(); ++i)
      first_.push_back(std::uint32_t(i));
    start = points_.size();
  };
  for (const char* at = file.begin(); at < file.end();) {
    const char* newline = static_cast<const char*>(std::memchr(at, '\n', std::size_t(file.end() - at)));
    Scanner s{at, newline ? newline : file.end()};
    if (s.at_end()) {
      finish_curve(at);
    } else {
      double v[4];
      for (double& x : v)
        if (!s.number(x)) throw file.error_at(s.at, "expected four numbers: x, y, z and the radius");
      if (!s.at_end()) throw file.error_at(s.at, "there is more than x, y, z and the radius");
      ControlPoint c;
      for (int i = 0; i < 3; ++i) c.p[i] = float(m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2] + m[i][3]);
      c.radius = float(v[3]);
      if (!is_finite(c.p) || !std::isfinite(c.radius)) throw file.error_at(at, "not a finite control point");
      if (c.radius < 0) throw file.error_at(at, "the radius must not be negative");
      const Vec3 r{c.radius, c.radius, c.radius};
      bounds_.extend(c.p - r), bounds_.extend(c.p + r);
      if (points_.size() == std::size_t(~0u)) throw file.error("more than 2^32 control points");
      points_.push_back(c);
    }
    at = newline ? newline + 1 : file.end();
  }
  finish_curve(file.end());
  if (first_.empty()) throw file.error("no control points in the file");
  points_.shrink_to_fit(), first_.shrink_to_fit();
}

RTCGeometry Curves::make_geometry(RTCDevice device) const {
  RTCGeometry g = rtcNewGeometry(device, type_);
  static_assert(sizeof(ControlPoint) == 16);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, points_.data(), 0,
                             sizeof(ControlPoint), points_.size());
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, first_.data(), 0,
                             sizeof(std::uint32_t), first_.size());
  rtcSetGeometryIntersectFilterFunction(g, reject_inside);
  rtcSetGeometryOccludedFilterFunction(g, reject_inside);
  rtcCommitGeometry(g);
  return g;
}

std::size_t Curves::memory_bytes() const {
  return points_.capacity() * sizeof(ControlPoint) + first_.capacity() * sizeof(std::uint32_t);
}

Vec3 Curves::point_error(std::uint32_t primitive, const Vec3& p) const {
  const ControlPoint* c = segment(primitive);
  Bounds3 box;
  float radius = 0;
  for (std::uint32_t i = 0; i < points_per_segment_; ++i)
    box.extend(c[i].p), radius = std::max(radius, c[i].radius);
  const float size = max_component(box.diagonal()) + radius;
  const float e = 0x1p-24f * (8 * max_component(abs(p)) + 64 * size);
  return {e, e, e};
}

CurveFrame::CurveFrame(const Double3& tangent) {
  const Double3 guide = Double3(0, 0, 1) - tangent * tangent.z;
  const double l = length(guide);
  rotation = l > 1e-4 ? guide * (1 / l) : Double3(0, 1, 0);
  radius = cross(rotation, tangent);
}

float CurveFrame::u_of(const Double3& direction) const {
  const double u = std::atan2(dot(rotation, direction), dot(radius, direction)) / (2 * kPiD);
  return float(u < 0 ? u + 1 : u);
}

Double3 CurveFrame::direction(float u) const {
  return radius * std::cos(2 * kPiD * u) + rotation * std::sin(2 * kPiD * u);
}

std::vector<ParameterDoc> curve_parameters() {
  return {
      {"filename", "file", "", "required",
       "A text file with the control points: a line x, y, z, radius for each, an empty line between curves."},
      {"bsdf", "bsdf", "", "diffuse of reflectance 0.5", "What the surface is made of."},
      {"emitter", "emitter", "", "none", "Not possible: an error."},
      {"to_world", "transform", "", "identity",
       "From the file's coordinates to those of the scene. Radii do not scale with it."},
      {"silhouette_sampling_weight", "float", "", "1", "Accepted for Mitsuba's sake, has no effect."}};
}

}  // namespace aureole
