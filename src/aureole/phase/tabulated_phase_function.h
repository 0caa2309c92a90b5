// SPDX-License-Identifier: Apache-2.0
// A phase function backed by a table: the base of plug-ins that compute tables, in this family and in media
// with given particles.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "aureole/optics/particle/phase_table.h"
#include "aureole/phase/phase.h"
#include "aureole/phase/table/tabulated_phase.h"

namespace aureole {

/// Tabulates phase functions that `optics::Ensemble::phases` returns: one per wavelength, at increasing
/// wavelengths, on one grid of angles. Throws as the constructor of `TabulatedPhase` does.
inline TabulatedPhase tabulate(const optics::PhaseTables& phases, std::span<const double> nm,
                               const SpectralGrid& grid) {
  const std::vector<double>& mu = phases.tables.at(0).mu;
  std::vector<double> values(mu.size() * nm.size());
  for (std::size_t w = 0; w < nm.size(); ++w)
    for (std::size_t i = 0; i < mu.size(); ++i) values[i * nm.size() + w] = phases.tables.at(w).p[i];
  return TabulatedPhase(mu, nm, values, grid);
}

class TabulatedPhaseFunction : public PhaseFunction {
public:
  /// `properties` belong to the plug-in that computes the table. `table` is null in a scene with errors.
  TabulatedPhaseFunction(const Properties& properties, std::shared_ptr<const TabulatedPhase> table)
      : PhaseFunction(properties), table_(std::move(table)) {}

  PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext& ctx) const override {
    const Spectrum p = table_->eval(wi, wo, ctx.wavelengths);
    return {p, p};
  }
  std::optional<PhaseSample> sample(const Vec3& wi, float u1, Vec2 u2,
                                    const PhaseContext& ctx) const override {
    const TabulatedPhase::Sample s = table_->sample(wi, u1, u2, ctx.wavelengths);
    if (!(s.value[0] > 0)) return {};
    return PhaseSample{s.wo, s.value, s.value};
  }
  bool needs_choice() const override { return !table_ || table_->wavelength_nodes() > 1; }

private:
  std::shared_ptr<const TabulatedPhase> table_;
};

}  // namespace aureole
