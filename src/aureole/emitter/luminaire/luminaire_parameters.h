// SPDX-License-Identifier: Apache-2.0
// Parameters of emitters whose intensities come from a file of a luminaire.
#pragma once

#include <vector>

#include "aureole/math/vec.h"
#include "aureole/parameter/luminaire/luminaire_file.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {

/// A luminaire in the form that emitters use.
struct LuminaireLight {
  Luminaire luminaire;  ///< intensities [cd], including all factors of the scene
  /// spectral radiant intensity of 1 cd [W/(sr nm)], times (scene units per metre)^2
  TexturePtr per_candela;
  double flux = 0;  ///< luminous flux [lm]

  double candela(const Vec3& local) const {
    return luminaire.distribution.intensity({double(local.x), double(local.y), double(local.z)});
  }
};

/// Reads the file and the parameters of `luminaire_parameter_rows`, and notes how the flux of the lamps and the
/// integral of the intensities agree. Throws located errors.
LuminaireLight get_luminaire(const Properties& properties);

/// Returns the table rows of a luminaire's parameters, followed by `rows`.
std::vector<ParameterDoc> luminaire_parameter_rows(std::vector<ParameterDoc> rows);

}  // namespace aureole
