// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/mesh.h"

#include <fmt/format.h>

#ifdef __FMA__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstring>

#include "aureole/core/parallel.h"
#include "aureole/core/shuffle.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {

namespace {

TrianglePlane exact_plane(const TriangleCorners& c) {
  const Double3 n = cross(Double3(c[1]) - Double3(c[0]), Double3(c[2]) - Double3(c[0]));
  const double doubled_area = length(n);
  const double a = length_squared(c[1] - c[0]), b = length_squared(c[2] - c[1]),
               d = length_squared(c[0] - c[2]);
  const double longest = std::max({a, b, d}), shortest = std::min({a, b, d});
  const double middle = a + b + d - longest - shortest;
  const Vec3 ng = (n * (1 / doubled_area)).to_float();
  float farthest = 0;
  for (const Vec3& corner : c) farthest = std::max(farthest, dot(abs(ng), abs(corner)));
  return {ng, float(std::sqrt(longest) *
                    (gamma_bound(4) + gamma_bound(2) * std::sqrt(shortest * middle) / doubled_area)) +
                  farthest * gamma_bound(7)};
}

/// Four floats, of which the first three are a Vec3; the fourth is the memory behind it.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));
Float4 load(const Vec3& v) {
  Float4 r;
  std::memcpy(&r, &v, sizeof r);
  return r;
}
Vec3 to_vec3(Float4 v) { return {v[0], v[1], v[2]}; }
Float4 abs(Float4 v) { return (Float4)((Int4)v & 0x7fffffff); }
float dot3(Float4 a, Float4 b) {
  const Float4 p = a * b;
  return p[0] + p[1] + p[2];
}

/// Returns a x b, every component to within an ulp or two (Kahan's difference of products by fused
/// multiply-adds).
Float4 accurate_cross(Float4 a, Float4 b) {
  constexpr Int4 kYzx = {1, 2, 0, 3}, kZxy = {2, 0, 1, 3};
  const Float4 p = shuffle(a, kYzx), q = shuffle(b, kZxy), r = shuffle(a, kZxy), s = shuffle(b, kYzx);
#ifdef __FMA__
  const __m128 product = _mm_mul_ps(r, s);
  return _mm_add_ps(_mm_fmsub_ps(p, q, product), _mm_fnmadd_ps(r, s, product));
#else
  const auto widened = [](float x, float y, float z, float w) {
    return float(double(x) * y - double(z) * w);
  };
  return Float4{widened(p[0], q[0], r[0], s[0]), widened(p[1], q[1], r[1], s[1]),
                widened(p[2], q[2], r[2], s[2]), 0};
#endif
}

/// Computes `exact_plane` in single precision, except for triangles so small or large that squares would
/// leave the range of float.
TrianglePlane plane_of(Float4 c0, Float4 c1, Float4 c2) {
  const Float4 e1 = c1 - c0, e2 = c2 - c0, e3 = c2 - c1;
  const Float4 n = accurate_cross(e1, e2);
  const float n2 = dot3(n, n), a = dot3(e1, e1), b = dot3(e2, e2), c = dot3(e3, e3);
  const float longest = std::max({a, b, c}), shortest = std::min({a, b, c});
  if (!(n2 > 1e-30f && longest < 1e12f)) return exact_plane({to_vec3(c0), to_vec3(c1), to_vec3(c2)});
  const float middle = a + b + c - longest - shortest;
  const float per_length = 1 / std::sqrt(n2), length = std::sqrt(longest);
  const Float4 ng = n * per_length, an = abs(ng);
  const float farthest = std::max({dot3(an, abs(c0)), dot3(an, abs(c1)), dot3(an, abs(c2))});
  // The error bound is enlarged by 0.1 % for its own rounding.
  const float error =
      1.001f * (length * (gamma_bound(4) + gamma_bound(2) * std::sqrt(shortest * middle) * per_length) +
                farthest * gamma_bound(7));
  return {to_vec3(ng), error};
}

/// Returns acos to 2e-8 (Abramowitz & Stegun 1964, 4.4.46). The library's acos would dominate the time to
/// load a mesh without normals.
float fast_acos(float x) {
  const float a = std::min(std::abs(x), 1.f);
  float p = -0.0012624911f;
  for (const float c : {0.0066700901f, -0.0170881256f, 0.0308918810f, -0.0501743046f, 0.0889789874f,
                        -0.2145988016f, 1.5707963050f})
    p = p * a + c;
  p *= std::sqrt(1 - a);
  return x < 0 ? kPi - p : p;
}

std::string count_text(std::size_t n, const char* what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

}  // namespace

Mesh::Mesh(const Properties& properties)
    : Shape(properties), to_world_(properties.get_transform("to_world")) {
  identity_ = to_world_ == Transform();
  flip_normals_ = properties.get_bool("flip_normals", false);
  reverse_winding_ = (to_world_.determinant3() < 0) != flip_normals_;
  face_normals_ = properties.get_bool("face_normals", false);
  max_smooth_angle_ = properties.get_float("max_smooth_angle", 0, Range{0, 180});
}

Vec3 Mesh::place_point(double x, double y, double z) const {
  if (identity_) return {float(x), float(y), float(z)};
  const auto& m = to_world_.matrix();
  Vec3 r;
  for (int i = 0; i < 3; ++i) r[i] = float(m[i][0] * x + m[i][1] * y + m[i][2] * z + m[i][3]);
  return r;
}

Vec3 Mesh::place_normal(double x, double y, double z) const {
  Double3 n(x, y, z);
  if (!identity_) n = Double3(to_world_.normal({float(x), float(y), float(z)}));
  const double l = length(n);
  if (!(l > 0) || !std::isfinite(l)) return {};
  return (n * ((flip_normals_ ? -1 : 1) / l)).to_float();
}

void Mesh::build(MeshData data, std::string_view source) {
  data_ = std::move(data);
  if (face_normals_ || max_smooth_angle_ > 0) data_.normals = {}, data_.normal_triangles = {};
  for (const TriangleIndices& t : data_.triangles)
    for (int k = 0; k < 3; ++k)
      if (const Vec3& p = data_.positions[t[k]]; !is_finite(p))
        throw properties().error(source, fmt::format("vertex {} of {} has a position that is not finite",
                                                     t[k] + 1, data_.positions.size()));
  const std::size_t dropped = drop_degenerate();
  if (dropped) remarks_.push_back(count_text(dropped, "degenerate triangle") + " dropped");
  if (reverse_winding_)
    for (std::size_t i = 0; i < data_.triangles.size(); ++i) reverse(i);
  if (!data_.normals.empty())
    orient_by_vertex_normals();
  else if (!face_normals_ && max_smooth_angle_ > 0)
    compute_creased_normals();
  else if (!face_normals_)
    compute_vertex_normals();
  source_ = source;
  find_bounds();
  if (data_.triangles.empty()) remarks_.push_back("the mesh has no triangles");
  // Padding of one more vertex, since Embree and this class read 16 bytes at every vertex.
  data_.positions.push_back({});
  find_planes();
}

void Mesh::find_planes() {
  planes_.resize(data_.triangles.size());
  const auto corner = [&](std::uint32_t v) { return load(data_.positions[v]); };
  for_ranges(planes_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleIndices& t = data_.triangles[i];
      planes_[i] = plane_of(corner(t[0]), corner(t[1]), corner(t[2]));
    }
  });
}

