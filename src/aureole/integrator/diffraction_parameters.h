// SPDX-License-Identifier: Apache-2.0
// The parameters of integrators that follow light around edges.
#pragma once

#include <optional>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/edges.h"

namespace aureole {

/// The parameters `diffraction` and `beam_width`; nothing where edges do not diffract.
inline std::optional<BeamWidth> get_diffraction(const Properties& p) {
  const bool is_on = p.get_bool("diffraction", false);
  const std::string text = p.get_string("beam_width", "25 wavelengths");
  try {
    const BeamWidth width = BeamWidth::parse(text);
    return is_on ? std::optional(width) : std::nullopt;
  } catch (const Error& e) {
    throw p.error("beam_width", e.message());
  }
}

/// Throws where the scene has what paths around edges are not found with.
inline void require_no_glowing_media(const Scene& scene, const Integrator& integrator) {
  if (scene.diffraction() && scene.emitting_media())
    throw integrator.properties().error(
        "diffraction", "light of media that emit is not followed around edges: switch one of them off");
}

/// `own` followed by the rows of these parameters.
inline std::vector<ParameterDoc> with_diffraction_parameters(std::vector<ParameterDoc> own) {
  own.push_back(
      {"diffraction", "boolean", "", "false",
       "edges of meshes, discs, cylinders and spheres diffract light (docs/diffraction.md); without it they cost nothing"});
  own.push_back(
      {"beam_width", "string", "number of wavelengths, length, or \"fresnel\" and a length", "25 wavelengths",
       "standard deviation of the beams of light in which edges are seen together: \"25 wavelengths\", \"3mm\", or "
       "\"fresnel 2m\", the root of wavelength times 2 m"});
  return own;
}

}  // namespace aureole
