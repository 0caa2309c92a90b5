// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/plan.h"

#include <fmt/format.h>

#include "aureole/core/memory.h"
#include "aureole/core/version.h"
#include "aureole/render/unit_renderer.h"
#include "aureole/transport/dimensions.h"

namespace aureole {

namespace {

void require_range(const Film& film, const RenderOptions& options, std::int64_t end) {
  if (end <= options.begin || options.begin < 0)
    throw Error(fmt::format("nothing to render: samples {}:{}", options.begin, end));
  if (options.begin % kSampleBlock != 0)
    throw Error(
        fmt::format("samples {}:{}: the first must be a multiple of {} (try {}), so that parts rendered "
                    "apart make the same picture",
                    options.begin, end, kSampleBlock, options.begin / kSampleBlock * kSampleBlock));
  if (options.replicates < 1) throw Error("there must be at least one replicate");
  if (2 * FilterTable(film.filter()).border() + 1 > FilterTable::kMaxReach)
    throw Error(film.filter().properties().where(), "the reconstruction filter is wider than 65 pixels");
  // The samplers' index is a 32-bit number, which bounds the samples of a pixel.
  if (end > std::int64_t(1) << 32)
    throw Error(fmt::format("samples {}:{}: at most 2^32 samples per pixel", options.begin, end));
}

/// Returns the target of adaptive sampling that the options or the sampler request, `none` if the range has
/// less than a block of samples. Throws Error if the integrator does not support it.
AdaptiveTarget adaptive_of(const Scene& scene, const Integrator& integrator, const RenderOptions& options,
                           std::int64_t end) {
  // With less than a block of samples, the pilot would be more than half of the work.
  if (end - options.begin < kSampleBlock) return AdaptiveTarget::none;
  const AdaptiveTarget adaptive = options.adaptive.value_or(scene.sensor().sampler().adaptive());
  if (adaptive == AdaptiveTarget::none) return adaptive;
  if (integrator.leaves() != Integrator::Leaves::pixel)
    throw Error(
        integrator.properties().where(),
        fmt::format(
            "paths of \"{}\" leave light on any pixel: they can't be adaptive to pixels (\"adaptive\" "
            "of the sampler, or --adaptive, must be none)",
            integrator.properties().type()));
  if (end > (std::int64_t(1) << 32) >> kMaxDensityExponent)
    throw Error(fmt::format("samples {}:{}: at most 2^{} samples per pixel where they are adaptive",
                            options.begin, end, 32 - kMaxDensityExponent));
  return adaptive;
}

void require_memory(const Film& film, const PictureIdentity& id, const RenderOptions& options,
                    std::int64_t end) {
  // The state exists twice while it is saved or displayed.
  const double sampled = double(id.width + 2 * id.border) * (id.height + 2 * id.border);
  const double pilot =
      id.adaptive == name_of(AdaptiveTarget::none)
          ? 0
          : UnitRenderer::pilot_bytes(sampled, id.measured_channels, options.begin) + density_bytes(sampled);
  const double needed = 2 * state_bytes(id) + pilot, available = available_memory_bytes();
  if (needed > 0.8 * available)
    throw Error(
        film.properties().where(),
        fmt::format("a picture of {} x {} pixels and {} samples{} needs about {:.1f} GiB of memory, and "
                    "{:.1f} GiB are "
                    "available: render it in "
                    "parts with crop_offset_x, crop_width, ... or --samples",
                    id.width, id.height, end - options.begin,
                    id.replicates > 1 ? fmt::format(" and {} replicates", id.replicates) : "",
                    needed / (1 << 30), available / (1 << 30)));
}

}  // namespace

Development development_of(const Film& film, const std::vector<std::string>& aovs,
                           const std::vector<std::string>& aov_meanings) {
  Development d;
  d.names = film.channel_names();
  d.half = film.pixel_type() == ExrPixel::half;
  const size_t channels = size_t(film.measured_channels());
  const bool alpha = d.names.back() == "A";
  const size_t own_rows = d.names.size() - (alpha ? 1 : 0);
  d.rows.assign(own_rows + aovs.size(), std::vector<float>(channels + aovs.size()));
  d.rgb_rows.assign(3, std::vector<float>(channels + aovs.size()));
  std::vector<float> out(d.names.size());
  for (size_t k = 0; k < channels; ++k) {
    std::vector<double> unit(channels, 0.0);
    unit[k] = 1;
    film.develop(unit.data(), 0, out.data());
    for (size_t c = 0; c < own_rows; ++c) d.rows[c][k] = out[c];
    float rgb[3];
    film.develop_rgb(unit.data(), rgb);
    for (size_t c = 0; c < 3; ++c) d.rgb_rows[c][k] = rgb[c];
  }
  d.names.insert(d.names.begin() + std::ptrdiff_t(own_rows), aovs.begin(), aovs.end());
  d.meanings = film.channel_meanings();
  d.meanings.insert(d.meanings.begin() + std::ptrdiff_t(own_rows), aov_meanings.begin(), aov_meanings.end());
  for (size_t k = 0; k < aovs.size(); ++k) d.rows[own_rows + k][channels + k] = 1;
  return d;
}

void divide_for_denoising(const LoadedScene& loaded, RenderOptions& options) {
  if (options.replicates > 1) return;
  constexpr std::int64_t kMostReplicates = 4;
  const std::int64_t samples = options.end ? *options.end : loaded.scene->sensor().sampler().sample_count();
  const std::int64_t replicates =
      std::clamp<std::int64_t>(samples / kSampleBlock, std::min<std::int64_t>(samples, 2), kMostReplicates);
  if (replicates < 2) return;
  options.replicates = int(replicates);
  options.end = (samples + replicates - 1) / replicates;
}

RenderState planned_state(const LoadedScene& loaded, const RenderOptions& options) {
  if (!loaded.integrator) throw Error("the scene has no integrator");
  const Scene& scene = *loaded.scene;
  const Integrator& integrator = *loaded.integrator;
  const Film& film = scene.film();
  const Sampler& sampler = scene.sensor().sampler();
  const std::int64_t end = options.end.value_or(sampler.sample_count());
  integrator.require_scene(scene);
  if (scene.sensor().disperses() && integrator.leaves() != Integrator::Leaves::pixel)
    throw Error(
        integrator.properties().where(),
        "\"" + integrator.properties().type() + "\" connects light with the sensor, which a \"" +
            scene.sensor().properties().type() +
            "\" does not allow: use an integrator that follows paths from the sensor alone, such as \"path\"");
  if (scene.changes() && scene.sensor().sensor->exposure().readout > 0 &&
      integrator.leaves() != Integrator::Leaves::pixel)
    throw scene.sensor().properties().error(
        "readout_time",
        "\"" + integrator.properties().type() +
            "\" leaves light anywhere on the film, whose rows are exposed at different times: use an "
            "integrator that follows paths from the sensor alone, such as \"path\"");
  require_range(film, options, end);
  const std::vector<std::string> aovs = integrator.aov_names();
  PictureIdentity id;
  id.scene = loaded.file.filename().string();
  id.version = kVersion;
  id.random_version = kRandomVersion;
  id.sampler = sampler.properties().type();
  id.integrator = integrator.properties().type();
  id.scene_hash = loaded.hash;
  id.adaptive = name_of(adaptive_of(scene, integrator, options, end));
  id.seed = options.seed.value_or(sampler.seed());
  id.wavelengths = kWavelengths;
  id.width = film.crop_width(), id.height = film.crop_height();
  id.border = film.sample_border() ? FilterTable(film.filter()).border() : 0;
  id.measured_channels = film.measured_channels() + int(aovs.size());
  id.splat_channels = integrator.leaves() == Integrator::Leaves::both ? film.measured_channels() : 0;
  id.replicates = options.replicates;
  require_memory(film, id, options, end);
  return RenderState(std::move(id), development_of(film, aovs, integrator.aov_meanings()), options.begin,
                     end);
}

}  // namespace aureole
