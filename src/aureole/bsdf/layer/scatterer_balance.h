// SPDX-License-Identifier: Apache-2.0
// Renormalisation of the power lost to evanescent waves, an option of the BSDF `correlated_scatterers`. u =
// |q| correlation_radius and phases k a = 2 pi correlation_radius/lambda are dimensionless.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "aureole/bsdf/layer/layer_substrate.h"
#include "aureole/optics/layer/radial_function.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The factor h of a reciprocal BSDF f h(w_i) h(w_o) whose directions together carry the whole diffracted
/// power, including the power of waves without a real direction. h is found by fixed-point iteration over
/// both half-spaces (Sinkhorn's algorithm for a symmetric kernel). It is a function of the angle and of k a,
/// for the indices at each wavelength.
class ScattererBalance {
public:
  /// `phase_nm`: 2 pi correlation_radius in nm. `indices`: exterior and interior index at a wavelength in nm.
  ScattererBalance(const optics::RadialDistribution& table, double phase_nm, const SpectralGrid& grid,
                   const std::function<std::pair<double, double>(double)>& indices,
                   LayerSubstrate::Kind substrate);

  /// Returns h for directions in media of index `here` at an angle of the given sine; `beyond` is the index
  /// on the other side.
  Spectrum factor(const Spectrum& nm, const Spectrum& here, const Spectrum& beyond, float sine) const;

private:
  static constexpr int kNodes = 64;                 // intervals per segment of the table
  static constexpr int kStride = 4 * (kNodes + 1);  // the rarer medium has one segment, the denser one three

  void solve(float* h, const optics::RadialDistribution& table, double phase, double n_ext, double n_int);

  LayerSubstrate::Kind substrate_;
  double phase_nm_, first_, scale_;  // table of h, whose wavelength nodes are uniform in 1/lambda
  int wavelength_nodes_;
  std::vector<float> h_;
};

}  // namespace aureole
