// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/paint_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/instrument/paint/cxf_file.h"
#include "aureole/instrument/paint/json_place.h"
#include "aureole/pigment/cgats_text.h"
#include "aureole/pigment/domain.h"
#include "aureole/pigment/joint_fit.h"
#include "aureole/pigment/measured_paints.h"
#include "aureole/pigment/text_table.h"
#include "aureole/pigment/wavelength_interpolation.h"

namespace aureole {
namespace {

using nlohmann::json;

/// A line of a JSON table that would be right for each key.
std::string right_json_line(const std::string& key) {
  static const std::map<std::string, std::string> kLines = {
      {"wavelengths_nm", R"("wavelengths_nm": [400, 550, 700])"},
      {"samples",
       R"("samples": [{"paints": "ochre", "backing": "0.01", "thickness_um": 24, "values": [0.41, 0.45, 0.5]}])"},
      {"unit", R"("unit": "percent")"},
      {"paints", R"("paints": {"ochre": 1, "white": 9})"},
      {"components", R"("components": {"ochre": 1, "white": 9})"},
      {"sample", R"("sample": "ochre over the card")"},
      {"specimen", R"("specimen": "layer 1")"},
      {"series", R"("series": "batch 1")"},
      {"quantity", R"("quantity": "R")"},
      {"backing", R"("backing": "opaque")"},
      {"thickness_um", R"("thickness_um": 24)"},
      {"values", R"("values": [0.41, 0.45, 0.5])"},
      {"reflectance", R"("reflectance": [41, 45, 50])"},
      {"name", R"("name": "ochre")"},
      {"type", R"("type": "wavelengths")"}};
  const auto at = kLines.find(key);
  return at == kLines.end() ? "{" + kLines.at("wavelengths_nm") + ", " + kLines.at("samples") + "}"
                            : at->second;
}

/// A JSON text with its name, for the places of errors.
struct JsonText {
  std::string file, text;
};

/// A value of a JSON document and its path, such as "samples[3].values[12]", for errors.
class Item {
public:
  Item(const JsonText& text, const json& value, JsonPath path)
      : text_(text), value_(value), path_(std::move(path)) {}

  /// Throws the error at this value's place, with a line that would be right for its key.
  [[noreturn]] void fail(const std::string& message) const {
    const auto key = std::find_if(path_.rbegin(), path_.rend(), [](const JsonStep& step) {
      return std::holds_alternative<std::string>(step);
    });
    fail(message, key == path_.rend() ? "" : std::get<std::string>(*key));
  }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
  Item at(const char* key) const {
    if (!value_.is_object()) fail("expected an object with the key \"" + std::string(key) + "\"" + found());
    if (!has(key)) fail("the key \"" + std::string(key) + "\" is missing", key);
    return {text_, value_[key], extended(key)};
  }
  std::vector<Item> items() const {
    if (!value_.is_array()) fail("expected an array" + found());
    std::vector<Item> all;
    for (std::size_t i = 0; i < value_.size(); ++i) all.emplace_back(text_, value_[i], extended(i));
    return all;
  }
  std::vector<std::string> keys() const {
    std::vector<std::string> all;
    for (const auto& [key, value] : value_.items()) all.push_back(key);
    return all;
  }
  double number() const {
    if (!value_.is_number() || !std::isfinite(value_.get<double>())) fail("expected a number" + found());
    return value_.get<double>();
  }
  std::string text() const {
    if (!value_.is_string()) fail("expected a string" + found());
    return value_.get<std::string>();
  }
  std::vector<double> numbers(double scale) const {
    std::vector<double> all;
    for (const Item& i : items()) all.push_back(scale * i.number());
    return all;
  }
  bool is_object() const { return value_.is_object(); }
  bool is_array() const { return value_.is_array(); }

private:
  [[noreturn]] void fail(const std::string& message, const std::string& key) const {
    throw Error(json_place(text_.file, text_.text, path_),
                (path_.empty() ? "" : json_path_text(path_) + ": ") + message +
                    "; a line that would be right:\n    " + right_json_line(key));
  }
  JsonPath extended(JsonStep step) const {
    JsonPath path = path_;
    path.push_back(std::move(step));
    return path;
  }
  /// The value as the end of an error that quotes it.
  std::string found() const {
    constexpr std::size_t kLongest = 40;
    if (value_.is_structured()) return value_.is_array() ? ", got an array" : ", got an object";
    const std::string text = value_.dump(-1, ' ', false, json::error_handler_t::replace);
    return ", got " + (text.size() > kLongest ? text.substr(0, kLongest) + "..." : text);
  }

