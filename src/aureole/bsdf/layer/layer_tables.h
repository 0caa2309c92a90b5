// SPDX-License-Identifier: Apache-2.0
// The tables of a layer of scatterers, computed from the parameters of `correlated_scatterers` that determine
// its diffraction.
#pragma once

#include <memory>
#include <optional>

#include "aureole/bsdf/layer/layer_substrate.h"
#include "aureole/bsdf/layer/scatterer_balance.h"
#include "aureole/bsdf/layer/scatterer_model.h"
#include "aureole/bsdf/layer/scatterer_sampler.h"
#include "aureole/bsdf/layer/scatterer_shapes.h"

namespace aureole {

/// Ranges of the parameters that may vary over the surface.
struct LayerRanges {
  double least_area_fraction, most_area_fraction;
  double least_radius_scale, most_radius_scale;

  bool area_fraction_varies() const { return least_area_fraction < most_area_fraction; }
  bool radius_scale_varies() const { return least_radius_scale < most_radius_scale; }
};

struct LayerTables {
  std::shared_ptr<const ScattererModel> model;      ///< null in a scene with errors, as are all others
  std::shared_ptr<const ScattererSampler> sampler;  ///< sampler of the diffracted wave; null: cosine sampling
  std::optional<ScattererBalance> balance;          ///< balance of the option "renormalize"
};

/// `phase_nm`: 2 pi correlation_radius in nm, which is k a times the wavelength. `renormalizable`: whether
/// "renormalize" supports the obliquity. Throws located Errors.
LayerTables make_layer_tables(const Properties& p, LayerShapes shapes, const LayerRanges& ranges,
                              double phase_nm, const LayerSubstrate& substrate, bool renormalizable);

}  // namespace aureole
