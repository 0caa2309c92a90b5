// SPDX-License-Identifier: Apache-2.0
// IES LM-63: IESNA LM-63-1986, -1991, -1995, -2002 and ANSI/IES LM-63-19, "Standard file format for the electronic
// transfer of photometric data".
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/units.h"
#include "aureole/parameter/luminaire/luminaire_reader.h"
#include "aureole/pigment/text_table.h"

namespace aureole {

namespace luminaire_reader {

namespace {

using optics::PhotometricType;

/// Reads the numbers of a text, separated by blanks, commas and line ends.
class NumberWords {
public:
  NumberWords(std::string_view text, std::size_t begin, int line, const std::filesystem::path& file)
      : text_(text), at_(begin), line_(line), line_begin_(begin), file_(file) {}

  /// Returns the next number; `meaning` is its name in errors.
  double number(const std::string& meaning) {
    skip();
    begin_ = at_;
    const auto ends = [](char c) { return is_separator(c); };
    while (at_ < text_.size() && !ends(text_[at_])) ++at_;
    const std::string_view word = text_.substr(begin_, at_ - begin_);
    if (word.empty()) throw error("the file ends where " + meaning + " should be");
    // The sign is removed, since std::from_chars accepts no plus sign.
    const auto value = pigment::finite_number(word.front() == '+' ? word.substr(1) : word);
    if (!value) throw error("expected " + meaning + ", got \"" + std::string(word.substr(0, 40)) + "\"");
    return *value;
  }
  std::size_t count(const std::string& meaning) {
    const double value = number(meaning);
    if (!(value >= 1 && value == std::floor(value) && value < 1e9))
      throw error("expected " + meaning + ", a whole number from 1 on, got " + shown_number(value));
    return std::size_t(value);
  }
  std::vector<double> list(std::size_t count, const std::string& meaning) {
    // Bound of the count: each number takes a character and a separator, so that memory is bounded by the
    // size of the file.
    if (count > (text_.size() - at_) / 2 + 1)
      throw error(fmt::format("the file is too short for {} numbers ({})", count, meaning));
    std::vector<double> all(count);
    for (double& x : all) x = number(meaning);
    return all;
  }
  /// Whether only blanks are left.
  bool ends() {
    skip();
    return at_ >= text_.size();
  }
  /// Returns an error located at the last number.
  Error error(const std::string& message) const {
    return fault(file_, line_, int(std::min(begin_, text_.size()) - line_begin_) + 1, message);
  }
  int line() const { return line_; }
  std::size_t left() const { return text_.size() - at_; }

private:
  static bool is_separator(char c) {
    return c == ' ' || c == '\t' || c == ',' || c == '\n' || c == '\r' || c == '\f' || c == '\x1a' || c == 0;
  }
  void skip() {
    for (; at_ < text_.size() && is_separator(text_[at_]); ++at_)
      if (text_[at_] == '\n') ++line_, line_begin_ = at_ + 1;
  }

  std::string_view text_;
  std::size_t at_, begin_ = 0;
  int line_;
  std::size_t line_begin_;
  const std::filesystem::path& file_;
};

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\f");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\f") - first + 1);
}

/// Returns the year of the standard by the first line of a file; 1986 for any other line.
int year_of(std::string_view first) {
  if (first.starts_with("IESNA91")) return 1991;
  for (const int year : {1986, 1991, 1995, 2002, 2019})
    if (first.find("LM-63-" + std::to_string(year)) != first.npos) return year;
  if (first.find("LM-63-19") != first.npos) return 2019;
  if (first.find("LM-63-02") != first.npos) return 2002;
  if (first.find("LM-63-95") != first.npos) return 1995;
  return 1986;
}

