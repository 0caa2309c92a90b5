// SPDX-License-Identifier: Apache-2.0
// The zero set of a function given at the nodes of a grid and trilinear between them. The user geometry has a
// primitive for each cell in which the function changes its sign. Conventions as in Mitsuba 3: the nodes fill
// [0, 1]^3 including its faces, and normals point to increasing values.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "aureole/parameter/voxel_data.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/geometry/shape_placement.h"
#include "aureole/shape/geometry/trilinear_cell.h"
#include "aureole/shape/geometry/user_geometry.h"
#include "aureole/shape/shape.h"

namespace aureole {
namespace {

using Index3 = std::array<int, 3>;

class SdfGrid final : public Shape {
public:
  explicit SdfGrid(const Properties& properties)
      : Shape(properties),
        place_(properties.get_transform("to_world")),
        grid_(read_voxels(properties, "grid")) {
    is_smooth_ = properties.get_choice("normals", "smooth", {"smooth", "analytic"}) == "smooth";
    is_flipped_ = properties.get_bool("flip_normals", false);
    const char* const source = voxels_parameter(properties, "grid");
    if (grid_.channels != 1)
      throw properties.error(
          source, fmt::format("has {} numbers at each node; a distance is one number", grid_.channels));
    std::uint64_t all = 1;
    for (const int n : grid_.size) {
      if (n < 2)
        throw properties.error(source, fmt::format("has {} x {} x {} nodes; a cell needs two along each axis",
                                                   grid_.size[0], grid_.size[1], grid_.size[2]));
      all *= std::uint64_t(n);
    }
    if (all > std::uint64_t(~0u)) throw properties.error(source, "has more than 2^32 nodes");
    find_cells();
    if (cells_.empty()) {
      const auto [least, most] = std::minmax_element(grid_.values.begin(), grid_.values.end());
      throw properties.error(source, fmt::format("has no surface: no sign changes between its nodes, whose "
                                                 "values go from {} to {}",
                                                 *least, *most));
    }
  }

  RTCGeometry make_geometry(RTCDevice device) const override { return make_user_geometry(device, *this); }
  Bounds3 bounds() const override { return bounds_; }
  std::size_t primitive_count() const override { return cells_.size(); }
  std::size_t memory_bytes() const override {
    return grid_.values.capacity() * sizeof(float) + cells_.capacity() * sizeof(std::uint32_t);
  }

  /// Returns the bounding box of a cell.
  Bounds3 bounds(std::uint32_t primitive) const {
    const Index3 cell = cell_of(primitive);
    Double3 middle, reach;
    middle = place_.origin();
    for (std::size_t k = 0; k < 3; ++k) {
      const Double3 axis = place_.axis(int(k)) * (0.5 / cells_along(k));
      middle = middle + axis * (2 * cell[k] + 1);
      reach = reach + Double3(std::abs(axis.x), std::abs(axis.y), std::abs(axis.z));
    }
    return outward_bounds(middle - reach, middle + reach);
  }
  /// Returns the first crossing in either direction, since both sides are visible.
  std::optional<double> intersect(std::uint32_t primitive, const Double3& o, const Double3& d, double t_min,
                                  double t_max) const {
    const Index3 cell = cell_of(primitive);
    const Double3 from = in_cell(place_.local_point(o), cell), along = scaled(place_.local_vector(d));
    // Margin of the crossings in a cell: crossings on the face between two cells belong to both, so that
    // rounding lets no ray through between them.
    constexpr double kMargin = 1e-9;
    const auto clip = [&](double p, double v) {
      if (v == 0) {
        if (p < -kMargin || p > 1 + kMargin) t_max = -1;
        return;
      }
      const double a = (-kMargin - p) / v, b = (1 + kMargin - p) / v;
      t_min = std::max(t_min, std::min(a, b)), t_max = std::min(t_max, std::max(a, b));
    };
    clip(from.x, along.x), clip(from.y, along.y), clip(from.z, along.z);
    if (!(t_min < t_max)) return {};
    const double length = t_max - t_min;
    const auto s = values(cell).along(from + along * t_min, along * length).first_crossing();
    return s ? std::optional(t_min + *s * length) : std::nullopt;
  }

