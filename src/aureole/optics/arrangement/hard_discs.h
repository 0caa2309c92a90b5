// SPDX-License-Identifier: Apache-2.0
// Hard discs in equilibrium, of one size or many, in a periodic box: straight event-chain Monte Carlo
// (Bernard, Krauth & Wilson, "Event-chain Monte Carlo algorithms for hard-sphere systems", 2009).
#pragma once

#include <cstdint>
#include <vector>

#include "aureole/core/random.h"

namespace aureole::optics {

struct HardDiscs {
  double box_x = 0, box_y = 0;
  std::vector<double> x, y, radius;  ///< centres in [0, box), and radii

  int size() const { return int(radius.size()); }
  double area_fraction() const;
};

/// Returns the compressibility factor of a fluid of equal hard discs, its pressure over that of an ideal gas:
/// (1 + Fa^2/8)/(1 - Fa)^2 = 1 + 2 Fa g(2a+) (Henderson, "A simple equation of state for hard discs", 1975).
double hard_disc_pressure(double area_fraction);
/// Returns the contact value g(2a+) of the pair correlation, by the same equation of state.
double hard_disc_contact_value(double area_fraction);

/// Event-chain Monte Carlo simulation. Equal seeds give bitwise equal discs.
class HardDiscSimulation {
public:
  /// Largest area fraction. Beyond it fluid and hexatic phases coexist and equilibration takes far longer
  /// (Bernard & Krauth, "Two-step melting in two dimensions", 2011: from 0.70).
  static constexpr double kMaxAreaFraction = 0.68;

  /// Makes `n` discs of radius 1 in a square box, initially on a hexagonal lattice. Throws std::domain_error
  /// unless 0 < area_fraction <= kMaxAreaFraction and the box is at least four diameters wide.
  HardDiscSimulation(int n, double area_fraction, std::uint64_t seed);
  /// Makes a mixture of the given radii at random positions: small discs on a lattice grow while they move.
  /// Throws std::domain_error if they cannot reach the area fraction.
  HardDiscSimulation(std::vector<double> radii, double area_fraction, std::uint64_t seed);

  /// Moves the discs. One sweep has about as many collisions as there are discs. In mixtures, discs of
  /// unequal size also swap positions if they fit.
  void advance(double sweeps);

  /// Returns the number of sweeps after which the initial arrangement is forgotten, from autocorrelation
  /// times (hard_discs.cpp).
  double equilibration_sweeps() const;
  /// Returns the number of sweeps between snapshots at which another snapshot is worth its cost. The
  /// statistics must account for the remaining correlation.
  double decorrelation_sweeps() const;

  const HardDiscs& state() const { return discs_; }

  /// Returns the pressure over that of an ideal gas, averaged over the chains since `reset_pressure`: the
  /// distance by which a chain transfers motion over the chain's length (Michel, Kapfer & Krauth,
  /// "Generalized event-chain Monte Carlo", 2014). `axis`: chains along x (0) or y (1).
  double pressure(int axis) const;
  double pressure() const;
  void reset_pressure() { chains_[0] = chains_[1] = 0, carried_[0] = carried_[1] = 0; }

private:
  void place_on_lattice();
  void grow(const std::vector<double>& target);
  void build_cells(double largest_radius);
  void insert(int disc, int cell);
  void remove(int disc);
  bool fits(int disc, double x, double y, double radius, int ignored) const;
  double room(int disc) const;
  double peak_correlation() const;
  void chain(int disc, int axis);
  void try_swap();
  double random() { return double(combine_bits(seed_, counter_++) >> 11) * 0x1p-53; }

  HardDiscs discs_;
  std::uint64_t seed_, counter_ = 0;
  bool mixed_ = false;
  double area_fraction_;
  double chain_length_ = 0, chains_per_sweep_ = 0, chains_due_ = 0, swaps_due_ = 0;
  std::int64_t chains_[2] = {0, 0};
  double carried_[2] = {0, 0};

  int cells_[2] = {0, 0}, capacity_ = 0;
  double cell_size_[2] = {0, 0};
  std::vector<int> members_, count_, cell_of_, slot_of_;
};

}  // namespace aureole::optics
