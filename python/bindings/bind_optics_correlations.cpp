// SPDX-License-Identifier: Apache-2.0
// Positions of scatterers: simulated hard discs, structure factors and pair correlation in closed form and of
// points. aureole/optics.py checks the arguments and shapes the results.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <cstdint>
#include <future>
#include <memory>
#include <vector>

#include "aureole/core/parallel.h"
#include "aureole/optics/arrangement/hard_disc_pair_correlation.h"
#include "aureole/optics/arrangement/hard_discs.h"
#include "aureole/optics/arrangement/pair_statistics.h"
#include "aureole/optics/arrangement/point_pattern.h"
#include "aureole/optics/arrangement/simulated_structure_factor.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "optics_bindings.h"
#include "pair_counts.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

using optics::StructureFactor;
using FactorPtr = std::shared_ptr<StructureFactor>;

/// Runs f(), a long computation that checks no signals, in a thread of its own and returns its result. On a
/// signal the thread is abandoned; it finishes and its result is discarded.
template <class F>
auto abandonable(F f, SignalCheck& check) {
  using T = decltype(f());
  auto task = std::make_shared<std::packaged_task<T()>>(std::move(f));
  std::future<T> result = task->get_future();
  std::thread([task] { (*task)(); }).detach();
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) check();
  return result.get();
}

/// The start of a mixture: discs grow there in a loop that may take long.
optics::HardDiscSimulation grown(std::vector<double> radii, double area_fraction, std::uint64_t seed,
                                 SignalCheck& check) {
  return abandonable([radii = std::move(radii), area_fraction,
                      seed] { return optics::HardDiscSimulation(radii, area_fraction, seed); },
                     check);
}

/// Fills `positions` of shape (snapshots, n, 2); returns the side of the box and the pressure over that of an
/// ideal gas. `first` and `between`: sweeps before the first and the other snapshots, negative for the
/// simulation's own.
std::pair<double, double> hard_discs(const Reals& radii, double area_fraction, std::uint64_t seed,
                                     double first, double between, const Array<double, 3>& positions) {
  const std::size_t n = radii.size(), snapshots = positions.shape(0);
  require_size(positions.shape(1) == n && positions.shape(2) == 2, "hard_discs");
  require_size(n > 0, "hard_discs");
  // Boxes of more diameters than an int counts would break the simulation.
  if (!(area_fraction >= 1e-6)) throw Error("area_fraction: expected at least 1e-6");
  const bool equal =
      std::all_of(radii.data(), radii.data() + n, [&](double r) { return r == radii.data()[0]; });
  const Unlocked release;
  SignalCheck check;
  return naming(equal ? "n" : "radius", [&] {
    std::vector<double> all(radii.data(), radii.data() + n);
    auto simulation = equal ? optics::HardDiscSimulation(std::move(all), area_fraction, seed)
                            : grown(std::move(all), area_fraction, seed, check);
    const auto advance = [&](double sweeps) {
      // Parts that together are the same as one call.
      const double part = std::max(1.0, std::floor(2e4 / double(n)));
      for (; sweeps > 0; sweeps -= part) {
        simulation.advance(std::min(part, sweeps));
        check();
      }
    };
    double* to = positions.data();
    for (std::size_t k = 0; k < snapshots; ++k) {
      const double equilibration = first >= 0 ? first : simulation.equilibration_sweeps(),
                   decorrelation = between >= 0 ? between : simulation.decorrelation_sweeps();
      advance(k == 0 ? equilibration : decorrelation);
      if (k == 0) simulation.reset_pressure();
      for (std::size_t i = 0; i < n; ++i) *to++ = simulation.state().x[i], *to++ = simulation.state().y[i];
    }
    const double pressure = snapshots > 1 ? simulation.pressure() : std::nan("");
    return std::pair(simulation.state().box_x, pressure);
  });
}

/// S on the wave vectors of a periodic box, ring by ring: rows q, S, number of vectors of `result`. Returns
/// how many rings have vectors. Positions of shape (snapshots, n, 2) in the box.
std::size_t ring_structure_factor(const Array<const double, 3>& positions, double box_x, double box_y,
                                  const Reals& edges, int per_ring, const Array<double, 2>& result) {
  const std::size_t n = positions.shape(1), most = result.shape(1);
  require_size(positions.shape(2) == 2 && result.shape(0) == 3 && edges.size() == most + 1,
               "ring_structure_factor");
  const Unlocked release;
  SignalCheck check;
  return naming("edges", [&] {
    optics::RingStructureFactor rings(box_x, box_y, {edges.data(), edges.data() + edges.size()}, per_ring);
    optics::HardDiscs discs;
    discs.box_x = box_x, discs.box_y = box_y;
    discs.x.resize(n), discs.y.resize(n), discs.radius.assign(n, 1.0);
    const double* from = positions.data();
    for (std::size_t k = 0; k < positions.shape(0); ++k) {
      for (std::size_t i = 0; i < n; ++i) discs.x[i] = *from++, discs.y[i] = *from++;
      rings.add(discs);
      check();
    }
    for (int r = 0; r < rings.rings(); ++r) {
      double* to = result.data() + r;
      to[0] = rings.q(r), to[most] = rings.total(r).mean(), to[2 * most] = rings.vectors(r);
    }
    return std::size_t(rings.rings());
  });
}

