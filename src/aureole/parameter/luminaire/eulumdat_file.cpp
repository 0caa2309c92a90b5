// SPDX-License-Identifier: Apache-2.0
// EULUMDAT (A. W. Stockmar, "EULUMDAT - ein Leuchtendatenformat fuer den europaeischen Beleuchtungsplaner", Licht '90,
// pp. 641-644): one value on each line.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/units.h"
#include "aureole/parameter/luminaire/luminaire_reader.h"
#include "aureole/pigment/text_table.h"

namespace aureole {

namespace luminaire_reader {

namespace {

constexpr std::size_t kRoomIndices = 10;  ///< number of the direct ratios of a file, one for each room index

/// The values of a file, line by line.
class ValueLines {
public:
  ValueLines(std::string_view text, const std::filesystem::path& file) : text_(text), file_(file) {}

  /// Returns the next line without blanks around it; `meaning` is its name in errors.
  std::string_view text(const std::string& meaning) {
    if (at_ > text_.size() || (at_ == text_.size() && number_ > 0)) {
      ++number_;
      throw error("the file ends where " + meaning + " should be");
    }
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1, ++number_;
    const auto first = line.find_first_not_of(" \t\r\x1a");
    if (first == line.npos) return {};
    return line.substr(first, line.find_last_not_of(" \t\r\x1a") - first + 1);
  }
  /// Returns a number with a decimal point or comma; an empty line is 0.
  double number(const std::string& meaning) {
    const std::string_view line = text(meaning);
    if (line.empty()) return 0;
    std::string word(line.front() == '+' ? line.substr(1) : line);
    std::replace(word.begin(), word.end(), ',', '.');
    const auto value = pigment::finite_number(word);
    if (!value) throw error("expected " + meaning + ", got \"" + std::string(line.substr(0, 40)) + "\"");
    return *value;
  }
  double non_negative(const std::string& meaning) {
    const double value = number(meaning);
    if (value < 0) throw error(meaning + " must not be negative, got " + shown_number(value));
    return value;
  }
  std::size_t whole(const std::string& meaning, std::size_t min, std::size_t max) {
    const double value = number(meaning);
    if (!(value >= double(min) && value <= double(max) && value == std::floor(value)))
      throw error(fmt::format("expected {}, a whole number from {} to {}, got {}", meaning, min, max,
                              shown_number(value)));
    return std::size_t(value);
  }
  /// Reads numbers. `at` takes the line of each.
  std::vector<double> list(std::size_t count, const std::string& meaning, std::vector<int>* at = nullptr) {
    // Bound of the count: each number takes a line, so that memory is bounded by the size of the file.
    if (count > text_.size() - std::min(at_, text_.size()) + 1)
      throw error(fmt::format("the file is too short for {} numbers ({})", count, meaning));
    std::vector<double> all(count);
    for (double& x : all) {
      x = number(meaning);
      if (at) at->push_back(number_);
    }
    return all;
  }
  bool ends() const {
    return text_.find_first_not_of(" \t\r\n\x1a", std::min(at_, text_.size())) == text_.npos;
  }
  /// Number of the line that was read last.
  int line() const { return number_; }
  Error error(const std::string& message) const { return error(number_, message); }
  Error error(int line, const std::string& message) const { return fault(file_, line, 1, message); }

private:
  std::string_view text_;
  std::size_t at_ = 0;
  int number_ = 0;
  const std::filesystem::path& file_;
};

/// Returns the index of the first half-plane in a file and the number of half-planes, by the indicator of
/// symmetry.
std::pair<std::size_t, std::size_t> stored_half_planes(std::size_t symmetry, std::size_t planes,
                                                       const ValueLines& lines) {
  const auto divisible = [&](std::size_t n) {
    if (planes % n != 0 || planes == 0)
      throw lines.error(fmt::format("symmetry {} needs a number of half-planes that {} divides, not {}",
                                    symmetry, n, planes));
  };
  switch (symmetry) {
    case 1:
      return {0, 1};
    case 2:
      divisible(2);
      return {0, planes / 2 + 1};
    case 3:
      divisible(4);
      return {3 * planes / 4, planes / 2 + 1};
    case 4:
      divisible(4);
      return {0, planes / 4 + 1};
    default:
      return {0, planes};
  }
}

/// Completes the circle of a table whose half-planes end before 360 degrees.
void close_circle(MeasuredTable& t) {
  if (t.horizontal.back() == 360) return;
  const std::size_t rows = t.vertical.size();
  t.horizontal.push_back(t.horizontal.front() + 360);
  const std::vector<double> row(t.candela.begin(), t.candela.begin() + std::ptrdiff_t(rows));
  t.candela.insert(t.candela.end(), row.begin(), row.end());
}

constexpr const char* kSymmetries[] = {"none", "rotational", "about C 0-180", "about C 90-270",
                                       "about C 0-180 and C 90-270"};

}  // namespace

Luminaire read_eulumdat(const std::string& text, const std::filesystem::path& file,
                        const LuminaireOptions& options) {
  ValueLines lines(text, file);
  std::vector<std::string> notes;
  std::vector<std::pair<std::string, std::string>> keywords;
  const auto keep = [&](const char* name) { keywords.emplace_back(name, std::string(lines.text(name))); };
  if (text.find_first_not_of(" \t\r\n") == text.npos) throw fault(file, 1, 1, "the file is empty");
  keep("MANUFAC");
  // Both formats begin with free text, so that files of other formats are detected at this number.
  try {
    lines.whole("the type indicator, 1, 2 or 3", 0, 3);
  } catch (const Error& e) {
    throw Error(
        e.where(),
        e.message() +
            "; a file of LM-63 has a line TILT=, one of EULUMDAT begins with a line of text and the type "
            "indicator");
  }
  const std::size_t symmetry = lines.whole("the symmetry indicator", 0, 4);
  const std::size_t planes = lines.whole("the number of C-planes", 1, 100000);
  lines.non_negative("the distance of the C-planes");
  const std::size_t rows = lines.whole("the number of intensities in each C-plane", 2, 100000);
  lines.non_negative("the distance of the intensities");
  for (const char* name : {"TEST", "LUMINAIRE", "LUMCAT", "FILENAME", "ISSUEDATE"}) keep(name);
  for (const char* name :
       {"the length of the luminaire", "the width of the luminaire", "the height of the luminaire"})
    lines.number(name);
  LuminousOpening opening;
  constexpr double kMillimetre = 1e-3;
  const auto size = [&](const std::string& name) {
    const double mm = lines.non_negative(name);
    if (!(mm < 1e7)) throw lines.error(fmt::format("{} of {:g} m is too large", name, mm * kMillimetre));
    return mm;
  };
  const double length = size("the length of the luminous area"),
               width = size("the width of the luminous area");
  double height = 0;
  for (const char* plane : {"C0", "C90", "C180", "C270"})
    height = std::max(height, size(std::string("the height of the luminous area in ") + plane));
  opening.size_m = {length * kMillimetre, width * kMillimetre, height * kMillimetre};
  if (width == 0 && length > 0)
    opening.shape = LuminousOpening::Shape::cylinder, opening.size_m[1] = opening.size_m[0];
  const double downward = lines.non_negative("the downward flux fraction") / 100,
               output_ratio = lines.non_negative("the light output ratio") / 100;
  double conversion = lines.number("the conversion factor");
  if (!(conversion >= 0))
    throw lines.error("the conversion factor must be positive, got " + shown_number(conversion));
  if (conversion == 0) {
    conversion = 1;
    notes.push_back("the conversion factor of the intensities is 0; 1 is used");
  }
  const double tilt = lines.number("the tilt of the luminaire");
  if (tilt != 0)
    notes.push_back(fmt::format(
        "the luminaire was measured with a tilt of {:g} degrees; its intensities hold for that", tilt));
  const std::size_t sets = lines.whole("the number of sets of lamps", 1, 1000);
  std::vector<LampSet> lamps;
  bool is_absolute = false;
  int flux_line = 0;
  for (std::size_t i = 0; i < sets; ++i) {
    LampSet& set = lamps.emplace_back();
    set.count = lines.number("the number of lamps");
    if (i == options.lamp_set) is_absolute = set.count < 0;  // the flux is the flux of the luminaire
    set.count = std::abs(set.count);
    set.type = lines.text("the type of the lamps");
    set.flux = lines.non_negative("the flux of the lamps");
    if (i == options.lamp_set) flux_line = lines.line();
    set.colour = lines.text("the colour of the lamps");
    set.rendering = lines.text("the colour rendering of the lamps");
    set.watts = lines.non_negative("the power of the lamps");
  }
  if (options.lamp_set >= sets)
    throw lines.error(fmt::format("there is no set of lamps {}: the file has {}", options.lamp_set, sets));
  if (options.lamp_flux > 0 && is_absolute)
    throw lines.error(
        "the intensities do not refer to the flux of lamps, which \"lamp_flux\" would replace: give \"flux\"");
  if (options.lamp_flux > 0) lamps[options.lamp_set].flux = options.lamp_flux;
  const double flux = lamps[options.lamp_set].flux;
  if (!(flux > 0))
    throw lines.error(
        flux_line,
        "the file states no flux of its lamps, to which the intensities refer: give \"lamp_flux\"");
  if (sets > 1) {
    std::string all;
    for (std::size_t i = 0; i < sets; ++i)
      all += fmt::format("{}{}: {:g} x {}, {:g} lm", i ? "; " : "", i, lamps[i].count, lamps[i].type,
                         lamps[i].flux);
    notes.push_back(fmt::format("set {} of alternative lamps is used ({})", options.lamp_set, all));
  }
  lines.list(kRoomIndices, "direct ratios");

  MeasuredTable table;
  std::vector<int> horizontal_lines, vertical_lines, candela_lines;
  table.horizontal = lines.list(planes, "angles C", &horizontal_lines);
  table.vertical = lines.list(rows, "angles gamma", &vertical_lines);
  const auto check = [&](const std::vector<double>& angles, const std::vector<int>& at, double max,
                         const char* name) {
    for (std::size_t i = 0; i < angles.size(); ++i) {
      if (!(angles[i] >= 0 && angles[i] <= max))
        throw lines.error(at[i], fmt::format("the angle {} of {:g} is not between 0 and {:g} degrees", name,
                                             angles[i], max));
      if (i > 0 && !(angles[i] > angles[i - 1]))
        throw lines.error(at[i], fmt::format("the angles {} must increase: {:g} follows {:g}", name,
                                             angles[i], angles[i - 1]));
    }
  };
  check(table.vertical, vertical_lines, 180, "gamma");
  const auto [first, stored] = stored_half_planes(symmetry, planes, lines);
  if (symmetry != 1) check(table.horizontal, horizontal_lines, 360, "C");
  if (stored > (text.size() / rows) + 1)
    throw lines.error(fmt::format("the file is too short for {} x {} intensities", stored, rows));
  table.candela = lines.list(stored * rows, "an intensity", &candela_lines);
  for (std::size_t i = 0; i < table.candela.size(); ++i) {
    double& cd = table.candela[i];
    const int at = candela_lines[i];
    if (cd < 0) throw lines.error(at, "expected intensities of 0 cd/klm or more, got " + shown_number(cd));
    cd *= conversion * flux / 1000;
    if (!(cd < 1e15)) throw lines.error(at, fmt::format("the intensity of {:g} cd is too large", cd));
  }
  if (!lines.ends()) notes.push_back("the file goes on behind its last intensity; that is ignored");

  const auto expect = [&](std::size_t plane, double angle) {
    const double c = table.horizontal[plane];
    if (std::abs(c - angle) > 1e-3)
      throw lines.error(horizontal_lines[plane],
                        fmt::format("symmetry {} needs the half-plane C = {:g}; in its place is C = {:g}",
                                    symmetry, angle, c));
    table.horizontal[plane] = angle;
  };
  if (symmetry == 1) {
    table.horizontal = {0};
  } else if (symmetry == 3) {
    // The half-planes are stored from C = 270 through 0 to 90.
    expect(0, 0), expect(planes / 4, 90), expect(first, 270);
    std::vector<double> angles;
    for (std::size_t i = 0; i < stored; ++i) {
      const std::size_t k = first + i;
      angles.push_back(k < planes ? table.horizontal[k] - 360 : table.horizontal[k - planes]);
    }
    table.horizontal = angles;
    mirror(table, 90);  // half-planes from -90 to 270
    MeasuredTable whole{{}, table.vertical, {}, table.type};
    const auto take = [&](double shift, double from, double to) {
      for (std::size_t i = 0; i < table.horizontal.size(); ++i) {
        const double c = table.horizontal[i] + shift;
        if (!(c >= from && c <= to) || (!whole.horizontal.empty() && c <= whole.horizontal.back())) continue;
        whole.horizontal.push_back(c);
        const auto row = table.candela.begin() + std::ptrdiff_t(i * rows);
        whole.candela.insert(whole.candela.end(), row, row + std::ptrdiff_t(rows));
      }
    };
    take(0, 0, 270), take(360, 270, 360);
    table = whole;
  } else if (symmetry == 2 || symmetry == 4) {
    expect(0, 0);
    if (symmetry == 4) expect(planes / 4, 90);
    if (symmetry == 2) expect(planes / 2, 180);
    table.horizontal.resize(stored);
    if (symmetry == 4) mirror(table, 90);
    mirror(table, 180);
  } else {
    if (table.horizontal.front() != 0) throw lines.error("the first half-plane must have C = 0");
    if (planes == 1) table.horizontal = {0};
  }
  if (table.horizontal.size() > 1) close_circle(table);

  const bool along = options.zero_plane == LuminaireOptions::ZeroPlane::along;
  return Luminaire{.format = Luminaire::Format::eulumdat,
                   .standard = "EULUMDAT",
                   .keywords = std::move(keywords),
                   .type = optics::PhotometricType::c,
                   .symmetry = planes == 1 ? kSymmetries[1] : kSymmetries[symmetry],
                   .distribution = make_distribution(table, axes_of(optics::PhotometricType::c, !along)),
                   .horizontal_count = stored,
                   .vertical_count = rows,
                   .opening = opening,
                   .lamps = std::move(lamps),
                   .lamp_set = options.lamp_set,
                   .is_absolute = is_absolute,
                   .output_ratio = output_ratio,
                   .downward_fraction = downward,
                   .notes = std::move(notes)};
}

}  // namespace luminaire_reader

std::string eulumdat_text(const Luminaire& luminaire) {
  const optics::IntensityDistribution& d = luminaire.distribution;
  if (luminaire.type != optics::PhotometricType::c) throw Error("files of type C alone are written");
  luminaire_reader::require_lines(luminaire);
  const bool is_rotational = d.is_rotational();
  // C = 0 runs across the luminaire here, and 360 degrees are not repeated.
  const bool along = d.axes().zero[0] != 0;
  const std::vector<double> half_planes =
      along ? luminaire_reader::turned_half_planes(d.azimuths(), -90) : d.azimuths();
  const std::size_t planes = is_rotational ? 1 : half_planes.size() - 1, rows = d.polar_angles().size();
  const auto step = [](const std::vector<double>& angles, std::size_t count) {
    if (count < 2) return 0.0;
    const double first = angles[1] - angles[0];
    for (std::size_t i = 1; i < count; ++i)
      // the angles have unequal distances
      if (std::abs(angles[i] - angles[i - 1] - first) > 1e-6) return 0.0;
    return first;
  };
  const auto keyword = [&](const char* name) {
    for (const auto& [key, value] : luminaire.keywords)
      if (key == name) return value.substr(0, 78);
    return std::string();
  };
  const FluxBalance balance = flux_balance(luminaire);
  const LampSet& lamps = luminaire.lamps.at(luminaire.lamp_set);
  const double refers_to = luminaire.is_absolute ? balance.flux : lamps.flux;
  if (!(refers_to > 0)) throw Error("a luminaire without light has no intensities in cd/klm");
  const auto millimetres = [&](std::size_t i) { return 1000 * luminaire.opening.size_m[i]; };
  const bool is_round = luminaire.opening.shape != LuminousOpening::Shape::box;
  std::string s;
  const auto line = [&](const auto& value) { s += fmt::format("{}\r\n", value); };
  const auto value = [&](double v) { s += fmt::format("{:.6g}\r\n", v); };
  line(keyword("MANUFAC"));
  line(is_rotational ? 1 : is_round ? 3 : 2);
  line(is_rotational ? 1 : 0);
  line(planes);
  value(step(half_planes, planes));
  line(rows);
  value(step(d.polar_angles(), rows));
  for (const char* name : {"TEST", "LUMINAIRE", "LUMCAT"}) line(keyword(name));
  line(keyword("FILENAME").substr(0, 8));
  line(keyword("ISSUEDATE"));
  for (int pass = 0; pass < 2; ++pass) {  // the first pass reads the luminaire, the second its luminous area
    value(millimetres(0)), value(is_round ? 0 : millimetres(1));
    if (pass == 0) value(millimetres(2));
  }
  for (int i = 0; i < 4; ++i) value(millimetres(2));
  value(balance.flux > 0 ? 100 * d.flux(0, 90) / balance.flux : 0);
  value(luminaire.is_absolute ? 100 : 100 * balance.output_ratio);
  value(1), value(0);
  line(1);
  line(luminaire.is_absolute ? fmt::format("{:g}", -lamps.count) : fmt::format("{:g}", lamps.count));
  line(lamps.type), value(refers_to), line(lamps.colour), line(lamps.rendering), value(lamps.watts);
  for (std::size_t i = 0; i < luminaire_reader::kRoomIndices; ++i) line(0);
  for (std::size_t i = 0; i < planes; ++i) value(half_planes[i]);
  for (const double gamma : d.polar_angles()) value(gamma);
  for (std::size_t i = 0; i < planes; ++i)
    for (std::size_t j = 0; j < rows; ++j)
      value(1000 / refers_to *
            (is_rotational ? d.value(0, j) : d.at(half_planes[i] + (along ? 90 : 0), d.polar_angles()[j])));
  return s;
}

}  // namespace aureole