  const JsonText& text_;
  const json& value_;
  JsonPath path_;
};

std::vector<pigment::Component> paints_of(const Item& item) {
  std::string recipe;
  if (item.is_object())
    for (const std::string& name : item.keys()) {
      char number[32];
      std::snprintf(number, sizeof number, "%.17g", item.at(name.c_str()).number());
      recipe += (recipe.empty() ? "" : " + ") + name + ": " + number;
    }
  else
    recipe = item.text();
  if (recipe.empty()) return {};
  try {
    return pigment::parse_recipe(recipe);
  } catch (const std::domain_error& e) {
    item.fail(e.what());
  }
}

/// Returns the factor that converts the document's numbers to fractions.
double unit_of(const Item& item) {
  const std::string unit = item.has("unit") ? item.at("unit").text() : "fraction";
  if (unit != "fraction" && unit != "percent")
    item.at("unit").fail("unit must be fraction or percent, got \"" + unit + "\"");
  return unit == "percent" ? 0.01 : 1;
}

/// Returns the numbers of an array of wavelengths, which must increase.
std::vector<double> wavelengths_of(const Item& array) {
  const std::vector<Item> items = array.items();
  if (items.empty()) array.fail("there are no wavelengths");
  std::vector<double> nm;
  for (const Item& item : items) {
    const double value = item.number();
    if (!nm.empty() && !(value > nm.back()))
      item.fail("wavelengths must increase, got " + pigment::number_text(value) + " behind " +
                pigment::number_text(nm.back()));
    nm.push_back(value);
  }
  return nm;
}

/// Returns the reflectances of an array, one for each wavelength.
std::vector<double> values_of(const Item& array, double unit, std::size_t wavelengths) {
  std::vector<double> values = array.numbers(unit);
  if (values.size() != wavelengths)
    array.fail("expected " + std::to_string(wavelengths) + " values, one for each wavelength, got " +
               std::to_string(values.size()));
  return values;
}

pigment::SampleTable sample_document(const Item& document) {
  pigment::SampleTable table{wavelengths_of(document.at("wavelengths_nm")), {}};
  const double unit = unit_of(document);
  for (const Item& item : document.at("samples").items()) {
    pigment::Sample& s = table.samples.emplace_back();
    if (item.has("paints")) s.paints = paints_of(item.at("paints"));
    s.name = item.has("sample")     ? item.at("sample").text()
             : s.paints.size() == 1 ? s.paints[0].name
                                    : pigment::recipe_text(s.paints);
    if (item.has("backing")) s.backing = item.at("backing").text(), s.states_backing = true;
    if (item.has("series")) s.series = item.at("series").text();
    if (item.has("specimen")) s.specimen = item.at("specimen").text();
    if (item.has("thickness_um")) {
      s.thickness = 1e-6 * item.at("thickness_um").number();
      if (!(s.thickness > 0))
        item.at("thickness_um")
            .fail("a thickness must be positive, got " + pigment::number_text(1e6 * s.thickness));
    }
    const std::string quantity = item.has("quantity") ? item.at("quantity").text() : "R";
    if (quantity != "R" && quantity != "T")
      item.at("quantity").fail("must be R or T, got \"" + quantity + "\"");
    if (quantity == "T") s.quantity = pigment::Sample::Quantity::transmittance;
    s.values = values_of(item.at("values"), unit, table.nm.size());
  }
  return table;
}

/// Reads the layout of github.com/miciwan/PaintMixing: an array of wavelengths and samples, in per cent.
pigment::SampleTable paint_mixing(const Item& document) {
  pigment::SampleTable table;
  for (const Item& item : document.items()) {
    if (item.at("type").text() == "wavelengths") {
      table.nm = wavelengths_of(item.at("values"));
      continue;
    }
    pigment::Sample& s = table.samples.emplace_back();
    s.name = item.at("name").text();
    s.paints = paints_of(item.at(item.has("components") ? "components" : "name"));
    s.values = item.at("reflectance").numbers(0.01);
  }
  return table;
}

pigment::SampleTable read_json_samples(const std::string& file) {
  const JsonText text{file, read_text_file(file, kMaxJsonBytes)};
  json document;
  try {
    document = json::parse(text.text);
  } catch (const json::parse_error& e) {
    // The byte is that at which the parser stopped, from 1; its message repeats the place before "syntax error".
    const std::string message = e.what();
    const auto begin = message.find("syntax error");
    throw Error(place_of_byte(file, text.text, e.byte > 0 ? e.byte - 1 : 0),
                "is no JSON: " + message.substr(begin == message.npos ? 0 : begin) +
                    "; a line that would be right:\n    " + right_json_line(""));
  } catch (const json::exception& e) {
    throw Error({file, 0, 0}, std::string("is no JSON: ") + e.what());  // a number beyond all doubles
  }
  const Item item(text, document, {});
  return item.is_array() ? paint_mixing(item) : sample_document(item);
}

/// An error on a sample, with the line that would be right as a line of JSON, in the place of headings and cells at its end.
std::string with_json_line(const std::string& message) {
  const auto begin = message.find("\n    ");
  if (begin == message.npos) return message;
  std::istringstream table(message.substr(begin));
  std::vector<pigment::TextRow> rows;
  try {
    rows = pigment::read_text_table(table);
  } catch (const pigment::TextError&) {
    return message;
  }
  if (rows.size() != 2 || rows[0].cells.size() != rows[1].cells.size()) return message;
  nlohmann::ordered_json sample;
  bool is_percent = false;
  for (std::size_t c = 0; c < rows[0].cells.size(); ++c) {
    const std::string &heading = rows[0].cells[c].text, &cell = rows[1].cells[c].text;
    if (cell.empty()) continue;
    if (heading == "unit")
      is_percent = cell == "percent";
    else if (heading == "thickness_um")
      sample[heading] = pigment::number_of(rows[1], c);
    else if (pigment::finite_number(heading))  // a wavelength
      sample["values"] = nlohmann::ordered_json::array({pigment::number_of(rows[1], c)});
    else
      sample[heading] = cell;
  }
  const std::string line = sample.dump(-1, ' ', false, json::error_handler_t::replace);
  return message.substr(0, begin) + "\n    " +
         (is_percent ? R"("unit": "percent", "samples": [)" + line + "]" : line);
}

/// The path in a JSON file of a sample, or of one of its values: `index` counts the samples of the file.
JsonPath path_of_sample(const std::string& text, std::size_t index, int wavelength) {
  const json document = json::parse(text, nullptr, false);
  const bool is_of_paint_mixing = document.is_array();
  JsonPath path;
  if (is_of_paint_mixing) {
    // One of the entries holds the wavelengths.
    std::size_t entry = 0;
    for (std::size_t samples = 0; entry < document.size(); ++entry)
      if (document[entry].value("type", "") != "wavelengths" && samples++ == index) break;
    path = {entry};
  } else {
    path = {"samples", index};
  }
  if (wavelength >= 0)
    path.push_back(is_of_paint_mixing ? "reflectance" : "values"), path.push_back(std::size_t(wavelength));
  return path;
}

bool is_json_file(const std::string& file) { return lower_case(file).ends_with(".json"); }

/// Detects the format by the extension, or else by the beginning of the text. CGATS has many extensions:
/// .txt, .cgats, .ti3, .sp, .it8.
std::string kind_of(const std::string& file, const std::string& text) {
  const std::string ending = lower_case(file.substr(std::min(file.rfind('.'), file.size())));
  if (is_json_file(file)) return "json";
  if (ending == ".cxf") return "cxf";
  if (ending == ".csv") return "csv";
  if (ending == ".cgats") return "cgats";
  std::istringstream stream(text);
  std::string line;
  bool is_first = true;
  for (int number = 0; number < 1000 && std::getline(stream, line); ++number) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == line.npos) continue;
    if (is_first && line[first] == '<') return "cxf";
    is_first = false;
    if (upper_case(line).compare(first, 17, "BEGIN_DATA_FORMAT") == 0) return "cgats";
  }
  return "csv";
}

