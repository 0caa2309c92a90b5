// SPDX-License-Identifier: Apache-2.0
// Edge waves, knife edges, the uniform theory, diffraction integrals, radio materials. aureole/_diffraction.py checks the arguments
// and shapes the results.
#include <nanobind/stl/array.h>
#include <nanobind/stl/complex.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "aureole/core/random.h"
#include "aureole/optics/diffraction/diffraction_integral.h"
#include "aureole/optics/diffraction/edge_density.h"
#include "aureole/optics/diffraction/edge_power.h"
#include "aureole/optics/diffraction/gaussian_beam.h"
#include "aureole/optics/diffraction/triangle_transform.h"
#include "aureole/optics/diffraction/uniform_theory.h"
#include "aureole/optics/faddeeva.h"
#include "aureole/optics/interface/radio_material.h"
#include "bindings.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

using optics::DiffractingEdge;
using optics::PlanePoint;
using optics::ZerothOrder;

ZerothOrder zeroth_order(const std::string& removal, double sigma) {
  return removal == "beam"   ? ZerothOrder::of_beam(sigma)
         : removal == "edge" ? ZerothOrder::of_edges()
                             : ZerothOrder::kept();
}

optics::Ring ring_of(const double* points, std::size_t count) {
  optics::Ring ring;
  for (std::size_t i = 0; i < count; ++i) ring.push_back({points[2 * i], points[2 * i + 1]});
  return ring;
}

/// The steps of quadratures grow with these numbers; beyond, a call would take minutes.
void limit_work(const char* name, double value, double most) {
  if (!(value <= most))
    throw Error(std::string(name) +
                ": expected less work, such as smaller figures in wavelengths or parts of them");
}

/// Edges with their amplitudes and what is removed of their waves.
class Edges {
public:
  /// `points`: x, y of both ends; `amplitudes`: at both ends.
  Edges(const Reals& points, const Complexes& amplitudes, const std::string& removal, double sigma)
      : zeroth_(zeroth_order(removal, sigma)) {
    const std::size_t n = points.size() / 4;
    require_size(points.size() == 4 * n && amplitudes.size() == 2 * n, "EdgeWaves");
    for (std::size_t i = 0; i < n; ++i) {
      const double* p = points.data() + 4 * i;
      edges_.push_back({{p[0], p[1]}, {p[2], p[3]}, amplitudes.data()[2 * i], amplitudes.data()[2 * i + 1]});
      extent_ = std::max({extent_, std::hypot(p[0] - points.data()[0], p[1] - points.data()[1]),
                          std::hypot(p[2] - points.data()[0], p[3] - points.data()[1])});
      length_ += edges_.back().length();
      if (!(std::isfinite(length_) && edges_.back().length() > 0))
        throw Error("edges: expected finite edges of positive length");
    }
  }

