// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/dvr/scene_checks.h"

#include <fmt/format.h>

#include "aureole/plugin/late_notes.h"
#include "aureole/transport/vertex.h"

namespace aureole {

std::vector<const ClassifiedMedium*> classified_media(const Scene& scene) {
  std::vector<const ClassifiedMedium*> media;
  for (const Medium* medium : scene.media())
    if (const auto* classified = dynamic_cast<const ClassifiedMedium*>(medium)) media.push_back(classified);
  return media;
}

void DvrSceneChecks::require() const {
  if (media_.empty())
    throw Error(
        properties_.where(),
        "\"dvr\" shows media of the type \"classified\", and the scene has none: give a shape that encloses the "
        "volume <medium type=\"classified\" name=\"interior\">");
  for (const Medium* medium : scene_.media())
    if (!dynamic_cast<const ClassifiedMedium*>(medium))
      throw Error(
          medium->properties().where(),
          "\"dvr\" shows media of the type \"classified\" alone, which no instance holds; this one would not be seen "
          "before or within them");
  if (scene_.sensor().sensor->medium())
    throw Error(scene_.sensor().sensor->properties().where(),
                "\"dvr\" finds the media around the sensor itself: state none on the sensor");
  using enum DvrSettings::Method;
  const DvrSettings::Method method = settings_.method;
  const bool is_by_opacity = settings_.steps == DvrSettings::Steps::by_opacity;
  const bool is_of_one = method == mip || method == average || method == splatting || is_by_opacity;
  if (is_of_one && media_.size() > 1)
    throw properties_.error(
        is_by_opacity ? "steps" : "method",
        fmt::format("takes the numbers of one volume, but the scene has {}", media_.size()));
  for (const ClassifiedMedium* medium : media_) require_classification(medium->classification());
  const bool needs_emission = !settings_.gradient_lighting && method != single_scattering && method != xray;
  for (const ClassifiedMedium* medium : media_)
    if (needs_emission && !medium->color_emits())
      throw medium->properties().error(
          "color_is",
          "the colour is an albedo, which this method shows black: give the integrator "
          "<string name=\"lighting\" value=\"gradient\"/> or the method \"single_scattering\"");
}

void DvrSceneChecks::note(std::vector<std::string>& notes) const {
  note_unseen_isosurfaces(notes);
  note_lighting(notes);
  note_unscattered(notes);
  for (const ClassifiedMedium* medium : media_) note_surface(*medium, notes), note_shape(*medium, notes);
}

void DvrSceneChecks::require_classification(const Classification& classification) const {
  using enum DvrSettings::Method;
  const DvrSettings::Method method = settings_.method;
  if (const char* name = classification.plane_parameter()) {
    if (method == mip || method == average || method == isosurface)
      throw properties_.error(
          "method",
          fmt::format("is for transfer functions of the number alone: it has no gradient that \"{}\" of the "
                      "volume could be a function of",
                      name));
    if (properties_.has("classification") && settings_.preintegrated)
      throw properties_.error(
          "classification",
          fmt::format(
              "\"preintegrated\" is for transfer functions of the number alone, but the volume has \"{}\", a "
              "function of number and gradient: give \"post\"",
              name));
  }
  if (classification.has_mask() && method == average)
    throw properties_.error("method",
                            "is for volumes without a mask: the mean number of a ray has no place "
                            "and thus no class");
}

void DvrSceneChecks::note_unseen_isosurfaces(std::vector<std::string>& notes) const {
  for (const ClassifiedMedium* medium : media_)
    for (const float value : settings_.isovalues) {
      const float low = medium->field().minimum(), high = medium->field().maximum();
      const float opacity = medium->layer_opacity(medium->classification().max_extinction(value, value));
      if (value >= low && value <= high && opacity > 0) continue;
      notes.push_back(note_text(
          properties_, "isovalues",
          fmt::format("the surface of {:g} is not seen: the numbers of the volume go from {:g} to {:g}, "
                      "and the opacity at {:g} is {:g}",
                      value, low, high, value, opacity)));
    }
}

void DvrSceneChecks::note_lighting(std::vector<std::string>& notes) const {
  if (settings_.gradient_lighting) {
    if (scene_.lights().empty())
      notes.push_back(note_text(
          properties_, "lighting",
          "the scene has no light: the \"ambient\" part of the colours alone is seen; a light is, for example, "
          "<emitter type=\"directional\">"));
    return;
  }
  using enum DvrSettings::Method;
  if (settings_.method != composite && settings_.method != isosurface) return;  // nothing is shaded
  for (const ClassifiedMedium* medium : media_)
    for (const char* name : {"ambient", "diffuse", "specular", "shininess"})
      if (const Properties& p = medium->properties(); p.has(name)) {
        notes.push_back(note_text(p, name,
                                  "has no effect without <string name=\"lighting\" value=\"gradient\"/> "
                                  "of the integrator"));
        break;
      }
}

void DvrSceneChecks::note_unscattered(std::vector<std::string>& notes) const {
  if (settings_.method != DvrSettings::Method::single_scattering) return;
  for (const Primitive& part : scene_.parts().surfaces)
    if (part.bsdf && has(part.bsdf->lobes(), Lobe::reflect | Lobe::transmit)) {
      notes.push_back(note_text(
          properties_, "method",
          fmt::format(
              "\"single_scattering\" takes the light that comes straight from lights: what surfaces such as that of "
              "{} send into the volume, and what the volume sends on to them and back, is left out (8 to 10 % for a "
              "ball before a wall of reflectance 0.5, docs/volumes.md); \"path\" follows it, and a line after the render "
              "says how much it is here",
              part.element->where().str())));
      return;
    }
}

void DvrSceneChecks::note_surface(const ClassifiedMedium& medium, std::vector<std::string>& notes) const {
  for (const Primitive& part : scene_.parts().surfaces)
    if (part.media.inside.get() == &medium && part.bsdf &&
        has(part.bsdf->lobes(), Lobe::reflect | Lobe::transmit))
      notes.push_back(
          part.element->where().str() +
          ": the surface of this shape is that of a body, where \"dvr\" ends: seen from outside, the volume "
          "within is hidden or followed by the nested integrator; <bsdf type=\"null\"/> shows it");
}

void DvrSceneChecks::note_shape(const ClassifiedMedium& medium, std::vector<std::string>& notes) const {
  if (medium.is_clipped()) return;
  Bounds3 shapes, numbers;
  for (const Primitive& part : scene_.parts().surfaces)
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

}  // namespace aureole
