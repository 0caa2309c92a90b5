// SPDX-License-Identifier: Apache-2.0
// Optical data of a sheet, a pane or a layer of a scene: direct and diffuse transmission and reflection, by
// wavelength and for the CIE observer; haze; losses. They are measured with the BSDF's own samples, for any BSDF.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "aureole/instrument/light_budget.h"

namespace aureole {

/// A fraction of the light that arrives, with its name in tables and in files.
struct LayerQuantity {
  const char *name, *key;
  double (*of)(const LightBudget&);
};
inline constexpr std::array<LayerQuantity, 8> kLayerQuantities = {
    LayerQuantity{"direct T", "direct_transmission",
                  [](const LightBudget& b) { return b.direct_transmission; }},
    LayerQuantity{"near T", "diffuse_transmission_near",
                  [](const LightBudget& b) { return b.near_transmission; }},
    LayerQuantity{"far T", "diffuse_transmission_far",
                  [](const LightBudget& b) { return b.far_transmission; }},
    LayerQuantity{"total T", "total_transmission", [](const LightBudget& b) { return b.transmission(); }},
    LayerQuantity{"direct R", "direct_reflection", [](const LightBudget& b) { return b.direct_reflection; }},
    LayerQuantity{"diffuse R", "diffuse_reflection",
                  [](const LightBudget& b) { return b.diffuse_reflection; }},
    LayerQuantity{"total R", "total_reflection", [](const LightBudget& b) { return b.reflection(); }},
    LayerQuantity{"lost", "lost", [](const LightBudget& b) { return b.lost(); }}};

struct LayerSettings {
  double angle_degrees = 0;    ///< of incidence, above 90 from below
  double azimuth_degrees = 0;  ///< of the incident light from the u axis
  double step_nm = 0;  ///< largest step between wavelengths; 0: 20 nm, or a hundredth of a larger range
  std::string illuminant = "D65";
  LightBudgetSettings budget;
};

struct LayerFigures {
  std::vector<LightBudget> rows;  ///< by wavelength
  /// X, Y, Z of each of `kLayerQuantities` for the illuminant, relative to its Y. Empty where the illuminant has no visible
  /// light in the scene's range, or there is one wavelength.
  std::vector<std::array<double, 3>> xyz;

  /// Fraction of the transmitted light that leaves beyond the haze angle, for the observer; NaN without light.
  double haze() const;
};

/// Throws Error for an unknown illuminant and for more than 10000 wavelengths.
LayerFigures measure_layer(const Bsdf& bsdf, const SpectralGrid& grid, const LayerSettings& settings);

}  // namespace aureole
