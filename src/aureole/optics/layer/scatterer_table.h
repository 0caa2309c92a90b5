// SPDX-License-Identifier: Apache-2.0
// `ScattererTable`: U and C of a mixture for look-up in single precision, and their azimuthal distributions
// for sampling. In terms of u = q a one table serves all radii, wavelengths, indices and area fractions.
#pragma once

#include <optional>

#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/layer/intensity_map.h"
#include "aureole/optics/layer/ring_azimuths.h"
#include "aureole/optics/layer/scatterer_mixture.h"

namespace aureole::optics {

class ScattererTable {
public:
  /// An empty table, to be read.
  ScattererTable() = default;
  /// Tabulates U and C up to |u| = `extent`. Beyond 4096 (240 for anisotropic mixtures) they are replaced by
  /// the ring mean, which falls as u^-3. `anisotropic` is the structure factor of positions without circular
  /// symmetry, or null; if given, azimuths follow U + C S'. `mixture` and `anisotropic` are evaluated on the
  /// threads of `parallel_for`.
  ScattererTable(const ScattererMixture& mixture, double extent,
                 std::shared_ptr<const StructureFactor> anisotropic = nullptr,
                 const ParallelFor& parallel_for = serial_for);

  using Pair = IntensityMap::Pair;
  /// Returns the ring means of U and C.
  Pair ring(float u) const { return {uncorrelated_.eval(u), coherent_.eval(u)}; }
  /// Returns U and C at (ux, uy) of length u.
  Pair eval(float ux, float uy, float u) const {
    if (!map_ || !(u < map_->extent())) return envelope(ux, uy, u);
    return map_->eval(ux, uy);
  }
  /// Returns U and C at N points at once.
  template <int N>
  void eval(const float* ux, const float* uy, const float* u, float* uncorrelated, float* coherent) const {
    if (map_) {
      map_->eval<N>(ux, uy, uncorrelated, coherent);
      bool all = true;
      for (int j = 0; j < N; ++j) all &= u[j] < map_->extent();
      if (all) return;
    }
    for (int j = 0; j < N; ++j) {
      if (map_ && u[j] < map_->extent()) continue;
      const Pair p = envelope(ux[j], uy[j], u[j]);
      uncorrelated[j] = p.uncorrelated, coherent[j] = p.coherent;
    }
  }
  /// Whether the mixture or its positions are anisotropic, so that azimuths have distributions.
  bool has_azimuths() const { return uncorrelated_azimuths_.has_value(); }
  /// The azimuthal distributions of U and of C have equal bins; for an anisotropic correlation they are one
  /// distribution.
  const RingAzimuths& uncorrelated_azimuths() const { return *uncorrelated_azimuths_; }
  const RingAzimuths& coherent_azimuths() const {
    return coherent_azimuths_ ? *coherent_azimuths_ : *uncorrelated_azimuths_;
  }
  /// Returns the ring mean of U + C S' with the anisotropic S'.
  float product_ring(float u) const { return product_->eval(u); }
  bool is_product() const { return product_.has_value(); }
  double product_end() const { return product_->end(); }
  const RadialFunction& uncorrelated_ring() const { return uncorrelated_; }
  const RadialFunction& coherent_ring() const { return coherent_; }
  int end() const { return coherent_.end(); }
  std::size_t bytes() const;
  /// Calls `all` with the members, for tables that are kept; `self` is constant or not.
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.uncorrelated_, self.coherent_, self.map_, self.uncorrelated_azimuths_, self.coherent_azimuths_,
        self.product_);
  }

private:
  Pair envelope(float ux, float uy, float u) const;

  RadialFunction uncorrelated_, coherent_;  // ring means of U and C
  std::optional<IntensityMap> map_;
  std::optional<RingAzimuths> uncorrelated_azimuths_, coherent_azimuths_;
  std::optional<RadialFunction> product_;
};

}  // namespace aureole::optics
