// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/cxf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <pugixml.hpp>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/pigment/text_table.h"

namespace aureole {
namespace {

/// Returns the name of an element without its namespace prefix, which differs between programs.
std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const auto colon = name.find(':');
  return colon == name.npos ? name : name.substr(colon + 1);
}

/// Returns the descendants of that name that are not inside another one of that name. Not recursive, so that
/// any depth of nesting is safe.
std::vector<pugi::xml_node> descendants(const pugi::xml_node& top, std::string_view name) {
  std::vector<pugi::xml_node> found;
  for (pugi::xml_node node = top.first_child(); node;) {
    const bool is_found = local_name(node) == name;
    if (is_found) found.push_back(node);
    if (!is_found && node.first_child()) {
      node = node.first_child();
      continue;
    }
    while (node && node != top && !node.next_sibling()) node = node.parent();
    if (!node || node == top) break;
    node = node.next_sibling();
  }
  return found;
}

class CxfReader {
public:
  explicit CxfReader(const std::string& file) : file_(file) {
    text_ = read_text_file(file, kMaxTableBytes);
    for (std::size_t i = 0; i < text_.size(); ++i)
      if (text_[i] == '\n') line_ends_.push_back(std::ptrdiff_t(i));
    // Line ends are kept, so that offsets in an element are offsets in the file.
    const pugi::xml_parse_result result = document_.load_buffer(
        text_.data(), text_.size(), pugi::parse_default & ~pugi::parse_eol, pugi::encoding_utf8);
    if (!result)
      fail(result.offset, std::string("not well-formed: ") + result.description() +
                              "; right would be elements that all end, as in <Tag Name=\"Backing\" "
                              "Value=\"0\"/> or <L>74</L>");
    const pugi::xml_node root = document_.document_element();
    if (local_name(root) != "CxF")
      fail(root,
           "expected the element CxF; a line that would be right:\n    <cc:CxF "
           "xmlns:cc=\"http://colorexchangeformat.com/CxF3-core\">");
    for (const pugi::xml_node& s : descendants(root, "ColorSpecification")) {
      const auto ranges = descendants(s, "WavelengthRange");
      if (!ranges.empty()) ranges_.emplace(s.attribute("Id").value(), ranges.front());
      instruments_.emplace(s.attribute("Id").value(), instrument_of(s));
    }
    for (const pugi::xml_node& o : descendants(root, "Object")) read_object(o);
    if (table_.samples.empty())
      fail(
          root,
          "there is no object with a reflectance or transmittance spectrum; lines that would be right:\n    " +
              element(root, "Object Name=\"ochre\" Id=\"1\"",
                      element(root, "ColorValues",
                              element(root, "ReflectanceSpectrum ColorSpecification=\"CS\" StartWL=\"400\"",
                                      "0.40 0.45 0.50"))));
    scale_per_cent();
  }
  pigment::SampleTable take() { return std::move(table_); }

private:
  [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& message) const {
    const auto [line, column] = place(offset);
    throw Error({file_, line, column}, message);
  }
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& message) const {
    // the offset of pugixml points behind the bracket
    fail(std::max<std::ptrdiff_t>(node.offset_debug() - 1, 0), message);
  }
  /// An element with this start tag and content, with the namespace prefix of another element, as a file would have it.
  static std::string element(const pugi::xml_node& like, const std::string& start,
                             const std::string& content) {
    const std::string name = like.name(),
                      prefix = name.substr(0, name.find(':') == name.npos ? 0 : name.find(':') + 1);
    const std::string end = start.substr(0, start.find(' '));
    return "<" + prefix + start + (content.empty() ? "/>" : ">" + content + "</" + prefix + end + ">");
  }
  static std::string right_line(const std::string& line) {
    return "; a line that would be right:\n    " + line;
  }

  std::pair<int, int> place(std::ptrdiff_t offset) const {
    const auto end = std::lower_bound(line_ends_.begin(), line_ends_.end(), offset);
    const std::ptrdiff_t start = end == line_ends_.begin() ? 0 : *(end - 1) + 1;
    return {int(end - line_ends_.begin()) + 1, int(offset - start) + 1};
  }