  void field(const Reals& q, const Array<Complex>& result) const {
    require_size(q.size() == 2 * result.size(), "field");
    for_each(result.size(), [this, from = q.data(), to = result.data()](std::size_t i) {
      to[i] = optics::edge_field(edges_, {from[2 * i], from[2 * i + 1]}, zeroth_);
    });
  }
  std::vector<double> powers() const {
    std::vector<double> all;
    for (const DiffractingEdge& e : edges_) all.push_back(optics::edge_power(e, zeroth_).total());
    return all;
  }
  /// To |q| < q_max; to all q, in closed form, where that is 0 and chi that of the beam.
  double power(double q_max) const {
    const double edges = double(edges_.size());
    if (q_max == 0)
      limit_work("edges", std::pow(edges + length_ * zeroth_.sigma, 2), 1e7);
    else
      limit_work("q_max", std::pow(q_max * extent_, 2) * edges, 1e9);
    const Unlocked release;
    if (q_max == 0) return optics::interfering_power(edges_, zeroth_.sigma, 8);
    return optics::diffracted_power(edges_, zeroth_, q_max);
  }
  /// To all q, with `nodes` of the rule along edges; chi that of the beam.
  double interfering_power(int nodes) const {
    limit_work("edges", std::pow(double(edges_.size()) + length_ * zeroth_.sigma, 2), 1e7);
    const Unlocked release;
    return naming("sigma", [&] { return optics::interfering_power(edges_, zeroth_.sigma, nodes); });
  }
  double mean_sigma() const {
    return naming("edges", [&] { return optics::mean_edge_sigma(edges_); });
  }
  void pdf(const Reals& q, const Array<double>& result) const {
    require_size(q.size() == 2 * result.size(), "pdf");
    std::vector<optics::EdgeDensity::Share> shares(edges_.size());
    const optics::EdgeDensity density = density_of(shares);
    for_each(result.size(), [&density, from = q.data(), to = result.data()](std::size_t i) {
      to[i] = density.pdf({from[2 * i], from[2 * i + 1]});
    });
  }
  void sample(std::uint64_t seed, const Array<double>& result) const {
    std::vector<optics::EdgeDensity::Share> shares(edges_.size());
    const optics::EdgeDensity density = density_of(shares);
    if (!(density.total() > 0)) throw Error("amplitudes: expected an edge that diffracts, all powers are 0");
    for_each(result.size() / 2, [&density, seed, to = result.data()](std::size_t i) {
      std::uint64_t state = combine_bits(seed, i), draws = 0;
      const PlanePoint q =
          density.sample([&] { return double(combine_bits(state, draws++) >> 11) * 0x1p-53; });
      to[2 * i] = q.x, to[2 * i + 1] = q.y;
    });
  }
  /// Ends and amplitudes as the constructor takes them.
  std::pair<std::vector<double>, std::vector<Complex>> balanced(double power, std::size_t most_edges) const {
    limit_work("edges", double(edges_.size()), 5000);
    std::pair<std::vector<double>, std::vector<Complex>> result;
    for (const DiffractingEdge& e :
         naming("amplitudes", [&] { return optics::balanced_edges(edges_, zeroth_, power, most_edges); })) {
      for (double x : {e.from.x, e.from.y, e.to.x, e.to.y}) result.first.push_back(x);
      result.second.push_back(e.a), result.second.push_back(e.b);
    }
    return result;
  }

private:
  optics::EdgeDensity density_of(std::vector<optics::EdgeDensity::Share>& shares) const {
    return naming("zeroth_order", [&] { return optics::EdgeDensity(edges_, zeroth_, shares); });
  }

  std::vector<DiffractingEdge> edges_;
  ZerothOrder zeroth_;
  double extent_ = 0, length_ = 0;
};

/// `corners`: three x, y of each triangle, `values`: three.
std::vector<optics::LinearTriangle> triangles_of(const Reals& corners, const Complexes& values) {
  const std::size_t n = values.size() / 3;
  require_size(corners.size() == 6 * n && values.size() == 3 * n, "triangles");
  std::vector<optics::LinearTriangle> triangles;
  for (std::size_t i = 0; i < n; ++i) {
    const double* c = corners.data() + 6 * i;
    const Complex* v = values.data() + 3 * i;
    triangles.push_back({{{{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}}}, {v[0], v[1], v[2]}});
  }
  return triangles;
}

/// Results for every q.
void triangle_transform(const Reals& corners, const Complexes& values, const Reals& q,
                        const Array<Complex>& result) {
  require_size(q.size() == 2 * result.size(), "triangle_transform");
  const std::vector<optics::LinearTriangle> triangles = triangles_of(corners, values);
  for_each(result.size(), [&triangles, from = q.data(), to = result.data()](std::size_t i) {
    to[i] = optics::transform(triangles, {from[2 * i], from[2 * i + 1]});
  });
}

template <class Result, class F>
auto of_each_real(const char* name, const F& f) {
  return [name, f](const Reals& x, const Array<Result>& result) {
    require_size(x.size() == result.size(), name);
    for_each(x.size(), [&f, from = x.data(), to = result.data()](std::size_t i) { to[i] = f(from[i]); });
  };
}

/// Applies a function of several numbers, which are rows of `arguments`.
template <int kColumns, class F>
auto of_each_row(const char* name, const F& f) {
  return [name, f](const Reals& arguments, const Array<double>& result) {
    require_size(arguments.size() == kColumns * result.size(), name);
    for_each(result.size(), [&f, from = arguments.data(), to = result.data()](std::size_t i) {
      to[i] = f(from + kColumns * i);
    });
  };
}

/// Columns of `arguments`: k, sin_beta, phi, phi_i.
void keller_coefficient(double n, const Reals& arguments, bool is_hard, const Array<Complex>& result) {
  require_size(arguments.size() == 4 * result.size(), "keller_coefficient");
  const optics::Wedge w = naming("n", [&] { return optics::Wedge(n); });
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 4 * i;
    result.data()[i] = w.keller_coefficient(a[0], a[1], a[2], a[3], is_hard);
  });
}