  SurfacePoint surface_point(const ShapeHit& hit, const Ray& ray, bool) const override {
    const Index3 cell = cell_of(hit.primitive);
    const TrilinearCell f = values(cell);
    Double3 at = in_cell(place_.local_point(Double3(ray.o) + Double3(ray.d) * double(hit.t)), cell);
    // The point is moved back onto the surface by Newton's method, since the distance was rounded to single
    // precision.
    for (int i = 0; i < 3; ++i) {
      const Double3 g = f.gradient(at);
      const Double3 step = g * (f.at(at) / dot(g, g));
      if (dot(step, step) < 0.25) at = at - step;
    }
    SurfacePoint s;
    const Double3 own((at.x + cell[0]) / cells_along(0), (at.y + cell[1]) / cells_along(1),
                      (at.z + cell[2]) / cells_along(2));
    s.p = place_.point(own).to_float();
    s.p_error = place_.rounding_error(s.p);
    const Double3 n = normal_to_world(scaled(f.gradient(at)), -Double3(ray.d));
    const Double3 shading = is_smooth_ ? smooth_normal(at, cell) : n;
    s.ng = n.to_float();
    s.shading = Frame::from_normal((dot(shading, n) > 0 ? shading : n).to_float());
    s.shape = this;
    s.primitive = hit.primitive;
    return s;
  }
  SurfaceDerivatives own_derivatives(const SurfacePoint&) const override { return {}; }

  std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse use) const override {
    throw Error(std::string("an sdfgrid cannot be ") + (use == AreaUse::emitter ? "an emitter" : "a sensor") +
                "; use a mesh");
  }
  std::string opening() const override {
    return is_open_ ? "the surface ends at the faces of its grid" : std::string();
  }

private:
  double cells_along(std::size_t k) const { return grid_.size[k] - 1; }
  /// Scales a vector from local coordinates, in which the grid fills [0, 1]^3, to units of cells. A gradient
  /// is scaled from units of cells to local coordinates.
  Double3 scaled(const Double3& v) const {
    return {v.x * cells_along(0), v.y * cells_along(1), v.z * cells_along(2)};
  }
  Double3 in_cell(const Double3& own, const Index3& cell) const {
    return scaled(own) - Double3(cell[0], cell[1], cell[2]);
  }
  Index3 cell_of(std::uint32_t primitive) const {
    const std::uint32_t i = cells_[primitive], nx = std::uint32_t(grid_.size[0]),
                        ny = std::uint32_t(grid_.size[1]);
    return {int(i % nx), int(i / nx % ny), int(i / nx / ny)};
  }
  double node(int x, int y, int z) const { return grid_.values[grid_.voxel(x, y, z)]; }
  std::array<double, 8> corners(const Index3& cell) const {
    std::array<double, 8> f;
    for (std::size_t i = 0; i < 8; ++i)
      f[i] = node(cell[0] + int(i & 1), cell[1] + int(i >> 1 & 1), cell[2] + int(i >> 2));
    return f;
  }
  TrilinearCell values(const Index3& cell) const { return TrilinearCell(corners(cell)); }

  Double3 normal_to_world(const Double3& own, const Double3& fallback) const {
    const Double3 n = place_.normal(own);
    const double l = length(n);
    if (!(l > 0)) return normalize(fallback);  // fallback where the gradient vanishes
    return n * ((is_flipped_ ? -1 : 1) / l);
  }

