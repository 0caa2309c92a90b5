// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/samples.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include "aureole/core/letter_case.h"
#include "aureole/pigment/domain.h"
#include "aureole/pigment/text_table.h"

namespace aureole::pigment {
namespace {

constexpr const char* kColumnNames =
    "sample, specimen, series, paints, quantity, backing, thickness_um, unit and wavelengths in nm";
constexpr const char* kRightHeader = "sample,paints,backing,thickness_um,unit,400,410,420";

/// Bounds of the wavelengths of pigments in nm; beyond them a number is no wavelength or has another unit.
constexpr double kShortestWavelength = 200, kLongestWavelength = 2600;

/// A heading in lower case, without blanks, underscores, hyphens and text in brackets, which is kept in
/// `inside`.
struct Heading {
  std::string word, inside;

  explicit Heading(const std::string& text) {
    bool in = false;
    for (const char c : lower_case(text)) {
      if (c == '(' || c == '[') {
        in = true;
      } else if (c == ')' || c == ']') {
        in = false;
      } else if (c != ' ' && c != '_' && c != '-') {
        (in ? inside : word) += c;
      }
    }
  }
};

struct Wavelength {
  double nm = 0;
  bool percent = false, transmitted = false;
};

/// The wavelength that a heading names, or nothing.
std::optional<Wavelength> wavelength_of(const std::string& text) {
  const Heading heading(text);
  std::string word = heading.word;
  if (word.empty()) return {};
  Wavelength result;
  const auto drop = [&](const char c) {
    const auto end = std::remove(word.begin(), word.end(), c);
    const bool any = end != word.end();
    word.erase(end, word.end());
    return any;
  };
  result.percent = drop('%') || heading.inside == "%";
  for (const std::string prefix : {"spectralpct", "spectraldec", "spectralnm", "spectral", "spec",
                                   "reflectance", "refl", "wl", "nm", "r", "transmittance", "trans", "t"})
    if (word.starts_with(prefix)) {
      word.erase(0, prefix.size());
      result.percent = result.percent || prefix == "spectralpct";
      result.transmitted = prefix[0] == 't';
      break;
    }
  if (word.ends_with("nm")) word.erase(word.size() - 2);
  std::replace(word.begin(), word.end(), ',', '.');
  const auto nm = finite_number(word);
  if (!nm || !(*nm >= 100 && *nm < 1e5)) return {};
  result.nm = *nm;
  return result;
}

/// Headings without the number of a repeat: "400_1", "R400-2", "400nm #3" are 400, R400 and 400nm. The
/// headings "400.1" and "400.2", as programs number columns of one name, count as repeats if such wavelengths
/// are at least 5 nm apart and all have the same numbers from 1 on; they cannot be tenths of nanometres then.
std::vector<std::string> without_repeat_numbers(const TextRow& header) {
  static const std::regex numbered("(.*[0-9]{3,4}( ?nm)?) ?[_#-] ?#?[0-9]{1,2}", std::regex::icase),
      dotted("([^0-9]*)([0-9]{3,4})[.]([0-9])");
  constexpr std::size_t kLongestHeading = 60;  // matching needs stack memory for each letter
  std::vector<std::string> texts;
  std::map<std::string, std::vector<int>> tenths;
  std::set<std::string> all;
  for (const TextCell& cell : header.cells) {
    std::smatch found;
    const bool is_short = cell.text.size() <= kLongestHeading;
    texts.push_back(is_short && std::regex_match(cell.text, found, numbered) ? found[1].str() : cell.text);
    all.insert(cell.text);
    if (is_short && std::regex_match(cell.text, found, dotted))
      tenths[found[1].str() + found[2].str()].push_back(found[3].str()[0] - '0');
  }
  if (tenths.size() < 2) return texts;
  std::vector<double> wavelengths;
  for (auto& [base, numbers] : tenths) {
    std::sort(numbers.begin(), numbers.end());
    const auto wavelength = wavelength_of(base);
    if (!wavelength || (!all.contains(base) && numbers.size() < 2) || numbers != tenths.begin()->second)
      return texts;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if (numbers[i] != int(i) + 1) return texts;
    wavelengths.push_back(wavelength->nm);
  }
  std::sort(wavelengths.begin(), wavelengths.end());
  for (std::size_t i = 0; i + 1 < wavelengths.size(); ++i)
    if (wavelengths[i + 1] - wavelengths[i] < 5) return texts;
  for (std::string& text : texts)
    if (std::smatch found; text.size() <= kLongestHeading && std::regex_match(text, found, dotted))
      text = found[1].str() + found[2].str();
  return texts;
}

/// Whether a column of instruments' exports is known to be of no use for samples of paint.
bool is_unused(const Heading& heading) {
  for (const char* name :
       {"l*",         "a*",       "b*",       "c*",      "h",        "h*",       "h°",      "x",
        "y",          "z",        "l",        "a",       "b",        "c",        "de",      "date",
        "time",       "datetime", "operator", "comment", "comments", "remark",   "remarks", "instrument",
        "illuminant", "observer", "no",       "nr",      "number",   "aperture", "geometry"})
    if (heading.word == name) return true;
  return false;
}

/// The number of letters that differ (Levenshtein's distance), for short words.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// The column whose name a heading nearly has, or nothing.
std::optional<std::string> misspelt(const Heading& heading) {
  for (const char* name :
       {"sample", "paints", "quantity", "backing", "thickness", "unit", "series", "specimen"})
    if (heading.word.size() > 3 && distance(heading.word, name) <= 2) return name;
  if (heading.word.starts_with("thickness")) return "thicknessum";
  return {};
}

using OptionalColumn = std::optional<std::size_t>;

/// Indices of the table's columns.
struct Columns {
  OptionalColumn sample, paints, quantity, backing, thickness, unit, series, specimen;
  double thickness_scale = 1e-6;  ///< factor from the unit of the thickness to metres
  bool percent = false;
  /// for each repeat, the columns in order of increasing wavelength
  std::vector<std::vector<std::size_t>> values;
  std::vector<bool> transmitted;  ///< for each repeat, whether its values are transmittances
  std::vector<double> nm;

