// SPDX-License-Identifier: Apache-2.0
// Spheres and interfaces. aureole/optics.py checks the arguments and shapes the results.
#include <cmath>
#include <optional>
#include <vector>

#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/optics/particle/mie_sphere.h"
#include "bindings.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

using optics::Mie;
using optics::MieAmplitudes;

/// Rows of `result`: extinction, scattering, backscattering, asymmetry.
void mie(const Reals& x, const Complexes& m, const Array<double, 2>& result) {
  const std::size_t n = x.size();
  require_size(m.size() == n && result.shape(0) == 4 && result.shape(1) == n, "mie");
  const double* size = x.data();
  const Complex* index = m.data();
  double* to = result.data();
  for_each(n, [=](std::size_t i) {
    const Mie sphere(size[i], index[i]);
    to[i] = sphere.extinction();
    to[n + i] = sphere.scattering();
    to[2 * n + i] = sphere.backscattering();
    to[3 * n + i] = sphere.asymmetry();
  });
}

/// Calls store(sphere, first result, amplitudes) for the angles `mu` of every sphere, block by block. The
/// coefficients of a sphere are found once.
template <class Store>
void for_amplitudes(const Reals& x, const Complexes& m, const Reals& mu, const Store& store) {
  const std::size_t n = x.size(), angles = mu.size();
  if (n == 0 || angles == 0) return;
  constexpr std::size_t kBlock = 64, kMaxSpheres = 4096;
  constexpr double kMaxTerms = 5e5;  // about 50 MB
  const std::size_t blocks = (angles + kBlock - 1) / kBlock;
  std::vector<std::optional<Mie>> spheres;
  SignalCheck signals;
  for (std::size_t first = 0, last; first < n; first = last) {
    double terms = 0;
    for (last = first; last < n && last - first < kMaxSpheres && terms < kMaxTerms; ++last)
      terms += 64 + x.data()[last];
    spheres.assign(last - first, std::nullopt);
    for_each(
        last - first, [&](std::size_t i) { spheres[i].emplace(x.data()[first + i], m.data()[first + i]); },
        signals);
    for_each((last - first) * blocks,
             [&](std::size_t task) {
               const std::size_t i = task / blocks, begin = task % blocks * kBlock,
                                 size = std::min(kBlock, angles - begin);
               MieAmplitudes s[kBlock];
               spheres[i]->amplitudes(std::span(mu.data() + begin, size), std::span(s, size));
               store(*spheres[i], (first + i) * angles + begin, std::span<const MieAmplitudes>(s, size));
             },
             signals);
  }
}

void mie_amplitudes(const Reals& x, const Complexes& m, const Reals& mu, const Array<Complex>& s1,
                    const Array<Complex>& s2) {
  require_size(m.size() == x.size() && s1.size() == x.size() * mu.size() && s2.size() == s1.size(),
               "mie_amplitudes");
  Complex *to1 = s1.data(), *to2 = s2.data();
  for_amplitudes(x, m, mu, [=](const Mie&, std::size_t at, std::span<const MieAmplitudes> s) {
    for (std::size_t k = 0; k < s.size(); ++k) to1[at + k] = s[k].s1, to2[at + k] = s[k].s2;
  });
}

/// (|S1|^2 + |S2|^2)/(2 k^2) over the cross section of scattering.
void mie_phase_function(const Reals& x, const Complexes& m, const Reals& mu, const Array<double>& result) {
  require_size(m.size() == x.size() && result.size() == x.size() * mu.size(), "mie_phase_function");
  double* to = result.data();
  for_amplitudes(x, m, mu, [=](const Mie& sphere, std::size_t at, std::span<const MieAmplitudes> s) {
    const double norm = M_PI * sphere.size() * sphere.size() * sphere.scattering();
    if (!(norm > 0)) throw Error("m: expected a sphere that scatters, one of index 1 does not");
    for (std::size_t k = 0; k < s.size(); ++k) to[at + k] = s[k].intensity() / norm;
  });
}

