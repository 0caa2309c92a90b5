// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/instrument/info/file_info.h"
#include "aureole/instrument/info/printed_text.h"
#include "aureole/plugin/registry.h"
#include "aureole/render/output.h"
#include "aureole/render/state.h"

namespace aureole {
namespace {

/// Text of a file as one line of limited length, without control characters.
std::string one_line(std::string text) {
  constexpr std::size_t kLongest = 200;
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
  return text.size() > kLongest ? text.substr(0, kLongest - 3) + "..." : text;
}

std::string found(const ExrAttributes& a, const std::string& name, const char* otherwise = "unknown") {
  const auto at = a.strings.find("aureole:" + name);
  return at == a.strings.end() ? otherwise : one_line(at->second);
}
int number(const ExrAttributes& a, const std::string& name, int otherwise) {
  const auto at = a.integers.find("aureole:" + name);
  return at == a.integers.end() ? otherwise : at->second;
}

/// The meaning of a channel that no attribute describes, by the names in use.
std::string usual_meaning(const Image& image, const std::string& name) {
  constexpr std::string_view kVariance = "variance.";
  if (name.starts_with(kVariance))
    return "variance of the mean over replicates of " + name.substr(kVariance.size());
  if (name.starts_with("S0.") && name.ends_with("nm"))
    return "spectral radiance of the bin around " + name.substr(3, name.size() - 5) + " nm";
  const std::size_t dot = name.rfind('.');
  const std::string last = dot == std::string::npos ? name : name.substr(dot + 1);
  const std::string layer = dot == std::string::npos ? "" : " of the layer " + name.substr(0, dot);
  const char* coding = image.srgb_encoded ? ", sRGB-encoded" : ", linear";
  if (last == "R") return "red" + layer + coding;
  if (last == "G") return "green" + layer + coding;
  if (last == "B") return "blue" + layer + coding;
  if (last == "A") return "alpha" + layer;
  if (last == "Y" && image.channel("X") < 0)
    return (image.srgb_encoded ? "grey" : "luminance or grey") + layer + coding;
  if (last == "Z" && image.channel("X") < 0) return "depth" + layer + ", by the conventions of EXR";
  return "not stated";
}

void print_channels(std::string& out, const Image& image, const std::string& described) {
  add_text(out, "channels     {:<20} {:>11} {:>11} {:>11}  {}\n", "name", "lowest", "mean", "highest",
           "meaning");
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    double low = INFINITY, high = -INFINITY, sum = 0;
    std::size_t count = 0, invalid = 0;
    for (std::size_t i = c; i < image.pixels.size(); i += image.channel_count()) {
      const double v = double(image.pixels[i]);
      if (!std::isfinite(v)) {
        ++invalid;
        continue;
      }
      low = std::min(low, v), high = std::max(high, v), sum += v, ++count;
    }
    const std::string meaning = channel_meaning(described, image.channels[c]);
    add_text(out, "             {:<20} {:>11.4g} {:>11.4g} {:>11.4g}  {}{}\n", one_line(image.channels[c]),
             low, sum / double(count), high,
             one_line(meaning.empty() ? usual_meaning(image, image.channels[c]) : meaning),
             invalid ? fmt::format("; {} pixels are not finite", invalid) : "");
  }
}

/// The first sentence of an integrator's documentation; empty for an unknown one.
std::string estimate_of(const std::string& integrator) {
  const PluginInfo* plugin = Registry::instance().find("integrator", integrator);
  return plugin ? plugin->doc.summary.substr(0, plugin->doc.summary.find(". ")) : "";
}

/// Prints what aureole writes into the headers of its pictures.
void print_origin(std::string& out, const ExrAttributes& a, const Image& image,
                  const std::filesystem::path& file) {
  add_text(out, "scene        {} (hash {})\n", found(a, "scene"), found(a, "scene_hash"));
  add_text(out, "rendered by  aureole {}, integrator {}, sampler {}, seed {}, {} wavelengths per path\n",
           found(a, "version"), found(a, "integrator"), found(a, "sampler"), found(a, "seed"),
           number(a, "wavelengths", 0));
  if (const std::string estimate = estimate_of(found(a, "integrator")); !estimate.empty())
    add_text(out, "estimates    {}\n", estimate);
  const auto seconds = a.floats.find("aureole:seconds");
  const std::string adaptive = found(a, "adaptive", "none");
  add_text(out, "samples      {} per pixel, of the range {}{}{}\n", number(a, "spp", 0), found(a, "samples"),
           adaptive == "none" ? "" : ", adaptive for " + adaptive + " error",
           seconds == a.floats.end() ? "" : fmt::format(", in {:.2f} s", seconds->second));
  const int replicates = number(a, "replicates", 1), invalid = number(a, "invalid_samples", 0);
  const bool has_variances =
      std::any_of(image.channels.begin(), image.channels.end(),
                  [](const std::string& name) { return name.starts_with("variance."); });
  if (replicates > 1 && !has_variances)
    add_text(out, "noise        {} replicates, whose variances are not stored\n", replicates);
  else if (replicates > 1)
    add_text(out, "noise        variances of the mean of {} replicates, in the channels variance.*\n",
             replicates);
  else
    add_text(out, "noise        not stored (--replicates N stores variances)\n");
  if (invalid > 0) add_text(out, "invalid      {} samples were left out\n", invalid);
  const auto state = std::filesystem::path(file).replace_extension(".state");
  std::error_code ignored;
  if (std::filesystem::exists(state, ignored))
    add_text(out, "state        {} is beside it, to resume from or to merge\n", state.filename().string());
  else
    add_text(out, "state        none beside it: this render can be neither resumed nor merged\n");
}

void print_colours(std::string& out, const Image& image) {
  const bool rgb = image.channel("R") >= 0 && image.channel("G") >= 0 && image.channel("B") >= 0;
  if (!rgb) return;
  add_text(out, "colours      {}, {}\n", image.srgb_encoded ? "sRGB-encoded" : "linear",
           image.srgb_encoded        ? "primaries taken for those of sRGB"
           : image.primaries.empty() ? "primaries not stated: taken for those of sRGB"
                                     : "primaries stated: " + one_line(image.primaries));
}

/// Prints the attributes that no other line has told.
void print_attributes(std::string& out, const ExrAttributes& a) {
  const auto add = [&](const std::string& name, const std::string& value) {
    if (!name.starts_with("aureole:"))
      add_text(out, "attribute    {} = {}\n", one_line(name), one_line(value));
  };
  for (const auto& [name, value] : a.strings) add(name, value);
  for (const auto& [name, value] : a.integers) add(name, std::to_string(value));
  for (const auto& [name, value] : a.floats) add(name, fmt::format("{:.6g}", value));
}

}  // namespace