/// Columns of `arguments`: k, rho (or KP's L), sin_beta, phi, phi_i; `faces`: reflection of the o- and n-face.
void wedge(double n, const Reals& arguments, const Complexes& faces, bool is_field,
           const Array<Complex>& result) {
  require_size(arguments.size() == 5 * result.size() && faces.size() == 2 * result.size(), "wedge");
  const optics::Wedge w = naming("n", [&] { return optics::Wedge(n); });
  for_each(result.size(), [&](std::size_t i) {
    const double* a = arguments.data() + 5 * i;
    const optics::WedgeFaces f{faces.data()[2 * i], faces.data()[2 * i + 1]};
    result.data()[i] = naming(is_field ? "utd_field" : "utd_coefficient", [&] {
      return is_field ? w.plane_wave_field(a[0], a[1], a[3], a[4], f)
                      : w.coefficient(a[0], a[1], a[2], a[3], a[4], f);
    });
  });
}

/// The opening is a disc or ring where `sizes` is empty, else rings of `vertices`; the source a plane wave's direction or a position.
void diffraction_integral(const std::string& kind, const Reals& vertices,
                          const Array<const std::int64_t>& sizes, double radius, double inner_radius,
                          bool is_point, const std::array<double, 3>& source, double k, const Reals& points,
                          const Array<Complex>& result) {
  using optics::FlatOpening;
  const std::size_t columns = kind == "fraunhofer" ? 2 : 3;
  require_size(points.size() == columns * result.size(), "diffraction_integral");
  double extent = radius;
  const FlatOpening opening = naming("opening", [&] {
    if (sizes.size() == 0) return FlatOpening::disc(radius, inner_radius);
    std::vector<optics::Ring> rings;
    std::size_t at = 0;
    for (std::size_t r = 0; r < sizes.size(); ++r) {
      require_size(sizes.data()[r] >= 0 && std::size_t(sizes.data()[r]) <= vertices.size() / 2 - at,
                   "diffraction_integral");
      rings.push_back(ring_of(vertices.data() + 2 * at, std::size_t(sizes.data()[r])));
      at += rings.back().size();
    }
    auto region = optics::PolygonRegion::even_odd(std::move(rings));
    extent = std::hypot(region.upper().x - region.lower().x, region.upper().y - region.lower().y);
    return FlatOpening::polygon(std::move(region));
  });
  double nearest = INFINITY, widest = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double* p = points.data() + columns * i;
    if (columns == 3)
      nearest = std::min(nearest, p[2]);
    else
      widest = std::max({widest, std::abs(p[0]), std::abs(p[1])});
  }
  // Cells along one axis: by the phase, and by the distance.
  limit_work("opening", extent * (columns == 3 ? std::max(k, 2 / nearest) : widest), 2e4);
  if (is_point) limit_work("source", extent * 2 / std::abs(source[2]), 2e4);
  const optics::ScreenSource from = naming("source", [&] {
    return is_point ? optics::ScreenSource::point(source) : optics::ScreenSource::plane_wave(source);
  });
  for_each(result.size(), [&](std::size_t i) {
    const double* p = points.data() + columns * i;
    result.data()[i] = naming("points", [&] {
      if (kind == "fraunhofer") return optics::fraunhofer(opening, {p[0], p[1]});
      return (kind == "kirchhoff" ? optics::kirchhoff : optics::rayleigh_sommerfeld)(opening, from,
                                                                                     {p[0], p[1], p[2]}, k);
    });
  });
}

}  // namespace

