// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/cgats_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <istream>
#include <map>
#include <optional>
#include <string>

#include "aureole/core/letter_case.h"
#include "aureole/pigment/domain.h"
#include "aureole/pigment/recipe.h"
#include "aureole/pigment/text_table.h"

namespace aureole::pigment {
namespace {

constexpr int kMaxLines = 100000;

/// Fields that a table of paints may have.
constexpr const char* kRightFields =
    "SAMPLE_NAME PAINTS BACKING THICKNESS_UM SPECTRAL_NM400 SPECTRAL_NM410 SPECTRAL_NM420";
/// Lines longer than this are not shown whole.
constexpr std::size_t kLongestLine = 400;

/// The end of an error: the line as it would be right.
std::string right_line(const std::string& line) { return "; a line that would be right:\n    " + line; }

/// A row of data as text: cells with blanks, and empty ones, in quotes.
std::string text_of(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    const bool quoted = cell.empty() || cell.find_first_of(" \t#") != cell.npos;
    line += (line.empty() ? "" : " ") + (quoted ? '"' + cell + '"' : cell);
  }
  return line;
}

/// Splits a line into words, separated by blanks or tabs. Quoted text is one word, even if it is empty.
TextRow words_of(const std::string& line, int number) {
  TextRow row{{}, number};
  for (std::size_t at = 0;;) {
    at = line.find_first_not_of(" \t\r", at);
    if (at == line.npos || line[at] == '#') return row;
    TextCell cell;
    cell.column = int(at) + 1;
    std::size_t end;
    if (line[at] == '"') {
      end = line.find('"', at + 1);
      if (end == line.npos)
        throw TextError(number, cell.column,
                        "the quote does not end" +
                            (line.size() > kLongestLine
                                 ? std::string()
                                 : right_line(line.substr(0, line.find_last_not_of("\r") + 1) + '"')));
      cell.text = line.substr(at + 1, end - at - 1);
      ++end;
    } else {
      end = std::min(line.find_first_of(" \t\r", at), line.size());
      cell.text = line.substr(at, end - at);
    }
    row.cells.push_back(std::move(cell));
    at = end;
  }
}

/// The wavelength in a field's name, and whether the name implies per cent.
struct SpectralField {
  double nm;
  bool percent;
};
std::optional<SpectralField> spectral(const std::string& name) {
  std::string_view rest = name;
  bool percent = false, prefixed = false;
  for (const std::string_view prefix :
       {"SPECTRAL_PCT", "SPECTRAL_DEC", "SPECTRAL_NM", "SPECTRAL", "SPEC", "NM", "R"})
    if (rest.starts_with(prefix)) {
      rest.remove_prefix(prefix.size());
      percent = prefix == "SPECTRAL_PCT", prefixed = true;
      break;
    }
  if (prefixed && rest.starts_with('_')) rest.remove_prefix(1);
  if (rest.ends_with("NM")) rest.remove_suffix(2);
  double nm = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), nm);
  if (rest.empty() || error != std::errc() || end != rest.data() + rest.size() || !(nm >= 100 && nm < 1e5))
    return {};
  return SpectralField{nm, percent};
}

/// One table of the file, unprocessed.
struct Table {
  std::map<std::string, TextRow> keywords;  ///< the line of each keyword; its value is the second cell
  int line = 0;                             ///< line number of the table's list of fields
  std::vector<TextCell> fields;
  std::vector<int> field_lines;
  std::vector<TextRow> rows;

  std::optional<std::size_t> find(const std::string& field) const {
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (upper_case(fields[i].text) == field) return i;
    return {};
  }
  std::string keyword(const std::string& name) const {
    const auto at = keywords.find(name);
    return at == keywords.end() ? std::string() : at->second.cells[1].text;
  }
  bool has_spectra() const {
    return std::any_of(fields.begin(), fields.end(), [](const TextCell& f) {
      return spectral(upper_case(f.text)).has_value() || upper_case(f.text) == "SPECTRAL_NM";
    });
  }
};

class Reader {
public:
  explicit Reader(std::istream& text) : text_(text) {}

