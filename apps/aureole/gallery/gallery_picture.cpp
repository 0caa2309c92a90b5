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
#include "scene_loading.h"

namespace aureole {
namespace {

/// A number of samples that jobs with a time limit never reach.
constexpr std::int64_t kMaxSamples = 65536;

Defines all_defines(const GalleryPicture& picture, GallerySize size) {
  Defines defines{{"width", std::to_string(picture.effort[size].width)},
                  {"height", std::to_string(picture.effort[size].height)}};
  for (const auto& d : picture.defines) {
    // A later value replaces an earlier one of that name: an axis overrides the table.
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
  return effort.seconds > 0 ? kMaxSamples : effort.samples;
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
  return fmt::format("{} {:016x} {}x{} {} {:g}", kVersion,
                     content_hash(elements_hash(parsed.root, references), references), effort.width,
                     effort.height, samples_of(effort), effort.seconds);
}

RenderedPicture render_picture(const GalleryPicture& picture, GallerySize size, int threads,
                               const std::filesystem::path& state, const std::atomic<bool>& stop,
                               const std::function<void(const Progress&)>& report,
                               const TableProgress& tables) {
  const auto start = std::chrono::steady_clock::now();
  LoadOptions load;
  load.defines = all_defines(picture, size);
  load.tables = table_cache();
  // exception type that is not derived from std::exception, which would become an error of the scene
  struct Stopped {};
  load.progress = [&](const std::string& object, double part) {
    if (stop) throw Stopped();
    tables(object, part);
  };
  LoadedScene scene;
  try {
    scene = load_scene(picture.scene, load);
  } catch (const Stopped&) {
    return {};
  }
  RenderOptions options;
  options.end = samples_of(picture.effort[size]);
  options.time_limit_s = picture.effort[size].seconds;
  options.threads = threads;
  // whether the picture has a time limit, which applies to a single run
  const bool timed = picture.effort[size].seconds > 0;
  if (!timed) options.state_file = state;
  RenderJob job(scene, options);
  if (!timed && std::filesystem::exists(state)) try {
      RenderState earlier = RenderState::load(state);
      if (earlier.begin == 0 && earlier.end == *options.end) job.resume(std::move(earlier));
    } catch (const Error&) {
      // Rendering starts anew: the state is damaged or belongs to another picture.
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

std::string render_command(const GalleryPicture& picture, GallerySize size) {
  std::string out = "aureole render " + quoted(picture.scene.string());
  for (const auto& [name, value] : all_defines(picture, size)) out += " -D " + quoted(name + "=" + value);
  const PictureEffort& effort = picture.effort[size];
  out += fmt::format(" --spp {}", samples_of(effort));
  if (effort.seconds > 0) out += fmt::format(" --time {:g}", effort.seconds);
  return out + " -o " + picture.name + ".exr";
}

}  // namespace aureole