std::size_t Mesh::drop_degenerate() {
  auto& d = data_;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < d.triangles.size(); ++i) {
    const Vec3 &p0 = d.positions[d.triangles[i][0]], &p1 = d.positions[d.triangles[i][1]];
    const Vec3& p2 = d.positions[d.triangles[i][2]];
    const Vec3 n = cross(p1 - p0, p2 - p0);
    // The area is tested in float: it must be positive for the ray caster, which computes in float as well.
    if (!(length_squared(n) > 0) || !is_finite(n)) {
      // A second test in double precision, since underflow of tiny triangles and overflow of huge ones are
      // not degeneracy.
      const Double3 exact = cross(Double3(p1) - Double3(p0), Double3(p2) - Double3(p0));
      const double l = length(exact);
      if (!(l > 0) || !std::isfinite(l)) continue;
    }
    if (kept != i) {
      d.triangles[kept] = d.triangles[i];
      if (!d.normal_triangles.empty()) d.normal_triangles[kept] = d.normal_triangles[i];
      if (!d.uv_triangles.empty()) d.uv_triangles[kept] = d.uv_triangles[i];
      if (!d.materials.empty()) d.materials[kept] = d.materials[i];
      for (MeshAttribute& a : d.attributes)
        if (a.of_faces()) a.move(i, kept);
    }
    ++kept;
  }
  const std::size_t dropped = d.triangles.size() - kept;
  d.triangles.resize(kept);
  if (!d.normal_triangles.empty()) d.normal_triangles.resize(kept);
  if (!d.uv_triangles.empty()) d.uv_triangles.resize(kept);
  if (!d.materials.empty()) d.materials.resize(kept);
  for (MeshAttribute& a : d.attributes)
    if (a.of_faces()) a.cut(kept);
  return dropped;
}

void Mesh::find_bounds() {
  for (const TriangleIndices& t : data_.triangles)
    for (const std::uint32_t v : t) bounds_.extend(data_.positions[v]);
}

void Mesh::reverse(std::size_t i) {
  std::swap(data_.triangles[i][0], data_.triangles[i][2]);
  if (!data_.normal_triangles.empty()) std::swap(data_.normal_triangles[i][0], data_.normal_triangles[i][2]);
  if (!data_.uv_triangles.empty()) std::swap(data_.uv_triangles[i][0], data_.uv_triangles[i][2]);
}