  /// Returns the next table, or nothing at the end of the text. Keywords stay valid until they are given
  /// again.
  std::optional<Table> next() {
    table_.fields.clear(), table_.field_lines.clear(), table_.rows.clear();
    while (const auto row = words()) {
      const std::string key = upper_case(row->cells.front().text);
      if (key == "BEGIN_DATA_FORMAT") {
        read_fields(*row);
      } else if (key == "BEGIN_DATA") {
        read_rows(*row);
        return table_;
      } else if (key == "END_DATA" || key == "END_DATA_FORMAT") {
        throw TextError(row->line, row->cells.front().column,
                        key + " without BEGIN" + key.substr(3) + right_line("BEGIN" + key.substr(3)));
      } else if (row->cells.size() > 1) {
        table_.keywords[key] = *row;
      }
    }
    if (!table_.fields.empty())
      throw TextError(number_, 0, "BEGIN_DATA is missing" + right_line("BEGIN_DATA"));
    return {};
  }

private:
  std::optional<TextRow> words() {
    std::string line;
    while (std::getline(text_, line)) {
      if (++number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
      if (number_ > kMaxLines)
        throw TextError(number_, 0, "the table has more than " + std::to_string(kMaxLines) + " lines");
      TextRow row = words_of(line, number_);
      if (!row.cells.empty()) return row;
    }
    return {};
  }

  void read_fields(const TextRow& begin) {
    table_.fields.clear(), table_.field_lines.clear();
    table_.line = begin.line;
    while (const auto row = words()) {
      if (upper_case(row->cells.front().text) == "END_DATA_FORMAT") {
        if (table_.fields.empty())
          throw TextError(begin.line, 0, "BEGIN_DATA_FORMAT has no fields" + right_line(kRightFields));
        check_count("NUMBER_OF_FIELDS", table_.fields.size(), "fields", begin.line);
        return;
      }
      for (const TextCell& cell : row->cells)
        table_.fields.push_back(cell), table_.field_lines.push_back(row->line);
    }
    throw TextError(
        begin.line, 0,
        "BEGIN_DATA_FORMAT does not end: END_DATA_FORMAT is missing" + right_line("END_DATA_FORMAT"));
  }

  void read_rows(const TextRow& begin) {
    if (table_.fields.empty())
      throw TextError(
          begin.line, 0,
          "BEGIN_DATA comes before the fields" +
              right_line("BEGIN_DATA_FORMAT\n    " + std::string(kRightFields) + "\n    END_DATA_FORMAT"));
    while (const auto row = words()) {
      if (row->cells.size() == 1 && upper_case(row->cells.front().text) == "END_DATA") {
        check_count("NUMBER_OF_SETS", table_.rows.size(), "rows", begin.line);
        // These two keywords apply to one table only; other keywords apply to the next table as well.
        table_.keywords.erase("NUMBER_OF_SETS"), table_.keywords.erase("NUMBER_OF_FIELDS");
        return;
      }
      if (row->cells.size() != table_.fields.size())
        throw TextError(row->line, 0,
                        "expected " + std::to_string(table_.fields.size()) +
                            " values, one for each field (an empty one is \"\"), got " +
                            std::to_string(row->cells.size()) + right_width(*row));
      table_.rows.push_back(*row);
    }
    throw TextError(begin.line, 0, "BEGIN_DATA does not end: END_DATA is missing" + right_line("END_DATA"));
  }

  /// The end of an error on a row with too few or too many values: the row with one value for each field.
  std::string right_width(const TextRow& row) const;

  void check_count(const std::string& keyword, std::size_t count, const char* what, int line) const {
    const std::string stated = table_.keyword(keyword);
    std::size_t number = count;
    const auto [end, error] = std::from_chars(stated.data(), stated.data() + stated.size(), number);
    if (!stated.empty() && (error != std::errc() || end != stated.data() + stated.size() || number != count))
      throw TextError(line, 0,
                      keyword + " is " + stated + ", and there are " + std::to_string(count) + " " + what +
                          right_line(keyword + " " + std::to_string(count)));
  }

  std::istream& text_;
  int number_ = 0;
  Table table_;
};

/// A value that a field may have, in a row of this table.
std::string right_value(const Table& t, const TextRow& row, std::size_t field) {
  const std::string name = upper_case(t.fields[field].text);
  if (name == "PAINTS") return "red: 1 + white: 3";
  if (name == "QUANTITY") return "R";
  if (name == "BACKING") return "opaque";
  if (name == "THICKNESS_UM") {
    const auto stated = field < row.cells.size() ? finite_number(row.cells[field].text) : std::nullopt;
    return number_text(stated && *stated < 0 ? -*stated : 24);
  }
  if (name == "SPECTRAL_NM")
    return field < t.rows.front().cells.size() ? t.rows.front().cells[field].text : "400";
  if (name == "SAMPLE_NAME" || name == "SAMPLE_ID") return "red";
  if (!spectral(name) && name != "SPECTRAL_DEC" && name != "SPECTRAL_PCT") return "1";
  // The nearest value of the row that is a number.
  std::string nearest = "0.412";
  std::size_t distance = row.cells.size() + t.fields.size();
  for (std::size_t i = 0; i < std::min(row.cells.size(), t.fields.size()); ++i) {
    const std::string of = upper_case(t.fields[i].text);
    const std::size_t away = i > field ? i - field : field - i;
    if (away == 0 || away >= distance || !finite_number(row.cells[i].text) ||
        !(spectral(of) || of == "SPECTRAL_DEC" || of == "SPECTRAL_PCT"))
      continue;
    nearest = row.cells[i].text, distance = away;
  }
  return nearest;
}

std::string Reader::right_width(const TextRow& row) const {
  std::vector<std::string> cells;
  Table with_row = table_;
  if (with_row.rows.empty()) with_row.rows.push_back(row);
  for (std::size_t i = 0; i < table_.fields.size(); ++i)
    cells.push_back(i < row.cells.size() ? row.cells[i].text : right_value(with_row, row, i));
  const std::string line = text_of(cells);
  return line.size() > kLongestLine ? std::string() : right_line(line);
}

/// The error with the field of its value, and the row as it would be right.
TextError with_right_row(const TextError& error, const Table& t, const TextRow& row) {
  for (std::size_t i = 0; i < row.cells.size() && i < t.fields.size(); ++i) {
    if (row.cells[i].column != error.column() || row.line != error.line()) continue;
    std::vector<std::string> cells;
    for (const TextCell& cell : row.cells) cells.push_back(cell.text);
    cells[i] = right_value(t, row, i);
    const std::string line = text_of(cells);
    return {error.line(), error.column(),
            std::string(error.what()) + " in the field " + t.fields[i].text +
                (line.size() > kLongestLine ? "; right would be " + cells[i] : right_line(line))};
  }
  return error;
}

SampleTable samples_of(const Table& t) {
  struct Column {
    std::size_t field;
    double nm;
  };
  std::vector<Column> columns;
  bool percent = upper_case(t.keyword("UNIT")) == "PERCENT";
  if (const std::string norm = t.keyword("SPECTRAL_NORM"); !norm.empty()) {
    const TextRow& row = t.keywords.at("SPECTRAL_NORM");
    const double value = number_of(row, 1);
    if (value != 1 && value != 100)
      throw TextError(row.line, row.cells[1].column,
                      "SPECTRAL_NORM must be 1 or 100, got " + norm + right_line("SPECTRAL_NORM \"100\""));
    percent = value == 100;
  }
  // Pairs of fields SPECTRAL_NM and SPECTRAL_DEC or SPECTRAL_PCT, whose wavelengths are part of the data
  // rows.
  for (std::size_t i = 0; i + 1 < t.fields.size(); ++i) {
    const std::string next = upper_case(t.fields[i + 1].text);
    if (upper_case(t.fields[i].text) != "SPECTRAL_NM" || (next != "SPECTRAL_DEC" && next != "SPECTRAL_PCT"))
      continue;
    if (t.rows.empty())
      throw TextError(
          t.line, 0,
          "there are no rows, and so no wavelengths; a row that would be right has a value for each field");
    if (!finite_number(t.rows.front().cells[i].text))
      throw TextError(t.rows.front().line, t.rows.front().cells[i].column,
                      "expected a wavelength in the field SPECTRAL_NM, got \"" +
                          t.rows.front().cells[i].text + "\"; right would be 400");
    const double nm = number_of(t.rows.front(), i);
    for (const TextRow& row : t.rows)
      if (finite_number(row.cells[i].text) != nm)
        throw with_right_row(TextError(row.line, row.cells[i].column,
                                       "expected the wavelength of the first row, " + number_text(nm) +
                                           ", got " + row.cells[i].text),
                             t, row);
    columns.push_back({i + 1, nm}), percent = percent || next == "SPECTRAL_PCT";
  }
  for (std::size_t i = 0; i < t.fields.size(); ++i)
    if (const auto s = spectral(upper_case(t.fields[i].text))) {
      for (const Column& c : columns)
        if (c.nm == s->nm)
          throw TextError(
              t.field_lines[i], t.fields[i].column,

              "the wavelength of \"" + t.fields[i].text + "\" comes twice" + right_line(kRightFields));
      columns.push_back({i, s->nm}), percent = percent || s->percent;
    }
  std::sort(columns.begin(), columns.end(), [](const Column& a, const Column& b) { return a.nm < b.nm; });
  for (std::size_t i = 1; i < columns.size(); ++i)
    if (columns[i].nm == columns[i - 1].nm)
      throw TextError(
          t.line, 0,
          "the wavelength " + number_text(columns[i].nm) + " comes twice" + right_line(kRightFields));
  if (columns.empty())
    throw TextError(
        t.line, 0,
        "SPECTRAL_NM needs SPECTRAL_DEC or SPECTRAL_PCT behind it, or a wavelength: SPECTRAL_NM400" +
            right_line(kRightFields));

  const auto name = t.find("SAMPLE_NAME"), id = t.find("SAMPLE_ID"), paints = t.find("PAINTS");
  const auto named = name ? name : id;
  if (!paints && !named)
    throw TextError(t.line, 0,
                    "the samples have no names: there is no field PAINTS, SAMPLE_NAME or SAMPLE_ID" +
                        right_line(kRightFields));
  const auto quantity = t.find("QUANTITY"), backing = t.find("BACKING"), thickness = t.find("THICKNESS_UM"),
             series = t.find("SERIES"), specimen = t.find("SPECIMEN");
  SampleTable table;
  table.instrument = instrument_called(t.keyword("MEASUREMENT_GEOMETRY"));
  for (const char* keyword : {"MEASUREMENT_APERTURE", "APERTURE", "APERTURE_SIZE"})
    if (table.instrument.aperture.empty()) table.instrument.aperture = t.keyword(keyword);
  for (const Column& c : columns) table.nm.push_back(c.nm);
  const auto read_row = [&](const TextRow& row) {
    Sample& s = table.samples.emplace_back();
    s.line = row.line;
    const auto at = [&](const std::optional<std::size_t>& field) {
      return field ? row.cells[*field].text : std::string();
    };
    const auto fail = [&](const std::optional<std::size_t>& field, const std::string& message) {
      throw TextError(row.line, row.cells[*field].column, message);
    };
    const std::string recipe = paints ? at(paints) : at(named);
    try {
      s.paints = paints ? (recipe.empty() ? std::vector<Component>() : parse_recipe(recipe))
                        : recipe_of_name(recipe, table.notes);
    } catch (const std::domain_error& e) {
      fail(paints ? paints : named, e.what());
    }
    s.name = named ? at(named) : recipe, s.is_named_recipe = !paints;
    const std::string kind = upper_case(at(quantity));
    if (kind == "T")
      s.quantity = Sample::Quantity::transmittance;
    else if (!kind.empty() && kind != "R")
      fail(quantity, "QUANTITY must be R or T, got \"" + at(quantity) + "\"");
    if (!at(backing).empty()) s.backing = at(backing), s.states_backing = true;
    s.series = at(series), s.specimen = at(specimen);
    if (!at(thickness).empty()) {
      s.thickness = 1e-6 * number_of(row, *thickness);
      if (!(s.thickness > 0)) fail(thickness, "THICKNESS_UM must be positive, got " + at(thickness));
    }
    for (const Column& c : columns) {
      s.values.push_back(number_of(row, c.field) * (percent ? 0.01 : 1));
      s.columns.push_back(row.cells[c.field].column);
    }
  };
  for (const TextRow& row : t.rows) try {
      read_row(row);
    } catch (const TextError& e) {
      throw with_right_row(e, t, row);
    }
  return table;
}

}  // namespace

SampleTable read_cgats(std::istream& text) {
  Reader reader(text);
  int line = 0;  // of the first list of fields
  while (const auto table = reader.next()) {
    if (table->has_spectra()) return samples_of(*table);
    if (line == 0) line = table->line;
  }
  throw TextError(
      line, 0,
      std::string(line > 0 ? "no table has spectra: fields such as SPECTRAL_NM400"
                           : "there is no table of data") +
          right_line(
              "BEGIN_DATA_FORMAT\n    " + std::string(kRightFields) +
              "\n    END_DATA_FORMAT\n    BEGIN_DATA\n    a red card 24 0.412 0.42 0.439\n    END_DATA"));
}

}  // namespace aureole::pigment
