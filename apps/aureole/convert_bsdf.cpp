// SPDX-License-Identifier: Apache-2.0
// aureole convert-bsdf: a material of a scene, or a measured file, as a file of another format.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "aureole/core/output_file.h"
#include "aureole/instrument/measured/bsdf_conversion.h"
#include "command.h"
#include "interruption.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {
namespace {

struct ConvertOptions : BsdfConversionSettings {
  std::string input, output;
  std::vector<std::string> defines;
};

int convert(ConvertOptions o) {
  if (o.format.empty()) o.format = format_of_output(o.output);
  LoadOptions load = load_options(o.defines);
  const ConvertibleBsdf material = load_convertible(o.input, load, o.range);
  for (const auto& note : material.notes) tell("note: {}\n", note);
  o.stop = &stop_on_interrupt();
  const ConvertedBsdf converted = convert_bsdf(material, o.input, o);
  fmt::print("{} ({})\n{}", o.input, converted.type, report_text(converted.report));
  for (const auto& note : converted.notes) tell("note: {}\n", note);
  write_file_atomically(o.output, converted.content);
  fmt::print("wrote {} ({:.1f} kB)\n", o.output, 1e-3 * double(converted.content.size()));
  return 0;
}

std::function<int()> declare_convert(CommandOptions& options) {
  auto o = std::make_shared<ConvertOptions>();
  options
      .add(
          "input", o->input,
          "scene.xml#id (id of a BSDF or a shape), or a measured file: .bsdf, .binary (MERL), .xml (WINDOW), .csv")
      .required();
  options
      .add("output", o->output, "file to write: .bsdf (RGL), .xml (Klems, tensor tree) or .csv (directions)")
      .required()
      .names_output();
  options.add("-D,--define", o->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--range", o->range, "first and last wavelength in nm, as 400,700 (default: the scene's)")
      .separated_by(',')
      .takes(2);
  options.add("--step", o->step, "largest step between wavelengths in nm (default 20)").between(0.01, 1e9);
  options.add("--angles", o->angles, "angles of incidence (default 24 for .bsdf, else 18)").between(3, 90);
  options.add("--azimuths", o->azimuths, "azimuths of incidence; 1: isotropic (default: as the material is)")
      .between(1, 73);
  options
      .add(
          "--resolution", o->resolution,
          "rows and columns of spectra of .bsdf (default 32), or cells along each axis of a tensor tree (default 64, "
          "anisotropic 16)")
      .between(4, 256);
  options.add("--tolerance", o->tolerance, "cells of a tensor tree that differ by less are merged")
      .between(0, 10)
      .shows_default();
  options.add("--normals", o->normals, "nodes of the distribution of normals of .bsdf (default 128)")
      .between(16, 1024);
  options.add("--basis", o->basis, "angle basis of .xml: full, half or quarter (default full)")
      .one_of({"full", "half", "quarter"});
  options
      .add("--samples", o->samples,
           "samples for each incident patch of .xml (default 1024, tensor tree 4096)")
      .between(16, 1 << 22);
  options.add("--description", o->description, "name of the material in the file (default: the input)");
  options.add("--format", o->format, "rgl, klems, tensor_tree, csv or zemax (default: by the ending)")
      .one_of({"rgl", "klems", "tensor_tree", "csv", "zemax"});
  options.add("--make-reciprocal", o->make_reciprocal, "write the mean of both directions of light");
  return [o] { return convert(*o); };
}

AUREOLE_COMMAND("convert-bsdf", "Write a material or a measured file in another format of measured BSDFs",
                declare_convert);

}  // namespace
}  // namespace aureole
