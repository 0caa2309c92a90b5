// SPDX-License-Identifier: Apache-2.0
// The scattering material of a translucent body, given by the parameters of a BSSRDF: a medium, coefficients,
// or a diffuse reflectance.
#pragma once

#include <vector>

#include "aureole/core/table_fields.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {

/// Coefficients at each node of the scene's grid, in 1/length of the scene.
struct Matter {
  std::vector<double> absorption, scattering, asymmetry;  ///< sigma_a, sigma_s and the mean cosine g

  static constexpr TableKind kTable{"coefficients of a translucent body", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.absorption, self.scattering, self.asymmetry);
  }

  std::size_t size() const { return absorption.size(); }
  double extinction(std::size_t node) const { return absorption[node] + scattering[node]; }
  double reduced_scattering(std::size_t node) const { return scattering[node] * (1 - asymmetry[node]); }
  double transport(std::size_t node) const { return absorption[node] + reduced_scattering(node); }
};

/// A material given by its appearance: the reflectance of a thick body, without reflection at its boundary,
/// and the reduced mean free path 1/(sigma_a + sigma_s (1 - g)).
struct ShownMatter {
  TexturePtr reflectance;
  SampledSpectrum mean_free_path;  ///< reduced mean free path in units of the scene, positive
};

/// Returns the documentation of the parameters of both kinds of material, for plug-ins that read them.
std::vector<ParameterDoc> matter_rows();

/// Whether the parameters state a reflectance instead of coefficients.
bool is_shown_matter(const Properties& properties);
/// Reads a material that is given by its reflectance. Throws located Errors, as the function below.
ShownMatter read_shown_matter(const Properties& properties);
Matter read_matter(const Properties& properties);

}  // namespace aureole
