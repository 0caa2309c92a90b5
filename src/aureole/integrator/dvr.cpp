// SPDX-License-Identifier: Apache-2.0
// Direct volume rendering: pictures of scalar fields by the conventions of scientific visualisation.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/integrator/aov_channels.h"
#include "aureole/integrator/dvr/error_probe.h"
#include "aureole/integrator/dvr/march.h"
#include "aureole/integrator/dvr/measured_errors.h"
#include "aureole/integrator/dvr/scene_checks.h"
#include "aureole/integrator/first_surface.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/vertex.h"

namespace aureole {
namespace {

/// The light that rays lack, in all, beside what it should be, in words.
ApproximationError left_out_error(const std::vector<double>& found, const std::vector<double>& expected,
                                  std::size_t rays) {
  double sum = 0, difference = 0, squares = 0;
  const double n = double(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double d = found[i] - expected[i];
    sum += expected[i] / n, difference += d / n, squares += d * d / n;
  }
  const char* const name = "light that the volume scatters more than once or gets from surfaces";
  if (!(sum > 0)) return {fmt::format("{}: {} rays have no light", name, rays), 0, 0};
  const double error = std::sqrt(std::max(0., squares - difference * difference) / std::max(1., n - 1)) / sum;
  return {fmt::format(
              "{}, left out: the light of all rays by {:+.2g} +- {:.2g} % from that of \"path\" ({} rays)",
              name, 100 * difference / sum, 100 * error, rays),
          std::abs(difference / sum), std::abs(difference / sum)};
}

class DvrIntegrator final : public Integrator {
public:
  explicit DvrIntegrator(const Properties& p)
      : Integrator(p),
        settings_(DvrSettings::read(p)),
        nested_(nested_integrators(p, "integrator")),
        d65_(d65_spectrum(p.context().grid, 1)),
        measures_(p.get_bool("measures", false)) {
    if (nested_.size() > 1)
      throw p.error("integrator", "one integrator finds what is behind the volume; there are several");
    if (nested_.empty()) nested_.push_back({"", make_default<const Integrator>(p, "integrator"), {}, {}});
    if (!nested_.front().channels.empty())
      throw p.error("integrator", "has further channels; nest \"dvr\" in \"aov\" instead");
  }