  OptionalColumn* find(const std::string& name, double* scale = nullptr) {
    const Heading heading(name);
    const std::string& word = heading.word;
    const auto is = [&](std::initializer_list<const char*> names) {
      return std::any_of(names.begin(), names.end(), [&](const char* n) { return word == n; });
    };
    if (is({"sample", "samplename", "sampleid", "name", "id"})) return &sample;
    if (is({"paints", "paint", "recipe", "mixture", "composition"})) return &paints;
    if (is({"quantity", "mode"})) return &quantity;
    if (is({"backing", "background", "substrate"})) return &backing;
    if (is({"unit", "units"})) return &unit;
    if (is({"series", "batch"})) return &series;
    if (is({"specimen", "drawdown"})) return &specimen;
    if (word.starts_with("thickness")) {
      const std::string of = word.size() > 9 ? word.substr(9) : heading.inside;
      const double found = of == "um" || of == "µm" || of == "μm" || of == "micron" || of == "microns" ? 1e-6
                           : of == "mm"                                                                ? 1e-3
                           : of == "m"                                                                 ? 1
                                                                                                       : 0;
      if (found == 0) return nullptr;
      if (scale) *scale = found;
      return &thickness;
    }
    return nullptr;
  }

  Columns() = default;
  Columns(const TextRow& header, Recipes recipes, std::vector<std::string>& notes) {
    std::vector<Found> reflected, through;
    std::vector<std::string> unused;
    const auto line = [&](const TextCell& cell) { return cell.line ? cell.line : header.line; };
    const std::vector<std::string> headings = without_repeat_numbers(header);
    for (std::size_t i = 0; i < header.cells.size(); ++i) {
      const TextCell& cell = header.cells[i];
      if (auto* known = find(cell.text, &thickness_scale)) {
        if (*known) throw TextError(line(cell), cell.column, "the column \"" + cell.text + "\" comes twice");
        *known = i;
        continue;
      }
      if (const auto wavelength = wavelength_of(headings[i])) {
        (wavelength->transmitted ? through : reflected).push_back({i, wavelength->nm});
        percent = percent || wavelength->percent;
        continue;
      }
      // an empty last cell comes from a separator at the end of the line
      if (cell.text.empty() && i + 1 == header.cells.size()) continue;
      const auto meant = is_unused(Heading(cell.text)) ? std::nullopt : misspelt(Heading(cell.text));
      if (meant)
        throw TextError(line(cell), cell.column,
                        "unknown column \"" + cell.text + "\"; columns are " + kColumnNames +
                            ", as in the line\n    " + kRightHeader);
      unused.push_back("\"" + cell.text + "\"");
    }
    std::string all;
    for (const std::string& name : unused) all += (all.empty() ? "" : ", ") + name;
    if (!unused.empty())
      notes.push_back(unused.size() == 1 ? "the column " + all + " is not used"
                                         : "the columns " + all + " are not used");
    if (!paints && !sample && recipes == Recipes::optional)
      throw TextError(
          header.line, 0,
          "there is no column \"sample\", the name of each measurement (or \"paints\", its recipe); a "
          "line of headings that would be right:\n    sample,unit,400,410,420");
    if (!paints && recipes == Recipes::required)
      throw TextError(
          header.line, 0,
          "there is no column \"paints\", the recipe of each sample; a line of headings that would be "
          "right:\n    " +
              std::string(kRightHeader));
    if (reflected.empty() && through.empty())
      throw TextError(
          header.line, 0,
          "there is no column with a wavelength, such as 400, 400nm or R400; a line of headings that "
          "would be right:\n    " +
              std::string(kRightHeader));
    if (!reflected.empty()) add(header, reflected, false, notes);
    if (!through.empty()) add(header, through, true, notes);
  }

private:
  struct Found {
    std::size_t column;
    double nm;
  };