void Mesh::orient_by_vertex_normals() {
  std::size_t turned = 0;
  for (std::size_t i = 0; i < data_.triangles.size(); ++i) {
    const TriangleCorners c = corners(i);
    const TriangleIndices& n = normal_triangle(i);
    const Vec3 sum = data_.normals[n[0]] + data_.normals[n[1]] + data_.normals[n[2]];
    if (dot(cross(c[1] - c[0], c[2] - c[0]), sum) < 0) reverse(i), ++turned;
  }
  if (turned)
    remarks_.push_back(count_text(turned, "triangle") + " wound against the vertex normals turned around");
}

namespace {

/// Returns a triangle's normal times the angle at each corner; zero for triangles too thin for float.
std::array<Vec3, 3> weighted_normals(const TriangleCorners& c) {
  // The edges are scaled to size 1, since fourth powers of lengths easily leave the range of float.
  const Vec3 edge0 = c[1] - c[0], edge2 = c[0] - c[2];
  const float scale = 1 / std::max(max_component(abs(edge0)), max_component(abs(edge2)));
  const Vec3 e[3] = {edge0 * scale, (c[2] - c[1]) * scale, edge2 * scale};
  const Vec3 n = cross(e[0], e[1]);
  const float n2 = length_squared(n), l0 = length_squared(e[0]), l1 = length_squared(e[1]),
              l2 = length_squared(e[2]);
  const float per_n = 1 / std::sqrt(n2);
  const float a0 = fast_acos(-dot(e[2], e[0]) / std::sqrt(l2 * l0));
  const float a1 = fast_acos(-dot(e[0], e[1]) / std::sqrt(l0 * l1));
  const float a2 = std::max(0.f, kPi - a0 - a1);
  if (!std::isfinite(per_n) || !std::isfinite(a0) || !std::isfinite(a1)) return {};
  return {n * (per_n * a0), n * (per_n * a1), n * (per_n * a2)};
}

}  // namespace

void Mesh::compute_vertex_normals() {
  data_.normals.assign(data_.positions.size(), Vec3{});
  // Number of triangles of one block, on which all cores work at a time. Sums are added in the order of the
  // triangles, so that they do not depend on the number of cores.
  constexpr std::size_t kPart = 1 << 17;
  const std::size_t n = data_.triangles.size();
  std::vector<std::array<Vec3, 3>> weighted(std::min(n, kPart));
  for (std::size_t first = 0; first < n; first += kPart) {
    const std::size_t count = std::min(kPart, n - first);
    for_ranges(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) weighted[i] = weighted_normals(corners(first + i));
    });
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 3; ++k) data_.normals[data_.triangles[first + i][k]] += weighted[i][k];
  }
  for_ranges(data_.normals.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float l2 = length_squared(data_.normals[i]);
      data_.normals[i] = l2 > 0 ? data_.normals[i] * (1 / std::sqrt(l2)) : Vec3{};
    }
  });
}

void Mesh::compute_creased_normals() {
  const std::size_t n = data_.triangles.size();
  const float least = std::cos(float(max_smooth_angle_) * kPi / 180) - 1e-6f;
  std::vector<std::vector<std::uint32_t>> around(data_.positions.size());  // triangles at each vertex
  std::vector<Vec3> facing(n);
  for (std::size_t i = 0; i < n; ++i) {
    const TriangleCorners c = corners(i);
    const Double3 normal = cross(Double3(c[1]) - Double3(c[0]), Double3(c[2]) - Double3(c[0]));
    facing[i] = normalize(normal).to_float();
    for (const std::uint32_t v : data_.triangles[i]) around[v].push_back(std::uint32_t(i));
  }
  data_.normals.resize(3 * n), data_.normal_triangles.resize(n);
  for_ranges(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = data_.triangles[i][k];
        Vec3 sum;
        for (const std::uint32_t j : around[vertex]) {
          if (dot(facing[i], facing[j]) < least) continue;
          const auto at = std::find(data_.triangles[j].begin(), data_.triangles[j].end(), vertex);
          sum += weighted_normals(corners(j))[std::size_t(at - data_.triangles[j].begin())];
        }
        const float l2 = length_squared(sum);
        data_.normals[3 * i + k] = l2 > 0 ? sum * (1 / std::sqrt(l2)) : Vec3{};
        data_.normal_triangles[i][k] = std::uint32_t(3 * i + k);
      }
  });
}

RTCGeometry Mesh::make_geometry(RTCDevice device) const {
  RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, data_.positions.data(), 0,
                             sizeof(Vec3), data_.positions.size() - 1);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, data_.triangles.data(), 0,
                             sizeof(TriangleIndices), data_.triangles.size());
  rtcCommitGeometry(g);
  return g;
}

