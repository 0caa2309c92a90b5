// SPDX-License-Identifier: Apache-2.0
// Paints that transport makes (streams, optics/stack; tests/medium/layered_slab_test.cpp follows paths through
// such layers), measured as a laboratory would, and mixtures of three of them that no fit has seen: how well do
// Kubelka and Munk, and streams with a guessed phase function, predict their colour?
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "aureole/optics/stack/plane_stack.h"
#include "aureole/pigment/kubelka_munk_inverse.h"
#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/observation.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {
namespace {

constexpr double kIndex = 1.5, kFilm = 20e-6, kWhite = 0.85, kGuessedG = 0.5;
constexpr double kOpaque = std::numeric_limits<double>::infinity();

struct Grains {
  double absorption = 0, scattering = 0, first = 0;  ///< 1/m; first: scattering times g
  double g() const { return scattering > 0 ? first / scattering : 0; }
};
Grains mixed(std::span<const Grains> paints, std::span<const double> volumes) {
  Grains sum;
  for (std::size_t i = 0; i < paints.size(); ++i)
    sum.absorption += volumes[i] * paints[i].absorption, sum.scattering += volumes[i] * paints[i].scattering,
        sum.first += volumes[i] * paints[i].first;
  return sum;
}

double bump(double nm, double centre, double width) { return std::exp(-std::pow((nm - centre) / width, 2)); }

/// White, yellow, red and blue: absorption bands, and grains smaller than the wavelength that scatter less
/// where it is long, each with a phase function of its own.
std::vector<Grains> paints_at(double nm) {
  const double fall = std::pow(550 / nm, 1.5);
  const auto paint = [](double a, double s, double g) { return Grains{a, s, s * g}; };
  return {paint(300 + 4e4 * bump(nm, 380, 25), 5e5 * fall, 0.45),
          paint(2e5 * bump(nm, 420, 60), 1.5e5 * fall, 0.6), paint(2e5 * bump(nm, 500, 60), 1e5 * fall, 0.7),
          paint(2.5e5 * bump(nm, 620, 70), 3e4 * fall, 0.3)};
}

/// Reflectance for diffuse light, gloss included, as a sphere instrument measures it.
double transport(const Grains& p, double thickness, double substrate, int streams = 32) {
  optics::StackDescription d;
  d.layers = {
      {p.absorption, p.scattering, thickness, optics::LegendrePhase::henyey_greenstein(p.g()), kIndex}};
  d.substrate = substrate;
  return optics::PlaneStack(d, {streams}).fluxes(optics::StackLight::diffuse()).reflectance;
}

/// sigma_a and sigma_s with this g that give two drawdowns, by Newton's method in their logarithms.
Grains fitted_streams(double over_black, double over_white, double g) {
  double a = std::log(1e4), s = std::log(2e5);
  const auto paint = [g](double la, double ls) {
    return Grains{std::exp(la), std::exp(ls), g * std::exp(ls)};
  };
  const auto both = [&](double la, double ls) {
    const Grains p = paint(la, ls);
    return std::array{std::log(transport(p, kFilm, 0, 16) / over_black),
                      std::log(transport(p, kFilm, kWhite, 16) / over_white)};
  };
  for (int i = 0; i < 40; ++i) {
    constexpr double kStep = 1e-4;
    const auto f = both(a, s), fa = both(a + kStep, s), fs = both(a, s + kStep);
    if (std::abs(f[0]) + std::abs(f[1]) < 1e-9) break;
    const double m00 = (fa[0] - f[0]) / kStep, m10 = (fa[1] - f[1]) / kStep, m01 = (fs[0] - f[0]) / kStep,
                 m11 = (fs[1] - f[1]) / kStep, det = m00 * m11 - m01 * m10;
    a -= std::clamp((m11 * f[0] - m01 * f[1]) / det, -0.7, 0.7);
    s -= std::clamp((m00 * f[1] - m10 * f[0]) / det, -0.7, 0.7);
    a = std::clamp(a, std::log(1.0), std::log(1e7)), s = std::clamp(s, std::log(1e2), std::log(1e7));
  }
  return paint(a, s);
}

/// And g, by which an opaque layer has its reflectance, too: two films cannot tell light that is scattered forward
/// from light that is not scattered. By the secant method.
Grains fitted_streams_and_g(double over_black, double over_white, double opaque) {
  double g0 = 0.4, g1 = 0.6;
  const auto miss = [&](double g) {
    return std::log(transport(fitted_streams(over_black, over_white, g), kOpaque, 0, 16) / opaque);
  };
  double f0 = miss(g0), f1 = miss(g1);
  for (int i = 0; i < 12 && std::abs(f1) > 1e-7 && f1 != f0; ++i) {
    const double next = std::clamp(g1 - f1 * (g1 - g0) / (f1 - f0), -0.5, 0.9);
    g0 = g1, f0 = f1, g1 = next, f1 = miss(next);
  }
  return fitted_streams(over_black, over_white, g1);
}

/// The parameter in [low, high] at which a rising or falling function has this value, by bisection.
template <class F>
double solve(F&& f, double wanted, double low, double high) {
  const bool rises = f(high) > f(low);
  for (int i = 0; i < 50; ++i) {
    const double middle = std::sqrt(low * high);
    ((f(middle) < wanted) == rises ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// Measurements of four paints in a laboratory, reflectances of opaque layers, pure and as tints with white, and of
/// films over black and white; and the coefficients of two theories from them, by paint. With the opaque layer
/// beside the films, streams find g as well (`three_streams`).
struct Laboratory {
  std::vector<Coefficients> opaque, film;
  std::vector<Grains> opaque_streams, film_streams, three_streams;

  explicit Laboratory(double nm, const Surface& surface) {
    const std::vector<Grains> paints = paints_at(nm);
    constexpr double kShare = 0.3;  // of a paint in its tint
    for (std::size_t i = 0; i < paints.size(); ++i) {
      const double black = transport(paints[i], kFilm, 0), white = transport(paints[i], kFilm, kWhite);
      film.push_back(coefficients_of_drawdowns({inner_reflectance(surface, black), 0},
                                               {inner_reflectance(surface, white), kWhite}, kFilm));
      film_streams.push_back(fitted_streams(black, white, kGuessedG));
      const double masstone = transport(paints[i], kOpaque, 0);
      three_streams.push_back(fitted_streams_and_g(black, white, masstone));

      const auto streams_of = [](double a, double s) { return Grains{a, s, kGuessedG * s}; };
      const auto inside = [&](double r) { return k_over_s(inner_reflectance(surface, r)); };
      // Relative to the white: its S, or sigma_s, is 1.
      const double ratio =
          solve([&](double a) { return transport(streams_of(a, 1), kOpaque, 0, 16); }, masstone, 1e-6, 1e3);
      if (i == 0) {
        opaque.push_back({inside(masstone), 1});
        opaque_streams.push_back(streams_of(ratio, 1));
        continue;
      }
      const double shares[] = {1 - kShare, kShare};
      const Grains both[] = {paints[0], paints[i]};
      const double tint = transport(mixed(both, shares), kOpaque, 0);
      const double s = scattering_of_tint(inside(masstone), {kShare, inside(tint)}, opaque[0]);
      opaque.push_back({s * inside(masstone), s});
      const double scattering = solve(
          [&](double x) {
            const Grains guess[] = {opaque_streams[0], streams_of(ratio * x, x)};
            return transport(mixed(guess, shares), kOpaque, 0, 16);
          },
          tint, 1e-3, 1e3);
      opaque_streams.push_back(streams_of(ratio * scattering, scattering));
    }
  }
};

TEST(SyntheticPaints, MixturesOfThree) {
  std::vector<double> nm;
  for (double l = 400; l <= 700; l += 20) nm.push_back(l);
  const Surface surface = smooth_surface(kIndex, Geometry::diffuse_diffuse, Specular::included);
  std::vector<Laboratory> known;
  for (const double l : nm) known.emplace_back(l, surface);
  const auto lobe = [](double l, double scale, double centre, double below, double above) {
    return scale * std::exp(-0.5 * std::pow((l - centre) / (l < centre ? below : above), 2));
  };
  // The CIE 1931 observer by a fit of lobes (Wyman, Sloan & Shirley, JCGT 2, 2013, (4)), under a black body.
  const Observation day(
      "day", nm, [](double l) { return std::pow(l, -5) / std::expm1(1.4388e7 / (l * 6500)); },
      {[=](double l) {
         return lobe(l, 1.056, 599.8, 37.9, 31.0) + lobe(l, 0.362, 442.0, 16.0, 26.7) +
                lobe(l, -0.065, 501.1, 20.4, 26.2);
       },
       [=](double l) { return lobe(l, 0.821, 568.8, 46.9, 40.5) + lobe(l, 0.286, 530.9, 16.3, 31.1); },
       [=](double l) { return lobe(l, 1.217, 437.0, 11.8, 36.0) + lobe(l, 0.681, 459.0, 26.0, 13.8); }});

  const std::array<double, 4> mixtures[] = {{.8, .15, .05, 0}, {.6, .35, 0, .05}, {.5, 0, .4, .1},
                                            {.2, .5, .3, 0},   {.9, .05, .05, 0}, {.3, .6, 0, .1},
                                            {.1, .6, .3, 0},   {.7, 0, .1, .2}};
  for (const bool is_film : {false, true}) {
    const double thickness = is_film ? kFilm : kOpaque;
    double sums[3] = {}, worst[3] = {};
    for (const auto& volumes : mixtures) {
      std::vector<double> truth, predicted[3];
      for (std::size_t i = 0; i < nm.size(); ++i) {
        const auto& paints = is_film ? known[i].film : known[i].opaque;
        Coefficients c;
        for (std::size_t p = 0; p < 4; ++p)
          c.k += volumes[p] * std::max(0.0, paints[p].k), c.s += volumes[p] * std::max(0.0, paints[p].s);
        const Grains streams = mixed(is_film ? known[i].film_streams : known[i].opaque_streams, volumes);
        truth.push_back(transport(mixed(paints_at(nm[i]), volumes), thickness, 0));
        predicted[0].push_back(outer_reflectance(surface, reflectance_over(layer(c, thickness), 0)));
        predicted[1].push_back(transport(streams, thickness, 0, 16));
        predicted[2].push_back(transport(mixed(known[i].three_streams, volumes), thickness, 0, 16));
      }
      for (const int theory : {0, 1, 2}) {
        const double difference = ciede2000(day.lab(truth), day.lab(predicted[theory]));
        sums[theory] += difference / double(std::size(mixtures));
        worst[theory] = std::max(worst[theory], difference);
      }
    }
    std::printf(
        "mixtures of three, %s: Kubelka and Munk Delta E 2000 %.2f (at most %.2f), streams %.2f (%.2f), with g from films "
        "and an opaque layer %.3f (%.3f)\n",
        is_film ? "films, from films over black and white" : "opaque, from masstones and tints", sums[0],
        worst[0], sums[1], worst[1], sums[2], worst[2]);
    EXPECT_LT(sums[0], is_film ? 6 : 1);
    EXPECT_LT(sums[1], is_film ? 0.5 : 0.3);
    EXPECT_LT(sums[2], 0.2);
  }
}

}  // namespace
}  // namespace aureole::pigment
