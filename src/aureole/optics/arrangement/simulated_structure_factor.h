// SPDX-License-Identifier: Apache-2.0
// Structure factors of hard discs from independent simulations, smooth and with a stated error.
#pragma once

#include <cstdint>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/arrangement/partial_structure_factors.h"
#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole::optics {

struct HardDiscEnsemble {
  static constexpr int kReplicas = 8;  ///< number of independent simulations, whatever the number of threads

  /// Below this area fraction the error of the theory, under 0.4 Fa^2, is smaller than the noise of a
  /// simulation.
  static constexpr double kTheoryBelow = 0.03;

  int discs = 1500;      ///< discs in each replica
  int snapshots = 1200;  ///< snapshots in all replicas together
  std::uint64_t seed = 0;
  int per_ring = 24;  ///< wave vectors of a ring
};

struct HardDiscMeasurement {
  HardDiscMixture mixture;  ///< the mixture as simulated, with whole numbers of discs
  RingStructureFactor structure;
  double pressure;  ///< pressure over the pressure of an ideal gas
};

/// Simulates a mixture of any area fraction above 0.01; the replicas run in parallel by `parallel_for`.
/// Throws std::domain_error as HardDiscSimulation does.
HardDiscMeasurement measure_hard_discs(const HardDiscMixture& mixture, const HardDiscEnsemble& ensemble = {},
                                       const ParallelFor& parallel_for = serial_for);

/// Returns S_ml of the mixture, by simulation. Each class has at least one disc, so its fraction may change:
/// the result states the simulated fractions.
PartialStructureFactors simulate_partial_structure_factors(const HardDiscMixture& mixture,
                                                           const HardDiscEnsemble& ensemble = {},
                                                           const ParallelFor& parallel_for = serial_for);

/// S' of equal discs. Near the end of the tabulated range, u = 40, it blends into Percus-Yevick's S' to first
/// order in c.
class SimulatedStructureFactor final : public StructureFactor {
public:
  /// Throws std::domain_error unless 0 <= area_fraction <= HardDiscSimulation::kMaxAreaFraction. S' = 1 for
  /// an area fraction of 0.
  explicit SimulatedStructureFactor(double area_fraction, const HardDiscEnsemble& ensemble = {},
                                    const ParallelFor& parallel_for = serial_for);
  using StructureFactor::eval;
  double eval(double u) const override { return table_.eval(0, 0, u); }
  /// Returns the standard error of `eval`.
  double error(double u) const { return table_.error(0, 0, u); }
  double chi_squared() const { return table_.chi_squared(); }

private:
  PartialStructureFactors table_;
};

}  // namespace aureole::optics