  /// Adds the columns of one quantity.
  void add(const TextRow& header, std::vector<Found> found, bool is_transmitted,
           std::vector<std::string>& notes) {
    const auto by_nm = [](const Found& a, const Found& b) { return a.nm < b.nm; };
    if (!std::is_sorted(found.begin(), found.end(), by_nm) && found.front().nm > found.back().nm)
      notes.push_back("wavelengths descend; they are sorted");
    std::stable_sort(found.begin(), found.end(), by_nm);
    std::vector<double> wavelengths;
    for (const Found& f : found)
      if (wavelengths.empty() || f.nm > wavelengths.back()) wavelengths.push_back(f.nm);
    const std::size_t repeats = found.size() / wavelengths.size(), first = values.size();
    values.resize(first + repeats), transmitted.resize(first + repeats, is_transmitted);
    const auto fail = [&](std::size_t column, const std::string& message) {
      const TextCell& cell = header.cells[column];
      throw TextError(cell.line ? cell.line : header.line, cell.column,
                      message + "; a line of headings that would be right:\n    " + kRightHeader);
    };
    for (const Found& f : found)
      if (f.nm < kShortestWavelength || f.nm > kLongestWavelength)
        fail(f.column, "the heading \"" + header.cells[f.column].text + "\" is a wavelength of " +
                           number_text(f.nm) + " nm; those of pigments are from 200 to 2600 nm");
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found.size() % wavelengths.size() != 0 || found[i].nm != wavelengths[i / repeats])
        fail(found[i].column, "wavelengths must increase or all come equally often: \"" +
                                  header.cells[found[i].column].text + "\" does not");
      values[first + i % repeats].push_back(found[i].column);
    }
    if (!nm.empty() && nm != wavelengths)
      fail(found.front().column, "transmittances and reflectances need equal wavelengths");
    nm = std::move(wavelengths);
    if (repeats > 1)
      notes.push_back("each wavelength has " + std::to_string(repeats) + " columns: they are repeats");
  }
};

/// The sum of a recipe's amounts if it is nearly but not quite 100, which happens when percentages were
/// rounded or misread.
std::optional<double> sum_beside_100(const std::string& recipe) {
  double sum = 0;
  for (std::size_t at = recipe.find(':'); at != recipe.npos; at = recipe.find(':', at + 1)) {
    const std::size_t begin = recipe.find_first_not_of(' ', at + 1), end = recipe.find('+', at);
    if (begin == recipe.npos) return {};
    std::string amount = recipe.substr(begin, end == recipe.npos ? recipe.npos : end - begin);
    amount.erase(amount.find_last_not_of(" ") + 1);
    const auto value = finite_number(amount);
    if (!value) return {};
    sum += *value;
  }
  if (std::abs(sum - 100) < 0.05 || std::abs(sum - 100) > 10) return {};
  return sum;
}

/// Stands for a value that the table lacks.
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
/// Widest gap in nm over which missing values are interpolated.
constexpr double kWidestGap = 40;
/// Largest reflectance that a paint can have, with the error of the instrument; joint fits have the same
/// limit.
constexpr double kLargestReflectance = 1.05;

bool is_missing(const std::string& text) {
  const std::string word = lower_case(text);
  return word.empty() || word == "-" || word == "n/a" || word == "na" || word == "nan";
}

[[noreturn]] void fail_missing(const Sample& s, double nm, std::size_t i) {
  throw TextError(!s.lines.empty() ? s.lines[i] : s.line, s.columns[i],
                  "sample \"" + s.name + "\" has no value at " + number_text(nm) +
                      " nm; the measurement or this wavelength of all measurements may be left out");
}

/// Leaves out wavelengths at the ends that a sample lacks, and interpolates over other missing values.
void fill_missing(SampleTable& table) {
  const auto is_known = [](double v) { return !std::isnan(v); };
  std::size_t first = 0, last = table.nm.size();
  for (const Sample& s : table.samples) {
    const auto begin = std::find_if(s.values.begin(), s.values.end(), is_known);
    if (begin == s.values.end()) fail_missing(s, table.nm.front(), 0);
    const auto end = std::find_if(s.values.rbegin(), s.values.rend(), is_known);
    first = std::max(first, std::size_t(begin - s.values.begin()));
    last = std::min(last, s.values.size() - std::size_t(end - s.values.rbegin()));
  }
  const std::size_t all = table.nm.size();
  if (first + 1 >= last)
    for (const Sample& s : table.samples)
      for (std::size_t i = 0; i < all; ++i)
        if (!is_known(s.values[i])) fail_missing(s, table.nm[i], i);
  const auto cut = [&](auto& values) {
    if (values.size() != all) return;
    values.erase(values.begin() + std::ptrdiff_t(last), values.end());
    values.erase(values.begin(), values.begin() + std::ptrdiff_t(first));
  };
  int count = 0;
  std::string place;
  for (Sample& s : table.samples) {
    std::size_t before = all;  // index of the last known value
    for (std::size_t i = 0; i < all; ++i) {
      if (!is_known(s.values[i])) continue;
      const double gap = before < i ? table.nm[i] - table.nm[before] : 0;
      for (std::size_t j = before + 1; before < i && j < i; ++j) {
        // A gap at wavelengths that are cut off does not matter.
        if (gap > kWidestGap && j >= first && j < last) fail_missing(s, table.nm[j], j);
        const double t = (table.nm[j] - table.nm[before]) / gap;
        s.values[j] = s.values[before] + t * (s.values[i] - s.values[before]);
        if (j < first || j >= last) continue;
        if (count++ == 0)
          place = "line " + std::to_string(!s.lines.empty() ? s.lines[j] : s.line) + ", \"" + s.name +
                  "\" at " + number_text(table.nm[j]) + " nm";
      }
      before = i;
    }
    cut(s.values), cut(s.columns), cut(s.lines);
  }
  if (last - first < all)
    table.notes.push_back(
        std::to_string(all - (last - first)) +
        " wavelengths at the ends, which a sample lacks, are left out: " + number_text(table.nm[first]) +
        " to " + number_text(table.nm[last - 1]) + " nm remain");
  if (count > 0)
    table.notes.push_back(std::to_string(count) + (count == 1 ? " missing value is" : " missing values are") +
                          " interpolated; the first: " + place);
  cut(table.nm);
}

