// SPDX-License-Identifier: Apache-2.0
// Splatting: pictures of Gaussian splats and of points by projection, sorting and blending.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/integrator/aov_channels.h"
#include "aureole/integrator/first_surface.h"
#include "aureole/integrator/splat/blended_light.h"
#include "aureole/integrator/splat/ray_splats.h"
#include "aureole/integrator/splat/splat_blend.h"
#include "aureole/integrator/splat/splat_scene.h"
#include "aureole/plugin/late_notes.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/path_density.h"

namespace aureole {
namespace {

/// Distance along a ray at which it leaves a box, or 0 where the ray misses the box.
float exit_of(const Bounds3& box, const Ray& ray) {
  float begin = 0, end = kInfinity;
  for (int k = 0; k < 3; ++k) {
    const float a = (box.lower[k] - ray.o[k]) / ray.d[k], b = (box.upper[k] - ray.o[k]) / ray.d[k];
    if (ray.d[k] == 0) {
      if (ray.o[k] < box.lower[k] || ray.o[k] > box.upper[k]) return 0;
      continue;
    }
    begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
  }
  return end > begin ? end : 0;
}

class SplatIntegrator final : public Integrator {
public:
  explicit SplatIntegrator(const Properties& p)
      : Integrator(p),
        settings_(SplatSettings::read(p)),
        nested_(nested_integrators(p, "integrator")),
        d65_(d65_spectrum(p.context().grid, 1)),
        measures_(p.get_bool("measures", false)) {
    if (nested_.size() > 1)
      throw p.error("integrator", "one integrator finds what is behind the splats; there are several");
    if (!nested_.empty() && settings_.background)
      throw p.error("integrator",
                    "nothing but the background is seen behind the splats: state only one of both");
    if (nested_.empty()) nested_.push_back({"", make_default<const Integrator>(p, "integrator"), {}, {}});
    if (!nested_.front().channels.empty())
      throw p.error("integrator", "has further channels; nest \"splat\" in \"aov\" instead");
  }

  SceneNeeds needs() const override { return nested_needs(nested_); }
  bool shows_emitters() const override { return behind().shows_emitters(); }
  void require_scene(const Scene& scene) const override {
    behind().require_scene(scene);
    require_splat_scene(scene, settings_, properties());
  }
  std::vector<std::string> scene_notes(const Scene& scene) const override {
    try {
      require_scene(scene);
    } catch (const Error&) {
      return {};  // There will be no picture.
    }
    std::vector<std::string> notes;
    if (!settings_.background && has_surfaces(scene)) notes = behind().scene_notes(scene);
    const auto note = [&](const char* name, const std::string& message) {
      notes.push_back(note_text(properties(), name, message));
    };
    if (follows_rays(scene, settings_)) {
      if (settings_.method == SplatSettings::Method::automatic)
        for (const char* name :
             {"sorting", "projection", "compensation", "dilation", "jacobian_limit", "evaluated_at"})
          if (properties().has(name))
            note(name, "has no effect: this sensor follows splats by rays, in their order along each");
      if (along_rays(scene)->size() == 0) note("", "none of the splats has an opacity and an extent");
      return notes;
    }
    const auto splats = projected(scene);
    if (splats->without_area() > 0)
      note("dilation",
           fmt::format("{} splats have a projection without area, which is not seen without dilation",
                       splats->without_area()));
    if (splats->footprints().empty())
      note(
          "",
          "none of the splats is seen: all are transparent, lie beside the picture, before \"near\" or beyond far_clip");
    return notes;
  }
  std::vector<std::string> aov_names() const override {
    if (!measures_) return {};
    return {"splats.R", "splats.G", "splats.B", "transmittance", "depth"};
  }
  std::vector<std::string> aov_meanings() const override {
    if (!measures_) return {};
    return {
        "red of the blended splats, in the colours that are blended", "green of the blended splats",
        "blue of the blended splats", "part of the light from behind the splats that passes",
        "distance from the camera of the splat that leaves half of that light or less, scene units; 0: none"};
  }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    Ray rays[kBatch];
    FirstSurface ends[kBatch];
    for (std::size_t i = 0; i < paths.size(); ++i) rays[i] = paths[i].ray;
    if (!settings_.background)
      find_first_surfaces(scene, {rays, paths.size()}, RayTracer::Rays::coherent, ends);

    SplatSample samples[kBatch];
    int sample_of[kBatch];
    bool is_encoded;
    if (follows_rays(scene, settings_)) {
      const auto splats_of_rays = along_rays(scene);
      for (std::size_t i = 0; i < paths.size(); ++i) {
        Ray ray = rays[i];
        ray.t_max = std::min(ray.t_max, ends[i].distance);
        splats_of_rays->blend(settings_, ray, samples[i]);
        sample_of[i] = int(i);
      }
      is_encoded = is_encoded_by(SplatConventions::of(splat_media(scene), settings_, properties()));
    } else {
      const auto projection = projected(scene);
      is_encoded = is_encoded_by(projection->conventions());
      blend_projected(scene, *projection, rays, ends, paths, samples, sample_of);
    }