FileInfo picture_info(const std::filesystem::path& file) {
  FileInfo info{"picture", "", {}};
  std::string& out = info.text;
  ExrAttributes attributes;
  const Image image = read_image(file, &attributes);
  for (const std::string& note : image.notes) info.notes.push_back(file.string() + ": " + note);
  add_text(out, "picture      {} ({})\n", file.string(), image.format);
  add_text(out, "size         {} x {} pixels, {} channel{}{}\n", image.width, image.height,
           image.channel_count(), image.channel_count() == 1 ? "" : "s",
           image.cube_map ? ", six faces of a cube map" : "");
  if (attributes.strings.contains("aureole:scene_hash")) print_origin(out, attributes, image, file);
  if (const auto edits = attributes.strings.find("aureole:edits"); edits != attributes.strings.end())
    add_text(out, "edited       {}\n", one_line(edits->second));
  print_colours(out, image);
  print_attributes(out, attributes);
  const auto described = attributes.strings.find(kChannelsAttribute);
  print_channels(out, image, described == attributes.strings.end() ? "" : described->second);
  return info;
}

FileInfo state_info(const std::filesystem::path& file) {
  FileInfo info{"state", "", {}};
  std::string& out = info.text;
  const RenderState s = RenderState::load(file);
  const PictureIdentity& id = s.identity;
  add_text(out, "state        {}: samples of a picture, to resume from or to merge\n", file.string());
  add_text(out, "size         {} x {} pixels, channels {}\n", id.width, id.height,
           one_line(fmt::format("{}", fmt::join(s.development.names, ", "))));
  add_text(out, "scene        {} (hash {:016x})\n", one_line(id.scene), id.scene_hash);
  add_text(out, "rendered by  aureole {}, integrator {}, sampler {}, seed {}, {} wavelengths per path\n",
           one_line(id.version), one_line(id.integrator), one_line(id.sampler), id.seed, id.wavelengths);
  add_text(out, "samples      {}:{} of each pixel, {:.1f} % done in {:.2f} s{}\n", s.begin, s.end,
           100 * double(s.units_done()) / double(s.units()), s.seconds,
           id.adaptive == "none" ? "" : ", adaptive for " + id.adaptive + " error");
  if (id.replicates > 1) add_text(out, "noise        {} replicates\n", id.replicates);
  return info;
}

}  // namespace aureole