  SceneNeeds needs() const override {
    SceneNeeds needs = nested_needs(nested_);
    needs.adds_media = true;
    return needs;
  }
  bool shows_emitters() const override { return behind().shows_emitters(); }
  void require_scene(const Scene& scene) const override {
    behind().require_scene(scene);
    DvrSceneChecks(scene, properties(), settings_).require();
  }
  std::vector<std::string> scene_notes(const Scene& scene) const override {
    std::vector<std::string> notes = behind().scene_notes(scene);
    DvrSceneChecks(scene, properties(), settings_).note(notes);
    return notes;
  }
  std::vector<ApproximationError> approximation_errors(const Scene& scene, double samples,
                                                       int threads) const override {
    const auto media = classified_media(scene);
    std::vector<ApproximationError> errors =
        measured_errors(scene, media, settings_in(scene, media), d65_, samples, threads);
    if (settings_.method == DvrSettings::Method::single_scattering && behind().properties().type() == "path")
      errors.push_back(scattering_error(scene, media, samples, threads));
    return errors;
  }
  std::vector<std::string> aov_names() const override {
    if (!measures_) return {};
    return {"optical_thickness", "value", "depth", "lookups"};
  }
  std::vector<std::string> aov_meanings() const override {
    if (!measures_) return {};
    return {
        "optical thickness along the ray",
        "number of the volume: the largest, the mean, that of the first isosurface, or where half of the light is lost",
        "distance of that number along the ray, scene units",
        "how often the numbers of the volume were looked up along the ray"};
  }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    const auto media = classified_media(scene);
    const DvrSettings settings = settings_in(scene, media);
    VolumeResult results[kBatch];
    Ray rays[kBatch];
    FirstSurface ends[kBatch];
    for (std::size_t i = 0; i < paths.size(); ++i) rays[i] = paths[i].ray;
    bool follows_all = behind().leaves() != Leaves::pixel;
    for (std::size_t i = 0; i < paths.size(); ++i) follows_all |= log.follows(int(i));
    const bool is_alone = !follows_all && behind().shows_light() && has_volumes_alone(scene);
    if (settings.method != DvrSettings::Method::xray && !is_alone)
      find_first_surfaces(scene, {rays, paths.size()}, RayTracer::Rays::coherent, ends);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Path& path = paths[i];
      // Vertices of a walk are numbered from 0, so that no walk uses the random numbers of vertex -1.
      VolumeMarch march(scene, media, settings, path, ends[i].distance, d65_,
                        key(path.samples, -1, Stream::volume_march));
      results[i] = march.follow();
      // The nested integrator begins behind the media, or at the ray's origin where there are none.
      ends[i].move_beginning(path.ray, march.end());
    }
    // Paths behind an opaque volume are not followed, unless they leave splats or are replayed.
    const auto follows = [&](std::size_t i) {
      return follows_all || (!is_alone && results[i].transmittance > 0);
    };
    for (std::size_t i = 0; i < paths.size();) {
      std::size_t end = i;
      while (end < paths.size() && follows(end)) ++end;
      if (end > i) behind().trace(scene, paths.subspan(i, end - i), splats, log);
      for (i = end; i < paths.size() && !follows(i); ++i) paths[i].result = {};
    }
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Path& path = paths[i];
      const VolumeResult& r = results[i];
      path.ray = rays[i];
      path.result.estimate =
          path.result.estimate * r.transmittance + single_estimate(r.radiance, path.wavelengths);
      path.result.alpha = 1 - r.transmittance * (1 - path.result.alpha);
      if (measures_)
        path.aovs[0] = r.optical_thickness, path.aovs[1] = r.value, path.aovs[2] = r.depth,
        path.aovs[3] = r.lookups;
    }
  }

private:
  /// The light that scattering once leaves out: that of some rays of the sensor, beside the nested integrator along the whole rays.
  ApproximationError scattering_error(const Scene& scene, const std::vector<const ClassifiedMedium*>& media,
                                      double samples, int threads) const {
    constexpr std::uint32_t kSamples = 4;  // paths along each ray
    const ErrorProbe probe(scene, media, d65_, ErrorProbe::count_of(samples, 2 * kSamples), threads);
    const std::size_t count = probe.count(), channels = aov_names().size();
    std::vector<double> found(count * kSamples), expected(count * kSamples);
    for (std::uint32_t k = 0; k < kSamples; ++k) {
      std::vector<Path> once = probe.paths(k), all = once;
      std::atomic<std::size_t> next{0};
      run_workers(threads, [&](int) {
        std::vector<Splat> splats;
        std::vector<float> aovs(kBatch * channels);
        for (std::size_t i = next.fetch_add(kBatch); i < count; i = next.fetch_add(kBatch)) {
          const std::size_t n = std::min<std::size_t>(count - i, kBatch);
          for (std::size_t j = 0; j < n; ++j) once[i + j].aovs = aovs.data() + j * channels;
          trace(scene, std::span(once).subspan(i, n), splats, {});
          behind().trace(scene, std::span(all).subspan(i, n), splats, {});
          for (std::size_t j = i; j < i + n; ++j) {
            found[k * count + j] = double(mean(once[j].result.estimate));
            expected[k * count + j] = double(mean(all[j].result.estimate));
          }
        }
      });
    }
    return left_out_error(found, expected, count);
  }
  /// Whether there is nothing to see beside the volumes: no emitter, and no surface but null ones.
  static bool has_volumes_alone(const Scene& scene) {
    const auto& surfaces = scene.parts().surfaces;
    return scene.emitters().empty() &&
           std::all_of(surfaces.begin(), surfaces.end(),
                       [](const Primitive& part) { return part.bsdf && part.bsdf->lobes() == kNullLobe; });
  }
  /// The settings with the lengths that follow from the media and the sensor.
  DvrSettings settings_in(const Scene& scene, const std::vector<const ClassifiedMedium*>& media) const {
    DvrSettings settings = settings_;
    if (!(settings.step > 0)) {
      settings.step = kInfinity;
      const float voxels = settings.method == DvrSettings::Method::splatting ? 1 : 0.5f;
      for (const ClassifiedMedium* m : media)
        settings.step = std::min(settings.step, voxels * m->field().spacing());
    }
    if (settings.method == DvrSettings::Method::splatting) {
      const FilmPart& film = scene.sensor().part;
      settings.view =
          scene.sensor().sample_ray({film.left + 0.5f * film.width, 0.5f * film.height}, {0.5f, 0.5f}).ray.d;
    }
    if (measures_) settings.termination = 0;  // The optical thickness is measured along the whole ray.
    return settings;
  }
  const Integrator& behind() const { return *nested_.front().integrator; }

  DvrSettings settings_;
  std::vector<NestedIntegrator> nested_;
  SampledSpectrum d65_;
  bool measures_;
};

