// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/version.h"
#include "aureole/loading/references.h"
#include "aureole/loading/upgrade.h"

namespace aureole {
namespace {

/// A number of samples never reached, for jobs that end by time.
constexpr std::int64_t kManySamples = 65536;

Defines all_defines(const GalleryPicture& picture, GallerySize size) {
  Defines defines{{"width", std::to_string(picture.effort[size].width)},
                  {"height", std::to_string(picture.effort[size].height)}};
  for (const auto& d : picture.defines) {
    // The last one counts: those of an axis override those of the table.
    const auto same =
        std::find_if(defines.begin(), defines.end(), [&](const auto& e) { return e.first == d.first; });
    if (same == defines.end())
      defines.push_back(d);
    else
      same->second = d.second;
  }
  return defines;
}

std::int64_t samples_of(const PictureEffort& effort) {
  return effort.seconds > 0 ? kManySamples : effort.samples;
}

std::string quoted(const std::string& text) {
  if (!text.empty() && text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                              "_-+=.,:/@%") == std::string::npos)
    return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

std::string picture_key(const GalleryPicture& picture, GallerySize size) {
  Diagnostics diagnostics;
  const Defines defines = all_defines(picture, size);
  ParsedScene parsed = parse_scene(picture.scene, {}, defines, diagnostics);
  upgrade(parsed.root, diagnostics);
  const References references(parsed, diagnostics);
  diagnostics.throw_if_errors();
  const PictureEffort& effort = picture.effort[size];
  return fmt::format("{} {:016x} {}x{} {} {:g}", kVersion, content_hash(parsed.root, references),
                     effort.width, effort.height, samples_of(effort), effort.seconds);
}

RenderedPicture render_picture(const GalleryPicture& picture, GallerySize size, int threads,
                               const std::filesystem::path& state, const std::atomic<bool>& stop,
                               const std::function<void(const Progress&)>& report) {
  const auto start = std::chrono::steady_clock::now();
  LoadOptions load;
  load.defines = all_defines(picture, size);
  const LoadedScene scene = load_scene(picture.scene, load);
  RenderOptions options;
  options.end = samples_of(picture.effort[size]);
  options.time_limit_s = picture.effort[size].seconds;
  options.threads = threads;
  const bool timed = picture.effort[size].seconds > 0;  // a time limit counts for a single run
  if (!timed) options.state_file = state;
  RenderJob job(scene, options);
  if (!timed && std::filesystem::exists(state)) try {
      RenderState earlier = RenderState::load(state);
      if (earlier.begin == 0 && earlier.end == *options.end) job.resume(std::move(earlier));
    } catch (const Error&) {
      // The state is damaged or of another picture: start anew.
    }
  RenderedPicture out;
  out.load_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.complete = job.run(stop, report) != RenderJob::Outcome::interrupted;
  out.image = job.state().picture();
  out.invalid_samples = job.state().invalid_samples;
  out.samples = job.state().samples_everywhere();
  out.seconds = job.state().seconds;
  return out;
}

Image toned(const Image& picture, const Tone& tone) {
  int channel[3] = {picture.channel("R"), picture.channel("G"), picture.channel("B")};
  if (channel[0] < 0 || channel[1] < 0 || channel[2] < 0)
    channel[0] = channel[1] = channel[2] = std::max(0, picture.channel("Y"));
  Image out{picture.width, picture.height, {"R", "G", "B"}, {}, true};
  out.pixels.resize(std::size_t(picture.width) * picture.height * 3);
  const double gain = std::exp2(tone.exposure), b = tone.compression;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      double c[3];
      for (int k = 0; k < 3; ++k) {
        c[k] = gain * picture.at(x, y, std::size_t(channel[k]));
        if (!std::isfinite(c[k])) c[k] = 0;
      }
      const double luminance = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
      if (!(luminance > 0)) {
        for (int k = 0; k < 3; ++k) out.at(x, y, std::size_t(k)) = 0;
        continue;
      }
      const double target = std::min(1.0, b > 0 ? std::asinh(b * luminance) / std::asinh(b) : luminance);
      // Desaturates colours outside of the display's gamut, keeping hue and brightness.
      double keep = 1;
      for (double& v : c) {
        v *= target / luminance;
        if (v < 0) keep = std::min(keep, target / (target - v));
        if (v > 1) keep = std::min(keep, (1 - target) / (v - target));
      }
      for (int k = 0; k < 3; ++k)
        out.at(x, y, std::size_t(k)) =
            srgb_encode(float(std::clamp(target + keep * (c[k] - target), 0.0, 1.0)));
    }
  return out;
}

std::string render_command(const GalleryPicture& picture, GallerySize size) {
  std::string out = "aureole render " + quoted(picture.scene.string());
  for (const auto& [name, value] : all_defines(picture, size)) out += " -D " + quoted(name + "=" + value);
  const PictureEffort& effort = picture.effort[size];
  out += fmt::format(" --spp {}", samples_of(effort));
  if (effort.seconds > 0) out += fmt::format(" --time {:g}", effort.seconds);
  return out + " -o " + picture.name + ".exr";
}

}  // namespace aureole
