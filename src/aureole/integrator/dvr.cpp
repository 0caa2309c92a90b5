// SPDX-License-Identifier: Apache-2.0
// Direct volume rendering: pictures of scalar fields by the conventions of scientific visualisation.
#include <fmt/format.h>

#include "aureole/integrator/aov_channels.h"
#include "aureole/integrator/dvr/first_surface.h"
#include "aureole/integrator/dvr/march.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/vertex.h"

namespace aureole {
namespace {

std::vector<const ClassifiedMedium*> classified_media(const Scene& scene) {
  std::vector<const ClassifiedMedium*> media;
  for (const Medium* medium : scene.media())
    if (const auto* classified = dynamic_cast<const ClassifiedMedium*>(medium)) media.push_back(classified);
  return media;
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

  SceneNeeds needs() const override { return nested_needs(nested_); }
  bool shows_emitters() const override { return behind().shows_emitters(); }
  void require_scene(const Scene& scene) const override {
    behind().require_scene(scene);
    const auto media = classified_media(scene);
    if (media.empty())
      throw Error(
          properties().where(),
          "\"dvr\" shows media of the type \"classified\", and the scene has none: give a shape that encloses the "
          "volume <medium type=\"classified\" name=\"interior\">");
    for (const Medium* medium : scene.media())
      if (!dynamic_cast<const ClassifiedMedium*>(medium))
        throw Error(
            medium->properties().where(),
            "\"dvr\" shows media of the type \"classified\" alone, which no instance holds; this one would not be seen "
            "before or within them");
    if (scene.sensor().sensor->medium())
      throw Error(scene.sensor().sensor->properties().where(),
                  "\"dvr\" finds the media around the sensor itself: state none on the sensor");
    using enum DvrSettings::Method;
    const DvrSettings::Method method = settings_.method;
    const bool is_by_opacity = settings_.steps == DvrSettings::Steps::by_opacity;
    const bool is_of_one = method == mip || method == average || method == splatting || is_by_opacity;
    if (is_of_one && media.size() > 1)
      throw properties().error(
          is_by_opacity ? "steps" : "method",
          fmt::format("takes the numbers of one volume, but the scene has {}", media.size()));
    for (const ClassifiedMedium* medium : media) require_classification(medium->classification());
    const bool needs_emission = !settings_.gradient_lighting && method != single_scattering && method != xray;
    for (const ClassifiedMedium* medium : media)
      if (needs_emission && !medium->color_emits())
        throw medium->properties().error(
            "color_is",
            "the colour is an albedo, which this method shows black: give the integrator "
            "<string name=\"lighting\" value=\"gradient\"/> or the method \"single_scattering\"");
  }
  std::vector<std::string> scene_notes(const Scene& scene) const override {
    std::vector<std::string> notes = behind().scene_notes(scene);
    const auto media = classified_media(scene);
    note_unseen_isosurfaces(media, notes);
    note_lighting(scene, media, notes);
    for (const ClassifiedMedium* medium : media)
      note_surface(scene, *medium, notes), note_shape(scene, *medium, notes);
    return notes;
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
    VolumeResult results[kBatch];
    Ray rays[kBatch];
    float ends[kBatch];
    for (std::size_t i = 0; i < paths.size(); ++i) rays[i] = paths[i].ray, ends[i] = kInfinity;
    if (settings.method != DvrSettings::Method::xray)
      find_first_surfaces(scene, {rays, paths.size()}, RayTracer::Rays::coherent, ends);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Path& path = paths[i];
      // Vertices of a walk are numbered from 0, so that no walk uses the random numbers of vertex -1.
      VolumeMarch march(scene, media, settings, path, ends[i], d65_.eval(path.wavelengths),
                        key(path.samples, -1, Stream::volume_march));
      results[i] = march.follow();
      // The nested integrator begins behind the media, or at the ray's origin where there are none.
      const float shift = std::min(march.end(), ends[i]);
      path.ray.o = path.ray.o + path.ray.d * shift;
      path.ray.t_max -= shift;
    }
    // Paths behind an opaque volume are not followed, unless they leave splats or are replayed.
    bool follows_all = behind().leaves() != Leaves::pixel;
    for (std::size_t i = 0; i < paths.size(); ++i) follows_all |= log.follows(int(i));
    for (std::size_t i = 0; i < paths.size();) {
      std::size_t end = i;
      while (end < paths.size() && (follows_all || results[end].transmittance > 0)) ++end;
      if (end > i) behind().trace(scene, paths.subspan(i, end - i), splats, log);
      for (i = end; i < paths.size() && !(follows_all || results[i].transmittance > 0); ++i)
        paths[i].result = {};
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
  /// Throws a located Error where the method cannot use a transfer function of two numbers or a mask.
  void require_classification(const Classification& classification) const {
    using enum DvrSettings::Method;
    const DvrSettings::Method method = settings_.method;
    if (const char* name = classification.plane_parameter()) {
      if (method == mip || method == average || method == isosurface)
        throw properties().error(
            "method",
            fmt::format(
                "is for transfer functions of the number alone: it has no gradient that \"{}\" of the "
                "volume could be a function of",
                name));
      if (properties().has("classification") && settings_.preintegrated)
        throw properties().error(
            "classification",
            fmt::format(
                "\"preintegrated\" is for transfer functions of the number alone, but the volume has \"{}\", a "
                "function of number and gradient: give \"post\"",
                name));
    }
    if (classification.has_mask() && method == average)
      throw properties().error("method",
                               "is for volumes without a mask: the mean number of a ray has no place "
                               "and thus no class");
  }
  /// Returns a note at a parameter of an object.
  static std::string note_at(const Properties& p, const char* name, const std::string& message) {
    return p.error(name, message).what();
  }
  void note_unseen_isosurfaces(const std::vector<const ClassifiedMedium*>& media,
                               std::vector<std::string>& notes) const {
    for (const ClassifiedMedium* medium : media)
      for (const float value : settings_.isovalues) {
        const float low = medium->field().minimum(), high = medium->field().maximum();
        const float opacity = medium->layer_opacity(medium->classification().max_extinction(value, value));
        if (value >= low && value <= high && opacity > 0) continue;
        notes.push_back(note_at(
            properties(), "isovalues",
            fmt::format("the surface of {:g} is not seen: the numbers of the volume go from {:g} to {:g}, "
                        "and the opacity at {:g} is {:g}",
                        value, low, high, value, opacity)));
      }
  }
  /// Notes on lighting without lights, and on coefficients of lighting that is not chosen.
  void note_lighting(const Scene& scene, const std::vector<const ClassifiedMedium*>& media,
                     std::vector<std::string>& notes) const {
    if (settings_.gradient_lighting) {
      if (scene.lights().empty())
        notes.push_back(note_at(
            properties(), "lighting",
            "the scene has no light: the \"ambient\" part of the colours alone is seen; a light is, for example, "
            "<emitter type=\"directional\">"));
      return;
    }
    using enum DvrSettings::Method;
    if (settings_.method != composite && settings_.method != isosurface) return;  // nothing is shaded
    for (const ClassifiedMedium* medium : media)
      for (const char* name : {"ambient", "diffuse", "specular", "shininess"})
        if (const Properties& p = medium->properties(); p.has(name)) {
          notes.push_back(note_at(p, name,
                                  "has no effect without <string name=\"lighting\" value=\"gradient\"/> "
                                  "of the integrator"));
          break;
        }
  }
  /// Notes on shapes that hold the volume behind a surface at which "dvr" ends.
  static void note_surface(const Scene& scene, const ClassifiedMedium& medium,
                           std::vector<std::string>& notes) {
    for (const Primitive& part : scene.parts().surfaces)
      if (part.media.inside.get() == &medium && part.bsdf &&
          has(part.bsdf->lobes(), Lobe::reflect | Lobe::transmit))
        notes.push_back(
            part.element->where().str() +
            ": the surface of this shape is that of a body, where \"dvr\" ends: seen from outside, the volume "
            "within is hidden or followed by the nested integrator; <bsdf type=\"null\"/> shows it");
  }
  /// Notes that shapes do not enclose the volume, by their bounds.
  void note_shape(const Scene& scene, const ClassifiedMedium& medium, std::vector<std::string>& notes) const {
    if (medium.is_clipped()) return;
    Bounds3 shapes, numbers;
    for (const Primitive& part : scene.parts().surfaces)
      if (part.media.inside.get() == &medium || part.media.outside.get() == &medium)
        shapes.extend(part.bounds());
    const ScalarField& field = medium.field();
    const Transform from_box = field.to_box().inverse();
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 p;  // the centre of a voxel at a corner
      for (int k = 0; k < 3; ++k) {
        const float half = 0.5f / float(field.size()[std::size_t(k)]);
        p[k] = corner >> k & 1 ? 1 - half : half;
      }
      numbers.extend(from_box.point(p));
    }
    if (shapes.empty()) return;
    const float rounding = 1e-4f * field.spacing();
    bool is_enclosed = true;
    for (int k = 0; k < 3; ++k)
      is_enclosed &=
          numbers.lower[k] >= shapes.lower[k] - rounding && numbers.upper[k] <= shapes.upper[k] + rounding;
    if (is_enclosed) return;
    const auto shown = [](const Vec3& v) { return fmt::format("({:.5g}, {:.5g}, {:.5g})", v.x, v.y, v.z); };
    notes.push_back(fmt::format(
        "{}: the volume reaches from {} to {}, beyond the shape that holds it, which reaches from {} to {}: "
        "\"dvr\" shows the whole volume, other integrators what the shape encloses",
        medium.properties().where().str(), shown(numbers.lower), shown(numbers.upper), shown(shapes.lower),
        shown(shapes.upper)));
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
        "Westover 1990, \"Footprint evaluation for volume rendering\"; Mueller & Crawfis 1998, \"Eliminating popping artifacts "
        "in sheet buffer-based splatting\"",
        rows(),
        {R"(<integrator type="dvr"><float name="step" value="0.01"/><string name="classification" value="preintegrated"/>
    <string name="lighting" value="gradient"/><string name="highlight" value="reflection"/><boolean name="shadows" value="true"/>
    <integer name="ambient_occlusion" value="8"/><float name="occlusion_radius" value="0.2"/>
    <integrator type="direct"/></integrator>)",
         R"(<integrator type="dvr"><string name="method" value="composite"/><string name="form" value="premultiplied"/>
    <string name="alpha" value="taylor"/><string name="order" value="back_to_front"/><float name="termination" value="0"/>
    <boolean name="jitter" value="true"/><boolean name="skip_empty" value="false"/></integrator>)",
         R"(<integrator type="dvr"><string name="method" value="isosurface"/><string name="isovalues" value="0.2, 0.6"/>
    <boolean name="measures" value="true"/></integrator>)",
         R"(<integrator type="dvr"><string name="steps" value="adaptive"/><float name="tolerance" value="0.005"/></integrator>)",
         R"(<integrator type="dvr"><string name="steps" value="by_opacity"/><float name="step_opacity" value="0.01"/></integrator>)",
         R"(<integrator type="dvr"><string name="method" value="splatting"/><string name="sheets" value="image"/>
    <float name="kernel_width" value="0.7"/></integrator>)",
         R"(<integrator type="dvr"><string name="method" value="emission_absorption"/><float name="tolerance" value="0.01"/></integrator>)"}});

}  // namespace
}  // namespace aureole
