// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/refractive_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "aureole/core/letter_case.h"

namespace aureole {
namespace detail {

/// A dispersion formula. Sellmeier: n^2 = 1 + a + sum_j b_j l^2 / (l^2 - c_j). Cauchy: n = a + b_0/l^2 +
/// b_1/l^4. The wavelength l is in um, c_j in um^2.
struct DispersionFormula {
  std::string_view name;
  enum Kind { kSellmeier, kCauchy } kind;
  double min_nm, max_nm, a;
  struct Term {
    double b, c;
  };
  std::array<Term, 7> terms;  // terms of the formula; unused terms are zero
  std::string_view source;

  double n(double lambda_um) const;
};

struct MetalRow {
  double nm, n, k;
};

struct MetalRecord {
  std::string_view name;
  std::span<const MetalRow> rows;
  std::string_view source;
};

}  // namespace detail

namespace {

using detail::DispersionFormula;
using detail::MetalRecord;
using detail::MetalRow;

constexpr double kSodiumD = 589.3;  // wavelength of the sodium D line, the mean of the doublet [nm]

constexpr std::string_view kPalik1 =
    "E. D. Palik (ed.), Handbook of Optical Constants of Solids, Academic Press 1985";
constexpr std::string_view kPalik2 =
    "E. D. Palik (ed.), Handbook of Optical Constants of Solids II, Academic Press 1991";
constexpr std::string_view kPalik =
    "E. D. Palik (ed.), Handbook of Optical Constants of Solids I or II, Academic Press";
constexpr std::string_view kSultanova =
    "20 C: N. Sultanova, S. Kasarova and I. Nikolov, Acta Physica Polonica A 116, 585 (2009)";
constexpr std::string_view kUnstated = "collected at luxpop.com, which does not state the original source";
constexpr std::string_view kConstantSource =
    "constant near 589 nm, as in Mitsuba 3 (many from E. Hecht, Optics)";

#include "aureole/spectrum/data/metals.inc"

constexpr double square(double x) { return x * x; }

constexpr auto kSellmeier = DispersionFormula::kSellmeier;
constexpr auto kCauchy = DispersionFormula::kCauchy;

// clang-format off
/// Dispersion formulas, with the ranges in nm that their sources state.
constexpr DispersionFormula kFormulas[] = {
    {"water", kSellmeier, 182, 1129, 0,
     {{{5.684027565e-1, 5.101829712e-3}, {1.726177391e-1, 1.821153936e-2}, {2.086189578e-2, 2.620722293e-2},
       {1.130748688e-1, 1.069792721e1}}},
     "20 C: M. Daimon and A. Masumura, Appl. Opt. 46, 3811 (2007)"},
    {"bk7", kSellmeier, 300, 2500, 0,
     {{{1.03961212, 0.00600069867}, {0.231792344, 0.0200179144}, {1.01046945, 103.560653}}},
     "Schott N-BK7 data sheet"},
    {"fused silica", kSellmeier, 210, 3710, 0,
     {{{0.6961663, square(0.0684043)}, {0.4079426, square(0.1162414)}, {0.8974794, square(9.896161)}}},
     "20 C: I. H. Malitson, J. Opt. Soc. Am. 55, 1205 (1965)"},
    {"diamond", kSellmeier, 226, 644, 0, {{{0.3306, square(0.1750)}, {4.3356, square(0.1060)}}},
     "F. Peter, Zeitschrift fuer Physik 15, 358 (1923)"},
    {"sapphire", kSellmeier, 200, 5000, 0,
     {{{1.4313493, square(0.0726631)}, {0.65054713, square(0.1193242)}, {5.3414021, square(18.028251)}}},
     "ordinary ray, 20 C: I. H. Malitson and M. J. Dodge, J. Opt. Soc. Am. 62, 1405 (1972)"},
    {"acrylic glass", kSellmeier, 437, 1052, 0, {{{1.1819, 0.011313}}}, kSultanova},
    {"polystyrene", kSellmeier, 437, 1052, 0, {{{1.4435, 0.020216}}}, kSultanova},
    {"polycarbonate", kSellmeier, 437, 1052, 0, {{{1.4182, 0.021304}}}, kSultanova},
    {"sodium chloride", kSellmeier, 200, 30000, 0.00055,
     {{{0.19800, square(0.050)}, {0.48398, square(0.100)}, {0.38696, square(0.128)}, {0.25998, square(0.158)},
       {0.08796, square(40.50)}, {3.17064, square(60.98)}, {0.30038, square(120.34)}}},
     "24 C: H. H. Li, J. Phys. Chem. Ref. Data 5, 329 (1976)"},
    {"calcium fluoride", kSellmeier, 230, 9700, 0,
     {{{0.5675888, square(0.050263605)}, {0.4710914, square(0.1003909)}, {3.8484723, square(34.649040)}}},
     "24 C: I. H. Malitson, Appl. Opt. 2, 1103 (1963)"},
    {"magnesium fluoride", kSellmeier, 200, 7000, 0,
     {{{0.48755108, square(0.04338408)}, {0.39875031, square(0.09461442)}, {2.3120353, square(23.793604)}}},
     "ordinary ray: M. J. Dodge, Appl. Opt. 23, 1980 (1984)"},
    {"f2", kSellmeier, 334, 2500, 0,
     {{{1.34533359, 0.00997743871}, {0.209073176, 0.0470450767}, {0.937357162, 111.886764}}},
     "Schott F2 data sheet"},
    {"sf11", kSellmeier, 370, 2500, 0,
     {{{1.73759695, 0.013188707}, {0.313747346, 0.0623068142}, {1.89878101, 155.23629}}},
     "Schott N-SF11 data sheet"},
    {"sk16", kSellmeier, 310, 2500, 0,
     {{{1.34317774, 0.00704687339}, {0.241144399, 0.0229005}, {0.994317969, 92.7508526}}},
     "Schott N-SK16 data sheet"},
    {"sk2", kSellmeier, 310, 2500, 0,
     {{{1.28189012, 0.0072719164}, {0.257738258, 0.0242823527}, {0.96818604, 110.377773}}},
     "Schott N-SK2 data sheet"},
    {"ssk2", kSellmeier, 326, 2500, 0,
     {{{1.4306027, 0.00823982975}, {0.153150554, 0.0333736841}, {1.01390904, 106.870822}}},
     "Schott N-SSK2 data sheet"},
    {"f5", kSellmeier, 320, 2500, 0,
     {{{1.3104463, 0.00958633048}, {0.19603426, 0.0457627627}, {0.96612977, 115.011883}}},
     "Schott F5 data sheet"},
    {"sf5", kSellmeier, 350, 2500, 0,
     {{{1.46141885, 0.0111826126}, {0.247713019, 0.0508594669}, {0.949995832, 112.041888}}},
     "Schott SF5 data sheet"},
    {"sf6", kSellmeier, 380, 2500, 0,
     {{{1.72448482, 0.0134871947}, {0.390104889, 0.0569318095}, {1.04572858, 118.557185}}},
     "Schott SF6 data sheet"},
    {"sf10", kSellmeier, 380, 2500, 0,
     {{{1.61625977, 0.0127534559}, {0.259229334, 0.0581983954}, {1.07762317, 116.60768}}},
     "Schott SF10 data sheet"},
    {"lak9", kSellmeier, 334, 2500, 0,
     {{{1.46231905, 0.00724270156}, {0.344399589, 0.0243353131}, {1.15508372, 85.4686868}}},
     "Schott N-LAK9 data sheet"},
    {"bak4", kSellmeier, 334, 2500, 0,
     {{{1.28834642, 0.00779980626}, {0.132817724, 0.0315631177}, {0.945395373, 105.965875}}},
     "Schott N-BAK4 data sheet"},
    {"baf10", kSellmeier, 350, 2500, 0,
     {{{1.5851495, 0.00926681282}, {0.143559385, 0.0424489805}, {1.08521269, 105.613573}}},
     "Schott N-BAF10 data sheet"},
    {"ethanol", kCauchy, 476.5, 830, 1.35265, {{{0.00306, 0}, {0.00002, 0}}},
     "20 C: J. Rheims, J. Koeser and T. Wriedt, Meas. Sci. Technol. 8, 601 (1997)"},
};
// clang-format on

struct Constant {
  std::string_view name;
  double n;
};

/// Mitsuba 3's named indices (include/mitsuba/render/ior.h). Air is constant even with dispersion. It varies
/// by 8e-6 over the visible, and a dispersive exterior would make every constant-index glass dispersive.
constexpr Constant kConstants[] = {
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419},
};

/// Alternative names, and pairs of names where Mitsuba's constant and the dispersion formula are named
/// differently.
struct Alias {
  std::string_view name, constant, formula;
};
constexpr Alias kAliases[] = {
    {"fused quartz", "fused quartz", "fused silica"},
    {"fused silica", "fused quartz", "fused silica"},
    {"silica", "fused quartz", "fused silica"},
    {"n-bk7", "bk7", "bk7"},
    {"pmma", "acrylic glass", "acrylic glass"},
    {"acrylic", "acrylic glass", "acrylic glass"},
    {"salt", "sodium chloride", "sodium chloride"},
    {"nacl", "sodium chloride", "sodium chloride"},
    {"ice", "water ice", "water ice"},
    {"caf2", "", "calcium fluoride"},
    {"mgf2", "", "magnesium fluoride"},
    {"n-sf11", "", "sf11"},
    {"n-sk16", "", "sk16"},
    {"n-sk2", "", "sk2"},
    {"n-ssk2", "", "ssk2"},
    {"n-lak9", "", "lak9"},
    {"n-bak4", "", "bak4"},
    {"n-baf10", "", "baf10"},
};

}  // namespace

