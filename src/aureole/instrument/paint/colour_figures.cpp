// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/colour_figures.h"

#include <stdexcept>

namespace aureole {

ColourFigures colour_figures(const std::vector<double>& nm, const std::vector<double>& reflectance,
                             const std::string& viewing) {
  const pigment::Observation lamp = observe(viewing, nm);
  const Viewing of = viewing_of(viewing);
  ColourFigures f;
  const pigment::Xyz xyz = lamp.xyz(reflectance);
  f.xyz = {100 * xyz[0], 100 * xyz[1], 100 * xyz[2]};
  f.chromaticity = pigment::chromaticity(xyz), f.lab = lamp.lab(reflectance);
  if (of.illuminant == "D65") f.whiteness = pigment::cie_whiteness(xyz, lamp.white(), of.field);
  f.yellowness = pigment::yellowness(xyz, of.illuminant, of.field);
  return f;
}

ColourComparison compare_colours(const std::vector<double>& nm, const std::vector<double>& standard,
                                 const std::vector<double>& sample, const ColourSettings& settings) {
  const pigment::Observation lamp = observe(settings.viewing, nm);
  const pigment::Lab a = lamp.lab(standard), b = lamp.lab(sample);
  ColourComparison c;
  c.lab = {b.l - a.l, b.a - a.a, b.b - a.b}, c.lch = pigment::lch_difference(a, b);
  c.cie1976 = pigment::cie1976(a, b), c.cmc = pigment::cmc(a, b, settings.cmc_l, settings.cmc_c);
  c.cie94 = pigment::cie94(a, b, settings.cie94), c.ciede2000 = pigment::ciede2000(a, b);
  c.din99o = pigment::din99o(a, b);
  try {
    const std::vector<double>& reference =
        settings.standard_for_strength.empty() ? standard : settings.standard_for_strength;
    const pigment::Lab wanted = lamp.lab(reference);
    c.strength = pigment::colour_strength(nm, reference, sample, lamp, settings.strength);
    if (!(c.strength->at_maximum > 0)) throw std::domain_error("the sample absorbs no more than the white");
    const pigment::Lab tone =
        lamp.lab(pigment::at_equal_strength(nm, sample, c.strength->at_maximum, settings.strength));
    c.tone = pigment::lch_difference(wanted, tone), c.tone_ciede2000 = pigment::ciede2000(wanted, tone);
  } catch (const std::domain_error& e) {
    c.strength.reset(), c.no_strength = e.what();
  }
  for (const std::string& other : settings.others)
    c.metamerism.push_back(pigment::metamerism_index(lamp, observe(other, nm), standard, sample));
  return c;
}

}  // namespace aureole