/// Throws Error for workbooks, which begin as ZIP archives or compound documents do.
void refuse_spreadsheet(const std::string& file, const std::string& bytes) {
  const bool is_archive = bytes.starts_with("PK\x03\x04"),
             is_compound = bytes.starts_with("\xD0\xCF\x11\xE0");
  if (is_archive || is_compound)
    throw Error({file, 0, 0},
                "is a spreadsheet (.xlsx, .ods, .xls), which aureole.pigment in Python reads (pip install "
                "'aureole[spreadsheet]'); for this command save its sheet as text (.csv)");
}

}  // namespace

pigment::SampleTable read_sample_file(const std::string& file, pigment::Recipes recipes) {
  if (file == kMeasuredPaints) return pigment::kimera_samples();
  pigment::SampleTable table;
  std::vector<std::string> of_text;
  const std::string bytes = read_table_file(file).str();
  refuse_spreadsheet(file, bytes);
  const std::string text = pigment::utf8_text(bytes, &of_text);
  const std::string kind = kind_of(file, text);
  if (kind == "json") {
    table = read_json_samples(file);
  } else if (kind == "cxf") {
    table = read_cxf_file(file);
  } else {
    std::istringstream stream(text);
    try {
      table = kind == "cgats" ? pigment::read_cgats(stream) : pigment::read_samples(stream, recipes);
    } catch (const pigment::TextError& e) {
      throw Error({file, e.line(), e.column()}, e.what());
    }
    table.notes.insert(table.notes.begin(), of_text.begin(), of_text.end());
  }
  located_in(file, table, [&] { return pigment::check(table), pigment::settle_backings(table), 0; });
  return table;
}

