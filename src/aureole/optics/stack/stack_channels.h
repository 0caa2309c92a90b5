// SPDX-License-Identifier: Apache-2.0
// The directions in which discrete ordinates follow light through a stack of media of different index. A
// channel is a value of Snell's invariant n sin(theta), so refraction maps it onto itself.
#pragma once

#include <span>
#include <vector>

#include "aureole/optics/gauss_legendre.h"

namespace aureole::optics {

/// A direction by its cosine mu > 0 in a medium of this index.
struct IndexedCosine {
  double index, mu;
};

/// Quadrature channels of one hemisphere, and extra ones of no solid angle: beams and directions to look
/// from. Ordered such that a medium has the first `count(index)` of them; in the others light is reflected
/// totally before it gets there.
///
/// The range of n sin(theta) is cut at each index, since radiance has a kink at the critical angle, and at
/// `cuts`. In each piece the nodes are those of Gauss and Legendre in the cosine of the medium where it ends
/// at grazing directions. With one index that is the double Gauss rule (Sykes 1951, Mon. Not. R. Astron. Soc.
/// 111, 377).
class Channels {
public:
  /// `half_streams` nodes are shared evenly among the pieces, one at least in each.
  Channels(std::vector<double> indices, int half_streams, std::span<const IndexedCosine> extra = {},
           std::span<const IndexedCosine> cuts = {});

  int size() const { return int(channels_.size()); }
  /// How many exist in a medium; its index must be one of those given.
  int count(double index) const;
  /// Cosine in a medium that has the channel.
  double mu(int channel, double index) const;
  /// 2 pi n^2 mu dmu, the same in all media; of extra channels `kNoEtendue`.
  double etendue(int channel) const { return channels_[channel].etendue; }
  bool is_extra(int channel) const { return channels_[channel].is_extra; }
  /// Gauss and Legendre's nodes in the range of directions that a channel stands for, by their cosines in a
  /// medium that has it, and weights of flux, whose sum is 1. Ranges of neighbours meet, each as wide as its
  /// weight. An extra channel is one direction.
  Quadrature within(int channel, double index, int nodes) const;
  /// Width of that range in radians.
  double width(int channel, double index) const;
  /// The channels of the extra directions, in the order in which they were given.
  const std::vector<int>& extra() const { return extra_; }

  /// Extra channels carry so little that what they scatter changes no digit of the others; operators are kept
  /// in a form that does not lose the digits of their own.
  static constexpr double kNoEtendue = 1e-24;

private:
  struct Channel {
    IndexedCosine at;
    double etendue;
    bool is_extra;
    double steepest, most_grazing;  ///< cosines of the ends of its range, in the medium of `at`
  };
  std::vector<double> indices_;
  std::vector<int> counts_;
  std::vector<Channel> channels_;
  std::vector<int> extra_;
};

}  // namespace aureole::optics
