// SPDX-License-Identifier: Apache-2.0
// Stacks of plane layers, one for each wavelength. aureole/_stack.py checks the arguments and shapes the
// results.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "aureole/optics/stack/plane_stack.h"
#include "bindings.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

using optics::PlaneStack;
using optics::StackInterface;
using optics::StackLight;

/// How the phase function of a layer is given.
enum Phase { henyey_greenstein, by_moments, by_table };

optics::InterfaceKind interface_kind(int kind) {
  if (kind < 0 || kind > 2) throw Error("interface: expected 0, 1 or 2");
  return optics::InterfaceKind(kind);
}

/// NaN: diffuse light.
StackLight light(double cosine, bool from_below) {
  return std::isnan(cosine) ? StackLight::diffuse(from_below) : StackLight::beam(cosine, from_below);
}

class PlaneStacks {
public:
  /// `values` by stack and layer: absorption, scattering, thickness, g, index, roughness of the top.
  /// `outside` by stack: index above, index below, reflectance of a substrate or NaN, roughness of the
  /// bottom. `kinds`: interfaces from the top, one more than layers. `moments` by stack and layer. Tables by
  /// layer.
  PlaneStacks(const Array<const double, 3>& values, const Array<const double, 2>& outside,
              const std::vector<int>& kinds, const std::vector<int>& phases,
              const Array<const double, 3>& moments, const std::vector<std::vector<double>>& table_mu,
              const std::vector<std::vector<double>>& table_p, int streams, bool delta_m) {
    const std::size_t n = values.shape(0), layers = values.shape(1), terms = moments.shape(2);
    require_size(values.shape(2) == 6 && outside.shape(0) == n && outside.shape(1) == 4 &&
                     kinds.size() == layers + 1 && phases.size() == layers && moments.shape(0) == n &&
                     moments.shape(1) == layers && table_mu.size() == layers && table_p.size() == layers,
                 "PlaneStacks");
    naming("PlaneStack", [&] {
      for (std::size_t i = 0; i < n; ++i) {
        optics::StackDescription d;
        const double* around = outside.data() + 4 * i;
        d.index_above = around[0], d.index_below = around[1];
        if (!std::isnan(around[2])) d.substrate = around[2];
        d.bottom = {interface_kind(kinds[layers]), around[3]};
        for (std::size_t k = 0; k < layers; ++k) {
          const double *v = values.data() + 6 * (i * layers + k),
                       *chi = moments.data() + terms * (i * layers + k);
          optics::LegendrePhase phase =
              phases[k] == by_table     ? optics::LegendrePhase::table({table_mu[k], table_p[k]})
              : phases[k] == by_moments ? optics::LegendrePhase::of_moments({chi, chi + terms})
                                        : optics::LegendrePhase::henyey_greenstein(v[3]);
          d.layers.push_back({v[0], v[1], v[2], std::move(phase), v[4], {interface_kind(kinds[k]), v[5]}});
        }
        stacks_.emplace_back(std::move(d), optics::DiscreteOrdinates{streams, delta_m});
      }
    });
  }

  /// By stack: reflectance, transmittance, and both of what was not scattered.
  void fluxes(double cosine, bool from_below, const Array<double, 2>& result) const {
    require_size(result.shape(0) == stacks_.size() && result.shape(1) == 4, "fluxes");
    double* to = result.data();
    over("fluxes", [&, to](std::size_t i) {
      const optics::StackFluxes f = stacks_[i].fluxes(light(cosine, from_below));
      double* row = to + 4 * i;
      row[0] = f.reflectance, row[1] = f.transmittance;
      row[2] = f.unscattered_reflectance, row[3] = f.unscattered_transmittance;
    });
  }

  /// By stack, direction and azimuth; a layer of -1: outside, where depths mean nothing.
  void radiance(double cosine, bool from_below, int layer, const Reals& depths, const Reals& cosines,
                const Reals& azimuths, const Array<double, 3>& result) const {
    require_size(result.shape(0) == stacks_.size() && depths.size() == stacks_.size() &&
                     result.shape(1) == cosines.size() && result.shape(2) == azimuths.size(),
                 "radiance");
    double* to = result.data();
    const std::span<const double> mu(cosines.data(), cosines.size()), phi(azimuths.data(), azimuths.size());
    over("radiance", [&, to](std::size_t i) {
      const StackLight lights[] = {light(cosine, from_below)};
      const std::vector<double> values =
          layer < 0 ? stacks_[i].radiance(lights, mu, phi)
                    : stacks_[i].radiance(lights, {layer, depths.data()[i]}, mu, phi);
      std::copy(values.begin(), values.end(), to + i * mu.size() * phi.size());
    });
  }

  /// By stack and position; depths by stack and position.
  void fields(double cosine, bool from_below, const std::vector<int>& layers,
              const Array<const double, 2>& depths, const Array<double, 3>& result) const {
    const std::size_t count = layers.size();
    require_size(result.shape(0) == stacks_.size() && result.shape(1) == count && result.shape(2) == 10 &&
                     depths.shape(0) == stacks_.size() && depths.shape(1) == count,
                 "fields");
    double* to = result.data();
    over("fields", [&, to](std::size_t i) {
      std::vector<optics::StackPosition> at;
      for (std::size_t k = 0; k < count; ++k) at.push_back({layers[k], depths.data()[i * count + k]});
      double* row = to + i * count * 10;
      for (const optics::StackField& f : stacks_[i].fields(light(cosine, from_below), at))
        for (const double v : {f.flux_down, f.flux_up, f.fluence_down, f.fluence_up, f.unscattered_flux_down,
                               f.unscattered_flux_up, f.absorption_down, f.absorption_up, f.backscatter_down,
                               f.backscatter_up})
          *row++ = v;
    });
  }

private:
  template <class Body>
  void over(const char* function, const Body& body) const {
    naming(std::string("PlaneStack.") + function, [&] { for_each(stacks_.size(), body); });
  }
  std::vector<PlaneStack> stacks_;
};

}  // namespace

void bind_stack(nb::module_& m) {
  using nb::arg;
  nb::class_<PlaneStacks>(m, "PlaneStacks")
      .def(nb::init<const Array<const double, 3>&, const Array<const double, 2>&, const std::vector<int>&,
                    const std::vector<int>&, const Array<const double, 3>&,
                    const std::vector<std::vector<double>>&, const std::vector<std::vector<double>>&, int,
                    bool>(),
           arg("values"), arg("outside"), arg("kinds"), arg("phases"), arg("moments"), arg("table_mu"),
           arg("table_p"), arg("streams"), arg("delta_m"))
      .def("fluxes", &PlaneStacks::fluxes, arg("cosine"), arg("from_below"), arg("result").noconvert())
      .def("radiance", &PlaneStacks::radiance, arg("cosine"), arg("from_below"), arg("layer"), arg("depths"),
           arg("cosines"), arg("azimuths"), arg("result").noconvert())
      .def("fields", &PlaneStacks::fields, arg("cosine"), arg("from_below"), arg("layers"), arg("depths"),
           arg("result").noconvert());
}

}  // namespace aureole::python