/// The message about a layer with a thickness but without a stated backing.
std::string without_backing(const Sample& s) {
  return "\"" + s.name +
         "\" has a thickness and no backing; right would be opaque, none (a free film), an inner reflectance such as 0.04, "
         "or the name of a line without paints, the bare card";
}

/// One row of the table: a measurement, or several repeats.
std::vector<Sample> samples_of(const TextRow& row, const Columns& columns, std::vector<std::string>& notes,
                               bool& has_unit) {
  const auto text = [&](const OptionalColumn& column) {
    return column ? row.cells[*column].text : std::string();
  };
  const auto line = [&](std::size_t column) {
    return row.cells[column].line ? row.cells[column].line : row.line;
  };
  const auto fail = [&](const OptionalColumn& column, const std::string& message) {
    throw TextError(line(*column), row.cells[*column].column, message);
  };
  Sample s;
  s.line = row.line;
  s.name = text(columns.sample);
  s.series = text(columns.series), s.specimen = text(columns.specimen);
  try {
    if (!text(columns.paints).empty()) s.paints = parse_recipe(text(columns.paints));
  } catch (const std::domain_error& e) {
    fail(columns.paints, std::string(e.what()) + "; a recipe that would be right: red: 1 + white: 3");
  }
  if (const auto sum = sum_beside_100(text(columns.paints)))
    notes.push_back("line " + std::to_string(line(*columns.paints)) + ": the amounts of \"" +
                    text(columns.paints) + "\" sum to " + number_text(*sum) + " and are taken for parts");
  if (s.name.empty()) s.name = text(columns.paints);
  const std::string quantity = upper_case(text(columns.quantity));
  if (quantity == "T")
    s.quantity = Sample::Quantity::transmittance;
  else if (!quantity.empty() && quantity != "R")
    fail(columns.quantity, "quantity must be R or T, got \"" + text(columns.quantity) + "\"");
  if (!text(columns.backing).empty()) s.backing = text(columns.backing), s.states_backing = true;
  if (!text(columns.thickness).empty()) {
    s.thickness = columns.thickness_scale * number_of(row, *columns.thickness);
    if (!(s.thickness > 0))
      fail(columns.thickness, "thickness must be positive, got " + text(columns.thickness));
    if (s.thickness < 0.4e-6)
      notes.push_back("line " + std::to_string(line(*columns.thickness)) + ": a thickness of " +
                      number_text(1e6 * s.thickness) +
                      " um is thinner than a wavelength; if it is in mm, the heading is \"thickness (mm)\"");
  }
  const std::string unit = lower_case(text(columns.unit));
  if (!unit.empty() && unit != "percent" && unit != "%" && unit != "fraction")
    fail(columns.unit, "unit must be fraction or percent, got \"" + text(columns.unit) + "\"");
  has_unit = !unit.empty() || columns.percent;
  const bool percent = unit.empty() ? columns.percent : unit != "fraction";
  std::vector<Sample> all;
  const bool has_film =
      std::find(columns.transmitted.begin(), columns.transmitted.end(), true) != columns.transmitted.end();
  const auto is_empty = [&](std::size_t column) { return is_missing(row.cells[column].text); };
  const auto is_measured = [&](std::size_t r) {
    return !std::all_of(columns.values[r].begin(), columns.values[r].end(), is_empty);
  };
  // A film with transmittances has no backing.
  for (std::size_t r = 0; r < columns.values.size(); ++r)
    if (columns.transmitted[r] && is_measured(r) && text(columns.backing).empty() && !s.paints.empty())
      s.backing = "none", s.states_backing = true;
  if (s.thickness > 0 && !s.paints.empty() && s.backing == "opaque" && text(columns.backing).empty())
    fail(columns.backing ? columns.backing : columns.thickness, without_backing(s));
  for (std::size_t r = 0; r < columns.values.size(); ++r) {
    const std::vector<std::size_t>& run = columns.values[r];
    if (has_film && !is_measured(r)) continue;  // a row may have one quantity only
    Sample& one = all.emplace_back(s);
    if (columns.transmitted[r]) one.quantity = Sample::Quantity::transmittance;
    bool down = false;
    for (const std::size_t column : run) {
      one.values.push_back(is_empty(column) ? kMissing : number_of(row, column) * (percent ? 0.01 : 1));
      one.columns.push_back(row.cells[column].column), one.lines.push_back(line(column));
      down = down || row.cells[column].line > 0;
    }
    if (!down) one.lines.clear();
  }
  return all;
}

/// The longest line that an error shows.
constexpr std::size_t kLongestShown = 400;

/// The cells of a line in one text, those with the separator in quotes.
std::string line_of(const std::vector<std::string>& cells, char separator) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != cells.data()) line += separator;
    if (cell.find(separator) == cell.npos && !cell.starts_with('"')) {
      line += cell;
      continue;
    }
    line += '"';
    for (const char c : cell) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line;
}

