// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/curve/curves.h"

#include <algorithm>
#include <cstring>

#include "aureole/shape/mesh/mesh_file.h"

namespace aureole {

Curves::Curves(const Properties& properties, std::uint32_t points_per_segment)
    : Shape(properties), points_per_segment_(points_per_segment) {
  read(properties);
}

std::shared_ptr<const AreaSampler> Curves::make_area_sampler(AreaUse use) const {
  throw Error(std::string("a curve cannot be ") + (use == AreaUse::emitter ? "an emitter" : "a sensor") +
              "; use a cylinder or a mesh");
}

namespace {
Error number_error(const MeshFile& file, const char* at) {
  return file.error_at(at, "expected four numbers: x, y, z and the radius");
}
}  // namespace

void Curves::read(const Properties& properties) {
  const MeshFile file(properties);
  const auto m = properties.get_transform("to_world").matrix();
  const double radius = properties.get_float("radius", 0, Range::non_negative());
  if (std::string_view(file.begin(), std::min<std::size_t>(file.size(), 11)) == "BINARY_HAIR")
    throw file.error("is a binary file of hair; only text is read");
  std::size_t start = 0;  // first control point of the current curve
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
      for (int i = 0; i < 3; ++i)
        if (!s.number(v[i])) throw number_error(file, s.at);
      if (s.at_end() && radius > 0)
        v[3] = radius;
      else if (!s.number(v[3]))
        throw number_error(file, s.at);
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

std::size_t Curves::memory_bytes() const {
  return points_.capacity() * sizeof(ControlPoint) + first_.capacity() * sizeof(std::uint32_t);
}

SurfacePoint Curves::surface_point(const ShapeHit& hit, const Ray& ray, bool) const {
  const Double3 met = Double3(ray.o) + Double3(ray.d) * double(hit.t);
  const CurvePoint at = locate(hit.primitive, met, hit.u);
  SurfacePoint s;
  s.p = (at.center + at.out * at.radius).to_float();
  // Bound of the rounding error: the point is computed in double precision and rounded once. is_outside_hit
  // derives the side from it.
  s.p_error = abs(s.p) * (4 * 0x1p-24f) + abs(at.normal.to_float()) * float(at.radius * 1e-6);
  s.ng = at.normal.to_float();
  s.uv = {CurveFrame(at.tangent).u_of(at.out), float((double(hit.primitive) + at.v) / double(first_.size()))};
  s.shading = Frame::from_normal_tangent(s.ng, cross(at.tangent, at.out).to_float());
  s.shape = this;
  s.primitive = hit.primitive;
  s.barycentric = {float(at.v), 0};
  return s;
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
  return {{"filename", "file", "", "required",
           "text file of control points: a line x, y, z, radius for each, an empty line between curves"},
          {"radius", "float", "", "0", "radius of control points that have none in the file; 0: an error"},
          {"bsdf", "bsdf", "", "diffuse of reflectance 0.5", "material of the surface"},
          {"emitter", "emitter", "", "none", "not supported: an error"},
          {"sensor", "sensor", "", "none", "not supported: an error"},
          {"to_world", "transform", "", "identity",
           "transform from the file's coordinates to world space; radii do not scale with it"},
          {"silhouette_sampling_weight", "float", "", "1",
           "accepted for compatibility with Mitsuba, without effect"}};
}

}  // namespace aureole