double detail::DispersionFormula::n(double lambda_um) const {
  const double l2 = lambda_um * lambda_um;
  if (kind == kCauchy) return a + terms[0].b / l2 + terms[1].b / (l2 * l2);
  double n2 = 1.0 + a;
  for (const Term& t : terms) n2 += t.b * l2 / (l2 - t.c);
  return std::sqrt(n2);
}

std::complex<double> RefractiveIndex::at(double lambda_nm) const {
  if (!is_dispersive()) return constant_;
  const double nm = std::clamp(lambda_nm, min_nm(), max_nm());
  if (formula_) return formula_->n(nm * 1e-3);
  const std::span<const MetalRow> rows = table_->rows;
  const auto above = std::ranges::upper_bound(rows, nm, {}, &MetalRow::nm);
  if (above == rows.end()) return {rows.back().n, rows.back().k};
  const MetalRow &low = *(above - 1), &high = *above;
  const double t = (nm - low.nm) / (high.nm - low.nm);
  return {low.n + t * (high.n - low.n), low.k + t * (high.k - low.k)};
}

double RefractiveIndex::min_nm() const {
  return formula_ ? formula_->min_nm : table_ ? table_->rows.front().nm : 0.0;
}

double RefractiveIndex::max_nm() const {
  return formula_ ? formula_->max_nm
         : table_ ? table_->rows.back().nm
                  : std::numeric_limits<double>::infinity();
}