/// S of points in windows without a period at each q: rows S, standard error of `result`.
void window_structure_factor(const Array<const double, 3>& positions, double width, double height,
                             const Reals& q, const Array<double, 2>& result) {
  const std::size_t n = positions.shape(1), size = q.size();
  require_size(positions.shape(2) == 2 && result.shape(0) == 2 && result.shape(1) == size,
               "window_structure_factor");
  std::vector<optics::PointPattern> fields(positions.shape(0));
  const double* from = positions.data();
  for (optics::PointPattern& field : fields) {
    field.width = width, field.height = height;
    field.x.resize(n), field.y.resize(n);
    for (std::size_t i = 0; i < n; ++i) field.x[i] = *from++, field.y[i] = *from++;
  }
  naming("q", [&] {
    for_each(size, [&, at = q.data(), to = result.data()](std::size_t i) {
      const optics::Estimate s = optics::window_structure_factor(fields, {at[i]})[0];
      to[i] = s.mean, to[size + i] = s.error;
    });
    return 0;
  });
}

/// For u, or for pairs (ux, uy) of it.
void evaluate_structure(const StructureFactor& factor, const Reals& u, bool vectors,
                        const Array<double>& result) {
  const std::size_t n = result.size();
  require_size(u.size() == (vectors ? 2 * n : n), "StructureFactor");
  for_each(n, [&factor, vectors, from = u.data(), to = result.data()](std::size_t i) {
    to[i] = vectors ? factor.eval(from[2 * i], from[2 * i + 1]) : factor.eval(from[i]);
  });
}

std::vector<double> list(const Reals& a) { return {a.data(), a.data() + a.size()}; }

void bind_factors(nb::module_& m) {
  using nb::arg;
  nb::class_<StructureFactor>(m, "StructureFactor")
      .def_prop_ro("is_isotropic", &StructureFactor::is_isotropic)
      .def("evaluate", &evaluate_structure, arg("u"), arg("vectors"), arg("result").noconvert());
  m.def("percus_yevick_factor", [](double area_fraction) -> FactorPtr {
    return naming("area_fraction",
                  [&] { return std::make_shared<optics::PercusYevickStructureFactor>(area_fraction); });
  });
  m.def("poisson_factor", []() -> FactorPtr { return std::make_shared<optics::PoissonStructureFactor>(); });
  m.def(
      "lattice_factor",
      [](bool hexagonal, double area_fraction, double jitter, double domain, double angle,
         bool random) -> FactorPtr {
        using Lattice = optics::LatticeStructureFactor;
        return naming("area_fraction", [&] {
          return std::make_shared<Lattice>(hexagonal ? Lattice::Kind::hexagonal : Lattice::Kind::square,
                                           area_fraction, jitter, domain, angle, random);
        });
      },
      arg("hexagonal"), arg("area_fraction"), arg("jitter"), arg("domain"), arg("angle"), arg("random"));
  m.def(
      "tabulated_factor",
      [](const Reals& u, const Reals& values) -> FactorPtr {
        require_size(u.size() == values.size(), "tabulated_factor");
        return naming(
            "qa", [&] { return std::make_shared<optics::TabulatedStructureFactor>(list(u), list(values)); });
      },
      arg("qa"), arg("values"));
  m.def(
      "factor_of_pair_correlation",
      [](const Reals& r, const Reals& g, double area_fraction) -> FactorPtr {
        require_size(r.size() == g.size(), "factor_of_pair_correlation");
        const Unlocked release;
        return naming("ra", [&] {
          return std::make_shared<optics::TabulatedStructureFactor>(
              optics::TabulatedStructureFactor::from_pair_correlation(list(r), list(g), area_fraction));
        });
      },
      arg("ra"), arg("g"), arg("area_fraction"));
  m.def(
      "simulated_factor",
      [](double area_fraction, int discs, int snapshots, std::uint64_t seed) -> FactorPtr {
        const Unlocked release;
        optics::HardDiscEnsemble ensemble;
        ensemble.discs = discs, ensemble.snapshots = snapshots, ensemble.seed = seed;
        SignalCheck check;
        return naming("area_fraction", [&]() -> FactorPtr {
          return abandonable(
              [=] {
                return std::make_shared<optics::SimulatedStructureFactor>(area_fraction, ensemble,
                                                                          for_ranges);
              },
              check);
        });
      },
      arg("area_fraction"), arg("discs"), arg("snapshots"), arg("seed"));
}

/// result = f(x, y), element by element.
template <double (*kFunction)(double, double)>
void map(const Reals& x, const Reals& y, const Array<double>& result) {
  require_size(y.size() == x.size() && result.size() == x.size(), "the function");
  for_each(x.size(), [x = x.data(), y = y.data(), to = result.data()](std::size_t i) {
    to[i] = kFunction(x[i], y[i]);
  });
}

}  // namespace

void bind_correlations(nb::module_& m) {
  using nb::arg;
  m.def("hard_discs", &hard_discs, arg("radii"), arg("area_fraction"), arg("seed"), arg("first"),
        arg("between"), arg("positions").noconvert());
  m.def("hard_disc_structure_factor", &map<optics::hard_disc_structure_factor>, arg("u"),
        arg("area_fraction"), arg("result").noconvert());
  m.def("hard_disc_pair_correlation", &map<optics::hard_disc_pair_correlation>, arg("r"),
        arg("area_fraction"), arg("result").noconvert());
  m.def("ring_structure_factor", &ring_structure_factor, arg("positions"), arg("box_x"), arg("box_y"),
        arg("edges"), arg("per_ring"), arg("result").noconvert());
  m.def("window_structure_factor", &window_structure_factor, arg("positions"), arg("width"), arg("height"),
        arg("q"), arg("result").noconvert());
  m.def("count_pairs", &count_pairs, arg("positions"), arg("box_x"), arg("box_y"), arg("periodic"),
        arg("edges"), arg("tiles"), arg("result").noconvert());
  bind_factors(m);
}

}  // namespace aureole::python