std::vector<ParameterDoc> rows() {
  std::vector<ParameterDoc> all = DvrSettings::rows();
  all.push_back(
      {"measures", "boolean", "", "false",
       "further channels optical_thickness, value (the largest number for mip, the mean for average, else that where "
       "half of the light is lost), depth (where) and lookups (of the numbers along the ray)"});
  return all;
}

AUREOLE_PLUGIN(
    DvrIntegrator, "integrator", "dvr",
    PluginDoc{
        "Direct volume rendering: composites the media of the type \"classified\" along each ray by the conventions of "
        "scientific visualisation, each by its name. Surfaces are seen through them, by a nested integrator. What a "
        "scene's other integrators make of the same media is the physical picture (docs/volumes.md).",
        "Max 1995, \"Optical models for direct volume rendering\"; Levoy 1988, \"Display of surfaces from volume data\"; "
        "Engel, Kraus & Ertl 2001, \"High-quality pre-integrated volume rendering using hardware-accelerated pixel shading\"; "
        "Keller & Heidrich 2001, \"Interleaved sampling\"; Westover 1990, \"Footprint evaluation for volume rendering\"; Mueller & Crawfis 1998, \"Eliminating popping artifacts "
        "in sheet buffer-based splatting\"",
        rows(),
        {R"(<integrator type="dvr"><float name="step" value="0.01"/><string name="classification" value="preintegrated"/>
    <string name="lighting" value="gradient"/><string name="highlight" value="reflection"/><boolean name="shadows" value="true"/>
    <integer name="ambient_occlusion" value="8"/><float name="occlusion_radius" value="0.2"/>
    <integrator type="direct"/></integrator>)",
         R"(<integrator type="dvr"><string name="method" value="composite"/><string name="form" value="premultiplied"/>
    <string name="alpha" value="taylor"/><string name="order" value="back_to_front"/><float name="termination" value="0"/>
    <boolean name="jitter" value="true"/><string name="jitter_pattern" value="interleaved"/>
    <boolean name="skip_empty" value="false"/></integrator>)",
         R"(<integrator type="dvr"><string name="method" value="isosurface"/><string name="isovalues" value="0.2, 0.6"/>
    <boolean name="measures" value="true"/></integrator>)",
         R"(<integrator type="dvr"><string name="steps" value="adaptive"/><float name="tolerance" value="0.005"/></integrator>)",
         R"(<integrator type="dvr"><string name="steps" value="by_opacity"/><float name="step_opacity" value="0.01"/></integrator>)",
         R"(<integrator type="dvr"><string name="method" value="splatting"/><string name="sheets" value="image"/>
    <float name="kernel_width" value="0.7"/></integrator>)",
         R"(<integrator type="dvr"><string name="method" value="emission_absorption"/><float name="tolerance" value="0.01"/></integrator>)"}});

}  // namespace
}  // namespace aureole
