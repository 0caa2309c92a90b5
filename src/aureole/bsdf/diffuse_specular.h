// SPDX-License-Identifier: Apache-2.0
// The two colours of a BSDF that adds a glossy lobe to a diffuse one (`phong`, `ward`).
#pragma once

#include <string>

#include "aureole/bsdf/bsdf.h"
#include "aureole/texture/texture.h"

namespace aureole {

class DiffuseSpecular {
public:
  struct Colors {
    Spectrum diffuse, specular;
    /// By the energy of both, averaged over the path's wavelengths: the same whichever is the hero.
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
    scale_ = 1 / largest;
    properties.note(properties.has("specular_reflectance") ? "specular_reflectance" : "diffuse_reflectance",
                    "diffuse and specular reflectance add up to " + std::to_string(largest) +
                        ": both are divided by that, so that no energy is gained");
  }

  Colors at(const BsdfContext& ctx) const {
    Colors c{diffuse_->eval(ctx.point, ctx.wavelengths) * scale_,
             specular_->eval(ctx.point, ctx.wavelengths) * scale_, 0};
    const float d = mean(c.diffuse), s = mean(c.specular);
    c.specular_probability = s + d > 0 ? s / (s + d) : 0;
    return c;
  }

private:
  TexturePtr diffuse_, specular_;
  float scale_ = 1;
};

}  // namespace aureole