pigment::SampleTable read_sample_files(const std::vector<std::string>& files) {
  if (files.size() == 1) return read_sample_file(files.front());
  pigment::SampleTable all;
  std::vector<pigment::SampleTable> tables;
  std::map<std::string, int> cards;  ///< number of files that have a bare card of this name
  for (const std::string& file : files) {
    std::set<std::string> names;
    for (const pigment::Sample& s : tables.emplace_back(read_sample_file(file)).samples)
      if (s.paints.empty()) names.insert(s.name);
    for (const std::string& name : names) ++cards[name];
  }
  for (std::size_t f = 0; f < files.size(); ++f) {
    const std::string& file = files[f];
    pigment::SampleTable& one = tables[f];
    for (const std::string& note : one.notes) all.notes.push_back(file + ": " + note);
    if (all.nm.empty()) {
      all.nm = one.nm, all.instrument = one.instrument;
    } else if (one.instrument.geometry != all.instrument.geometry ||
               one.instrument.specular != all.instrument.specular) {
      throw Error({file, 0, 0},
                  "was measured at another geometry than " + files.front() +
                      "; one fit has one geometry: convert one of them (aureole pigment colour)");
    } else if (one.instrument.aperture != all.instrument.aperture) {
      const auto aperture = [](const pigment::SampleTable& t) {
        return t.instrument.aperture.empty() ? std::string("not stated") : t.instrument.aperture;
      };
      all.notes.push_back(file + ": the aperture is " + aperture(one) + ", that of " + files.front() + " " +
                          aperture(all) + ": translucent layers lose more light at the edge of a small one");
    }
    const std::string stem = std::filesystem::path(file).stem().string();
    const auto is_own = [&](const std::string& card) {
      return cards[card] > 1 &&
             std::any_of(one.samples.begin(), one.samples.end(),
                         [&](const pigment::Sample& s) { return s.paints.empty() && s.name == card; });
    };
    std::vector<pigment::Sample> renamed = one.samples;
    for (pigment::Sample& s : renamed) {
      if (s.paints.empty()) {
        if (is_own(s.name)) s.name = stem + ": " + s.name;
      } else {
        if (is_own(s.backing)) s.backing = stem + ": " + s.backing;
        if (s.specimen.empty() && s.backing != "opaque") s.specimen = stem + ": " + pigment::specimen_key(s);
      }
      s.file = file;
    }
    if (one.nm != all.nm) {
      // Wavelengths of the first file within the range of this file.
      std::vector<double> common;
      for (const double l : all.nm)
        if (l >= one.nm.front() && l <= one.nm.back()) common.push_back(l);
      if (common.size() < 2)
        throw Error({file, 0, 0}, "its wavelengths do not overlap those of " + files.front());
      all.notes.push_back(file + ": other wavelengths than " + files.front() + "; both are taken at " +
                          std::to_string(common.size()) +
                          " common ones, between which values are interpolated");
      const auto taken = [&](const std::vector<double>& nm, pigment::Sample& s) {
        s.values = pigment::interpolated(nm, s.values, common), s.columns.clear(), s.lines.clear();
      };
      for (pigment::Sample& s : all.samples) taken(all.nm, s);
      for (pigment::Sample& s : renamed) taken(one.nm, s);
      all.nm = std::move(common);
    }
    all.samples.insert(all.samples.end(), renamed.begin(), renamed.end());
  }
  pigment::match_card_names(all);
  return all;
}