  /// Reads a number; `right` is a text that would be right.
  double number(const pugi::xml_node& node, std::string_view text, const char* what,
                const std::string& right) const {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
    const auto value = pigment::finite_number(text);
    if (!value) fail(node, fmt::format("{}: expected a number, got \"{}\"", what, text) + right_line(right));
    return *value;
  }

  /// Returns an attribute of the spectrum, or else of the wavelength range of its colour specification.
  std::optional<double> range_value(const pugi::xml_node& spectrum, const char* name) const {
    if (const auto a = spectrum.attribute(name))
      return number(spectrum, a.value(), name, fmt::format("{}=\"{}\"", name, name[0] == 'S' ? 400 : 10));
    const auto range = ranges_.find(spectrum.attribute("ColorSpecification").value());
    if (range == ranges_.end()) return {};
    if (const auto a = range->second.attribute(name))
      return number(range->second, a.value(), name,
                    element(range->second, "WavelengthRange StartWL=\"400\" Increment=\"10\"", ""));
    return {};
  }

  /// Geometry, specular component and aperture of a colour specification (GeometryChoice and Aperture of its
  /// MeasurementSpec).
  pigment::Instrument instrument_of(const pugi::xml_node& specification) {
    pigment::Instrument result;
    for (const pugi::xml_node& sphere : descendants(specification, "SphereGeometry"))
      result = sphere_of(sphere);
    for (const pugi::xml_node& choice : descendants(specification, "GeometryChoice"))
      for (const pugi::xml_node& child : choice.children()) {
        const std::string name(local_name(child));
        if (name.starts_with("Spher")) {
          result = sphere_of(child);
        } else if (!name.empty() && name != "SingleAngle" && name != "MultiAngle") {
          const std::string note = "GeometryChoice has the element " + name +
                                   ", which is not known; --geometry states the geometry";
          if (std::find(table_.notes.begin(), table_.notes.end(), note) == table_.notes.end())
            table_.notes.push_back(note);
        }
      }
    const std::string right_angles = right_line(element(
        specification, "SingleAngle",
        element(specification, "IlluminationAngle", "45") + element(specification, "MeasurementAngle", "0")));
    for (const pugi::xml_node& single : descendants(specification, "SingleAngle")) {
      const auto angle = [&](const char* name) {
        const auto found = descendants(single, name);
        if (found.empty()) fail(single, fmt::format("SingleAngle needs {}", name) + right_angles);
        return number(found.front(), found.front().text().get(), name,
                      element(single, name, name[0] == 'I' ? "45" : "0"));
      };
      const double lit = angle("IlluminationAngle"), seen = angle("MeasurementAngle");
      if ((lit == 45 && seen == 0) || (lit == 0 && seen == 45))
        result.geometry = "45_0", result.specular = "excluded";
      else
        fail(single,
             fmt::format("light from {:g} and measurement at {:g} degrees: expected 45 and 0", lit, seen) +
                 right_angles);
    }
    for (const pugi::xml_node& multiple : descendants(specification, "MultiAngle"))
      fail(multiple,

           "measurements at several angles are of surfaces that vary with angle, which no paint here does" +
               right_angles);
    for (const pugi::xml_node& aperture : descendants(specification, "Aperture"))
      result.aperture = aperture.text().get();
    return result;
  }

  /// An integrating sphere: words such as Specular_Included in the element or in those within, or the element
  /// SpecularExclusion with true or false.
  static pigment::Instrument sphere_of(const pugi::xml_node& sphere) {
    std::string words = sphere.text().get();
    for (const char* name : {"SphereGeometryConfiguration", "SphereConfiguration"})
      for (const pugi::xml_node& found : descendants(sphere, name))
        words += std::string(" ") + found.text().get();
    for (const pugi::xml_attribute& attribute : sphere.attributes())
      words += std::string(" ") + attribute.value();
    pigment::Instrument result = pigment::instrument_called(words);
    for (const pugi::xml_node& found : descendants(sphere, "SpecularExclusion"))
      result.specular = found.text().as_bool() ? "excluded" : "included";
    result.geometry = words == "Diffuse" ? "diffuse" : "d8";
    return result;
  }

