// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/simulated_structure_factor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "aureole/core/random.h"

namespace aureole::optics {
namespace {

/// Ends of the measured rings of wave vectors (kMeasured) and of the tables (kTable), as |q| times the mean
/// radius.
constexpr double kMeasured = 20, kTable = 40;
/// Upper bound of the waves per side of the box: in large, dilute boxes the rings end at a smaller |q|.
constexpr double kMaxWaves = 2000;

std::vector<double> ring_edges(double mean_radius, double box) {
  std::vector<double> edges;
  const double end = std::min(kMeasured, kMaxWaves * 2 * std::numbers::pi / box * mean_radius);
  // Rings start at the box's longest wave and are narrow where S has its peaks.
  for (double u = std::min(0.9 * 2 * std::numbers::pi / box * mean_radius, 0.5); u < end;
       u += u < 6 ? 0.05 : 0.15)
    edges.push_back(u / mean_radius);
  return edges;
}

/// Apportions whole numbers of discs to the classes by the largest remainders; each class has at least one.
std::vector<int> whole_numbers(const HardDiscMixture& mixture, int discs) {
  std::vector<int> count;
  std::vector<double> rest;
  int sum = 0;
  for (int m = 0; m < mixture.classes(); ++m) {
    const double wanted = mixture.fraction(m) * discs;
    count.push_back(std::max(1, int(wanted)));
    rest.push_back(wanted - count.back());
    sum += count.back();
  }
  for (; sum < discs; ++sum) {
    const size_t m = size_t(std::max_element(rest.begin(), rest.end()) - rest.begin());
    ++count[m], rest[m] -= 1;
  }
  return count;
}

}  // namespace

HardDiscMeasurement measure_hard_discs(const HardDiscMixture& mixture, const HardDiscEnsemble& ensemble,
                                       const ParallelFor& parallel_for) {
  if (ensemble.discs < 16 || ensemble.snapshots < 2 * HardDiscEnsemble::kReplicas)
    throw std::domain_error("simulations of hard discs need at least 16 discs and 16 snapshots");
  const std::vector<int> count = whole_numbers(mixture, ensemble.discs);
  std::vector<double> radii, realised_radii, fractions;
  DiscClasses class_of;
  for (int m = 0; m < mixture.classes(); ++m) {
    radii.insert(radii.end(), size_t(count[m]), mixture.radius(m));
    if (mixture.classes() > 1) class_of.insert(class_of.end(), size_t(count[m]), m);
    realised_radii.push_back(mixture.radius(m)), fractions.push_back(count[m]);
  }
  const HardDiscMixture realised(realised_radii, fractions, mixture.area_fraction());
  const double box = std::sqrt(double(radii.size()) / realised.density());
  const RingStructureFactor rings(box, box, ring_edges(realised.mean_radius(), box), ensemble.per_ring,
                                  class_of);

  constexpr int kReplicas = HardDiscEnsemble::kReplicas;
  std::vector<std::optional<RingStructureFactor>> results(kReplicas);
  std::vector<double> pressures(kReplicas);
  const auto simulate = [&](std::size_t begin, std::size_t end) {
    for (int replica = int(begin); replica < int(end); ++replica) {
      HardDiscSimulation simulation(radii, mixture.area_fraction(), combine_bits(ensemble.seed, replica));
      simulation.advance(simulation.equilibration_sweeps());
      simulation.reset_pressure();
      RingStructureFactor structure = rings;
      const int snapshots =
          ensemble.snapshots / kReplicas + (replica < ensemble.snapshots % kReplicas ? 1 : 0);
      for (int i = 0; i < snapshots; ++i) {
        simulation.advance(simulation.decorrelation_sweeps());
        structure.add(simulation.state());
      }
      pressures[replica] = simulation.pressure();
      results[replica] = std::move(structure);
    }
  };
  parallel_for(kReplicas, simulate, 1);
  // Replicas are merged in their order, so that sums do not depend on threads.
  HardDiscMeasurement all{realised, *results[0], 0};
  for (int replica = 0; replica < kReplicas; ++replica) {
    if (replica > 0) all.structure.merge(*results[replica]);
    all.pressure += pressures[replica] / kReplicas;
  }
  return all;
}

PartialStructureFactors simulate_partial_structure_factors(const HardDiscMixture& mixture,
                                                           const HardDiscEnsemble& ensemble,
                                                           const ParallelFor& parallel_for) {
  if (mixture.area_fraction() > HardDiscSimulation::kMaxAreaFraction)
    throw std::domain_error("area fraction of simulated hard discs must be in [0, 0.68], got " +
                            std::to_string(mixture.area_fraction()));
  if (mixture.area_fraction() < HardDiscEnsemble::kTheoryBelow)
    return PartialStructureFactors(mixture, kTable / mixture.mean_radius());
  const HardDiscMeasurement measured = measure_hard_discs(mixture, ensemble, parallel_for);
  return PartialStructureFactors(measured.mixture, kTable / measured.mixture.mean_radius(),
                                 measured.structure);
}

SimulatedStructureFactor::SimulatedStructureFactor(double area_fraction, const HardDiscEnsemble& ensemble,
                                                   const ParallelFor& parallel_for)
    : table_(simulate_partial_structure_factors(HardDiscMixture({1}, {1}, area_fraction), ensemble,
                                                parallel_for)) {}

}  // namespace aureole::optics
