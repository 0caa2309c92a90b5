// SPDX-License-Identifier: Apache-2.0
// The two reflectances of a BSDF that adds a glossy lobe to a diffuse one (`phong`, `ward`).
#pragma once

#include <string>

#include "aureole/bsdf/bsdf.h"
#include "aureole/texture/texture.h"

namespace aureole {

class DiffuseSpecular {
public:
  struct Colors {
    Spectrum diffuse, specular;
    /// Probability of the specular lobe, by the energy of both lobes averaged over the path's wavelengths, so
    /// that it does not depend on the hero.
    float specular_probability;
  };

  explicit DiffuseSpecular(const Properties& properties)
      : diffuse_(get_texture(properties, "diffuse_reflectance", 0.5, SpectrumRole::reflectance)),
        specular_(get_texture(properties, "specular_reflectance", 0.2, SpectrumRole::reflectance)) {
    float largest = diffuse_->maximum() + specular_->maximum();
    if (diffuse_->is_constant() && specular_->is_constant()) {
      const SampledSpectrum d = diffuse_->average(), s = specular_->average();
      largest = 0;
      for (std::size_t i = 0; i < d.nodes().size(); ++i)
        largest = std::max(largest, d.nodes()[i] + s.nodes()[i]);
    }
    if (!(largest > 1 + 1e-4f)) return;
    exceeds_ = true;
    properties.note(
        properties.has("specular_reflectance") ? "specular_reflectance" : "diffuse_reflectance",
        "diffuse and specular reflectance add up to " + std::to_string(largest) +
            " at some wavelength: there both are divided by their sum, so that no energy is gained");
  }

  Colors at(const BsdfContext& ctx) const {
    Colors c{diffuse_->eval(ctx.point, ctx.wavelengths), specular_->eval(ctx.point, ctx.wavelengths), 0};
    if (exceeds_) {
      // The sum is limited at each wavelength separately: spectra of saturated colours approach one outside
      // the visible range, which must not darken the colour.
      const Spectrum sum = max(c.diffuse + c.specular, 1.f);
      c.diffuse = c.diffuse / sum, c.specular = c.specular / sum;
    }
    const float d = mean(c.diffuse), s = mean(c.specular);
    c.specular_probability = s + d > 0 ? s / (s + d) : 0;
    return c;
  }

private:
  TexturePtr diffuse_, specular_;
  bool exceeds_ = false;
};

}  // namespace aureole
