// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/samples.h"

#include <cmath>
#include <optional>

#include "aureole/pigment/domain.h"
#include "aureole/pigment/text_table.h"

namespace aureole::pigment {
namespace {

/// The indices of the columns.
struct Columns {
  std::optional<std::size_t> sample, paints, quantity, backing, thickness, unit, series, specimen;
  std::vector<std::size_t> values;
  std::vector<double> nm;

  explicit Columns(const TextRow& header) {
    for (std::size_t i = 0; i < header.cells.size(); ++i) {
      const TextCell& cell = header.cells[i];
      if (auto* known = find(cell.text)) {
        if (*known) throw TextError(header.line, cell.column, "the column \"" + cell.text + "\" comes twice");
        *known = i;
        continue;
      }
      if (cell.text.empty() || cell.text.find_first_not_of("0123456789.") != cell.text.npos)
        throw TextError(
            header.line, cell.column,
            "unknown column \"" + cell.text +
                "\"; columns are sample, specimen, series, paints, quantity, backing, thickness_um, unit and wavelengths in nm");
      const double wavelength = number_of(header, i);
      if (!nm.empty() && !(wavelength > nm.back()))
        throw TextError(header.line, cell.column, "wavelengths must increase");
      values.push_back(i), nm.push_back(wavelength);
    }
    if (!paints) throw TextError(header.line, 0, "there is no column \"paints\"");
    if (nm.empty()) throw TextError(header.line, 0, "there is no column with a wavelength");
  }

private:
  std::optional<std::size_t>* find(const std::string& name) {
    return name == "sample"         ? &sample
           : name == "paints"       ? &paints
           : name == "quantity"     ? &quantity
           : name == "backing"      ? &backing
           : name == "thickness_um" ? &thickness
           : name == "unit"         ? &unit
           : name == "series"       ? &series
           : name == "specimen"     ? &specimen
                                    : nullptr;
  }
};

Sample sample_of(const TextRow& row, const Columns& columns) {
  const auto text = [&](const std::optional<std::size_t>& column) {
    return column ? row.cells[*column].text : std::string();
  };
  const auto fail = [&](const std::optional<std::size_t>& column, const std::string& message) {
    throw TextError(row.line, row.cells[*column].column, message);
  };
  Sample s;
  s.line = row.line;
  s.name = text(columns.sample);
  s.series = text(columns.series), s.specimen = text(columns.specimen);
  try {
    if (!text(columns.paints).empty()) s.paints = parse_recipe(text(columns.paints));
  } catch (const std::domain_error& e) {
    fail(columns.paints, e.what());
  }
  if (s.name.empty()) s.name = text(columns.paints);
  const std::string quantity = text(columns.quantity);
  if (quantity == "T")
    s.quantity = Sample::Quantity::transmittance;
  else if (!quantity.empty() && quantity != "R")
    fail(columns.quantity, "quantity must be R or T, got \"" + quantity + "\"");
  if (!text(columns.backing).empty()) s.backing = text(columns.backing);
  if (!text(columns.thickness).empty()) {
    s.thickness = 1e-6 * number_of(row, *columns.thickness);
    if (!(s.thickness > 0))
      fail(columns.thickness, "thickness must be positive, got " + text(columns.thickness));
  }
  const std::string unit = text(columns.unit);
  if (!unit.empty() && unit != "percent" && unit != "fraction")
    fail(columns.unit, "unit must be fraction or percent, got \"" + unit + "\"");
  for (const std::size_t column : columns.values) {
    const double value = number_of(row, column) * (unit == "percent" ? 0.01 : 1);
    s.values.push_back(value);
    s.columns.push_back(row.cells[column].column);
  }
  return s;
}

}  // namespace

SampleTable read_samples(std::istream& text) {
  const std::vector<TextRow> rows = read_text_table(text);
  if (rows.empty()) throw TextError(0, 0, "there is no table");
  const Columns columns(rows.front());
  SampleTable table{columns.nm, {}};
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].cells.size() != rows.front().cells.size())
      throw TextError(rows[i].line, 0,
                      "expected " + std::to_string(rows.front().cells.size()) + " cells, got " +
                          std::to_string(rows[i].cells.size()));
    table.samples.push_back(sample_of(rows[i], columns));
  }
  return table;
}

void check(const SampleTable& table) {
  if (table.nm.empty()) throw std::domain_error("there are no wavelengths");
  for (std::size_t i = 1; i < table.nm.size(); ++i)
    require(table.nm[i] > table.nm[i - 1], table.nm[i], "wavelengths", "must increase");
  if (table.samples.empty()) throw std::domain_error("there are no samples");
  for (std::size_t s = 0; s < table.samples.size(); ++s) {
    const Sample& sample = table.samples[s];
    if (sample.values.size() != table.nm.size())
      throw SampleError(s, -1,
                        "sample \"" + sample.name + "\" has " + std::to_string(sample.values.size()) +
                            " values for " + std::to_string(table.nm.size()) + " wavelengths");
    for (std::size_t i = 0; i < table.nm.size(); ++i)
      if (!(sample.values[i] >= 0 && std::isfinite(sample.values[i])))
        throw SampleError(s, int(i),
                          "sample \"" + sample.name + "\" at " + number_text(table.nm[i]) +
                              " nm: must be finite and not negative, got " + number_text(sample.values[i]));
  }
}

}  // namespace aureole::pigment
