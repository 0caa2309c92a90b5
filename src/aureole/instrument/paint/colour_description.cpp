// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/colour_description.h"

#include <fmt/format.h>

#include "aureole/core/error.h"
#include "aureole/instrument/paint/paint_files.h"

namespace aureole {
namespace {

/// Monochromatic light at steps of a nanometre for an observer.
struct SpectrumLocus {
  std::vector<double> nm;
  std::vector<pigment::Chromaticity> points;
};

SpectrumLocus locus_of(pigment::Field field) {
  SpectrumLocus locus;
  for (int nm = 360; nm <= 780; ++nm) locus.nm.push_back(nm);
  // Under equal energy, at steps of a nanometre, the weights are the observer's functions.
  const pigment::Observation observer = observe(field == pigment::Field::ten ? "E/10" : "E/2", locus.nm);
  for (const pigment::Xyz& w : observer.weights()) locus.points.push_back(pigment::chromaticity(w));
  // At the ends of the spectrum the chromaticities hardly change and rounding would turn them back.
  const auto first = std::ptrdiff_t(400 - 360), last = std::ptrdiff_t(700 - 360) + 1;
  locus.nm = {locus.nm.begin() + first, locus.nm.begin() + last};
  locus.points = {locus.points.begin() + first, locus.points.begin() + last};
  return locus;
}

const SpectrumLocus& spectrum_locus(pigment::Field field) {
  static const SpectrumLocus kTwo = locus_of(pigment::Field::two), kTen = locus_of(pigment::Field::ten);
  return field == pigment::Field::ten ? kTen : kTwo;
}

/// Whether a text states a colour instead of naming a file.
bool is_stated_colour(const std::string& text) {
  const auto mark = text.rfind('#');
  return mark == 0 || text.starts_with("lab(") ||
         (mark == text.npos && text != kMeasuredPaints && text.find('.') == text.npos &&
          text.find('/') == text.npos);
}

}  // namespace

std::vector<NamedColour> colours_called(const std::string& text, const std::string& viewing,
                                        const std::string& option, std::vector<std::string>& notes) {
  if (is_stated_colour(text)) {
    const ColourTarget target = read_colour_target(text, {}, viewing, option);
    std::vector<double> nm;
    for (int i = 360; i <= 830; ++i) nm.push_back(i);
    NamedColour c{text, {}, {}, {}, observe(viewing, nm).white()};
    c.xyz = pigment::xyz_of_lab(target.target.lab, c.white);
    return {c};
  }
  const auto mark = text.rfind('#');
  const std::string file = text.substr(0, mark);
  pigment::SampleTable table = read_sample_file(file, pigment::Recipes::optional);
  for (const std::string& note : table.notes) notes.push_back(fmt::format("{}: {}", file, note));
  std::vector<pigment::Panel> panels = pigment::panels_of(table);
  if (mark != text.npos) {
    panels = pigment::panels_called(panels, text.substr(mark + 1));
    if (panels.empty()) mean_reflectance(file, text.substr(mark + 1));  // throws, with the names
  }
  if (panels.empty()) throw Error({file, 0, 0}, "there is no reflectance");
  const pigment::Observation lamp = observe(viewing, table.nm);
  if (const std::string note = sampling_note(viewing, table.nm); !note.empty())
    notes.push_back(fmt::format("{}: {}", file, note));
  std::vector<NamedColour> all;
  for (const pigment::Panel& p : panels) {
    if (p.count > 1)
      notes.push_back(fmt::format("{}: {} measurements of \"{}\" are averaged", file, p.count, p.name));
    all.push_back({p.name, table.nm, p.values, lamp.xyz(p.values), lamp.white()});
  }
  return all;
}

NamedColour colour_called(const std::string& text, const std::string& viewing, const std::string& option,
                          std::vector<std::string>& notes) {
  const std::vector<NamedColour> found = colours_called(text, viewing, option, notes);
  if (found.size() > 1)
    throw Error({text, 0, 0}, fmt::format("has {} samples: name one as FILE#SAMPLE", found.size()));
  return found.front();
}

ColourDescription describe_colour(const NamedColour& c, const std::string& viewing) {
  const Viewing of = viewing_of(viewing);
  const SpectrumLocus& locus = spectrum_locus(of.field);
  ColourDescription d;
  for (std::size_t k = 0; k < 3; ++k) d.xyz[k] = 100 * c.xyz[k];
  d.xy = pigment::chromaticity(c.xyz), d.uv = pigment::ucs_chromaticity(c.xyz);
  d.lab = pigment::lab_of_xyz(c.xyz, c.white), d.luv = pigment::luv_of_xyz(c.xyz, c.white);
  d.screen = screen_colour(c.xyz, c.white);
  const pigment::DominantWavelength dominant =
      pigment::dominant_wavelength(d.xy, pigment::chromaticity(c.white), locus.nm, locus.points);
  if (dominant.nm > 0 && dominant.purity > 1e-4) d.dominant = dominant;
  if (of.illuminant == "D65") d.whiteness = pigment::cie_whiteness(c.xyz, c.white, of.field);
  d.yellowness = pigment::yellowness(c.xyz, of.illuminant, of.field);
  return d;
}

ColourDifference colour_difference(const NamedColour& standard, const NamedColour& c,
                                   const std::string& viewing, const std::vector<double>& cmc,
                                   const std::vector<std::string>& others, std::vector<std::string>& notes) {
  const pigment::Lab a = pigment::lab_of_xyz(standard.xyz, standard.white),
                     b = pigment::lab_of_xyz(c.xyz, c.white);
  ColourDifference d;
  d.lab = {b.l - a.l, b.a - a.a, b.b - a.b}, d.lch = pigment::lch_difference(a, b);
  d.cie1976 = pigment::cie1976(a, b), d.ciede2000 = pigment::ciede2000(a, b);
  d.cmc = pigment::cmc(a, b, cmc[0], cmc[1]), d.cie94 = pigment::cie94(a, b),
  d.din99o = pigment::din99o(a, b);
  if (standard.values.empty() || c.values.empty()) return d;
  if (standard.nm != c.nm) {
    notes.push_back(fmt::format("\"{}\" and \"{}\" have other wavelengths; no metamerism is computed",
                                standard.name, c.name));
    return d;
  }
  const pigment::Observation lamp = observe(viewing, c.nm);
  for (const std::string& other : others)
    d.metamerism.emplace_back(
        other, pigment::metamerism_index(lamp, observe(other, c.nm), standard.values, c.values));
  return d;
}

}  // namespace aureole
