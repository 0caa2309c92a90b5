// SPDX-License-Identifier: Apache-2.0
// The tables of a layer of scatterers, from the parameters of `correlated_scatterers` that shape its
// diffracted light.
#pragma once

#include <memory>
#include <optional>

#include "aureole/bsdf/layer/layer_substrate.h"
#include "aureole/bsdf/layer/scatterer_balance.h"
#include "aureole/bsdf/layer/scatterer_model.h"
#include "aureole/bsdf/layer/scatterer_sampler.h"
#include "aureole/bsdf/layer/scatterer_shapes.h"

namespace aureole {

/// The ranges of the parameters that may vary over the surface.
struct LayerRanges {
  double least_area_fraction, most_area_fraction;
  double least_radius_scale, most_radius_scale;

  bool area_fraction_varies() const { return least_area_fraction < most_area_fraction; }
  bool radius_scale_varies() const { return least_radius_scale < most_radius_scale; }
};

struct LayerTables {
  std::shared_ptr<const ScattererModel> model;
  std::shared_ptr<const ScattererSampler> sampler;  ///< null: directions are drawn by their cosine
  std::optional<ScattererBalance> balance;          ///< with "renormalize"
};

/// `phase_nm`: 2 pi correlation_radius in nm, k a times the wavelength. `renormalizable`: the obliquity is
/// one that "renormalize" may be used with. Throws located errors.
LayerTables make_layer_tables(const Properties& p, LayerShapes shapes, const LayerRanges& ranges,
                              double phase_nm, const LayerSubstrate& substrate, bool renormalizable);

}  // namespace aureole
