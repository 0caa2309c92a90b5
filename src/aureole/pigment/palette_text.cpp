// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/palette_text.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "aureole/pigment/samples.h"
#include "aureole/pigment/text_table.h"

namespace aureole::pigment {
namespace {

std::string exact(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string cell(const std::string& text) { return text.find(',') == text.npos ? text : "\"" + text + "\""; }

/// A column of numbers of a pigment, and the suffix of its heading. Longer suffixes come first.
struct Quantity {
  std::string_view ending;
  std::vector<double> Pigment::*of;
};
constexpr Quantity kQuantities[] = {{" K error", &Pigment::k_error},
                                    {" S error", &Pigment::s_error},
                                    {" K", &Pigment::k},
                                    {" S", &Pigment::s}};

Pigment& named(Palette& palette, const std::string& name) {
  if (const auto at = palette.find(name)) return palette.pigments[*at];
  return palette.pigments.emplace_back(Pigment{.name = name, .k = {}, .s = {}});
}

/// Largest magnitude of a mean cosine in the theory by streams.
constexpr double kLargestCosine = 0.95;

/// Returns the value of a line with a key, which must lie in [least, most].
double number_within(const TextRow& row, double least, double most) {
  const double value = number_of(row, 1);
  if (!(value >= least && value <= most))
    throw TextError(row.line, row.cells[1].column,
                    row.cells[0].text + " must be in [" + exact(least) + ", " + exact(most) + "], got " +
                        row.cells[1].text);
  return value;
}

}  // namespace

std::string palette_text(const Palette& palette) {
  std::ostringstream out;
  out << "unit," << unit_name(palette) << "\nsurface seen," << exact(palette.surface.seen)
      << "\nsurface through," << exact(palette.surface.through) << "\nsurface k2,"
      << exact(palette.surface.k2) << "\n";
  if (const auto& s = palette.streams)
    out << "theory,streams\nstreams index," << exact(s->index) << "\nstreams g," << exact(s->g)
        << "\nstreams geometry," << name_of(s->geometry) << "\nstreams specular," << name_of(s->specular)
        << "\n";
  if (palette.by_volume) out << "mixing,volume\n";
  for (const Pigment& p : palette.pigments)
    if (p.density > 0) out << cell("density " + p.name) << "," << exact(p.density) << "\n";
  for (const Pigment& p : palette.pigments)
    if (p.g) out << cell("g " + p.name) << "," << exact(*p.g) << "\n";
  std::vector<const std::vector<double>*> columns;
  out << "nm";
  for (const Pigment& p : palette.pigments)
    for (const std::size_t q : {2, 3, 0, 1}) {
      const std::vector<double>& values = p.*kQuantities[q].of;
      if (values.empty()) continue;
      out << "," << cell(p.name + std::string(kQuantities[q].ending));
      columns.push_back(&values);
    }
  for (std::size_t i = 0; i < palette.nm.size(); ++i) {
    out << "\n" << exact(palette.nm[i]);
    for (const auto* column : columns) out << "," << exact((*column)[i]);
  }
  out << "\n";
  return out.str();
}

Palette read_palette(std::istream& text) {
  const std::vector<TextRow> rows = read_text_table(text);
  Palette palette;
  std::vector<std::pair<std::string, double>> densities;
  std::vector<std::pair<std::string, double>> cosines;
  PaletteStreams streams;
  bool is_by_streams = false;
  std::size_t at = 0;
  for (; at < rows.size() && rows[at].cells[0].text != "nm"; ++at) {
    const TextRow& row = rows[at];
    const std::string& key = row.cells[0].text;
    if (row.cells.size() < 2)
      throw TextError(row.line, 0, "expected a key and a value, or the headings from \"nm\" on");
    if (key == "unit") {
      const std::string& unit = row.cells[1].text;
      if (unit != "relative" && unit != "film" && unit != "1/m")
        throw TextError(row.line, row.cells[1].column,
                        "unit must be relative, film or 1/m, got \"" + unit + "\"");
      palette.relative = unit != "1/m", palette.per_film = unit == "film";
    } else if (key == "surface seen") {
      palette.surface.seen = number_of(row, 1);
    } else if (key == "surface through") {
      palette.surface.through = number_of(row, 1);
    } else if (key == "surface k2") {
      palette.surface.k2 = number_of(row, 1);
    } else if (key == "mixing") {
      const std::string& mixing = row.cells[1].text;
      if (mixing != "mass" && mixing != "volume")
        throw TextError(row.line, row.cells[1].column,
                        "mixing must be mass or volume, got \"" + mixing + "\"");
      palette.by_volume = mixing == "volume";
    } else if (key == "theory") {
      const std::string& theory = row.cells[1].text;
      if (theory != "two fluxes" && theory != "streams")
        throw TextError(row.line, row.cells[1].column,
                        "theory must be \"two fluxes\" or streams, got \"" + theory + "\"");
      is_by_streams = theory == "streams";
    } else if (key == "streams index") {
      streams.index = number_within(row, 1, 4);
    } else if (key == "streams g") {
      streams.g = number_within(row, -kLargestCosine, kLargestCosine);
    } else if (key == "streams geometry") {
      const std::string& name = row.cells[1].text;
      streams.geometry = geometry_called(name);
      if (name_of(streams.geometry) != name)
        throw TextError(row.line, row.cells[1].column,
                        "streams geometry must be diffuse, d8 or 45_0, got \"" + name + "\"");
    } else if (key == "streams specular") {
      const std::string& name = row.cells[1].text;
      if (name != "included" && name != "excluded")
        throw TextError(row.line, row.cells[1].column,
                        "streams specular must be included or excluded, got \"" + name + "\"");
      streams.specular = name == "included" ? Specular::included : Specular::excluded;
    } else if (key.starts_with("g ")) {
      cosines.emplace_back(key.substr(2), number_within(row, -kLargestCosine, kLargestCosine));
    } else if (key.starts_with("density ")) {
      densities.emplace_back(key.substr(8), number_of(row, 1));
    } else {
      throw TextError(row.line, row.cells[0].column,
                      "unknown key \"" + key +
                          "\"; a palette begins with unit, surface seen, surface through, surface k2, "
                          "theory, streams index, streams g, streams geometry, streams "
                          "specular, mixing, density or g, and then a line of headings from \"nm\" on");
    }
  }
  if (is_by_streams) palette.streams = streams;
  if (at == rows.size()) throw TextError(0, 0, "there is no line of headings that begins with \"nm\"");
  const TextRow& header = rows[at];
  std::vector<std::pair<std::string, std::vector<double> Pigment::*>> columns;
  for (std::size_t c = 1; c < header.cells.size(); ++c) {
    const std::string& heading = header.cells[c].text;
    bool found = false;
    for (const Quantity& q : kQuantities) {
      if (found || !heading.ends_with(q.ending)) continue;
      found = true;
      columns.emplace_back(heading.substr(0, heading.size() - q.ending.size()), q.of);
      if (std::count(columns.begin(), columns.end(), columns.back()) > 1)
        throw TextError(
            header.line, header.cells[c].column,
            "the column \"" + heading + "\" comes twice: each paint of a palette has one of each");
      named(palette, columns.back().first);
    }
    if (!found)
      throw TextError(header.line, header.cells[c].column,
                      "a heading ends with K, S, K error or S error, got \"" + heading + "\"");
  }
  while (++at < rows.size()) {
    const TextRow& row = rows[at];
    if (row.cells.size() != header.cells.size())
      throw TextError(row.line, 0,
                      "expected " + std::to_string(header.cells.size()) + " cells, got " +
                          std::to_string(row.cells.size()));
    palette.nm.push_back(number_of(row, 0));
    for (std::size_t c = 0; c < columns.size(); ++c)
      (named(palette, columns[c].first).*columns[c].second).push_back(number_of(row, c + 1));
  }
  for (const auto& [name, density] : densities) {
    if (!palette.find(name)) throw TextError(0, 0, "a density is that of an unknown paint \"" + name + "\"");
    named(palette, name).density = density;
  }
  for (const auto& [name, g] : cosines) {
    if (!palette.find(name)) throw TextError(0, 0, "a g is that of an unknown paint \"" + name + "\"");
    named(palette, name).g = g;
  }
  try {
    check(palette);
  } catch (const std::domain_error& e) {
    throw TextError(0, 0, e.what());
  }
  return palette;
}

}  // namespace aureole::pigment