/// Rows of `amplitudes`: r_s, r_p, t_s, t_p, cos_t; of `fractions`: reflected, transmitted power.
void fresnel(const Reals& cos_theta, const Complexes& eta, const Array<Complex, 2>& amplitudes,
             const Array<double, 2>& fractions) {
  const std::size_t n = cos_theta.size();
  require_size(eta.size() == n && amplitudes.shape(0) == 5 && amplitudes.shape(1) == n &&
                   fractions.shape(0) == 2 && fractions.shape(1) == n,
               "fresnel");
  const double* cosine = cos_theta.data();
  const Complex* index = eta.data();
  Complex* to = amplitudes.data();
  double* power = fractions.data();
  for_each(n, [=](std::size_t i) {
    const double cos_i = std::clamp(cosine[i], 0.0, 1.0);
    const optics::FresnelAmplitudes a = optics::fresnel_amplitudes(cos_i, 1, index[i]);
    const Complex row[5] = {a.r_s, a.r_p, a.t_s, a.t_p, a.cos_t};
    for (std::size_t k = 0; k < 5; ++k) to[k * n + i] = row[k];
    const double reflected = 0.5 * (std::norm(a.r_s) + std::norm(a.r_p));
    const double flux = (index[i] * a.cos_t).real() * std::norm(a.t_s) +
                        (index[i] * std::conj(a.cos_t)).real() * std::norm(a.t_p);
    power[i] = reflected;
    power[n + i] = cos_i > 0 ? std::max(0.5 * flux / cos_i, 0.0) : 1 - reflected;
  });
}

/// Rows of `result`: reflected, transmitted power.
void slab_powers(const Reals& cos_theta, const Complexes& index, const Reals& thickness, const Reals& outside,
                 const Array<double, 2>& result) {
  const std::size_t n = cos_theta.size();
  require_size(index.size() == n && thickness.size() == n && outside.size() == n && result.shape(0) == 2 &&
                   result.shape(1) == n,
               "slab_powers");
  double* to = result.data();
  naming("slab_powers", [&] {
    for_each(n, [&](std::size_t i) {
      const optics::SlabPowers p =
          optics::slab_powers(cos_theta.data()[i], outside.data()[i], index.data()[i], thickness.data()[i]);
      to[i] = p.reflected, to[n + i] = p.transmitted;
    });
  });
}

}  // namespace

void bind_optics(nb::module_& m) {
  using nb::arg;
  m.def("mie", &mie, arg("x"), arg("m"), arg("result").noconvert());
  m.def("mie_amplitudes", &mie_amplitudes, arg("x"), arg("m"), arg("mu"), arg("s1").noconvert(),
        arg("s2").noconvert());
  m.def("mie_phase_function", &mie_phase_function, arg("x"), arg("m"), arg("mu"), arg("result").noconvert());
  m.def("fresnel", &fresnel, arg("cos_theta"), arg("eta"), arg("amplitudes").noconvert(),
        arg("fractions").noconvert());
  m.def("slab_powers", &slab_powers, arg("cos_theta"), arg("index"), arg("thickness"), arg("outside"),
        arg("result").noconvert());
  m.def(
      "thin_slab_reflectance",
      [](const Reals& cos_theta, const Reals& eta, const Array<double>& result) {
        map_pairs("thin_slab_reflectance", cos_theta, eta, result, [](double cosine, double index) {
          return optics::thin_slab_reflectance(cosine, 1, index);
        });
      },
      arg("cos_theta"), arg("eta"), arg("result").noconvert());
  m.def(
      "fresnel_diffuse_reflectance",
      [](const Reals& eta, const Array<double>& result) {
        map_numbers("eta", eta, result, &optics::fresnel_diffuse_reflectance);
      },
      arg("eta"), arg("result").noconvert());
  bind_absorption(m);
  bind_sizes(m);
  bind_stack(m);
  bind_radiometry(m);
  bind_apertures(m);
  bind_correlations(m);
  bind_diffraction(m);
  bind_edge_kernels(m);
}

}  // namespace aureole::python
