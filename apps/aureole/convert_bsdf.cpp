// SPDX-License-Identifier: Apache-2.0
// aureole convert-bsdf: a material of a scene, or a measured file, as a file of another format.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/measured/rgl_file.h"
#include "aureole/bsdf/measured/window_file.h"
#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/find_object.h"
#include "aureole/instrument/measured/rgl_writer.h"
#include "aureole/instrument/measured/scattering_probe.h"
#include "aureole/instrument/measured/table_writers.h"
#include "aureole/instrument/wavelength_steps.h"
#include "aureole/loading/load.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

struct ConvertOptions {
  std::string input, output, basis = "full", description, format;
  std::vector<std::string> defines;
  std::vector<double> range;
  double step = 0;
  int angles = 0, azimuths = 0, resolution = 32, normals = 128, samples = 1024;
  bool make_reciprocal = false;
};

struct LoadedBsdf {
  std::shared_ptr<const Bsdf> bsdf;
  SpectralGrid grid;
};

/// Returns the BSDF plug-in that reads a measured file, by the file's extension; empty for a scene.
std::string plugin_of_file(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".bsdf") return "measured";
  if (ending == ".binary") return "merl";
  if (ending == ".csv") return "tabulated";
  if (ending != ".xml") return "";
  const std::string text = read_text_file(file, kMaxSceneBytes);
  if (text.find("<WindowElement") == text.npos) return "";
  return read_window_file(file)->is_tree() ? "tensor_tree" : "klems";
}

LoadedBsdf load_input(const ConvertOptions& options) {
  const std::size_t mark = options.input.rfind('#');
  LoadOptions load;
  load.defines = split_defines(options.defines);
  if (mark == std::string::npos) {
    if (const std::string fault = fault_of_input(options.input); !fault.empty())
      throw Error({options.input, 0, 0}, fault);
    const std::string plugin = plugin_of_file(options.input);
    if (plugin.empty())
      throw Error(
          {options.input, 0, 0},
          "is no measured file (.bsdf, .binary, .csv, .xml of WINDOW); name a material of a scene as scene.xml#id");
    std::string path;
    for (const char c : std::filesystem::absolute(options.input).string())
      path += c == '&' ? "&amp;" : c == '"' ? "&quot;" : c == '<' ? "&lt;" : std::string(1, c);
    SpectralGrid grid = SpectralGrid::over(360, 830);
    if (options.range.size() == 2) grid = SpectralGrid::over(options.range[0], options.range[1]);
    const LoadedObject loaded =
        load_object_from_string("<scene version=\"3.0.0\"><bsdf type=\"" + plugin +
                                    "\"><string name=\"filename\" value=\"" + path + "\"/></bsdf></scene>",
                                options.input, grid, load);
    for (const auto& note : loaded.notes) tell("note: {}\n", note);
    return {std::dynamic_pointer_cast<const Bsdf>(loaded.object), grid};
  }
  const std::string file = options.input.substr(0, mark), id = options.input.substr(mark + 1);
  const LoadedObjects loaded = load_objects(file, load);
  for (const auto& note : loaded.notes) tell("note: {}\n", note);
  return {find_bsdf(loaded, file, id), loaded.context->grid};
}

/// Returns `count` equidistant values from 0 to the largest.
std::vector<double> steps_to(double largest, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(largest * i / (count - 1));
  return values;
}

