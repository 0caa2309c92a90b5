// SPDX-License-Identifier: Apache-2.0
// The parameters of integrators that follow light around edges.
#pragma once

#include <optional>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/edges.h"

namespace aureole {

/// The models of diffraction that an integrator has.
enum class DiffractionModels { beams, all };

/// The parameters `diffraction`, `diffraction_model` and `beam_width`; nothing where edges do not diffract.
inline std::optional<DiffractionSettings> get_diffraction(const Properties& p, DiffractionModels models) {
  const bool is_on = p.get_bool("diffraction", false);
  std::vector<std::string> names = {"beams"};
  if (models == DiffractionModels::all) names.push_back("segments");
  DiffractionSettings settings;
  if (p.get_choice("diffraction_model", "beams", names) == "segments")
    settings.model = DiffractionSettings::Model::segments;
  if (!is_on && p.has("diffraction_model"))
    p.note("diffraction_model", "has no effect: \"diffraction\" is false");
  const std::string text = p.get_string("beam_width", "25 wavelengths");
  if (settings.model == DiffractionSettings::Model::segments && p.has("beam_width"))
    throw p.error("beam_width", "belongs to the diffraction model \"beams\"; \"segments\" has no beams");
  try {
    settings.width = BeamWidth::parse(text);
    return is_on ? std::optional(settings) : std::nullopt;
  } catch (const Error& e) {
    throw p.error("beam_width", e.message());
  }
}

/// Whether a path from the sensor may leave light on other pixels than its own.
inline bool leaves_splats(const std::optional<DiffractionSettings>& settings) {
  return settings && settings->model == DiffractionSettings::Model::beams;
}

/// Throws a located Error where the scene has media or shapes that the chosen diffraction model does not support.
inline void require_no_glowing_media(const Scene& scene, const Integrator& integrator) {
  if (scene.outline_edges() && scene.has_media())
    throw integrator.properties().error(
        "diffraction_model",
        "\"segments\" needs a scene without media and without shapes that have a "
        "priority or touch; use \"beams\"");
  if (scene.diffraction() && scene.emitting_media())
    throw integrator.properties().error(
        "diffraction", "light of media that emit is not followed around edges: switch one of them off");
}

/// Returns the table rows `own` followed by the rows of the parameters of diffraction.
inline std::vector<ParameterDoc> with_diffraction_parameters(std::vector<ParameterDoc> own) {
  own.push_back(
      {"diffraction", "boolean", "", "false",
       "edges of meshes, discs, cylinders and spheres diffract light (docs/diffraction.md); without it they cost nothing"});
  own.push_back(
      {"diffraction_model", "string", "", "beams",
       "beams: an edge is a scatterer of light in beams of the width `beam_width`; segments (not in `bdpt`): "
       "each straight segment has the exact Fresnel factor of the edges beside it, with fringes"});
  own.push_back(
      {"beam_width", "string", "number of wavelengths, length, or \"fresnel\" and a length", "25 wavelengths",
       "standard deviation of the beams of light in which edges are seen together: \"25 wavelengths\", \"3mm\", or "
       "\"fresnel 2m\", the root of wavelength times 2 m"});
  return own;
}

}  // namespace aureole