LampTilt read_tilt(NumberWords& words) {
  LampTilt tilt;
  const double geometry = words.number("the lamp-to-luminaire geometry, 1, 2 or 3");
  if (geometry != 1 && geometry != 2 && geometry != 3)
    throw words.error("expected the lamp-to-luminaire geometry, 1, 2 or 3, got " + shown_number(geometry));
  tilt.geometry = int(geometry);
  const std::size_t count = words.count("the number of pairs of angles and factors");
  tilt.angles = words.list(count, "angles of tilt");
  for (std::size_t i = 1; i < count; ++i)
    if (!(tilt.angles[i] > tilt.angles[i - 1])) throw words.error("the angles of tilt must increase");
  tilt.factors = words.list(count, "factors of tilt");
  for (const double f : tilt.factors)
    if (!(f >= 0)) throw words.error("the factors of tilt must not be negative");
  return tilt;
}

/// Returns the luminous opening by the signs of its sizes: negative sizes mean a round section (LM-63-2002,
/// table 1; older editions leave out the second diameter of a circle).
LuminousOpening opening_of(double width, double length, double height, PhotometricType type,
                           const NumberWords& words) {
  LuminousOpening o;
  // x runs along a luminaire of type C, and across the beam of the others.
  const std::size_t w = type == PhotometricType::c ? 1 : 0, l = 1 - w, h = 2;
  std::array<double, 3> given{};
  given[w] = width, given[l] = length, given[h] = height;
  const auto is_round = [&](std::size_t i) { return given[i] < 0; };
  const int round = int(is_round(0)) + int(is_round(1)) + int(is_round(2));
  for (std::size_t i = 0; i < 3; ++i) o.size_m[i] = std::abs(given[i]);
  if (round == 0) return o;
  if (round == 3) {
    o.shape = LuminousOpening::Shape::ellipsoid;
    return o;
  }
  o.shape = LuminousOpening::Shape::cylinder;
  std::size_t axis = 3;
  if (round == 2) {
    for (std::size_t i = 0; i < 3; ++i)
      if (!is_round(i)) axis = i;
  } else if (is_round(w) && length == 0) {
    axis = h, o.size_m[l] = o.size_m[w];
  } else if (is_round(l) && width == 0) {
    axis = h, o.size_m[w] = o.size_m[l];
  } else if (is_round(h) && width == 0) {
    axis = l, o.size_m[w] = o.size_m[h];
  } else if (is_round(h) && length == 0) {
    axis = w, o.size_m[l] = o.size_m[h];
  }
  if (axis == 3)
    throw words.error(fmt::format(
        "width {:g}, length {:g} and height {:g} describe no luminous opening: negative sizes are those of a round "
        "section and come in pairs",
        width, length, height));
  o.axis = int(axis);
  return o;
}

void check_angles(const std::vector<double>& angles, double min, double max, const char* name,
                  const NumberWords& words) {
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (!(angles[i] >= min && angles[i] <= max))
      throw words.error(
          fmt::format("the {} angle {:g} is not between {:g} and {:g} degrees", name, angles[i], min, max));
    if (i > 0 && !(angles[i] > angles[i - 1]))
      throw words.error(
          fmt::format("the {} angles must increase: {:g} follows {:g}", name, angles[i], angles[i - 1]));
  }
}

