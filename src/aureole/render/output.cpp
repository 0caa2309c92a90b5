// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/render/sample_density.h"

namespace aureole {

namespace {
std::filesystem::path png_of(std::filesystem::path exr) { return exr.replace_extension(".png"); }

bool has_channel(const std::vector<std::string>& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Returns the colour channels only: R, G, B, or else Y.
Image colors_of(const Image& picture) {
  Image image{picture.width, picture.height, {"Y"}, {}, false};
  if (has_channel(picture.channels, "R")) image.channels = {"R", "G", "B"};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (const auto& name : image.channels)
        image.pixels.push_back(picture.at(x, y, size_t(picture.channel(name))));
  return image;
}

}  // namespace

void require_format(const Development& development, int replicates, const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".exr") return;
  if (extension != ".hdr" && extension != ".rgbe" && extension != ".pfm")
    throw Error("-o " + file.string() + ": the output is an .exr, .hdr or .pfm file");
  if (replicates > 1) throw Error("-o " + file.string() + ": only an .exr file can hold variances");
  const std::vector<std::string>& names = development.names;
  const bool rgb = has_channel(names, "R") && has_channel(names, "G") && has_channel(names, "B");
  const std::size_t colors = rgb ? 3 : 1, alpha = names.back() == "A";
  if (!(rgb || has_channel(names, "Y")) || names.size() > colors + alpha)
    throw Error("-o " + file.string() + ": only an .exr file can hold the channels of this picture (" +
                fmt::format("{}", fmt::join(names, ", ")) + ")");
}

ExrAttributes picture_attributes(const RenderState& s) {
  ExrAttributes a;
  a.strings["aureole:scene"] = s.identity.scene;
  a.strings["aureole:scene_hash"] = fmt::format("{:016x}", s.identity.scene_hash);
  a.strings["aureole:version"] = s.identity.version;
  a.strings["aureole:seed"] = std::to_string(s.identity.seed);
  a.strings["aureole:sampler"] = s.identity.sampler;
  a.strings["aureole:integrator"] = s.identity.integrator;
  a.strings["aureole:samples"] = fmt::format("{}:{}", s.begin, s.end);
  a.strings["aureole:adaptive"] = s.identity.adaptive;
  a.floats["aureole:mean_density"] = float(mean_density(s.density));
  if (!s.development.meanings.empty())
    a.strings[kChannelsAttribute] = channels_attribute(s.development.names, s.development.meanings);
  if (!s.approximations.empty())
    a.strings["aureole:approximations"] = fmt::format("{}", fmt::join(s.approximations, "\n"));
  a.integers["aureole:spp"] = int(s.samples_everywhere());
  a.integers["aureole:replicates"] = s.identity.replicates;
  a.integers["aureole:wavelengths"] = s.identity.wavelengths;
  a.integers["aureole:invalid_samples"] = int(s.invalid_samples);
  a.floats["aureole:seconds"] = float(s.seconds);
  if (s.development.names.end() != std::find_if(s.development.names.begin(), s.development.names.end(),
                                                [](const auto& name) { return name.starts_with("S0."); })) {
    // Attributes required by the OpenEXR layout for spectral images, which defines no unit per nm.
    a.strings["spectralLayoutVersion"] = "1.0";
    a.strings["emissiveUnits"] = "W.m^-2.sr^-1";
  }
  return a;
}

void write_picture(const RenderState& s, const Image& picture, const std::filesystem::path& file) {
  const bool single = s.development.half && s.identity.replicates == 1;
  const std::string extension = lower_extension(file);
  if (extension == ".exr")
    write_exr(file, picture, single ? ExrPixel::half : ExrPixel::float32, picture_attributes(s));
  else if (extension == ".pfm")
    write_pfm(file, colors_of(picture));
  else
    write_hdr(file, colors_of(picture));
}

void write_pictures(const RenderState& s, const std::filesystem::path& file,
                    const std::optional<Tone>& tone) {
  write_picture(s, s.picture(), file);
  write_preview(s, file, tone);
}

void write_preview(const RenderState& s, const std::filesystem::path& file, const std::optional<Tone>& tone) {
  const Image rgb = s.rgb_picture();
  write_png(png_of(file), tone ? toned(rgb, *tone) : display_picture(rgb));
}

}  // namespace aureole