  /// Notes or refuses measurements of one file by different instruments.
  void compare_instruments(const pugi::xml_node& spectrum, const pigment::Sample& sample) {
    const auto found = instruments_.find(spectrum.attribute("ColorSpecification").value());
    const pigment::Instrument now = found == instruments_.end() ? pigment::Instrument{} : found->second;
    if (table_.samples.empty()) {
      table_.instrument = now;
      return;
    }
    const pigment::Instrument& first = table_.instrument;
    if (now.geometry != first.geometry || now.specular != first.specular)
      fail(spectrum,
           fmt::format("\"{}\" was measured at {} (specular {}), the first sample at {} (specular {}): "
                       "one table has one geometry",
                       sample.name, now.geometry.empty() ? "an unknown geometry" : now.geometry,
                       now.specular.empty() ? "unknown" : now.specular,
                       first.geometry.empty() ? "an unknown geometry" : first.geometry,
                       first.specular.empty() ? "unknown" : first.specular));
    if (now.aperture != first.aperture && !has_aperture_note_) {
      has_aperture_note_ = true;
      table_.notes.push_back(fmt::format(
          "apertures differ ({} and {}): translucent layers lose more light at the edge of a small one",
          first.aperture, now.aperture));
    }
  }

  /// CxF has fractions; some programs write per cent.
  void scale_per_cent() {
    double largest = 0;
    for (const pigment::Sample& s : table_.samples)
      for (const double v : s.values) largest = std::max(largest, v);
    if (!(largest > 1.5)) return;
    for (pigment::Sample& s : table_.samples)
      for (double& v : s.values) v *= 0.01;
    table_.notes.push_back(fmt::format("values up to {:g} are taken for per cent", largest));
  }

  void read_object(const pugi::xml_node& object) {
    for (const char* kind : {"ReflectanceSpectrum", "TransmittanceSpectrum"}) {
      for (const pugi::xml_node& values : descendants(object, "ColorValues"))
        for (const pugi::xml_node& child : values.children())
          if (local_name(child) == kind) read_spectrum(object, child, kind[0] == 'T');
    }
  }

  void read_spectrum(const pugi::xml_node& object, const pugi::xml_node& spectrum, bool transmitted) {
    pigment::Sample s;
    s.quantity =
        transmitted ? pigment::Sample::Quantity::transmittance : pigment::Sample::Quantity::reflectance;
    s.line = place(spectrum.offset_debug() - 1).first;
    s.name = object.attribute("Name").value();
    if (s.name.empty()) s.name = object.attribute("Id").value();
    std::string recipe = s.name;
    s.is_named_recipe = true;
    for (const pugi::xml_node& tag : descendants(object, "Tag")) {
      const std::string name = lower_case(tag.attribute("Name").value()),
                        value = tag.attribute("Value").value();
      if (name == "paints") {
        recipe = value, s.is_named_recipe = false;
      } else if (name == "sample") {
        s.name = value;
      } else if (name == "backing" && !value.empty()) {
        s.backing = value, s.states_backing = true;
      } else if (name == "series") {
        s.series = value;
      } else if (name == "specimen") {
        s.specimen = value;
      } else if (name == "thickness_um") {
        s.thickness = 1e-6 * number(tag, value, "the tag thickness_um", right_tag(tag, "24"));
        if (!(s.thickness > 0))
          fail(tag, "the tag thickness_um must be positive, got " + value +
                        right_line(right_tag(tag, value.starts_with('-') ? value.substr(1) : "24")));
      }
    }
    try {
      if (s.is_named_recipe)
        s.paints = pigment::recipe_of_name(recipe, table_.notes);
      else if (!recipe.empty())
        s.paints = pigment::parse_recipe(recipe);
    } catch (const std::domain_error& e) {
      fail(object, std::string(e.what()) +
                       right_line(element(object, "Tag Name=\"Paints\" Value=\"red: 1 + white: 3\"", "")));
    }
    if (s.name.empty())
      fail(object, "the object has neither a name nor an Id" +
                       right_line("<" + std::string(object.name()) +
                                  " ObjectType=\"Standard\" Name=\"ochre\" Id=\"1\">"));
    read_values(spectrum, s);
    const auto start = range_value(spectrum, "StartWL"), step = range_value(spectrum, "Increment");
    if (!start)
      fail(spectrum,
           "the spectrum has no StartWL, nor has its ColorSpecification" + right_line(right_range(spectrum)));
    if (!step)
      fail(spectrum,
           "the spectrum has no Increment: neither it nor a WavelengthRange of its ColorSpecification says" +
               right_line(right_range(spectrum)));
    if (!(*step > 0))
      fail(spectrum,
           fmt::format("Increment must be positive, got {:g}", *step) + right_line(right_range(spectrum)));
    std::vector<double> nm;
    for (std::size_t i = 0; i < s.values.size(); ++i) nm.push_back(*start + *step * double(i));
    if (table_.nm.empty()) table_.nm = nm;
    if (nm != table_.nm)
      fail(
          spectrum,
          fmt::format("the spectrum of \"{}\" has {} values from {:g} nm in steps of {:g}; all need the "
                      "wavelengths of the first",
                      s.name, nm.size(), *start, *step) +
              fmt::format(
                  "; right would be {} values from {:g} nm{}", table_.nm.size(), table_.nm.front(),
                  table_.nm.size() > 1 ? fmt::format(" in steps of {:g}", table_.nm[1] - table_.nm[0]) : ""));
    compare_instruments(spectrum, s);
    table_.samples.push_back(std::move(s));
  }