std::string_view RefractiveIndex::source() const {
  return formula_ ? formula_->source : table_ ? table_->source : kConstantSource;
}

std::optional<RefractiveIndex> find_refractive_index(std::string_view name, bool dispersion) {
  const std::string key = lower_case(name);
  std::string_view constant_name = key, formula_name = key;
  if (const auto alias = std::ranges::find(kAliases, key, &Alias::name); alias != std::end(kAliases)) {
    constant_name = alias->constant;
    formula_name = alias->formula;
  }
  const auto constant = std::ranges::find(kConstants, constant_name, &Constant::name);
  const auto formula = std::ranges::find(kFormulas, formula_name, &DispersionFormula::name);
  if (formula != std::end(kFormulas) && dispersion) return RefractiveIndex(*formula);
  if (constant != std::end(kConstants)) return RefractiveIndex({constant->n, 0.0});
  if (formula != std::end(kFormulas)) return RefractiveIndex({formula->n(kSodiumD * 1e-3), 0.0});
  for (const MetalRecord& metal : kMetals)
    if (lower_case(metal.name) == key) return RefractiveIndex(metal);
  return std::nullopt;
}

std::vector<std::string> refractive_index_names() {
  std::vector<std::string> names;
  const auto add = [&names](std::string_view name) {
    if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
  };
  for (const Constant& c : kConstants) add(c.name);
  for (const DispersionFormula& f : kFormulas) add(f.name);
  for (const Alias& a : kAliases) add(a.name);
  for (const MetalRecord& m : kMetals) add(m.name);
  return names;
}

}  // namespace aureole
