// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/paints.h"

#include <cmath>
#include <set>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {

std::optional<std::size_t> Palette::find(std::string_view name) const {
  for (std::size_t i = 0; i < pigments.size(); ++i)
    if (pigments[i].name == name) return i;
  return {};
}

std::vector<std::string> Palette::names() const {
  std::vector<std::string> all;
  for (const Pigment& p : pigments) all.push_back(p.name);
  return all;
}

std::string theory_note(const Palette& palette) {
  if (!palette.streams) return {};
  return "K and S were fitted by streams; two fluxes, which are used here, predict worse with them than with those of "
         "aureole pigment fit --joint --theory two-flux";
}

std::string_view unit_name(const Palette& palette) {
  return !palette.relative ? "1/m" : palette.per_film ? "film" : "relative";
}

void check(const Palette& palette) {
  if (palette.nm.empty()) throw std::domain_error("a palette needs wavelengths");
  if (palette.pigments.empty()) throw std::domain_error("a palette needs a pigment");
  for (std::size_t i = 1; i < palette.nm.size(); ++i)
    require(palette.nm[i] > palette.nm[i - 1], palette.nm[i], "wavelengths", "must increase");
  std::set<std::string> names;
  for (const Pigment& p : palette.pigments) {
    if (!names.insert(p.name).second) throw std::domain_error("two pigments are called \"" + p.name + "\"");
    if (p.k.size() != palette.nm.size() || p.s.size() != palette.nm.size())
      throw std::domain_error("pigment \"" + p.name + "\": K and S need one number for each of " +
                              std::to_string(palette.nm.size()) + " wavelengths");
    for (std::size_t i = 0; i < palette.nm.size(); ++i)
      for (const double value : {p.k[i], p.s[i]})
        require(std::isfinite(value), value, "pigment \"" + p.name + "\": K and S",
                ("must be finite at " + number_text(palette.nm[i]) + " nm").c_str());
    if (palette.by_volume && !(p.density > 0 && std::isfinite(p.density)))
      throw std::domain_error("the palette mixes by volume and needs the density of \"" + p.name + "\"");
  }
}

int clamp_negative(Palette& palette) {
  int count = 0;
  for (Pigment& p : palette.pigments)
    for (auto* values : {&p.k, &p.s})
      for (double& value : *values)
        if (value < 0) value = 0, ++count;
  return count;
}

std::vector<double> fractions_of_parts(std::span<const double> parts) {
  double sum = 0;
  for (const double part : parts) {
    require(part >= 0 && std::isfinite(part), part, "amount", "must be finite and not negative");
    sum += part;
  }
  require(sum > 0, sum, "sum of the amounts", "must be positive");
  std::vector<double> fractions(parts.begin(), parts.end());
  for (double& f : fractions) f /= sum;
  return fractions;
}

std::vector<double> fractions_of_volumes(const Palette& palette, std::span<const double> volumes) {
  if (volumes.size() != palette.pigments.size())
    throw std::domain_error("a recipe needs an amount for each pigment");
  std::vector<double> masses(volumes.begin(), volumes.end());
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const Pigment& p = palette.pigments[i];
    if (masses[i] != 0 && !(p.density > 0))
      throw std::domain_error("a recipe by volume needs the density of \"" + p.name + "\"");
    masses[i] *= p.density;
  }
  return fractions_of_parts(masses);
}

std::vector<double> mixing_fractions(const Palette& palette, std::span<const double> fractions) {
  std::vector<double> shares(fractions.begin(), fractions.end());
  if (!palette.by_volume) return shares;
  double sum = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) sum += shares[i] /= palette.pigments[i].density;
  for (double& share : shares) share /= sum;
  return shares;
}

Paint mix(const Palette& palette, std::span<const double> fractions) {
  if (fractions.size() != palette.pigments.size())
    throw std::domain_error("a recipe needs an amount for each pigment");
  double sum = 0;
  for (const double f : fractions) {
    require_not_negative(f, "amount");
    sum += f;
  }
  require(std::abs(sum - 1) < 1e-6, sum, "sum of the fractions", "must be 1");
  const std::vector<double> shares = mixing_fractions(palette, fractions);
  Paint paint(palette.nm.size());
  for (std::size_t p = 0; p < shares.size(); ++p)
    if (shares[p] > 0)
      for (std::size_t i = 0; i < paint.size(); ++i) {
        paint[i].k += shares[p] * palette.pigments[p].k[i];
        paint[i].s += shares[p] * palette.pigments[p].s[i];
      }
  return paint;
}

double unit_k_over_s(double tint_k_over_s, double base_k_over_s, double share) {
  require_not_negative(tint_k_over_s, "K/S of the tint");
  require_not_negative(base_k_over_s, "K/S of the base");
  require(share > 0 && share <= 1, share, "share", "must be in (0, 1]");
  return (tint_k_over_s - base_k_over_s) / share;
}

double single_constant_k_over_s(double base_k_over_s, std::span<const Colorant> colorants) {
  require_not_negative(base_k_over_s, "K/S of the base");
  double sum = base_k_over_s;
  for (const Colorant& c : colorants) {
    require_fraction(c.share, "share");
    sum += c.share * c.unit_k_over_s;
  }
  return sum;
}

std::vector<double> paint_reflectance(const Paint& paint, double thickness, Substrate substrate,
                                      const Surface& surface) {
  const bool opaque = std::isinf(thickness);
  if (!opaque && substrate.size() != 1 && substrate.size() != paint.size())
    throw std::domain_error("a substrate needs one reflectance, or one for each wavelength");
  std::vector<double> reflectance(paint.size());
  for (std::size_t i = 0; i < paint.size(); ++i) {
    // The reflectance of an opaque layer is computed from K/S rather than by S -> infinity, so that a paint
    // without scattering is black.
    const double inner = opaque ? (paint[i].s > 0 ? opaque_reflectance(paint[i].ratio()) : 0)
                                : reflectance_over(layer(paint[i], thickness),
                                                   substrate.size() == 1 ? substrate[0] : substrate[i]);
    reflectance[i] = outer_reflectance(surface, inner);
  }
  return reflectance;
}

}  // namespace aureole::pigment