  void read_values(const pugi::xml_node& spectrum, pigment::Sample& s) const {
    // The values are joined from several text nodes, since a comment within the numbers splits their text.
    for (const pugi::xml_node& text : spectrum.children()) {
      if (text.type() != pugi::node_pcdata && text.type() != pugi::node_cdata)

        fail(text, fmt::format("expected numbers, got the element {}", text.name()) +
                       right_line(element(spectrum, right_spectrum(spectrum), "0.40 0.45 0.50")));
      read_numbers(text, s);
    }
    if (s.values.empty())
      fail(spectrum, "the spectrum has no values" +
                         right_line(element(spectrum, right_spectrum(spectrum), "0.40 0.45 0.50")));
  }

  static std::string right_tag(const pugi::xml_node& tag, const std::string& value) {
    return element(tag, fmt::format("Tag Name=\"{}\" Value=\"{}\"", tag.attribute("Name").value(), value),
                   "");
  }
  static std::string right_range(const pugi::xml_node& spectrum) {
    return element(spectrum, "WavelengthRange StartWL=\"400\" Increment=\"10\"", "");
  }
  /// The start tag of a spectrum like this one, without brackets and prefix.
  static std::string right_spectrum(const pugi::xml_node& spectrum) {
    std::string start(local_name(spectrum));
    for (const pugi::xml_attribute& a : spectrum.attributes())
      start += fmt::format(" {}=\"{}\"", a.name(), a.value());
    return start;
  }
  /// A number in the place of a word: with a point where the word has a comma, or else the value before it.
  static std::string right_number(std::string word, const std::vector<double>& before) {
    std::replace(word.begin(), word.end(), ',', '.');
    if (pigment::finite_number(word)) return word;
    return before.empty() ? "0.40" : fmt::format("{:g}", before.back());
  }

  void read_numbers(const pugi::xml_node& text, pigment::Sample& s) const {
    const std::string all = text.value();
    const std::ptrdiff_t begin = text.offset_debug();  // offset of the text in the file
    for (std::size_t at = 0; (at = all.find_first_not_of(" \t\r\n", at)) != all.npos;) {
      const std::size_t end = std::min(all.find_first_of(" \t\r\n", at), all.size());
      const std::string word = all.substr(at, end - at);
      const auto value = pigment::finite_number(word);
      if (!value)
        fail(begin + std::ptrdiff_t(at),
             "expected a number, got \"" + word + "\"; right would be " + right_number(word, s.values));
      const auto [line, column] = place(begin + std::ptrdiff_t(at));
      s.values.push_back(*value), s.columns.push_back(line == s.line ? column : 0);
      at = end;
    }
  }

  const std::string& file_;
  std::string text_;
  std::vector<std::ptrdiff_t> line_ends_;
  pugi::xml_document document_;
  std::map<std::string, pugi::xml_node> ranges_;  ///< ranges of wavelengths by the Id of a ColorSpecification
  std::map<std::string, pigment::Instrument> instruments_;  ///< instruments by the Id of a ColorSpecification
  bool has_aperture_note_ = false;
  pigment::SampleTable table_;
};

}  // namespace

pigment::SampleTable read_cxf_file(const std::string& file) { return CxfReader(file).take(); }

}  // namespace aureole