void rethrow_located(const std::string& table_file, const pigment::SampleTable& table,
                     const std::domain_error& error) {
  const auto* of_sample = dynamic_cast<const pigment::SampleError*>(&error);
  if (!of_sample) throw Error({table_file, 0, 0}, error.what());
  const pigment::Sample& s = table.samples[of_sample->sample()];
  const std::string& file = s.file.empty() ? table_file : s.file;
  const int wavelength = of_sample->wavelength();
  const bool has_column = wavelength >= 0 && std::size_t(wavelength) < s.columns.size();
  if (s.line == 0 && is_json_file(file)) {
    // In a table that several files were joined to, samples of this file are counted; its wavelengths may differ from the table's.
    const auto before = table.samples.begin() + std::ptrdiff_t(of_sample->sample());
    const auto index = std::count_if(table.samples.begin(), before,
                                     [&](const pigment::Sample& other) { return other.file == s.file; });
    const std::string text = read_text_file(file, kMaxJsonBytes);
    const JsonPath path = path_of_sample(text, std::size_t(index), s.file.empty() ? wavelength : -1);
    const bool has_keys_of_tables = std::holds_alternative<std::string>(path.front());
    throw Error(
        json_place(file, text, path),
        json_path_text(path) + ": " + (has_keys_of_tables ? with_json_line(error.what()) : error.what()));
  }
  const int line = has_column && !s.lines.empty() ? s.lines[std::size_t(wavelength)] : s.line;
  throw Error({file, line, has_column ? s.columns[std::size_t(wavelength)] : 0}, error.what());
}

pigment::Fit fit_file(const std::string& file, const pigment::SampleTable& table,
                      const pigment::FitSettings& settings) {
  return located_in(file, table, [&] { return pigment::fit(table, settings); });
}

std::vector<pigment::Component> components_of(const pigment::Palette& palette,
                                              const std::vector<double>& fractions) {
  std::vector<pigment::Component> recipe;
  for (std::size_t i = 0; i < fractions.size(); ++i)
    if (fractions[i] > 0) recipe.push_back({palette.pigments[i].name, fractions[i]});
  return recipe;
}

json palette_json(const pigment::Palette& palette) {
  json out = {
      {"unit", pigment::unit_name(palette)},
      {"surface",
       {{"seen", palette.surface.seen}, {"through", palette.surface.through}, {"k2", palette.surface.k2}}},
      {"wavelengths_nm", palette.nm},
      {"pigments", json::array()}};
  if (palette.by_volume) out["mixing"] = "volume";
  out["theory"] = palette.streams ? "streams" : "two fluxes";
  if (palette.streams)
    out["streams"] = {{"index", palette.streams->index},
                      {"g", palette.streams->g},
                      {"geometry", pigment::name_of(palette.streams->geometry)},
                      {"specular", pigment::name_of(palette.streams->specular)}};
  for (const pigment::Pigment& p : palette.pigments) {
    json one = {{"name", p.name}, {"k", p.k}, {"s", p.s}};
    if (!p.k_error.empty()) one["k_error"] = p.k_error, one["s_error"] = p.s_error;
    if (p.density > 0) one["density"] = p.density;
    out["pigments"].push_back(std::move(one));
  }
  return out;
}

}  // namespace aureole