/// Completes the half-planes of a table of type C. Returns its symmetry in words.
std::string complete_half_planes(MeasuredTable& t, std::vector<std::string>& notes,
                                 const NumberWords& words) {
  constexpr double kSame = 1e-3;  // tolerance of equal angles [degrees]
  const double first = t.horizontal.front(), last = t.horizontal.back();
  const auto near = [](double a, double b) { return std::abs(a - b) < kSame; };
  if (t.horizontal.size() == 1) {
    if (!near(first, 0))
      notes.push_back(fmt::format("the only half-plane has C = {:g}; it is taken for all", first));
    t.horizontal = {0};
    return "rotational";
  }
  if (near(first, 0)) t.horizontal.front() = 0;
  if (near(first, 0) && near(last, 90)) {
    t.horizontal.back() = 90;
    mirror(t, 90);
    t.horizontal.back() = 180;
    mirror(t, 180);
    return "about C 0-180 and C 90-270";
  }
  if (near(first, 0) && near(last, 180)) {
    t.horizontal.back() = 180;
    mirror(t, 180);
    return "about C 0-180";
  }
  if (near(first, 90) && near(last, 270)) {
    t.horizontal.front() = 90, t.horizontal.back() = 270;
    mirror(t, 270);  // half-planes from 90 to 450, of which those from 360 on come first
    const std::size_t rows = t.vertical.size();
    std::vector<double> horizontal, candela;
    const auto take = [&](double shift, double from, double to) {
      for (std::size_t i = 0; i < t.horizontal.size(); ++i) {
        const double c = t.horizontal[i] - shift;
        if (!(c >= from && c < to) || (!horizontal.empty() && !(c > horizontal.back()))) continue;
        horizontal.push_back(c);
        const auto row = t.candela.begin() + std::ptrdiff_t(i * rows);
        candela.insert(candela.end(), row, row + std::ptrdiff_t(rows));
      }
    };
    take(360, 0, 90), take(0, 90, 360 + kSame);
    // without half-planes at 0 and 180 degrees, the seam lies between two half-planes
    if (horizontal.front() > 0) {
      const double seam = 0;
      MeasuredTable whole{horizontal, t.vertical, candela, t.type};
      const double before = horizontal.back() - 360, after = horizontal.front();
      const double s = (seam - before) / (after - before);
      std::vector<double> row(rows);
      for (std::size_t j = 0; j < rows; ++j)
        row[j] = std::lerp(candela[candela.size() - rows + j], candela[j], s);
      horizontal.insert(horizontal.begin(), 0), candela.insert(candela.begin(), row.begin(), row.end());
      horizontal.push_back(360), candela.insert(candela.end(), row.begin(), row.end());
    }
    t.horizontal = std::move(horizontal), t.candela = std::move(candela);
    return "about C 90-270";
  }
  if (near(first, 0) && last > 180) {
    if (near(last, 360)) {
      t.horizontal.back() = 360;
      return "none";
    }
    // Editions before 2002 end before 360 degrees, since that is 0 again.
    notes.push_back(
        fmt::format("the horizontal angles end at {:g}: from there to 360 degrees the intensities lead to "
                    "those of 0 degrees",
                    last));
    t.horizontal.push_back(360);
    const std::vector<double> row(t.candela.begin(), t.candela.begin() + std::ptrdiff_t(t.vertical.size()));
    t.candela.insert(t.candela.end(), row.begin(), row.end());
    return "none";
  }
  throw words.error(fmt::format(
      "horizontal angles of type C run from 0 to 0, 90, 180 or 360 degrees, or from 90 to 270; these run from {:g} to "
      "{:g}",
      first, last));
}

/// Notes intensities at the ends of a table that does not reach all directions.
void note_cut_ends(const MeasuredTable& t, std::vector<std::string>& notes) {
  const std::size_t rows = t.vertical.size(), columns = t.horizontal.size();
  const double most = *std::max_element(t.candela.begin(), t.candela.end());
  const auto note = [&](const char* what, double angle, double cd) {
    if (cd > 0.005 * most)
      notes.push_back(
          fmt::format("the {} angles end at {:g} degrees with {:g} cd: it is dark beyond", what, angle, cd));
  };
  const auto most_of_row = [&](std::size_t j) {
    double cd = 0;
    for (std::size_t i = 0; i < columns; ++i) cd = std::max(cd, t.candela[i * rows + j]);
    return cd;
  };
  const bool is_c = t.type == PhotometricType::c;
  const double first = t.vertical.front(), last = t.vertical.back();
  if (is_c ? first > 0 && first != 90 : first > -90 && first != 0) note("vertical", first, most_of_row(0));
  if (is_c ? last < 180 && last != 90 : last < 90) note("vertical", last, most_of_row(rows - 1));
  if (is_c) return;
  const auto most_of_column = [&](std::size_t i) {
    const auto begin = t.candela.begin() + std::ptrdiff_t(i * rows);
    return *std::max_element(begin, begin + std::ptrdiff_t(rows));
  };
  if (t.horizontal.front() > -90) note("horizontal", t.horizontal.front(), most_of_column(0));
  if (t.horizontal.back() < 90) note("horizontal", t.horizontal.back(), most_of_column(columns - 1));
}

