// SPDX-License-Identifier: Apache-2.0
// Structure factors and pair correlation of discs in a periodic box, averaged over snapshots. Standard errors
// account for the correlation between snapshots. See point_pattern.h for patterns in non-periodic windows.
#pragma once

#include <vector>

#include "aureole/optics/arrangement/block_average.h"
#include "aureole/optics/arrangement/hard_discs.h"

namespace aureole::optics {

/// The class of each disc, for example its size class; empty: all discs are of class 0.
using DiscClasses = std::vector<int>;

/// S(q) at wave vectors with the periodicity of the box, without the delta at q = 0. With several classes:
/// the partial structure factors S_ml = <rho_m conj(rho_l)>/sqrt(N_m N_l) of Ashcroft & Langreth ("Structure
/// of binary liquid mixtures", 1967). For random positions they are 1 if m = l, else 0.
class RingStructureFactor {
public:
  /// Defines rings between successive `edges` (increasing, > 0); rings without a wave vector are omitted. At
  /// most about `per_ring` vectors of each ring are used, near its middle and spread over all directions.
  RingStructureFactor(double box_x, double box_y, const std::vector<double>& edges, int per_ring,
                      DiscClasses class_of = {});

  void add(const HardDiscs& discs);
  /// Adds the snapshots of an independent simulation of the same rings and classes.
  void merge(const RingStructureFactor& other);

  int rings() const { return int(rings_.size()); }
  int classes() const { return classes_; }
  double q(int ring) const { return rings_[ring].q; }  ///< mean |q| of the ring's vectors
  int vectors(int ring) const { return rings_[ring].vectors; }
  const BlockAverage& partial(int ring, int m, int l) const;
  const BlockAverage& total(int ring) const { return rings_[ring].total; }  ///< S(q) of all discs together

private:
  struct Ring {
    double q = 0;
    int vectors = 0, first = 0, last = 0;  // number of vectors, and their range in pairs_
    BlockAverage total;
    std::vector<BlockAverage> partial;  // partial structure factors of the classes m <= l
  };
  struct VectorPair {  // vectors (kx, ky) and (kx, -ky) in units of 2 pi/box
    int kx, ky;
  };

  void sum_waves(const HardDiscs& discs);

  double box_x_, box_y_;
  DiscClasses class_of_;
  int classes_ = 1, largest_kx_ = 0, largest_ky_ = 0;
  std::vector<Ring> rings_;
  std::vector<VectorPair> pairs_;
  std::vector<double> class_count_;
  std::vector<double> sums_;   // sums by [pair][class][4]: cos cos, sin sin, cos sin, sin cos
  std::vector<float> powers_;  // scratch: powers of the phase of each disc of a block
};

/// Pair correlation g(r) in equal bins of [0, r_max); r_max is at most half of the box.
class PairHistogram {
public:
  PairHistogram(double r_max, int bins);
  void add(const HardDiscs& discs);
  void merge(const PairHistogram& other);
  int bins() const { return int(g_.size()); }
  double r(int bin) const { return (bin + 0.5) * width_; }
  const BlockAverage& g(int bin) const { return g_[bin]; }

private:
  double r_max_, width_;
  std::vector<BlockAverage> g_;
};

}  // namespace aureole::optics