TriangleCorners Mesh::corners(std::size_t i) const {
  const TriangleIndices& t = data_.triangles[i];
  return {data_.positions[t[0]], data_.positions[t[1]], data_.positions[t[2]]};
}

Vec2 Mesh::interpolate_uv(std::uint32_t triangle, float b0, float b1, float b2) const {
  if (data_.uvs.empty()) return {b1, b2};
  const TriangleIndices& t = uv_triangle(triangle);
  return data_.uvs[t[0]] * b0 + data_.uvs[t[1]] * b1 + data_.uvs[t[2]] * b2;
}

MeshPoint Mesh::point_at(std::uint32_t triangle, float b1, float b2) const {
  const TriangleIndices& t = data_.triangles[triangle];
  const Float4 c0 = load(data_.positions[t[0]]), c1 = load(data_.positions[t[1]]),
               c2 = load(data_.positions[t[2]]);
  const float b0 = 1 - b1 - b2;
  const TrianglePlane& plane = planes_[triangle];
  MeshPoint r;
  r.p = to_vec3(c0 * b0 + c1 * b1 + c2 * b2);
  r.ng = plane.ng;
  r.p_error = abs(r.ng) * plane.error;
  r.uv = interpolate_uv(triangle, b0, b1, b2);
  return r;
}

SurfacePoint Mesh::surface_point(const ShapeHit& hit, const Ray&, bool along_du) const {
  const auto [geometry, primitive, u, v, t] = hit;
  const MeshPoint at = point_at(primitive, u, v);
  SurfacePoint s;
  s.p = at.p, s.p_error = at.p_error, s.ng = at.ng, s.uv = at.uv;
  s.shape = this;
  s.primitive = primitive;
  s.barycentric = {u, v};

  Vec3 normal = s.ng;
  if (!data_.normals.empty()) {
    const TriangleIndices& i = normal_triangle(primitive);
    const Vec3 n = data_.normals[i[0]] * (1 - u - v) + data_.normals[i[1]] * u + data_.normals[i[2]] * v;
    const float l2 = length_squared(n);
    if (l2 > 1e-12f && std::isfinite(l2)) normal = n * (1 / std::sqrt(l2));
  }
  s.shading = along_du ? Frame::from_normal_tangent(normal, tangent(primitive)) : Frame::from_normal(normal);
  return s;
}

SurfaceDerivatives Mesh::own_derivatives(const SurfacePoint& point) const {
  const TriangleCorners c = corners(point.primitive);
  const Vec3 e1 = c[1] - c[0], e2 = c[2] - c[0];
  if (data_.uvs.empty()) return {e1, e2};
  const TriangleIndices& t = uv_triangle(point.primitive);
  const Vec2 d1 = data_.uvs[t[1]] - data_.uvs[t[0]], d2 = data_.uvs[t[2]] - data_.uvs[t[0]];
  const float determinant = d1.x * d2.y - d1.y * d2.x;
  if (determinant == 0) return {};
  return {(e1 * d2.y - e2 * d1.y) / determinant, (e2 * d1.x - e1 * d2.x) / determinant};
}

Vec3 Mesh::tangent(std::uint32_t primitive) const {
  const TriangleCorners c = corners(primitive);
  const Vec3 e1 = c[1] - c[0], e2 = c[2] - c[0];
  if (data_.uvs.empty()) return e1;
  const TriangleIndices& t = uv_triangle(primitive);
  const Vec2 d1 = data_.uvs[t[1]] - data_.uvs[t[0]], d2 = data_.uvs[t[2]] - data_.uvs[t[0]];
  const float determinant = d1.x * d2.y - d1.y * d2.x;
  // The tangent dp/du = (d2.y e1 - d1.y e2) / determinant; only its direction is needed.
  return determinant == 0 ? Vec3{} : (e1 * d2.y - e2 * d1.y) * std::copysign(1.f, determinant);
}

std::size_t Mesh::memory_bytes() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  std::size_t attributes = 0;
  for (const MeshAttribute& a : data_.attributes) attributes += a.memory_bytes();
  return bytes(data_.positions) + bytes(data_.normals) + bytes(data_.uvs) + bytes(data_.triangles) +
         bytes(data_.normal_triangles) + bytes(data_.uv_triangles) + bytes(planes_) + bytes(data_.materials) +
         attributes;
}

std::vector<ParameterDoc> mesh_parameters(std::vector<ParameterDoc> own) {
  own.push_back({"face_normals", "boolean", "", "false", "ignore vertex normals: flat facets"});
  own.push_back(
      {"max_smooth_angle", "float", "degrees", "0",
       "ignore vertex normals and smooth only facets at a vertex whose normals differ by no more; 0: "
       "off"});
  return own;
}

}  // namespace aureole