std::vector<std::pair<std::string, std::string>> keywords_of(std::string_view text) {
  constexpr std::size_t kMostKeywords = 1000;
  std::vector<std::pair<std::string, std::string>> all;
  while (!text.empty() && all.size() < kMostKeywords) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t close = line.find(']');
    if (!line.empty() && line.front() == '[' && close != line.npos) {
      const std::string name(line.substr(1, close - 1)), value(trimmed(line.substr(close + 1)));
      if (name == "MORE" && !all.empty())
        all.back().second += " " + value;
      else
        all.emplace_back(name, value);
    } else if (!line.empty() && !line.starts_with("IES")) {
      all.emplace_back("", std::string(line));  // a line without a keyword, as in LM-63-1986
    }
  }
  return all;
}

}  // namespace

std::optional<TextLine> find_tilt_line(std::string_view text) {
  int number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    const auto first = line.find_first_not_of(" \t");
    if (first != line.npos) {
      constexpr std::string_view kTilt = "TILT=";
      const std::string_view word = line.substr(first);
      if (word.size() >= kTilt.size() &&
          std::equal(kTilt.begin(), kTilt.end(), word.begin(),
                     [](char a, char b) { return a == std::toupper(static_cast<unsigned char>(b)); }))
        return TextLine{line, number, begin};
    }
    begin = end + 1;
  }
  return {};
}