  /// Returns a normal that is continuous across cells: the mean normal of the eight surrounding cells,
  /// weighted by the distance of their centres (Hansson-Soderlund et al. 2022). A neighbour along an axis
  /// contributes only that component of its gradient, taken at the point, as in Mitsuba 3.
  Double3 smooth_normal(const Double3& at, const Index3& cell) const {
    double slope[3][2], weight[3];
    const double p[3] = {at.x, at.y, at.z};
    for (std::size_t k = 0; k < 3; ++k) {
      const bool upper = p[k] >= 0.5;
      weight[k] = upper ? p[k] - 0.5 : p[k] + 0.5;
      for (int i = 0; i < 2; ++i) {
        // At the border the last cell replaces its missing neighbour.
        Index3 there = cell;
        there[k] = std::clamp(cell[k] + i - (upper ? 0 : 1), 0, grid_.size[k] - 2);
        const Double3 g = values(there).gradient(at);
        slope[k][i] = (k == 0 ? g.x : k == 1 ? g.y : g.z) * cells_along(k);
      }
    }
    Double3 n;
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t x = i & 1, y = i >> 1 & 1, z = i >> 2;
      const Double3 g(slope[0][x], slope[1][y], slope[2][z]);
      const double l = length(g), w = (x ? weight[0] : 1 - weight[0]) * (y ? weight[1] : 1 - weight[1]) *
                                      (z ? weight[2] : 1 - weight[2]);
      if (l > 0) n = n + g * (w / l);
    }
    return normal_to_world(n, {});
  }

  /// Finds the cells whose corners have both signs.
  void find_cells() {
    const Index3 n = grid_.size;
    const auto is_inside = [&](int x, int y, int z) { return grid_.values[grid_.voxel(x, y, z)] < 0; };
    bool border[2] = {false, false};
    for (int z = 0; z < n[2]; ++z)
      for (int y = 0; y < n[1]; ++y)
        for (int x = 0; x < n[0]; ++x) {
          if (x == 0 || y == 0 || z == 0 || x == n[0] - 1 || y == n[1] - 1 || z == n[2] - 1)
            border[is_inside(x, y, z)] = true;
          if (x == n[0] - 1 || y == n[1] - 1 || z == n[2] - 1) continue;
          int inside = 0;
          for (int i = 0; i < 8; ++i) inside += is_inside(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
          if (inside == 0 || inside == 8) continue;
          cells_.push_back(std::uint32_t(grid_.voxel(x, y, z)));
          bounds_.extend(bounds(std::uint32_t(cells_.size() - 1)));
        }
    cells_.shrink_to_fit();
    is_open_ = border[0] && border[1];
  }

  Placement place_;
  VoxelData grid_;
  std::vector<std::uint32_t> cells_;  ///< index of the first node of each cell
  Bounds3 bounds_;
  bool is_smooth_ = true, is_flipped_ = false, is_open_ = false;
};

AUREOLE_PLUGIN(
    SdfGrid, "shape", "sdfgrid",
    PluginDoc{
        .summary =
            "The zero set of a signed distance function, or of any other function that is negative inside. "
            "It is given at the nodes of a grid that fills [0, 1]^3 and is trilinear between them; rays "
            "intersect the exact zero of that function, not triangles. Any affine to_world is exact. There "
            "are no texture coordinates, and it cannot be an emitter or a sensor. The surface is open where "
            "it reaches the faces of the grid.",
        .source =
            "H. Hansson-Soderlund, A. Evans, T. Akenine-Moller, Ray tracing of signed distance function grids, "
            "JCGT 11(3), 2022",
        .parameters =
            {{"filename", "file", "", "required, or grid", "a .vol file of one number at each node"},
             {"grid", "array", "", "none",
              "instead of filename, from Python: depth x height x width [x 1] numbers"},
             {"normals", "string", "", "smooth",
              "shading normals: smooth (continuous) or analytic (those of the surface, with creases between "
              "cells)"}},
        .examples = {R"(<shape type="sdfgrid">
  <string name="filename" value="blob.vol"/>
  <string name="normals" value="analytic"/>
  <boolean name="flip_normals" value="false"/>
  <transform name="to_world"><rotate z="1" angle="30"/></transform>
  <bsdf type="diffuse"/>
</shape>)"}});

}  // namespace
}  // namespace aureole
