// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/grain_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <span>

#include "aureole/core/letter_case.h"

namespace aureole::pigment {
namespace {

using Complex = std::complex<double>;

/// Dispersion formula n^2 = a + sum b l^2/(l^2 - c) + d l^2, with l in um.
struct Formula {
  double a;
  std::array<std::array<double, 2>, 2> terms;
  double d = 0;

  double n(double um) const {
    const double l2 = um * um;
    double square = a + d * l2;
    for (const auto& [b, c] : terms) square += b * l2 / (l2 - c);
    return std::sqrt(square);
  }
};

/// Dispersion formula n^2 = a + b/(l^2 - c) + d/(l^2 - e), with l in um.
struct Poles {
  double a, b, c, d = 0, e = 0;
  double n(double um) const {
    const double l2 = um * um;
    return std::sqrt(a + b / (l2 - c) + (d != 0 ? d / (l2 - e) : 0));
  }
};

/// A wavelength in nm, and the ordinary and extraordinary complex indices.
struct Row {
  double nm, n_o, k_o, n_e, k_e;
};

// clang-format off
constexpr Row kHematite[] = {
    {360, 2.433, 1.14, 2.211, 0.987}, {370, 2.47, 1.202, 2.243, 1.034}, {380, 2.545, 1.258, 2.305, 1.075},
    {390, 2.645, 1.291, 2.387, 1.097}, {400, 2.756, 1.294, 2.475, 1.096}, {410, 2.863, 1.271, 2.56, 1.075},
    {420, 2.962, 1.231, 2.638, 1.04}, {430, 3.052, 1.173, 2.708, 0.993}, {440, 3.126, 1.101, 2.766, 0.936},
    {450, 3.181, 1.02, 2.809, 0.873}, {460, 3.217, 0.943, 2.837, 0.813}, {470, 3.242, 0.874, 2.858, 0.758},
    {480, 3.264, 0.809, 2.876, 0.707}, {490, 3.28, 0.741, 2.89, 0.654}, {500, 3.282, 0.675, 2.893, 0.602},
    {510, 3.272, 0.622, 2.887, 0.56}, {520, 3.262, 0.587, 2.881, 0.532}, {530, 3.266, 0.564, 2.885, 0.512},
    {540, 3.286, 0.538, 2.901, 0.492}, {550, 3.318, 0.498, 2.927, 0.46}, {560, 3.348, 0.437, 2.951, 0.413},
    {570, 3.361, 0.357, 2.963, 0.351}, {580, 3.348, 0.274, 2.956, 0.286}, {590, 3.312, 0.202, 2.931, 0.229},
    {600, 3.265, 0.149, 2.898, 0.186}, {610, 3.218, 0.114, 2.862, 0.156}, {620, 3.175, 0.089, 2.83, 0.134},
    {630, 3.135, 0.073, 2.8, 0.119}, {640, 3.102, 0.065, 2.775, 0.11}, {650, 3.074, 0.057, 2.753, 0.103},
    {660, 3.051, 0.051, 2.736, 0.096}, {670, 3.029, 0.043, 2.719, 0.089}, {680, 3.008, 0.038, 2.703, 0.083},
    {690, 2.99, 0.034, 2.688, 0.078}, {700, 2.972, 0.031, 2.675, 0.075}, {710, 2.956, 0.028, 2.662, 0.072},
    {720, 2.942, 0.026, 2.652, 0.068}, {730, 2.929, 0.024, 2.641, 0.066}, {740, 2.916, 0.022, 2.631, 0.063},
    {750, 2.903, 0.021, 2.621, 0.061}, {760, 2.892, 0.02, 2.612, 0.06}, {770, 2.882, 0.02, 2.604, 0.059},
    {780, 2.872, 0.019, 2.596, 0.058}, {790, 2.862, 0.019, 2.589, 0.057}, {800, 2.853, 0.02, 2.582, 0.057},
    {810, 2.845, 0.022, 2.575, 0.057}, {820, 2.838, 0.024, 2.57, 0.058}, {830, 2.833, 0.025, 2.566, 0.059},};
constexpr Row kMagnetite[] = {
    {360, 2.434, 0.112, 2.434, 0.112}, {370, 2.447, 0.108, 2.447, 0.108}, {380, 2.459, 0.096, 2.459, 0.096},
    {390, 2.464, 0.08, 2.464, 0.08}, {400, 2.462, 0.062, 2.462, 0.062}, {410, 2.453, 0.047, 2.453, 0.047},
    {420, 2.44, 0.034, 2.44, 0.034}, {430, 2.423, 0.026, 2.423, 0.026}, {440, 2.404, 0.026, 2.404, 0.026},
    {450, 2.386, 0.032, 2.386, 0.032}, {460, 2.374, 0.042, 2.374, 0.042}, {470, 2.367, 0.054, 2.367, 0.054},
    {480, 2.365, 0.063, 2.365, 0.063}, {490, 2.364, 0.067, 2.364, 0.067}, {500, 2.359, 0.071, 2.359, 0.071},
    {510, 2.354, 0.077, 2.354, 0.077}, {520, 2.349, 0.083, 2.349, 0.083}, {530, 2.346, 0.091, 2.346, 0.091},
    {540, 2.344, 0.099, 2.344, 0.099}, {550, 2.343, 0.105, 2.343, 0.105}, {560, 2.342, 0.112, 2.342, 0.112},
    {570, 2.342, 0.118, 2.342, 0.118}, {580, 2.342, 0.125, 2.342, 0.125}, {590, 2.344, 0.131, 2.344, 0.131},
    {600, 2.346, 0.136, 2.346, 0.136}, {610, 2.35, 0.141, 2.35, 0.141}, {620, 2.353, 0.144, 2.353, 0.144},
    {630, 2.358, 0.148, 2.358, 0.148}, {640, 2.366, 0.145, 2.366, 0.145}, {650, 2.366, 0.138, 2.366, 0.138},
    {660, 2.363, 0.137, 2.363, 0.137}, {670, 2.364, 0.135, 2.364, 0.135}, {680, 2.362, 0.131, 2.362, 0.131},
    {690, 2.359, 0.127, 2.359, 0.127}, {700, 2.355, 0.124, 2.355, 0.124}, {710, 2.349, 0.122, 2.349, 0.122},
    {720, 2.343, 0.12, 2.343, 0.12}, {730, 2.336, 0.119, 2.336, 0.119}, {740, 2.329, 0.118, 2.329, 0.118},
    {750, 2.32, 0.118, 2.32, 0.118}, {760, 2.312, 0.119, 2.312, 0.119}, {770, 2.303, 0.12, 2.303, 0.12},
    {780, 2.294, 0.123, 2.294, 0.123}, {790, 2.284, 0.128, 2.284, 0.128}, {800, 2.279, 0.134, 2.279, 0.134},
    {810, 2.272, 0.134, 2.272, 0.134}, {820, 2.262, 0.138, 2.262, 0.138}, {830, 2.253, 0.143, 2.253, 0.143},};
// clang-format on

Complex mean(Complex ordinary, Complex extraordinary) { return (2.0 * ordinary + extraordinary) / 3.0; }

template <class F>
optics::IndexFunction uniaxial(F ordinary, F extraordinary, double min_nm, double max_nm) {
  return [=](double nm) {
    const double um = 1e-3 * std::clamp(nm, min_nm, max_nm);
    return mean(ordinary.n(um), extraordinary.n(um));
  };
}

optics::IndexFunction table(std::span<const Row> rows) {
  return [rows](double nm) {
    const auto above = std::upper_bound(rows.begin(), rows.end(), nm,
                                        [](double value, const Row& r) { return value < r.nm; });
    const Row &b = above == rows.end() ? rows.back() : *above, &a = above == rows.begin() ? b : *(above - 1);
    const double t = b.nm > a.nm ? std::clamp((nm - a.nm) / (b.nm - a.nm), 0.0, 1.0) : 0;
    return mean({std::lerp(a.n_o, b.n_o, t), std::lerp(a.k_o, b.k_o, t)},
                {std::lerp(a.n_e, b.n_e, t), std::lerp(a.k_e, b.k_e, t)});
  };
}

optics::IndexFunction constant(Complex value) {
  return [value](double) { return value; };
}

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::string_view kQuerry = "M. R. Querry, Optical constants, Contractor Report CRDC-CR-85034, 1985",
                           kGhosh = "G. Ghosh, Opt. Commun. 163, 95, 1999";

const std::vector<GrainIndex>& all() {
  static const std::vector<GrainIndex> table_of_all = {
      {"rutile", uniaxial(Poles{5.913, 0.2441, 0.0803}, Poles{7.197, 0.3322, 0.0843}, 430, 1530), 430, 1530,
       false, "J. R. DeVore, J. Opt. Soc. Am. 41, 416, 1951; without the absorption below 430 nm"},
      {"anatase",
       uniaxial(Formula{1, {{{4.6796, 0.2002148 * 0.2002148}, {0, 0}}}},
                Formula{1, {{{4.6796, 0.2002148 * 0.2002148}, {0, 0}}}}, 405, 635),
       405, 635, false,
       "I. Bodurov, I. Vlaeva, A. Viraneva, T. Yovcheva & S. Sainov, Nanoscience & Nanotechnology 16, 31, 2016; mean of "
       "grains below 35 nm in water"},
      {"zinc oxide",
       uniaxial(Formula{2.81418, {{{0.87968, 0.3042 * 0.3042}, {0, 0}}}, -0.00711},
                Formula{2.80333, {{{0.94470, 0.3004 * 0.3004}, {0, 0}}}, -0.00714}, 450, 4000),
       450, 4000, false,
       "W. L. Bond, J. Appl. Phys. 36, 1674, 1965, by the formula in the Handbook of Optics IV, 2009"},
      {"zinc sulfide",
       uniaxial(Poles{8.393, 0.14383, 0.2421 * 0.2421, 4430.99, 36.71 * 36.71},
                Poles{8.393, 0.14383, 0.2421 * 0.2421, 4430.99, 36.71 * 36.71}, 405, 13000),
       405, 13000, false,
       "M. Debenham, Appl. Opt. 23, 2238, 1984, by C. A. Klein, Appl. Opt. 25, 1873, 1986"},
      {"hematite", table(kHematite), kHematite[0].nm, std::end(kHematite)[-1].nm, true, kQuerry},
      {"magnetite", table(kMagnetite), kMagnetite[0].nm, std::end(kMagnetite)[-1].nm, true, kQuerry},
      {"carbon black", constant({1.95, 0.79}), 0, kInfinite, true,
       "T. C. Bond & R. W. Bergstrom, Aerosol Sci. Technol. 40, 27, 2006; in the visible"},
      {"acetylene soot", constant({1.56, 0.46}), 0, kInfinite, true,
       "W. H. Dalzell & A. F. Sarofim, J. Heat Transfer 91, 100, 1969; in the visible, +-.01 and +-.02"},
      {"calcite",
       uniaxial(Formula{1.73358749, {{{0.96464345, 1.94325203e-2}, {1.82831454, 120}}}},
                Formula{1.35859695, {{{0.82427830, 1.06689543e-2}, {0.14429128, 120}}}}, 204, 2172),
       204, 2172, false, kGhosh},
      {"quartz",
       uniaxial(Formula{1.28604141, {{{1.07044083, 1.00585997e-2}, {1.10202242, 100}}}},
                Formula{1.28851804, {{{1.09509924, 1.02101864e-2}, {1.15662475, 100}}}}, 198, 2053),
       198, 2053, false, kGhosh},
      {"kaolinite", constant(1.562), 0, kInfinite, false,
       "middle of the range that mineralogies give, 1.553 to 1.570"},
      {"barite", constant(1.640), 0, kInfinite, false,
       "mean of 1.635 to 1.637, 1.636 to 1.639 and 1.646 to 1.649: mints.uwc.ac.za"},
      {"gypsum", constant(1.524), 0, kInfinite, false,
       "mean of 1.519 to 1.521, 1.522 to 1.523 and 1.529 to 1.530: SSHADE, sshade.eu"}};
  return table_of_all;
}

constexpr std::array<std::string_view, 2> kOfTheTrade[] = {
    {"titanium white", "rutile"},      {"zinc white", "zinc oxide"},     {"iron oxide red", "hematite"},
    {"iron oxide black", "magnetite"}, {"lamp black", "acetylene soot"}, {"chalk", "calcite"},
    {"china clay", "kaolinite"},       {"blanc fixe", "barite"}};

}  // namespace

std::optional<GrainIndex> find_grain_index(std::string_view name) {
  std::string key = lower_case(name);
  for (const auto& [trade, is] : kOfTheTrade)
    if (key == trade) key = is;
  for (const GrainIndex& g : all())
    if (g.name == key) return g;
  return {};
}

std::vector<std::string> grain_index_names() {
  std::vector<std::string> names;
  for (const GrainIndex& g : all()) names.push_back(g.name);
  for (const auto& [trade, is] : kOfTheTrade) names.emplace_back(trade);
  return names;
}

}  // namespace aureole::pigment