Luminaire read_ies(const std::string& text, const std::filesystem::path& file,
                   const LuminaireOptions& options) {
  std::vector<std::string> notes;
  const TextLine tilt_line = *find_tilt_line(text);
  const int year = year_of(trimmed(std::string_view(text).substr(0, text.find('\n'))));
  NumberWords words(text, std::min(tilt_line.begin + tilt_line.text.size() + 1, text.size()),
                    tilt_line.number + 1, file);

  LampTilt tilt;
  const std::string_view line = trimmed(tilt_line.text);
  const std::string of_tilt(trimmed(line.substr(5)));
  const std::string upper = upper_case(of_tilt);
  if (upper == "INCLUDE") {
    tilt = read_tilt(words);
  } else if (upper.empty()) {
    throw fault(file, tilt_line.number, 1,
                "expected TILT=NONE, TILT=INCLUDE or TILT= and the name of a file");
  } else if (upper != "NONE") {
    const std::filesystem::path other = file.parent_path() / of_tilt;
    if (std::filesystem::path(of_tilt).has_parent_path())
      throw fault(file, tilt_line.number, 1,
                  "TILT=" + of_tilt + ": expected the name of a file in the same folder");
    if (const std::string problem = fault_of_input(other); !problem.empty())
      throw fault(file, tilt_line.number, 1, "TILT=" + of_tilt + ": " + problem);
    if (options.on_file) options.on_file(other);
    const std::string content = read_text_file(other, kMaxLuminaireBytes);
    NumberWords in_file(content, 0, 1, other);
    tilt = read_tilt(in_file);
  }

  const double lamps = words.number("the number of lamps");
  if (!(lamps >= 1 && lamps < 1e9))
    throw words.error("the number of lamps must be at least 1, got " + shown_number(lamps));
  const double lumens = words.number("the lumens per lamp");
  if (lumens < 0 && lumens != -1)
    throw words.error("the lumens per lamp must be positive, or -1 for absolute photometry, got " +
                      shown_number(lumens));
  const double multiplier = words.number("the candela multiplier");
  if (!(multiplier > 0))
    throw words.error("the candela multiplier must be positive, got " + shown_number(multiplier));
  const std::size_t rows = words.count("the number of vertical angles"),
                    columns = words.count("the number of horizontal angles");
  const double type_number = words.number("the photometric type, 1 (C), 2 (B) or 3 (A)");
  if (type_number != 1 && type_number != 2 && type_number != 3)
    throw words.error("expected the photometric type, 1 (C), 2 (B) or 3 (A), got " +
                      shown_number(type_number));
  const PhotometricType type = type_number == 1   ? PhotometricType::c
                               : type_number == 2 ? PhotometricType::b
                                                  : PhotometricType::a;
  const double units = words.number("the type of units, 1 (feet) or 2 (metres)");
  if (units != 1 && units != 2)
    throw words.error("expected the type of units, 1 (feet) or 2 (metres), got " + shown_number(units));
  const double metres = units == 1 ? 0.3048 : 1;
  const double width = words.number("the width of the luminous opening") * metres,
               length = words.number("the length of the luminous opening") * metres,
               height = words.number("the height of the luminous opening") * metres;
  const LuminousOpening opening = opening_of(width, length, height, type, words);
  for (const double size : opening.size_m)
    if (!(size < 1e4)) throw words.error(fmt::format("the luminous opening of {:g} m is too large", size));
  const double ballast = words.number("the ballast factor");
  if (!(ballast > 0)) throw words.error("the ballast factor must be positive, got " + shown_number(ballast));
  // The next number is a factor until 1995 and reserved (1) in 2002; since 2019 it is the type of the file's
  // source.
  double lamp_factor = words.number(year >= 2019   ? "the type of the file's generation"
                                    : year >= 2002 ? "the reserved number 1"
                                                   : "the ballast-lamp photometric factor");
  if (year >= 2002) {
    if (year < 2019 && lamp_factor != 1)
      notes.push_back(
          fmt::format("the number behind the ballast factor, reserved in LM-63-2002, is {:g}; it has no "
                      "effect",
                      lamp_factor));
    lamp_factor = 1;
  }
  if (!(lamp_factor > 0))
    throw words.error("the ballast-lamp photometric factor must be positive, got " +
                      shown_number(lamp_factor));
  const double watts = words.number("the input watts");

  MeasuredTable table;
  table.type = type;
  table.vertical = words.list(rows, "vertical angles");
  const bool is_c = type == PhotometricType::c;
  check_angles(table.vertical,
               is_c                         ? 0
               : type == PhotometricType::b ? -180
                                            : -90,
               is_c || type == PhotometricType::b ? 180 : 90, "vertical", words);
  table.horizontal = words.list(columns, "horizontal angles");
  check_angles(table.horizontal,
               is_c                         ? 0
               : type == PhotometricType::a ? -180
                                            : -90,
               is_c                         ? 360
               : type == PhotometricType::a ? 180
                                            : 90,
               "horizontal", words);
  const NumberWords angles = words;  // position of the angles, at which their errors are located
  if (rows < 2) throw words.error("a distribution needs at least 2 vertical angles");
  if (columns > words.left() / (2 * rows) + 1)
    throw words.error(fmt::format("the file is too short for {} x {} intensities", columns, rows));
  table.candela.resize(columns * rows);
  const double factor = multiplier * ballast * lamp_factor;
  for (double& cd : table.candela) {
    cd = words.number("an intensity");
    if (cd < 0) throw words.error("expected an intensity of 0 cd or more, got " + shown_number(cd));
    cd *= factor;
    if (!(cd < 1e15)) throw words.error(fmt::format("the intensity of {:g} cd is too large", cd));
  }
  if (!words.ends()) notes.push_back("the file goes on behind its last intensity; that is ignored");

  std::string symmetry = "none";
  if (is_c) {
    symmetry = complete_half_planes(table, notes, angles);
  } else {
    if (columns < 2) throw angles.error("a distribution of types A and B needs at least 2 horizontal angles");
    if (table.horizontal.front() == 0) mirror(table, 0), symmetry = "about the vertical plane";
  }
  note_cut_ends(table, notes);

  const bool across = is_c && options.zero_plane == LuminaireOptions::ZeroPlane::across;
  Luminaire result{
      .format = Luminaire::Format::ies,
      .standard = fmt::format("LM-63-{}", year),
      .keywords = keywords_of(std::string_view(text).substr(0, tilt_line.begin)),
      .type = type,
      .symmetry = std::move(symmetry),
      .distribution = make_distribution(table, axes_of(type, across)),
      .horizontal_count = columns,
      .vertical_count = rows,
      .opening = opening,
      .lamps = {{.count = lamps, .flux = lumens > 0 ? lamps * lumens : 0, .watts = std::max(watts, 0.0)}},
      .is_absolute = lumens < 0,
      .tilt = std::move(tilt),
      .notes = std::move(notes)};
  if (lumens == 0) result.notes.push_back("the file states 0 lm for its lamps");
  return result;
}

}  // namespace luminaire_reader