/// A value that a cell of a column may have, in a row of this table.
std::string right_cell(const Columns& columns, const TextRow& row, std::size_t column) {
  if (columns.sample == column) return "a";
  if (columns.paints == column) return "red: 1 + white: 3";
  if (columns.quantity == column) return "R";
  if (columns.backing == column) return "opaque";
  if (columns.thickness == column) {
    const auto stated = column < row.cells.size() ? finite_number(row.cells[column].text) : std::nullopt;
    return number_text(stated && *stated < 0 ? -*stated : 24e-6 / columns.thickness_scale);
  }
  if (columns.unit == column) return "percent";
  if (columns.series == column || columns.specimen == column) return "1";
  // A wavelength: the nearest number of the row.
  std::string nearest = "41.2";
  std::size_t distance = row.cells.size() + 1;
  for (const std::vector<std::size_t>& run : columns.values)
    for (const std::size_t i : run) {
      const std::size_t away = i > column ? i - column : column - i;
      if (i >= row.cells.size() || away == 0 || away >= distance || !finite_number(row.cells[i].text))
        continue;
      nearest = row.cells[i].text, distance = away;
    }
  return nearest;
}

/// The error with the heading of its cell, and the line as it would be right.
TextError with_right_line(const TextError& error, const TextRow& row, const TextRow& header,
                          const Columns& columns, char separator) {
  const std::string said = error.what();
  if (said.find("would be") != said.npos) return error;  // it says itself what would be right
  for (std::size_t i = 0; i < row.cells.size() && i < header.cells.size(); ++i) {
    const TextCell& cell = row.cells[i];
    if (cell.column != error.column() || (cell.line ? cell.line : row.line) != error.line()) continue;
    const bool is_down = cell.line > 0;
    std::string message =
        said + (is_down ? " in the row \"" : " in the column \"") + header.cells[i].text + "\"";
    std::vector<std::string> cells;
    for (const TextCell& one : row.cells) cells.push_back(one.text);
    cells[i] = right_cell(columns, row, i);
    const std::string line = is_down ? std::string() : line_of(cells, separator);
    message += is_down || line.size() > kLongestShown ? "; right would be " + cells[i]
                                                      : "; a line that would be right:\n    " + line;
    return {error.line(), error.column(), message};
  }
  return error;
}

/// The end of an error on a row with too few or too many cells: the line as it would be right.
std::string with_all_cells(const TextRow& row, const TextRow& header, const Columns& columns,
                           char separator) {
  std::vector<std::string> cells;
  for (std::size_t i = 0; i < header.cells.size(); ++i)
    cells.push_back(i < row.cells.size() ? row.cells[i].text : right_cell(columns, row, i));
  const std::string line = line_of(cells, separator);
  return line.size() > kLongestShown ? std::string() : "; a line that would be right:\n    " + line;
}

/// The rows of a table, from its headings on.
struct Grid {
  std::vector<TextRow> rows;
  int headings = 0;  ///< number of cells of a row that are headings
  bool down = false;
  char separator = ',';
};

int count_headings(const TextRow& row) {
  int count = 0;
  for (const std::string& text : without_repeat_numbers(row)) count += wavelength_of(text).has_value();
  return count;
}

/// Whether the text is the heading of a column of wavelengths, in a table whose rows are wavelengths.
bool is_wavelength_heading(const std::string& text) {
  const std::string word = Heading(text).word;
  return word == "nm" || word == "wavelength" || word == "wavelengths" || word == "wavelengthnm" ||
         word == "wl" || word == "lambda" || word == "λ";
}

/// Turns rows into columns. Cells keep their positions in the file.
std::vector<TextRow> transposed(const std::vector<TextRow>& rows) {
  std::vector<TextRow> result(rows.front().cells.size());
  for (const TextRow& row : rows)
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i].cells.push_back(row.cells[i]);
      result[i].cells.back().line = row.line;
      if (result[i].line == 0) result[i].line = row.line;
    }
  return result;
}

/// Finds the table in rows split by one separator: the first line with wavelengths and text headings, or a line
/// that begins with "nm" above lines that begin with a wavelength.
Grid find_grid(std::vector<TextRow> rows, char separator) {
  Grid grid;
  grid.separator = separator;
  for (std::size_t r = 0; r < rows.size() && r < 300; ++r) {
    const int across = count_headings(rows[r]);
    // Data have numbers above 100 only in per cent, and a line of data has no text but names.
    if (across > grid.headings && rows[r].cells.size() >= 2) {
      const bool has_name = std::any_of(rows[r].cells.begin(), rows[r].cells.end(), [](const TextCell& c) {
        const std::string word = Heading(c.text).word;
        return word.starts_with("paint") || word == "recipe" || word == "mixture" || word == "composition" ||
               word.starts_with("sample") || word == "name" || word == "id";
      });
      if (has_name) {
        grid.headings = across, grid.down = false;
        grid.rows.assign(rows.begin() + std::ptrdiff_t(r), rows.end());
      }
    }
  }
  if (grid.headings > 0) return grid;
  // Headings are lines as wide as those of the wavelengths, unlike most lines of other text above the table.
  const auto of_wavelength = std::find_if(rows.begin(), rows.end(), [](const TextRow& row) {
    return row.cells.size() >= 2 && wavelength_of(row.cells[0].text);
  });
  std::size_t first = rows.size(), first_of_any_width = rows.size(), count = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].cells.size() < 2) continue;
    if (is_wavelength_heading(rows[r].cells[0].text) || Columns().find(rows[r].cells[0].text)) {
      first_of_any_width = std::min(first_of_any_width, r);
      if (of_wavelength != rows.end() && rows[r].cells.size() == of_wavelength->cells.size())
        first = std::min(first, r);
    }
    if (first_of_any_width < rows.size() && wavelength_of(rows[r].cells[0].text)) ++count;
  }
  if (first == rows.size()) first = first_of_any_width;
  if (count < 2) return grid;
  grid.headings = int(count), grid.down = true;
  grid.rows.assign(rows.begin() + std::ptrdiff_t(first), rows.end());
  return grid;
}

