// SPDX-License-Identifier: Apache-2.0
// Directions of the discrete ordinates in a stack of media with different indices. A channel is a value of
// Snell's invariant n sin(theta), so refraction maps it onto itself.
#pragma once

#include <span>
#include <vector>

#include "aureole/optics/gauss_legendre.h"

namespace aureole::optics {

/// A direction by its cosine mu > 0 in a medium of the given index.
struct IndexedCosine {
  double index, mu;
};

/// Quadrature channels of one hemisphere, and extra ones without solid angle for beams and viewing
/// directions. They are ordered such that a medium has the first `count(index)` of them; light in the others
/// undergoes total internal reflection before it reaches that medium.
///
/// The range of n sin(theta) is divided at each index, since radiance has a kink at the critical angle, and
/// at `cuts`. In each piece the nodes are those of Gauss-Legendre quadrature in the cosine of the medium in
/// which the piece ends at grazing directions. With a single index that is the double Gauss rule (Sykes 1951,
/// Mon. Not. R. Astron. Soc. 111, 377).
class Channels {
public:
  /// `half_streams` nodes are distributed evenly over the pieces, at least one in each.
  Channels(std::vector<double> indices, int half_streams, std::span<const IndexedCosine> extra = {},
           std::span<const IndexedCosine> cuts = {});

  int size() const { return int(channels_.size()); }
  /// Returns the number of channels in a medium; its index must be one of those given.
  int count(double index) const;
  /// Returns the cosine in a medium that has the channel.
  double mu(int channel, double index) const;
  /// Returns the etendue 2 pi n^2 mu dmu, which is equal in all media; `kNoEtendue` for extra channels.
  double etendue(int channel) const { return channels_[channel].etendue; }
  bool is_extra(int channel) const { return channels_[channel].is_extra; }
  /// Returns Gauss-Legendre nodes in the range of directions that a channel represents, by their cosines in a
  /// medium that has it. The flux weights sum to 1. Ranges of neighbours are adjacent, each as wide as its
  /// weight. An extra channel is a single direction.
  Quadrature within(int channel, double index, int nodes) const;
  /// Returns the width of a channel's range of directions in radians.
  double width(int channel, double index) const;
  /// Returns the channels of the extra directions, in the order in which they were given.
  const std::vector<int>& extra() const { return extra_; }

  /// Etendue of extra channels: so small that their scattered light does not change any digit of the others,
  /// while operators are stored in a form that keeps their own precision.
  static constexpr double kNoEtendue = 1e-24;

private:
  struct Channel {
    IndexedCosine at;
    double etendue;
    bool is_extra;
    double steepest, most_grazing;  ///< cosines at the limits of the channel's range, in the medium of `at`
  };
  std::vector<double> indices_;
  std::vector<int> counts_;
  std::vector<Channel> channels_;
  std::vector<int> extra_;
};

}  // namespace aureole::optics
