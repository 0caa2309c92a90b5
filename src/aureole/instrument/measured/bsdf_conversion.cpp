// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/measured/bsdf_conversion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>

#include "aureole/bsdf/measured/rgl_file.h"
#include "aureole/bsdf/measured/window_file.h"
#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/instrument/find_object.h"
#include "aureole/instrument/measured/rgl_writer.h"
#include "aureole/instrument/measured/table_writers.h"
#include "aureole/instrument/measured/tensor_tree_writer.h"
#include "aureole/instrument/wavelength_steps.h"

namespace aureole {
namespace {

/// Returns the BSDF plug-in that reads a measured file, by the file's extension; empty for a scene.
std::string plugin_of_file(const std::filesystem::path& file) {
  const std::string ending = lower_extension(file);
  if (ending == ".bsdf") return "measured";
  if (ending == ".binary") return "merl";
  if (ending == ".csv") return "tabulated";
  if (ending != ".xml") return "";
  const std::string text = read_text_file(file, kMaxSceneBytes);
  if (text.find("<WindowElement") == text.npos) return "";
  return read_window_file(file)->is_tree() ? "tensor_tree" : "klems";
}

/// Returns `count` equidistant values from 0 to the largest.
std::vector<double> steps_to(double largest, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(largest * i / (count - 1));
  return values;
}

void check_converted_range(const std::vector<double>& range) {
  if (!range.empty() && !(range.size() == 2 && range[0] > 0 && range[1] > range[0]))
    throw Error("--range: two increasing wavelengths in nm are expected");
}

}  // namespace

ConvertibleBsdf load_convertible(const std::string& input, const LoadOptions& load,
                                 const std::vector<double>& range) {
  const std::size_t mark = input.rfind('#');
  if (mark == std::string::npos) {
    if (const std::string fault = fault_of_input(input); !fault.empty()) throw Error({input, 0, 0}, fault);
    const std::string plugin = plugin_of_file(input);
    if (plugin.empty())
      throw Error(
          {input, 0, 0},
          "is no measured file (.bsdf, .binary, .csv, .xml of WINDOW); name a material of a scene as scene.xml#id");
    std::string path;
    for (const char c : std::filesystem::absolute(input).string())
      path += c == '&' ? "&amp;" : c == '"' ? "&quot;" : c == '<' ? "&lt;" : std::string(1, c);
    SpectralGrid grid = SpectralGrid::over(360, 830);
    check_converted_range(range);
    if (range.size() == 2) grid = SpectralGrid::over(range[0], range[1]);
    const LoadedObject loaded =
        load_object_from_string("<scene version=\"3.0.0\"><bsdf type=\"" + plugin +
                                    "\"><string name=\"filename\" value=\"" + path + "\"/></bsdf></scene>",
                                input, grid, load);
    return {std::dynamic_pointer_cast<const Bsdf>(loaded.object), grid, loaded.notes};
  }
  const std::string file = input.substr(0, mark);
  const std::string id = input.substr(mark + 1);
  const LoadedObjects loaded = load_wanted_objects(file, load, has_id(id));
  return {find_bsdf(loaded, file, id), loaded.context->grid, loaded.notes};
}

std::string format_of_output(const std::string& file) {
  const std::string ending = lower_extension(file);
  if (ending == ".bsdf") return "rgl";
  if (ending == ".xml") return "klems";
  if (ending == ".csv") return "csv";
  throw Error(
      {file, 0, 0},
      "the ending says what is written: .bsdf (RGL), .xml (Klems) or .csv (directions); or name a --format");
}

ConvertedBsdf convert_bsdf(const ConvertibleBsdf& material, const std::string& input,
                           const BsdfConversionSettings& s) {
  if (!material.bsdf) throw Error({input, 0, 0}, "is no BSDF");
  check_converted_range(s.range);
  SpectralGrid range = material.grid;
  if (s.range.size() == 2) {
    range.min_nm = s.range[0], range.max_nm = s.range[1];
    if (range.min_nm < material.grid.min_nm - 1e-6 || range.max_nm > material.grid.max_nm + 1e-6)
      throw Error(fmt::format("--range: the scene has wavelengths from {:g} to {:g} nm", material.grid.min_nm,
                              material.grid.max_nm));
  }
  ScatteringProbe probe(material.bsdf, material.grid, wavelength_steps(range, s.step, 20), s.make_reciprocal);
  probe.stop_by(s.stop);
  ConvertedBsdf converted;
  converted.type = material.bsdf->properties().type();
  converted.report = examine(probe);
  const ScatteringReport& report = converted.report;
  const auto note = [&](std::string text) { converted.notes.push_back(std::move(text)); };
  const std::string& format = s.format;
  if (report.mean_asymmetry > 0.005 && !s.make_reciprocal)
    note("the values are not reciprocal; --make-reciprocal takes the mean of both directions of light");
  if (report.largest_energy() > 1.005)
    note(fmt::format("up to {:.1f} % of the light is scattered; the values are written as they are",
                     100 * report.largest_energy()));
  if (report.has_delta && format != "klems" && format != "tensor_tree")
    note(
        "delta lobes (mirrors, clear glass) have no finite values and are left out; Klems files and tensor trees hold them");
  const BsdfConversionSettings usual;
  const auto note_unused = [&](bool is_given, const char* option,
                               std::initializer_list<const char*> formats) {
    if (is_given && std::find(formats.begin(), formats.end(), format) == formats.end())
      note(fmt::format("--{} has no effect on {} files; it is for {}", option, format,
                       fmt::join(formats, ", ")));
  };
  note_unused(s.basis != usual.basis, "basis", {"klems"});
  note_unused(s.tolerance != usual.tolerance, "tolerance", {"tensor_tree"});
  note_unused(s.samples > 0, "samples", {"klems", "tensor_tree"});
  note_unused(s.normals != usual.normals, "normals", {"rgl"});
  note_unused(s.resolution > 0, "resolution", {"rgl", "tensor_tree"});
  note_unused(s.angles > 0, "angles", {"rgl", "csv", "zemax"});
  note_unused(s.azimuths > 0, "azimuths", {"rgl", "tensor_tree", "csv"});
  const bool is_isotropic = s.azimuths > 0 ? s.azimuths == 1 : report.is_isotropic;
  if (is_isotropic && !report.is_isotropic)
    note("the material is anisotropic; one azimuth of incidence is written");
  // Below the rounding of single precision averages are no repair. Light that is refracted into a body has another radiance there.
  const bool is_reciprocal = report.has_values && !report.refracts && report.mean_asymmetry < 1e-5;
  const std::string name = s.description.empty() ? input : s.description;
  std::string& content = converted.content;
  if (format == "rgl") {
    if (report.transmits || report.reflects_below)
      note(".bsdf holds reflection on the side of the normal alone");
    RglWriterSettings w;
    w.angles = s.angles > 0 ? s.angles : 24;
    w.azimuths = is_isotropic ? 1 : s.azimuths > 0 ? s.azimuths : 13;
    w.resolution = s.resolution > 0 ? s.resolution : 32, w.normals = s.normals;
    w.description = name;
    try {
      content = rgl_file_content(make_rgl_file(probe, w));
    } catch (const Error& e) {
      throw Error({input, 0, 0}, e.message());
    }
  } else if (format == "klems") {
    KlemsWriterSettings w;
    w.basis = s.basis == "full"   ? "LBNL/Klems Full"
              : s.basis == "half" ? "LBNL/Klems Half"
                                  : "LBNL/Klems Quarter";
    if (s.samples > 0) w.samples = s.samples;
    w.is_reciprocal = is_reciprocal;
    w.name = std::filesystem::path(name).filename().string(), w.manufacturer = "aureole";
    content = klems_file_content(probe, w);
  } else if (format == "tensor_tree") {
    TensorTreeSettings w;
    w.is_isotropic = is_isotropic, w.levels = is_isotropic ? 6 : 4, w.tolerance = s.tolerance;
    if (s.resolution > 0) {
      w.levels = int(std::lround(std::log2(s.resolution)));
      if (1 << w.levels != s.resolution)
        throw Error(fmt::format("--resolution {}: a power of two is expected for a tree", s.resolution));
    }
    if (s.samples > 0) w.samples = s.samples;
    w.is_reciprocal = is_reciprocal;
    w.name = std::filesystem::path(name).filename().string(), w.manufacturer = "aureole";
    content = tensor_tree_file_content(probe, w);
  } else if (format == "csv") {
    DirectionTableSettings w;
    w.incident = steps_to(85, s.angles > 0 ? s.angles : 18);
    w.outgoing = steps_to(88, 45), w.azimuths = steps_to(360, 73);
    w.azimuths.pop_back();
    if (!is_isotropic) {
      w.incident_azimuths = steps_to(360, (s.azimuths > 0 ? s.azimuths : 12) + 1);
      w.incident_azimuths.pop_back();
    }
    w.transmits = report.transmits;
    content = direction_table_content(probe, w);
  } else if (format == "zemax") {
    ZemaxSettings w;
    w.incident = steps_to(85, s.angles > 0 ? s.angles : 18);
    w.azimuths = steps_to(180, 19);
    w.radial = {0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 120, 150, 180};
    w.transmission = report.transmits;
    if (report.transmits) note("Zemax files hold one side; transmission is written");
    content = zemax_file_content(probe, w);
  } else {
    throw Error(fmt::format("\"{}\" is no format; there are rgl, klems, tensor_tree, csv, zemax", format));
  }
  return converted;
}

}  // namespace aureole