int convert(const ConvertOptions& options) {
  const std::filesystem::path output = options.output;
  const std::string ending = output.extension().string();
  std::string format = options.format;
  if (format.empty())
    format = ending == ".bsdf" ? "rgl" : ending == ".xml" ? "klems" : ending == ".csv" ? "csv" : "";
  if (format.empty())
    throw Error(
        {options.output, 0, 0},
        "the ending says what is written: .bsdf (RGL), .xml (Klems) or .csv (directions); or name a --format");
  const LoadedBsdf input = load_input(options);
  if (!input.bsdf) throw Error({options.input, 0, 0}, "is no BSDF");
  SpectralGrid range = input.grid;
  if (options.range.size() == 2) {
    if (!(options.range[0] > 0 && options.range[1] > options.range[0]))
      throw Error("--range: two increasing wavelengths in nm are expected");
    range.min_nm = options.range[0], range.max_nm = options.range[1];
    if (range.min_nm < input.grid.min_nm - 1e-6 || range.max_nm > input.grid.max_nm + 1e-6)
      throw Error(fmt::format("--range: the scene has wavelengths from {:g} to {:g} nm", input.grid.min_nm,
                              input.grid.max_nm));
  }
  const ScatteringProbe probe(input.bsdf, input.grid, wavelength_steps(range, options.step, 20),
                              options.make_reciprocal);
  const ScatteringReport report = examine(probe);
  fmt::print("{} ({})\n{}", options.input, input.bsdf->properties().type(), report_text(report));
  if (report.mean_asymmetry > 0.005 && !options.make_reciprocal)
    tell(
        "note: the values are not reciprocal; --make-reciprocal takes the mean of both directions of light\n");
  if (report.largest_energy() > 1.005)
    tell("note: up to {:.1f} % of the light is scattered; the values are written as they are\n",
         100 * report.largest_energy());
  if (report.has_delta && format != "klems")
    tell(
        "note: delta lobes (mirrors, clear glass) have no finite values and are left out; Klems files hold them\n");
  const bool is_isotropic = options.azimuths > 0 ? options.azimuths == 1 : report.is_isotropic;
  if (is_isotropic && !report.is_isotropic)
    tell("note: the material is anisotropic; one azimuth of incidence is written\n");
  const std::string name = options.description.empty() ? options.input : options.description;
  std::string content;
  if (format == "rgl") {
    if (report.transmits || report.reflects_below)
      tell("note: .bsdf holds reflection on the side of the normal alone\n");
    RglWriterSettings s;
    s.angles = options.angles > 0 ? options.angles : 24;
    s.azimuths = is_isotropic ? 1 : options.azimuths > 0 ? options.azimuths : 13;
    s.resolution = options.resolution, s.normals = options.normals;
    s.description = name;
    try {
      content = rgl_file_content(make_rgl_file(probe, s));
    } catch (const Error& e) {
      throw Error({options.input, 0, 0}, e.message());
    }
  } else if (format == "klems") {
    KlemsWriterSettings s;
    s.basis = options.basis == "full"   ? "LBNL/Klems Full"
              : options.basis == "half" ? "LBNL/Klems Half"
                                        : "LBNL/Klems Quarter";
    s.samples = options.samples;
    s.name = std::filesystem::path(name).filename().string(), s.manufacturer = "aureole";
    content = klems_file_content(probe, s);
  } else if (format == "csv") {
    DirectionTableSettings s;
    s.incident = steps_to(85, options.angles > 0 ? options.angles : 18);
    s.outgoing = steps_to(88, 45), s.azimuths = steps_to(360, 73);
    s.azimuths.pop_back();
    if (!is_isotropic) {
      s.incident_azimuths = steps_to(360, (options.azimuths > 0 ? options.azimuths : 12) + 1);
      s.incident_azimuths.pop_back();
    }
    s.transmits = report.transmits;
    content = direction_table_content(probe, s);
  } else {
    ZemaxSettings s;
    s.incident = steps_to(85, options.angles > 0 ? options.angles : 18);
    s.azimuths = steps_to(180, 19);
    s.radial = {0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 120, 150, 180};
    s.transmission = report.transmits;
    if (report.transmits) tell("note: Zemax files hold one side; transmission is written\n");
    content = zemax_file_content(probe, s);
  }
  write_file_atomically(output, content);
  fmt::print("wrote {} ({:.1f} kB)\n", options.output, 1e-3 * double(content.size()));
  return 0;
}

std::function<int()> declare_convert(CommandOptions& options) {
  auto o = std::make_shared<ConvertOptions>();
  options
      .add(
          "input", o->input,
          "scene.xml#id (id of a BSDF or a shape), or a measured file: .bsdf, .binary (MERL), .xml (WINDOW), .csv")
      .required();
  options.add("output", o->output, "file to write: .bsdf (RGL), .xml (Klems) or .csv (directions)")
      .required()
      .names_output();
  options.add("-D,--define", o->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  options.add("--range", o->range, "first and last wavelength in nm, as 400,700 (default: the scene's)")
      .separated_by(',')
      .takes(2);
  options.add("--step", o->step, "largest step between wavelengths in nm (default 20)").between(0.01, 1e9);
  options.add("--angles", o->angles, "angles of incidence (default 24 for .bsdf, else 18)").between(3, 90);
  options.add("--azimuths", o->azimuths, "azimuths of incidence; 1: isotropic (default: as the material is)")
      .between(1, 73);
  options.add("--resolution", o->resolution, "rows and columns of spectra of .bsdf (default 32)")
      .between(4, 256);
  options.add("--normals", o->normals, "nodes of the distribution of normals of .bsdf (default 128)")
      .between(16, 1024);
  options.add("--basis", o->basis, "angle basis of .xml: full, half or quarter (default full)")
      .one_of({"full", "half", "quarter"});
  options.add("--samples", o->samples, "samples for each incident patch of .xml (default 1024)")
      .between(16, 1 << 22);
  options.add("--description", o->description, "name of the material in the file (default: the input)");
  options.add("--format", o->format, "rgl, klems, csv or zemax (default: by the ending)")
      .one_of({"rgl", "klems", "csv", "zemax"});
  options.add("--make-reciprocal", o->make_reciprocal, "write the mean of both directions of light");
  return [o] { return convert(*o); };
}

AUREOLE_COMMAND("convert-bsdf", "Write a material or a measured file in another format of measured BSDFs",
                declare_convert);

}  // namespace
}  // namespace aureole