    if (!settings_.background) {
      // The nested integrator begins at the first surface, or behind all media.
      for (std::size_t i = 0; i < paths.size(); ++i) {
        Path& path = paths[i];
        ends[i].move_beginning(path.ray, ends[i].distance < kInfinity
                                             ? ends[i].distance
                                             : 1.0001f * exit_of(scene.bounds(), path.ray));
      }
      behind().trace(scene, paths, splats, log);
    }
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Path& path = paths[i];
      const SplatSample& s = samples[sample_of[i]];
      path.ray = rays[i];
      if (settings_.background) path.result = {};
      const float passes = settings_.background ? 0.f : s.transmittance;
      path.result.estimate = path.result.estimate * passes +
                             single_estimate(light_of(scene, is_encoded, s, path), path.wavelengths);
      path.result.alpha = 1 - passes * (1 - path.result.alpha);
      if (!measures_) continue;
      for (int k = 0; k < 3; ++k) path.aovs[k] = s.color[k];
      path.aovs[3] = s.transmittance, path.aovs[4] = s.distance < kInfinity ? s.distance : 0.f;
    }
  }

private:
  const Integrator& behind() const { return *nested_.front().integrator; }

  std::shared_ptr<const ProjectedSplats> projected(const Scene& scene) const {
    return scene.tables().get<ProjectedSplats>(settings_.key(), [&] {
      const auto media = splat_media(scene);
      const Film& film = scene.film();
      return std::make_shared<const ProjectedSplats>(
          media, settings_, SplatConventions::of(media, settings_, properties()), *scene.sensor().pinhole(),
          scene.sensor().part, film.crop_x(), film.crop_y());
    });
  }

  /// Whether the nested integrator can find a surface: it begins at surfaces or behind all media.
  static bool has_surfaces(const Scene& scene) {
    const auto& surfaces = scene.parts().surfaces;
    return std::any_of(surfaces.begin(), surfaces.end(), [](const Primitive& part) {
      return part.bsdf && has(part.bsdf->lobes(), Lobe::reflect | Lobe::transmit);
    });
  }
  std::shared_ptr<const RaySplats> along_rays(const Scene& scene) const {
    return scene.tables().get<RaySplats>(
        settings_.key(), [&] { return std::make_shared<const RaySplats>(splat_media(scene), settings_); });
  }
  bool is_encoded_by(const SplatConventions& conventions) const {
    return settings_.blends() && conventions.colors == SplatHints::Colors::srgb;
  }

  /// Blends projected splats. Samples at one position, as those of a pixel's centre, are blended once.
  void blend_projected(const Scene& scene, const ProjectedSplats& projection, const Ray rays[],
                       const FirstSurface ends[], std::span<const Path> paths, SplatSample samples[],
                       int sample_of[]) const {
    const Vec3 eye = scene.sensor().pinhole()->to_camera.inverse().point({0, 0, 0});
    static_assert(kBatch <= kSplatLanes);
    int count = 0;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      SplatSample s;
      s.film = paths[i].film;
      if (settings_.at_pixel_center) s.film = {std::floor(s.film.x) + 0.5f, std::floor(s.film.y) + 0.5f};
      if (ends[i].distance < kInfinity) s.limit = length(rays[i].o - eye) + ends[i].distance;
      int k = 0;
      while (k < count &&
             !(samples[k].film.x == s.film.x && samples[k].film.y == s.film.y && samples[k].limit == s.limit))
        ++k;
      if (k == count) samples[count++] = s;
      sample_of[i] = k;
    }
    blend_splats(projection, settings_, {samples, std::size_t(count)});
  }

  /// The light of blended splats: their colour is a radiance in units of D65, as that of an <rgb> emitter.
  Spectrum light_of(const Scene& scene, bool is_encoded, const SplatSample& s, const Path& path) const {
    return blended_light(s.color, s.transmittance, settings_.background, is_encoded, path.wavelengths.nm,
                         d65_.eval(path.wavelengths)) *
           splat_media(scene).front()->emission_scale();
  }

  SplatSettings settings_;
  std::vector<NestedIntegrator> nested_;
  SampledSpectrum d65_;
  bool measures_;
};

std::vector<ParameterDoc> splat_rows() {
  std::vector<ParameterDoc> all = SplatSettings::rows();
  all.push_back(
      {"measures", "boolean", "", "false",
       "further channels splats.R, splats.G, splats.B (blended, before they are decoded), transmittance and depth"});
  return all;
}

AUREOLE_PLUGIN(
    SplatIntegrator, "integrator", "splat",
    PluginDoc{
        "Projects, sorts and blends the media of the type \"splats\": Gaussian splats by the formulas of 3D Gaussian splatting, "
        "points by the footprints of point-based graphics. Each convention in which viewers differ is a parameter with its "
        "published default. Surfaces are seen before and behind splats, by a nested integrator. What the scene's other integrators "
        "make of the same media is light in a medium (docs/splats.md).",
        "Kerbl, Kopanas, Leimkuehler & Drettakis 2023, \"3D Gaussian splatting for real-time radiance field rendering\"; Zwicker, "
        "Pfister, van Baar & Gross 2001, \"Surface splatting\"; Yu and others 2024, \"Mip-Splatting\"",
        splat_rows(),
        {R"(<integrator type="splat"><string name="footprint" value="3dgs"/><string name="sorting" value="camera_distance"/>
    <string name="projection" value="tangential"/><string name="color_space" value="srgb"/>
    <string name="compensation" value="off"/><float name="dilation" value="0.3"/><float name="cutoff" value="3"/>
    <float name="opacity_cap" value="0.999"/><float name="opacity_limit" value="0.004"/><float name="termination" value="0.0001"/>
    <float name="near" value="0.01"/><float name="jacobian_limit" value="1.3"/><string name="evaluated_at" value="sample"/>
    <boolean name="measures" value="true"/><integrator type="direct"/></integrator>)",
         R"(<integrator type="splat"><string name="method" value="rays"/><string name="background" value="1, 1, 1"/></integrator>)",
         R"(<integrator type="splat"><string name="footprint" value="ewa"/><string name="normalization" value="weights"/>
    <float name="depth_range" value="2"/></integrator>)"}});

}  // namespace
}  // namespace aureole