/// Drops empty columns at the end, which spreadsheets add.
void drop_empty_columns(std::vector<TextRow>& rows) {
  std::size_t width = rows.front().cells.size();
  const auto is_empty = [&](const TextRow& row) {
    return row.cells.size() < width || row.cells[width - 1].text.empty();
  };
  while (width > 1 && std::all_of(rows.begin(), rows.end(), is_empty)) --width;
  for (TextRow& row : rows)
    while (row.cells.size() > width && row.cells.back().text.empty()) row.cells.pop_back();
}

}  // namespace

SampleTable read_samples(std::istream& stream, Recipes recipes) {
  SampleTable table;
  std::vector<std::string>& notes = table.notes;
  const std::string text = utf8_text({std::istreambuf_iterator<char>(stream), {}}, &notes);
  Grid best;
  for (const char separator : {',', ';', '\t'}) {
    if (separator != ',' && text.find(separator) == text.npos) continue;
    std::istringstream in(text);
    Grid grid;
    try {
      grid = find_grid(read_text_table(in, separator), separator);
    } catch (const TextError&) {
      if (separator == ',') throw;
      continue;
    }
    if (grid.headings > best.headings) best = std::move(grid);
  }
  if (best.headings == 0) {
    std::istringstream in(text);
    best.rows = read_text_table(in);
    if (best.rows.empty())
      throw TextError(
          0, 0,
          "there is no table; a line of headings that would be right:\n    " + std::string(kRightHeader));
  }
  if (best.rows.front().line > 1 && best.headings > 0) {
    // Lines of text before the table are noted; lines of comment are skipped without a note.
    std::istringstream in(text);
    std::string skipped;
    int count = 0;
    for (int l = 1; l < best.rows.front().line && std::getline(in, skipped); ++l) {
      const auto at = skipped.find_first_not_of(" \t\r,;");
      count += at != skipped.npos && skipped[at] != '#';
    }
    if (count > 0)
      notes.push_back("the table begins in line " + std::to_string(best.rows.front().line) + "; " +
                      std::to_string(count) + " lines before it are not read");
  }
  drop_empty_columns(best.rows);
  if (change_decimal_commas(best.rows)) notes.push_back("decimal commas are read as points");
  if (best.down) {
    const std::size_t width = best.rows.front().cells.size();
    for (const TextRow& row : best.rows)
      if (row.cells.size() != width)
        throw TextError(row.line, 0,
                        "expected " + std::to_string(width) + " cells as in line " +
                            std::to_string(best.rows.front().line) + ", got " +
                            std::to_string(row.cells.size()));
    bool has_paints = recipes == Recipes::optional;
    for (const TextRow& row : best.rows) {
      Columns one;
      has_paints = has_paints || one.find(row.cells[0].text) == &one.paints;
    }
    for (TextRow& row : best.rows)
      if (is_wavelength_heading(row.cells[0].text)) {
        row.cells[0].text = has_paints ? "sample" : "paints";
        if (!has_paints)
          notes.push_back("the headings of line " + std::to_string(row.line) + " are the recipes");
      }
    best.rows = transposed(best.rows);
  }
  const Columns columns(best.rows.front(), recipes, notes);
  table.nm = columns.nm;
  std::vector<std::size_t> without_unit;
  double largest = 0;
  for (std::size_t i = 1; i < best.rows.size(); ++i) {
    const TextRow& row = best.rows[i];
    if (row.cells.size() != best.rows.front().cells.size())
      throw TextError(row.line, 0,
                      "expected " + std::to_string(best.rows.front().cells.size()) +
                          " cells, as in the line of headings, got " + std::to_string(row.cells.size()) +
                          (best.separator == ',' && row.cells.size() > best.rows.front().cells.size()
                               ? "; numbers with decimal commas need another separator, as in 24;0,41;0,42"
                               : with_all_cells(row, best.rows.front(), columns, best.separator)));
    bool has_unit = false;
    std::vector<Sample> of_row;
    try {
      of_row = samples_of(row, columns, notes, has_unit);
    } catch (const TextError& e) {
      throw with_right_line(e, row, best.rows.front(), columns, best.separator);
    }
    for (Sample& s : of_row) {
      if (!has_unit) {
        without_unit.push_back(table.samples.size());
        for (const double v : s.values) largest = std::max(largest, std::isnan(v) ? 0 : v);
      }
      table.samples.push_back(std::move(s));
    }
  }
  if (largest > 1.5) {
    std::size_t small = 0;
    std::string first;
    for (const std::size_t s : without_unit) {
      Sample& sample = table.samples[s];
      const bool is_small =
          std::all_of(sample.values.begin(), sample.values.end(), [](double v) { return !(v > 1.5); });
      if (is_small && small++ == 0) first = "\"" + sample.name + "\" of line " + std::to_string(sample.line);
      for (double& v : sample.values) v *= 0.01;
    }
    if (small > 0)
      notes.push_back(std::to_string(small) + (small == 1 ? " row has" : " rows have") +
                      " no value above 1.5 per cent, the first " + first +
                      ": if these are fractions, a column \"unit\" must say which is which");
    notes.push_back("values up to " + number_text(largest) +
                    " have no unit and are taken for per cent; a column \"unit\" with percent says so");
  }
  if (!table.samples.empty()) fill_missing(table);
  return table;
}