void bind_diffraction(nb::module_& m) {
  using nb::arg;
  nb::class_<Edges>(m, "DiffractingEdges",
                    "Edges with amplitudes; what `aureole.optics.EdgeWaves` computes with.")
      .def(nb::init<const Reals&, const Complexes&, const std::string&, double>(), arg("points"),
           arg("amplitudes"), arg("removal"), arg("sigma"))
      .def("field", &Edges::field, arg("q"), arg("result").noconvert())
      .def("powers", &Edges::powers)
      .def("power", &Edges::power, arg("q_max"))
      .def("interfering_power", &Edges::interfering_power, arg("nodes"))
      .def("mean_sigma", &Edges::mean_sigma)
      .def("pdf", &Edges::pdf, arg("q"), arg("result").noconvert())
      .def("sample", &Edges::sample, arg("seed"), arg("result").noconvert())
      .def("balanced", &Edges::balanced, arg("power"), arg("most_edges"));
  m.def("triangle_transform", &triangle_transform, arg("corners"), arg("values"), arg("q"),
        arg("result").noconvert());
  m.def(
      "triangle_power",
      [](const Reals& corners, const Complexes& values) {
        return optics::power(triangles_of(corners, values));
      },
      arg("corners"), arg("values"));
  m.def(
      "amplitude_moments",
      [](const Reals& corners, const Complexes& values) {
        const optics::AmplitudeMoments a = optics::amplitude_moments(triangles_of(corners, values));
        return std::array{a.total, a.x, a.y, a.xx, a.xy, a.yy};
      },
      arg("corners"), arg("values"));
  m.def(
      "zeroth_order_power",
      [](const Reals& corners, const Complexes& values, double sigma) {
        const auto triangles = triangles_of(corners, values);
        return naming("values", [&] { return optics::zeroth_order_power(triangles, sigma); });
      },
      arg("corners"), arg("values"), arg("sigma"));
  m.def("edge_alpha1",
        of_each_row<2>("edge_alpha1", [](const double* a) { return optics::edge_alpha1(a[0], a[1]); }),
        arg("arguments"), arg("result").noconvert());
  m.def("edge_alpha2",
        of_each_row<2>("edge_alpha2", [](const double* a) { return optics::edge_alpha2(a[0], a[1]); }),
        arg("arguments"), arg("result").noconvert());
  m.def(
      "edge_constants",
      [](double sigma) {
        const optics::EdgeConstants c = optics::edge_constants(sigma);
        return std::pair(c.alpha1, c.alpha2);
      },
      arg("sigma"));
  m.def(
      "gaussian_beam_power",
      [](double sigma, const Reals& ring) {
        return naming("sigma", [&] {
          return optics::GaussianBeam(sigma).power(ring_of(ring.data(), ring.size() / 2));
        });
      },
      arg("sigma"), arg("ring"));
  m.def(
      "faddeeva",
      [](const Complexes& z, const Array<Complex>& result) {
        require_size(z.size() == result.size(), "faddeeva");
        for_each(z.size(),
                 [from = z.data(), to = result.data()](std::size_t i) { to[i] = optics::faddeeva(from[i]); });
      },
      arg("z"), arg("result").noconvert());
  m.def("fresnel_integral", of_each_real<Complex>("fresnel_integral", optics::fresnel_integral), arg("v"),
        arg("result").noconvert());
  m.def("knife_edge", of_each_real<Complex>("knife_edge", optics::knife_edge_field), arg("v"),
        arg("result").noconvert());
  m.def("transition_function", of_each_real<Complex>("transition_function", optics::transition_function),
        arg("x"), arg("result").noconvert());
  m.def("wedge", &wedge, arg("n"), arg("arguments"), arg("faces"), arg("is_field"),
        arg("result").noconvert());
  m.def("keller_coefficient", &keller_coefficient, arg("n"), arg("arguments"), arg("is_hard"),
        arg("result").noconvert());
  m.def("plane_wave_distance",
        of_each_row<2>("plane_wave_distance",
                       [](const double* a) { return optics::plane_wave_distance(a[0], a[1]); }),
        arg("arguments"), arg("result").noconvert());
  m.def("point_source_distance",
        of_each_row<3>("point_source_distance",
                       [](const double* a) { return optics::point_source_distance(a[0], a[1], a[2]); }),
        arg("arguments"), arg("result").noconvert());
  m.def("plane_wave_spreading",
        of_each_row<1>("plane_wave_spreading",
                       [](const double* a) { return optics::plane_wave_spreading(*a); }),
        arg("arguments"), arg("result").noconvert());
  m.def("point_source_spreading",
        of_each_row<2>("point_source_spreading",
                       [](const double* a) { return optics::point_source_spreading(a[0], a[1]); }),
        arg("arguments"), arg("result").noconvert());
  m.def("diffraction_integral", &diffraction_integral, arg("kind"), arg("vertices"), arg("sizes"),
        arg("radius"), arg("inner_radius"), arg("is_point"), arg("source"), arg("k"), arg("points"),
        arg("result").noconvert());
  m.def(
      "radio_permittivity",
      [](const std::string& material, const Reals& frequency, const Array<Complex>& result) {
        require_size(frequency.size() == result.size(), "radio_permittivity");
        for (std::size_t i = 0; i < result.size(); ++i)
          result.data()[i] = naming("radio_permittivity", [&] {
            return optics::radio_permittivity(material, frequency.data()[i]);
          });
      },
      arg("material"), arg("frequency"), arg("result").noconvert());
  m.def("radio_materials", [] {
    std::vector<std::tuple<std::string, std::array<double, 4>, double, double>> rows;
    for (const optics::RadioMaterial& r : optics::radio_materials())
      rows.emplace_back(std::string(r.name), std::array{r.a, r.b, r.c, r.d}, r.min_ghz * 1e9,
                        r.max_ghz * 1e9);
    return rows;
  });
}

}  // namespace aureole::python
