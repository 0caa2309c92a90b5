// SPDX-License-Identifier: Apache-2.0
// Radiance grids along rays: by NeRF's discrete sum, or by the integral.
#include "aureole/integrator/aov_channels.h"
#include "aureole/integrator/first_surface.h"
#include "aureole/integrator/radiance/radiance_march.h"
#include "aureole/integrator/splat/blended_light.h"
#include "aureole/plugin/late_notes.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/path_density.h"
#include "aureole/transport/dimensions.h"

namespace aureole {
namespace {

const RadianceMedium* find_radiance_medium(const Scene& scene) {
  for (const Medium* medium : scene.media())
    if (const auto* grid = dynamic_cast<const RadianceMedium*>(medium)) return grid;
  return nullptr;
}

class RadianceFieldIntegrator final : public Integrator {
public:
  explicit RadianceFieldIntegrator(const Properties& p)
      : Integrator(p),
        settings_(RadianceSettings::read(p)),
        nested_(nested_integrators(p, "integrator")),
        d65_(d65_spectrum(p.context().grid, 1)),
        measures_(p.get_bool("measures", false)) {
    if (nested_.size() > 1)
      throw p.error("integrator", "one integrator finds what is behind the grid; there are several");
    if (!nested_.empty() && settings_.background)
      throw p.error("integrator",
                    "nothing but the background is seen behind the grid: state only one of both");
    if (nested_.empty()) nested_.push_back({"", make_default<const Integrator>(p, "integrator"), {}, {}});
    if (!nested_.front().channels.empty())
      throw p.error("integrator", "has further channels; nest \"radiance_field\" in \"aov\" instead");
  }

  SceneNeeds needs() const override { return nested_needs(nested_); }
  bool shows_emitters() const override { return behind().shows_emitters(); }
  void require_scene(const Scene& scene) const override {
    behind().require_scene(scene);
    const RadianceMedium* grid = find_radiance_medium(scene);
    if (!grid)
      throw Error(
          properties().where(),
          "\"radiance_field\" shows a medium of the type \"radiance_grid\", and the scene has none: give a "
          "shape <medium type=\"radiance_grid\" name=\"interior\">");
    for (const Medium* medium : scene.media())
      if (medium != grid)
        throw Error(
            medium->properties().where(),
            dynamic_cast<const RadianceMedium*>(medium)
                ? "\"radiance_field\" composites one radiance grid, but the scene has several: \"path\" "
                  "follows light through all of them"
                : "\"radiance_field\" shows a radiance grid alone; this medium would not be seen before or "
                  "within it");
    if (scene.sensor().sensor->medium())
      throw Error(
          scene.sensor().sensor->properties().where(),
          "\"radiance_field\" finds the grid around the sensor itself: state no medium on the sensor");
  }
  std::vector<std::string> scene_notes(const Scene& scene) const override {
    std::vector<std::string> notes;
    if (!settings_.background) notes = behind().scene_notes(scene);
    const RadianceMedium* grid = find_radiance_medium(scene);
    if (grid && settings_.blends_linear && !grid->is_encoded())
      notes.push_back(
          note_text(properties(), "color_space", "has no effect: the colours of the grid are linear"));
    return notes;
  }
  std::vector<std::string> aov_names() const override {
    if (!measures_) return {};
    return {"radiance.R", "radiance.G", "radiance.B", "transmittance", "depth"};
  }
  std::vector<std::string> aov_meanings() const override {
    if (!measures_) return {};
    return {"red of the composited grid, in the colours that are blended", "green of the composited grid",
            "blue of the composited grid", "part of the light from behind the grid that passes",
            "distance along the ray at which half of that light is lost, scene units; 0: less is lost"};
  }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    const RadianceMedium& grid = *find_radiance_medium(scene);
    Ray rays[kBatch];
    FirstSurface ends[kBatch];
    RadianceResult results[kBatch];
    for (std::size_t i = 0; i < paths.size(); ++i) rays[i] = paths[i].ray;
    if (!settings_.background)
      find_first_surfaces(scene, {rays, paths.size()}, RayTracer::Rays::coherent, ends);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Path& path = paths[i];
      Ray ray = rays[i];
      ray.t_max = std::min(ray.t_max, ends[i].distance);
      // Vertices of a walk are numbered from 0: the numbers of vertex -1 are used by none.
      results[i] = march_radiance(grid, settings_, ray, key(path.samples, -1, Stream::volume_march));
      if (settings_.background) continue;
      // The nested integrator begins at the first surface, or behind the grid.
      float from = 0;
      if (ends[i].distance < kInfinity)
        from = ends[i].distance;
      else if (const auto crossing = grid.field().cross_box(rays[i]))
        from = 1.0001f * (*crossing)[1];
      ends[i].move_beginning(path.ray, from);
    }
    if (!settings_.background) behind().trace(scene, paths, splats, log);
    const bool is_encoded = grid.is_encoded() && !settings_.blends_linear;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Path& path = paths[i];
      const RadianceResult& r = results[i];
      path.ray = rays[i];
      if (settings_.background) path.result = {};
      const float passes = settings_.background ? 0.f : r.transmittance;
      const Spectrum light = blended_light(r.color, r.transmittance, settings_.background, is_encoded,
                                           path.wavelengths.nm, d65_.eval(path.wavelengths)) *
                             grid.emission_scale();
      path.result.estimate = path.result.estimate * passes + single_estimate(light, path.wavelengths);
      path.result.alpha = 1 - passes * (1 - path.result.alpha);
      if (!measures_) continue;
      for (int k = 0; k < 3; ++k) path.aovs[k] = r.color[k];
      path.aovs[3] = r.transmittance, path.aovs[4] = r.depth;
    }
  }

private:
  const Integrator& behind() const { return *nested_.front().integrator; }

  RadianceSettings settings_;
  std::vector<NestedIntegrator> nested_;
  SampledSpectrum d65_;
  bool measures_;
};

std::vector<ParameterDoc> radiance_rows() {
  std::vector<ParameterDoc> all = RadianceSettings::rows();
  all.push_back(
      {"measures", "boolean", "", "false",
       "further channels radiance.R, radiance.G, radiance.B (blended, before they are decoded), transmittance and "
       "depth (where half of the light from behind is lost)"});
  return all;
}

AUREOLE_PLUGIN(
    RadianceFieldIntegrator, "integrator", "radiance_field",
    PluginDoc{
        "Composites the medium of the type \"radiance_grid\" along each ray, by the discrete sum of NeRF with the conventions of "
        "Plenoxels, or by the integral that it approximates. Surfaces are seen before and behind it, by a nested integrator "
        "(docs/splats.md).",
        "Mildenhall and others 2020, \"NeRF: representing scenes as neural radiance fields for view synthesis\", equation 3; "
        "Fridovich-Keil, Yu and others 2022, \"Plenoxels: radiance fields without neural networks\"; Max 1995, \"Optical models "
        "for direct volume rendering\"",
        radiance_rows(),
        {R"(<integrator type="radiance_field"><string name="method" value="nerf"/><float name="step" value="0.25"/>
    <string name="samples" value="jittered"/><string name="last_step" value="opaque"/><float name="density_limit" value="0.01"/>
    <float name="termination" value="0.001"/><boolean name="measures" value="true"/><integrator type="direct"/></integrator>)",
         R"(<integrator type="radiance_field"><string name="method" value="exact"/><string name="color_space" value="linear"/>
    <string name="background" value="1, 1, 1"/></integrator>)"}});

}  // namespace
}  // namespace aureole