Instrument instrument_called(const std::string& text) {
  std::string word;
  for (const char c : lower_case(text))
    if (std::isalnum(static_cast<unsigned char>(c))) word += c;
  const auto has = [&](std::initializer_list<const char*> parts) {
    return std::any_of(parts.begin(), parts.end(),
                       [&](const char* part) { return word.find(part) != word.npos; });
  };
  Instrument result;
  if (has({"450", "045", "45a0", "45c0", "0a45", "45x0"}))
    result.geometry = "45_0";
  else if (has({"d8", "di8", "de8", "8d", "8di", "8de", "d0", "0d", "sphere"}))
    result.geometry = "d8";
  if (has({"excluded", "sce", "spex", "de8", "8de", "d8e"}))
    result.specular = "excluded";
  else if (has({"included", "sci", "spin", "di8", "8di", "d8i"}))
    result.specular = "included";
  if (result.geometry == "45_0")
    result.specular = "excluded";  // in 45:0 geometry specular reflection never reaches the detector
  return result;
}

/// The headings of a line that describes a sample, and its cells.
constexpr const char* kSampleHeadings = "sample,specimen,paints,quantity,backing,thickness_um";
std::vector<std::string> sample_cells(const Sample& s) {
  return {s.name,
          s.specimen,
          s.paints.empty()       ? ""
          : s.paints.size() == 1 ? s.paints[0].name
                                 : recipe_text(s.paints),
          s.quantity == Sample::Quantity::transmittance ? "T" : "R",
          s.paints.empty() ? "" : s.backing,
          s.thickness > 0 ? number_text(1e6 * s.thickness) : ""};
}

std::string right_sample_line(const Sample& s) {
  return std::string("; a line that would be right, before its values:\n    ") + kSampleHeadings + "\n    " +
         line_of(sample_cells(s), ',');
}

std::string right_value_line(const Sample& sample, double nm, bool is_percent, double value) {
  std::vector<std::string> cells = sample_cells(sample);
  cells.push_back(is_percent ? "percent" : "fraction"), cells.push_back(number_text(value));
  return std::string("; a line that would be right, with one of its values:\n    ") + kSampleHeadings +
         ",unit," + number_text(nm) + "\n    " + line_of(cells, ',');
}

std::string right_reflectance_line(const Sample& sample, double nm, double value, double most) {
  const bool is_percent = value > 1.5 && value <= 100 * most;
  // The largest possible value is rounded down, so that the line is right.
  return right_value_line(sample, nm, is_percent, is_percent ? value : std::floor(1e4 * most) / 1e4);
}

std::string sample_table_template() {
  return "# One measurement a line. paints: a recipe by mass. backing: opaque, none (a free film), a reflectance, or\n"
         "# the name of a line without paints, a bare card. Films need a thickness, or: aureole pigment fit --joint.\n"
         "# specimen: the layer that was measured. series: what was made from the same batches of paint.\n"
         "sample,specimen,series,paints,quantity,backing,thickness_um,unit,400,410,420\n"
         "# black card,,,,R,,,percent,4.9,4.9,4.9\n"
         "# ochre over black,1,a,ochre,R,black card,24,percent,8.1,8.3,8.6\n"
         "# tint,2,a,ochre: 1 + white: 9,R,opaque,,percent,41.0,42.3,43.9\n";
}

std::vector<Panel> panels_of(const SampleTable& table) {
  const auto is_repeat = [](const Sample& a, const Sample& b) {
    return a.name == b.name && a.backing == b.backing && a.thickness == b.thickness &&
           recipe_text(a.paints) == recipe_text(b.paints);
  };
  std::vector<Panel> all;
  for (const Sample& s : table.samples) {
    if (s.quantity != Sample::Quantity::reflectance) continue;
    const auto same =
        std::find_if(all.begin(), all.end(), [&](const Panel& p) { return is_repeat(*p.first, s); });
    Panel& panel = same == all.end() ? all.emplace_back(Panel{s.name, s.values, 0, &s}) : *same;
    if (panel.count > 0)
      for (std::size_t i = 0; i < panel.values.size(); ++i)
        panel.values[i] += (s.values[i] - panel.values[i]) / (panel.count + 1);
    ++panel.count;
  }
  // Panels of one name are distinguished by backing, then by thickness, then by recipe.
  for (int step = 0; step < 3; ++step) {
    std::vector<bool> repeated(all.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      repeated[i] = std::count_if(all.begin(), all.end(),
                                  [&](const Panel& other) { return other.name == all[i].name; }) > 1;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Sample& s = *all[i].first;
      if (!repeated[i]) continue;
      if (step == 0) all[i].name += " over " + s.backing;
      if (step == 1 && s.thickness > 0) all[i].name += ", " + number_text(1e6 * s.thickness) + " um";
      if (step == 2) all[i].name += ", " + (s.paints.empty() ? "bare" : recipe_text(s.paints));
    }
  }
  return all;
}

