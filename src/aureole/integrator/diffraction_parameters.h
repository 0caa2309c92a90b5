// SPDX-License-Identifier: Apache-2.0
// The parameters of integrators that follow light around edges.
#pragma once

#include <optional>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/edges.h"

namespace aureole {

/// The parameters of diffraction; nothing where edges do not diffract.
inline std::optional<DiffractionSettings> get_diffraction(const Properties& p) {
  const bool is_on = p.get_bool("diffraction", false);
  DiffractionSettings settings;
  settings.model = p.get_choice("diffraction_model", "segments", {"segments", "beams"}) == "segments"
                       ? DiffractionSettings::Model::segments
                       : DiffractionSettings::Model::beams;
  if (!is_on && p.has("diffraction_model"))
    p.note("diffraction_model", "has no effect: \"diffraction\" is false");
  using Polarisation = DiffractionSettings::Polarisation;
  const std::string polarisation =
      p.get_choice("diffraction_polarisation", "none", {"none", "soft", "hard", "both"});
  settings.polarisation = polarisation == "soft"   ? Polarisation::soft
                          : polarisation == "hard" ? Polarisation::hard
                          : polarisation == "both" ? Polarisation::both
                                                   : Polarisation::none;
  if (p.has("diffraction_polarisation")) {
    if (!is_on) p.note("diffraction_polarisation", "has no effect: \"diffraction\" is false");
    if (settings.model == DiffractionSettings::Model::beams && polarisation != "none")
      throw p.error("diffraction_polarisation",
                    "belongs to the diffraction model \"segments\"; \"beams\" has no polarisation");
  }
  const std::string text = p.get_string("beam_width", "25 wavelengths");
  if (settings.model == DiffractionSettings::Model::segments && p.has("beam_width"))
    throw p.error(
        "beam_width",
        "belongs to the diffraction model \"beams\" (diffraction_model=\"beams\"); \"segments\", the "
        "default, has no beams");
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
        "priority or touch: state diffraction_model=\"beams\"");
  if (scene.diffraction() && scene.emitting_media())
    throw integrator.properties().error(
        "diffraction", "light of media that emit is not followed around edges: switch one of them off");
}

/// Returns the table rows `own` followed by the rows of the parameters of diffraction.
inline std::vector<ParameterDoc> with_diffraction_parameters(std::vector<ParameterDoc> own) {
  own.push_back(
      {"diffraction", "boolean", "", "false",
       "edges of meshes, discs, cylinders and spheres diffract light (docs/diffraction.md); without it they cost nothing"});
  own.push_back({"diffraction_model", "string", "", "segments",
                 "segments: each straight segment has the exact Fresnel factor of the edges beside it, with "
                 "fringes; beams: an edge is a scatterer of light in beams of the width `beam_width`"});
  own.push_back(
      {"diffraction_polarisation", "string", "", "none",
       "of the model segments. none: edges act as those of half planes that absorb; soft: as wedges with the angle between their "
       "faces, the electric field along each edge; hard: the magnetic field along it; both: the mean power of soft and hard. "
       "Faces of conductor, dielectric, slab and plastic reflect by Fresnel's amplitudes, other mirrors as metal, and all others absorb"});
  own.push_back(
      {"beam_width", "string", "number of wavelengths, length, or \"fresnel\" and a length", "25 wavelengths",
       "standard deviation of the beams of light in which edges are seen together: \"25 wavelengths\", \"3mm\", or "
       "\"fresnel 2m\", the root of wavelength times 2 m"});
  return own;
}

}  // namespace aureole
