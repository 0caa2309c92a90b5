// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/colour_strength.h"

#include "aureole/pigment/domain.h"
#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {
namespace {

/// K/S by wavelength of an opaque layer, from its measured reflectance.
std::vector<double> ratios(std::span<const double> nm, std::span<const double> reflectance,
                           const Surface& surface, const char* what) {
  if (reflectance.size() != nm.size())
    throw std::domain_error(std::string(what) + " needs one reflectance for each wavelength");
  std::vector<double> result;
  for (std::size_t i = 0; i < nm.size(); ++i) {
    const double inner = inner_reflectance(surface, reflectance[i]);
    if (!(inner > 0 && inner <= 1))
      throw std::domain_error(std::string(what) + " at " + number_text(nm[i]) + " nm: reflectance " +
                              number_text(reflectance[i]) + " has no K/S under this interface");
    result.push_back(k_over_s(inner));
  }
  return result;
}

std::vector<double> white_ratios(std::span<const double> nm, const StrengthSettings& settings) {
  return settings.white.empty() ? std::vector<double>(nm.size())
                                : ratios(nm, settings.white, settings.surface, "the white");
}

}  // namespace

ColourStrength colour_strength(std::span<const double> nm, std::span<const double> standard,
                               std::span<const double> sample, const Observation& lamp,
                               const StrengthSettings& settings) {
  if (lamp.weights().size() != nm.size())
    throw std::domain_error("the observation needs the wavelengths of the reflectances");
  const std::vector<double> white = white_ratios(nm, settings);
  std::vector<double> wanted = ratios(nm, standard, settings.surface, "the standard"),
                      got = ratios(nm, sample, settings.surface, "the sample");
  ColourStrength result;
  double most = 0, sums[2]{}, weighted[2]{};
  for (std::size_t i = 0; i < nm.size(); ++i) {
    wanted[i] -= white[i], got[i] -= white[i];
    const Xyz& w = lamp.weights()[i];
    const double weight = w[0] + w[1] + w[2];
    weighted[0] += weight * wanted[i], weighted[1] += weight * got[i];
    if (nm[i] < 400 || nm[i] > 700) continue;
    sums[0] += wanted[i], sums[1] += got[i];
    if (wanted[i] > most) most = wanted[i], result.nm = nm[i], result.at_maximum = got[i] / wanted[i];
  }
  require(most > 0 && sums[0] > 0 && weighted[0] > 0, sums[0],
          "what the standard adds to the white's K/S from 400 to 700 nm", "must be positive");
  result.summed = sums[1] / sums[0], result.weighted = weighted[1] / weighted[0];
  return result;
}

std::vector<double> at_equal_strength(std::span<const double> nm, std::span<const double> sample,
                                      double strength, const StrengthSettings& settings) {
  require(strength > 0, strength, "strength", "must be positive");
  const std::vector<double> white = white_ratios(nm, settings),
                            got = ratios(nm, sample, settings.surface, "the sample");
  std::vector<double> result;
  for (std::size_t i = 0; i < nm.size(); ++i)
    result.push_back(outer_reflectance(
        settings.surface, opaque_reflectance(std::max(white[i] + (got[i] - white[i]) / strength, 0.0))));
  return result;
}

}  // namespace aureole::pigment