std::vector<Panel> panels_called(const std::vector<Panel>& panels, const std::string& name) {
  const auto trimmed = [](const std::string& text) {
    const auto first = text.find_first_not_of(' ');
    return first == text.npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
  };
  std::vector<Panel> found;
  for (const Panel& p : panels)
    if (trimmed(p.name) == trimmed(name) || trimmed(p.first->name) == trimmed(name)) found.push_back(p);
  return found;
}

void match_card_names(SampleTable& table) {
  std::set<std::string> cards;
  for (const Sample& s : table.samples)
    if (s.paints.empty()) cards.insert(s.name);
  // card names that differ in case, and the names of the cards that they refer to
  std::map<std::string, std::string> meant;
  for (Sample& s : table.samples) {
    if (s.paints.empty() || s.backing == "opaque" || s.backing == "none" || cards.contains(s.backing))
      continue;
    std::vector<std::string> found;
    for (const std::string& card : cards)
      if (lower_case(card) == lower_case(s.backing)) found.push_back(card);
    if (found.size() != 1) continue;
    if (meant.emplace(s.backing, found[0]).second)
      table.notes.push_back("the backing \"" + s.backing + "\" is taken for the card \"" + found[0] +
                            "\", whose name differs in case");
    s.backing = found[0];
  }
}

/// Samples without a recipe of their own to which others refer as their backing are bare cards.
void find_bare_cards(SampleTable& table) {
  std::set<std::string> backings;
  for (const Sample& s : table.samples)
    if (s.states_backing) backings.insert(lower_case(s.backing));
  for (Sample& s : table.samples)
    if (s.is_named_recipe && !s.states_backing && !(s.thickness > 0) && backings.contains(lower_case(s.name)))
      s.paints.clear();
}

void settle_backings(SampleTable& table) {
  find_bare_cards(table);
  match_card_names(table);
  std::set<std::string> stated;
  const auto layers_of = [](const Sample& s) {
    std::vector<std::string> keys{"recipe " + recipe_text(s.paints, 6)};
    if (!s.specimen.empty()) keys.push_back("specimen " + s.series + " " + s.specimen);
    return keys;
  };
  for (const Sample& s : table.samples)
    if (s.states_backing && !s.paints.empty())
      for (std::string& key : layers_of(s)) stated.insert(std::move(key));
  int count = 0;
  const Sample* first = nullptr;
  for (std::size_t i = 0; i < table.samples.size(); ++i) {
    const Sample& s = table.samples[i];
    if (s.states_backing || s.paints.empty()) continue;
    if (s.thickness > 0 && s.backing == "opaque") throw SampleError(i, -1, without_backing(s));
    const std::vector<std::string> keys = layers_of(s);
    if (std::none_of(keys.begin(), keys.end(), [&](const std::string& key) { return stated.contains(key); }))
      continue;
    if (count++ == 0) first = &s;
  }
  if (count > 0)
    table.notes.push_back("\"" + first->name + "\"" +
                          (first->line > 0 ? " of line " + std::to_string(first->line) : "") +
                          (count > 1 ? " and " + std::to_string(count - 1) + " more have" : " has") +
                          " no backing, which other measurements of this paint or specimen state, and " +
                          (count > 1 ? "are" : "is") + " taken for opaque");
}

void check_not_above_white(const SampleTable& table) {
  for (std::size_t s = 0; s < table.samples.size(); ++s)
    for (std::size_t i = 0; i < table.samples[s].values.size(); ++i)
      if (table.samples[s].quantity == Sample::Quantity::reflectance &&
          table.samples[s].values[i] > kLargestReflectance)
        throw SampleError(s, int(i),
                          "sample \"" + table.samples[s].name + "\" at " + number_text(table.nm[i]) +
                              " nm: a reflectance of " + number_text(table.samples[s].values[i]) +
                              " is above 1.05" +
                              (table.samples[s].values[i] > 1.5
                                   ? "; if the values are per cent, a column \"unit\" with percent says so"
                                   : "; is the unit right (fraction or percent), or is a digit wrong?") +
                              right_reflectance_line(table.samples[s], table.nm[i],
                                                     table.samples[s].values[i], kLargestReflectance));
}

void check(const SampleTable& table) {
  if (table.nm.empty()) throw std::domain_error("there are no wavelengths");
  for (const double nm : table.nm)
    require(nm >= kShortestWavelength && nm <= kLongestWavelength, nm, "wavelengths",
            "must be from 200 to 2600 nm, as those of pigments");
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
                              " nm: must be finite and not negative, got " + number_text(sample.values[i]) +
                              right_value_line(sample, table.nm[i], false, 0.05));
  }
}

}  // namespace aureole::pigment
