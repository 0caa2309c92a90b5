// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/spectrum_files.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <pugixml.hpp>
#include <sstream>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/version.h"

namespace aureole {
namespace {

std::string ending_of(const std::string& file) { return lower_extension(file); }

/// A cell of a text table: in quotes where it holds a separator.
std::string cell(std::string text) {
  if (text.find_first_of(",;\t\"\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c == '\n' ? ' ' : c);
  return quoted + "\"";
}

const char* quantity_of(const pigment::Sample& s) {
  return s.quantity == pigment::Sample::Quantity::transmittance ? "T" : "R";
}

std::string csv_of(const pigment::SampleTable& table, const std::string& geometry) {
  std::string text =
      fmt::format("# geometry {}; fractions; made by aureole {}\nsample,paints,quantity", geometry, kVersion);
  for (const double nm : table.nm) text += fmt::format(",{:g}", nm);
  text += "\n";
  for (const pigment::Sample& s : table.samples) {
    text += fmt::format("{},{},{}", cell(s.name), cell(pigment::recipe_text(s.paints)), quantity_of(s));
    for (const double v : s.values) text += fmt::format(",{:.7g}", v);
    text += "\n";
  }
  return text;
}

std::string cgats_of(const pigment::SampleTable& table, const std::string& geometry) {
  const auto quoted = [](std::string text) {
    for (char& c : text)
      if (c == '"' || c == '\n') c = '\'';
    return "\"" + text + "\"";
  };
  std::string text = fmt::format(
      "CGATS.17\n\nORIGINATOR \"aureole {}\"\nMEASUREMENT_GEOMETRY \"{}\"\nNUMBER_OF_FIELDS {}\nBEGIN_DATA_FORMAT\n"
      "SAMPLE_ID SAMPLE_NAME QUANTITY",
      kVersion, geometry, 3 + table.nm.size());
  for (const double nm : table.nm) text += fmt::format(" SPECTRAL_NM{:g}", nm);
  text += fmt::format("\nEND_DATA_FORMAT\nNUMBER_OF_SETS {}\nBEGIN_DATA\n", table.samples.size());
  int id = 0;
  for (const pigment::Sample& s : table.samples) {
    text += fmt::format("{} {} {}", ++id, quoted(s.name), quantity_of(s));
    for (const double v : s.values) text += fmt::format(" {:.7g}", v);
    text += "\n";
  }
  return text + "END_DATA\n";
}

std::string cxf_of(const std::string& file, const pigment::SampleTable& table, const std::string& geometry) {
  const double step = table.nm.size() > 1 ? table.nm[1] - table.nm[0] : 10;
  for (std::size_t i = 1; i < table.nm.size(); ++i)
    if (std::abs(table.nm[i] - table.nm[i - 1] - step) > 1e-6 * step)
      throw Error({file, 0, 0}, "CxF needs equal steps of wavelength; write .csv or .cgats instead");
  pugi::xml_document document;
  pugi::xml_node root = document.append_child("cc:CxF");
  root.append_attribute("xmlns:cc") = "http://colorexchangeformat.com/CxF3-core";
  root.append_child("cc:FileInformation").append_child("cc:Creator").text() =
      fmt::format("aureole {}", kVersion).c_str();
  pugi::xml_node resources = root.append_child("cc:Resources"),
                 objects = resources.append_child("cc:ObjectCollection");
  int id = 0;
  for (const pigment::Sample& s : table.samples) {
    pugi::xml_node object = objects.append_child("cc:Object");
    object.append_attribute("ObjectType") = "Standard";
    object.append_attribute("Name") = s.name.c_str();
    object.append_attribute("Id") = fmt::format("o{}", ++id).c_str();
    pugi::xml_node spectrum =
        object.append_child("cc:ColorValues")
            .append_child(quantity_of(s)[0] == 'T' ? "cc:TransmittanceSpectrum" : "cc:ReflectanceSpectrum");
    spectrum.append_attribute("ColorSpecification") = "instrument";
    spectrum.append_attribute("StartWL") = table.nm.front();
    spectrum.append_attribute("Increment") = step;
    std::string values;
    for (const double v : s.values) values += fmt::format("{}{:.7g}", values.empty() ? "" : " ", v);
    spectrum.text() = values.c_str();
    if (!s.paints.empty()) {
      pugi::xml_node tag = object.append_child("cc:TagCollection").append_child("cc:Tag");
      tag.append_attribute("Name") = "PAINTS";
      tag.append_attribute("Value") = pigment::recipe_text(s.paints).c_str();
    }
  }
  pugi::xml_node specification =
      resources.append_child("cc:ColorSpecificationCollection").append_child("cc:ColorSpecification");
  specification.append_attribute("Id") = "instrument";
  pugi::xml_node measurement = specification.append_child("cc:MeasurementSpec");
  pugi::xml_node choice = measurement.append_child("cc:GeometryChoice");
  const pigment::Instrument instrument = pigment::instrument_called(geometry);
  if (instrument.geometry == "45_0") {
    const bool lit_at_45 = geometry.starts_with("45");
    pugi::xml_node single = choice.append_child("cc:SingleAngle");
    single.append_child("cc:SingleAngleConfiguration").text() =
        geometry.find('a') != geometry.npos ? "Annular" : "Directional";
    single.append_child("cc:IlluminationAngle").text() = lit_at_45 ? 45 : 0;
    single.append_child("cc:MeasurementAngle").text() = lit_at_45 ? 0 : 45;
  } else if (!instrument.geometry.empty()) {
    choice.append_child("cc:SphereGeometry").append_child("cc:SphereConfiguration").text() =
        instrument.specular == "excluded" ? "Specular_Excluded" : "Specular_Included";
  } else {
    measurement.remove_child(choice);
  }
  pugi::xml_node range = measurement.append_child("cc:WavelengthRange");
  range.append_attribute("StartWL") = table.nm.front();
  range.append_attribute("Increment") = step;
  std::ostringstream text;
  document.save(text, " ", pugi::format_default, pugi::encoding_utf8);
  return text.str();
}

}  // namespace

void require_spectrum_file(const std::string& file) {
  const std::string ending = ending_of(file);
  if (ending != ".csv" && ending != ".cxf" && ending != ".txt" && ending != ".cgats")
    throw Error({file, 0, 0},
                "the ending says what is written: .csv, .cxf (CxF 3) or .cgats, .txt (CGATS.17)");
}

std::string spectrum_file_content(const std::string& file, const pigment::SampleTable& table,
                                  const std::string& geometry) {
  require_spectrum_file(file);
  const std::string ending = ending_of(file);
  return ending == ".csv"   ? csv_of(table, geometry)
         : ending == ".cxf" ? cxf_of(file, table, geometry)
                            : cgats_of(table, geometry);
}

}  // namespace aureole
