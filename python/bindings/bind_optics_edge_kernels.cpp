// SPDX-License-Identifier: Apache-2.0
// Edges as scatterers of light. aureole/_edge_kernels.py checks the arguments and shapes the results.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "aureole/optics/diffraction/edge_group.h"
#include "aureole/optics/diffraction/edge_kernel.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

using optics::PlanePoint;
using optics::ProjectedEdge;
using optics::ZerothOrder;

/// Kernels of many wavelengths come in multiples of this.
constexpr std::size_t kGroup = 4;
using Group = std::array<double, kGroup>;

Group group_of(double value) {
  Group all;
  all.fill(value);
  return all;
}

/// Rows: x, y of both ends and the length in space.
std::vector<ProjectedEdge> projected_edges(const Reals& rows) {
  require_size(rows.size() % 5 == 0, "edges");
  std::vector<ProjectedEdge> edges;
  for (std::size_t i = 0; i < rows.size() / 5; ++i) {
    const double* e = rows.data() + 5 * i;
    edges.push_back({{e[0], e[1]}, {e[2], e[3]}, e[4]});
  }
  return edges;
}

/// Beyond, squares overflow and steps vanish beside positions.
void require_scale(const char* name, double value) {
  if (!(value >= 1e-100 && value <= 1e100))
    throw Error(std::string(name) + ": expected a number from 1e-100 to 1e100");
}

/// Rows of `arguments`: at, x and y of q, k, sigma.
void mean_edge_kernel(const Reals& edges, std::size_t index, const Reals& arguments,
                      const Array<double>& result) {
  const std::vector<ProjectedEdge> all = projected_edges(edges);
  require_size(index < all.size() && arguments.size() == 5 * result.size(), "mean_edge_kernel");
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 5 * i;
    result.data()[i] = optics::mean_edge_kernel(all, index, a[0], {a[1], a[2]}, a[3], a[4]);
  });
}

/// Rows of `arguments`: at, k, sigma.
void mean_edge_powers(const Reals& edges, std::size_t index, const Reals& arguments,
                      const Array<double>& result) {
  const std::vector<ProjectedEdge> all = projected_edges(edges);
  require_size(index < all.size() && arguments.size() == 3 * result.size(), "mean_edge_powers");
  for (const ProjectedEdge& e : all)
    require_size(std::isfinite(e.from.x + e.from.y + e.to.x + e.to.y + e.length), "mean_edge_powers");
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 3 * i;
    require_scale("k", a[1]), require_scale("sigma", a[2]);
    optics::mean_edge_powers(all, index, a[0], {a + 1, 1}, {a + 2, 1}, {result.data() + i, 1});
  });
}

/// Rows of `arguments`: two normal numbers, turn, k, sigma.
void drawn_edge_kernels(const Reals& edges, std::size_t index, const Reals& arguments,
                        const Array<double>& result) {
  const std::vector<ProjectedEdge> all = projected_edges(edges);
  require_size(index < all.size() && arguments.size() == 5 * result.size(), "drawn_edge_kernels");
  double farthest = 0;
  for (const ProjectedEdge& e : all)
    farthest =
        std::max({farthest, std::abs(e.from.x) + std::abs(e.from.y), std::abs(e.to.x) + std::abs(e.to.y)});
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 5 * i;
    require_scale("k", a[3]), require_scale("sigma", a[4]);
    if (!(a[2] * a[3] * farthest + (std::abs(a[0]) + std::abs(a[1])) / a[4] * farthest < 1e8))
      throw Error("edges: expected phases below 1e8, edges nearer to the origin or fewer wavelengths");
    Group kernels;
    optics::drawn_edge_kernels(all, index, {a[0], a[1]}, a[2], group_of(a[3]), group_of(a[4]), kernels);
    result.data()[i] = kernels[0];
  });
}

/// Rows of `arguments`: across, along, shown, k, sigma.
void straight_edge_kernels(const Reals& arguments, const Array<double>& result) {
  require_size(arguments.size() == 5 * result.size(), "straight_edge_kernels");
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 5 * i;
    Group kernels;
    optics::straight_edge_kernels(a[0], a[1], a[2], group_of(a[3]), group_of(a[4]), kernels);
    result.data()[i] = kernels[0];
  });
}

/// Rows of `arguments`: cosine, k, sigma.
void straight_edge_power(const Reals& arguments, const Array<double>& result) {
  require_size(arguments.size() == 3 * result.size(), "straight_edge_power");
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 3 * i;
    result.data()[i] = optics::straight_edge_power(a[0], a[1], a[2]);
  });
}

/// Rows of `arguments`: across, along, shown, weight, k, sigma.
void straight_edge_corrections(const Reals& arguments, const Array<double>& result) {
  require_size(arguments.size() == 6 * result.size(), "straight_edge_corrections");
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 6 * i;
    Group kernels = {};
    optics::add_straight_edge_corrections(a[0], a[1], a[2], group_of(a[3]), group_of(a[4]), group_of(a[5]),
                                          kernels);
    result.data()[i] = kernels[0];
  });
}

/// Rows of `arguments`: cosine, sigma.
void straight_edge_power_correction(const Reals& arguments, const Array<double>& result) {
  require_size(arguments.size() == 2 * result.size(), "straight_edge_power_correction");
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 2 * i;
    result.data()[i] = optics::straight_edge_power_correction(a[0], a[1]);
  });
}

/// Rows of `arguments`: x and y of the place, before, after, sigma.
void straight_edge_weights(const Reals& others, const Reals& arguments, const Array<double>& result) {
  const std::vector<ProjectedEdge> all = projected_edges(others);
  require_size(arguments.size() == 5 * result.size(), "straight_edge_weights");
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 5 * i;
    Group weights;
    optics::straight_edge_weights({a[0], a[1]}, a[2], a[3], all, group_of(a[4]), weights);
    result.data()[i] = weights[0];
  });
}

/// Rows of `arguments`: x and y of q, k, sigma of chi, 0 where nothing is removed.
void diffracted_intensity(const Complexes& field, const Reals& arguments, const Array<double>& result) {
  require_size(field.size() == result.size() && arguments.size() == 4 * result.size(),
               "diffracted_intensity");
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 4 * i;
    result.data()[i] =
        optics::diffracted_intensity({field.data()[i], 0}, {a[0], a[1]}, a[2],
                                     a[3] > 0 ? ZerothOrder::of_beam(a[3]) : ZerothOrder::kept());
  });
}

}  // namespace

void bind_edge_kernels(nb::module_& m) {
  using nb::arg;
  const auto add = [&m](const char* name, auto function) {
    m.def(name, function, arg("edges"), arg("index"), arg("arguments"), arg("result").noconvert());
  };
  add("mean_edge_kernel", &mean_edge_kernel);
  add("mean_edge_powers", &mean_edge_powers);
  add("drawn_edge_kernels", &drawn_edge_kernels);
  m.def("straight_edge_kernels", &straight_edge_kernels, arg("arguments"), arg("result").noconvert());
  m.def("straight_edge_power", &straight_edge_power, arg("arguments"), arg("result").noconvert());
  m.def("straight_edge_corrections", &straight_edge_corrections, arg("arguments"), arg("result").noconvert());
  m.def("straight_edge_power_correction", &straight_edge_power_correction, arg("arguments"),
        arg("result").noconvert());
  m.def("straight_edge_weights", &straight_edge_weights, arg("others"), arg("arguments"),
        arg("result").noconvert());
  m.def("diffracted_intensity", &diffracted_intensity, arg("field"), arg("arguments"),
        arg("result").noconvert());
}

}  // namespace aureole::python