std::string ies_text(const Luminaire& luminaire) {
  const optics::IntensityDistribution& d = luminaire.distribution;
  if (luminaire.type != optics::PhotometricType::c) throw Error("files of type C alone are written");
  luminaire_reader::require_lines(luminaire);
  std::string s = "IES:LM-63-2019\n";
  for (const auto& [name, value] : luminaire.keywords) {
    if (name.empty()) continue;
    std::string rest = value;
    std::string key = "[" + name + "] ";
    constexpr std::size_t kLongestLine = 256;
    for (bool first = true; first || !rest.empty(); first = false) {
      const std::string part = rest.substr(0, kLongestLine - key.size());
      s += key + part + "\n";
      rest.erase(0, part.size());
      key = "[MORE] ";
    }
  }
  s += "TILT=NONE\n";
  const LampSet& lamps = luminaire.lamps.at(luminaire.lamp_set);
  const LuminousOpening& o = luminaire.opening;
  std::array<double, 3> size = o.size_m;
  for (std::size_t i = 0; i < 3; ++i)
    if (o.shape == LuminousOpening::Shape::ellipsoid ||
        (o.shape == LuminousOpening::Shape::cylinder && int(i) != o.axis))
      size[i] = -size[i];
  // C = 0 runs along the luminaire here.
  const bool across = d.axes().zero[0] == 0;
  const std::vector<double> planes =
      across ? luminaire_reader::turned_half_planes(d.azimuths(), 90) : d.azimuths();
  const double per_lamp = luminaire.is_absolute ? -1 : lamps.flux / lamps.count;
  s += fmt::format("{:g} {:.6g} 1 {} {} 1 2 {:.6g} {:.6g} {:.6g}\n", lamps.count, per_lamp,
                   d.polar_angles().size(), planes.size(), size[1], size[0], size[2]);
  s += fmt::format("1 1.00010 {:.6g}\n", lamps.watts);  // type 1.00010: the file comes from a simulation
  const auto add = [&](std::size_t count, const auto& number) {
    std::string line;
    for (std::size_t i = 0; i < count; ++i) {
      const std::string word = fmt::format("{:.6g}", number(i));
      if (line.size() + word.size() > 130) s += line + "\n", line.clear();
      line += (line.empty() ? "" : " ") + word;
    }
    s += line + "\n";
  };
  add(d.polar_angles().size(), [&](std::size_t j) { return d.polar_angles()[j]; });
  add(planes.size(), [&](std::size_t i) { return planes[i]; });
  for (const double c : planes)
    add(d.polar_angles().size(),
        [&](std::size_t j) { return d.at(across ? c - 90 : c, d.polar_angles()[j]); });
  return s;
}

}  // namespace aureole
