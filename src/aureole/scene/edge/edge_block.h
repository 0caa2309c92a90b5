// SPDX-License-Identifier: Apache-2.0
// `EdgeBlock`: two edges of one face that light passes one after the other, such as those of a block's roof. The
// face reflects the light between them, so that light by way of both edges depends on its polarisation.
#pragma once

#include <array>
#include <complex>

#include "aureole/scene/edge/outline_edges.h"

namespace aureole {

/// Two half planes one behind the other beside a segment, as they act together on its light.
struct HalfPlanes {
  std::array<double, 2> v;      ///< magnitudes of Fresnel's parameters at a unit wavelength
  std::array<bool, 2> is_open;  ///< whether the segment passes on the open side of each
  std::array<double, 2> turn;   ///< cos(theta/2) of light by way of each alone
  std::array<double, 2> w;      ///< parameters of each for light by way of the other, negative in its shadow
  double turns;                 ///< product of both cos(theta/2) of light by way of both

  /// Returns u/u0 minus the field of an unoccluded segment: the boundary waves of both, each as the other one
  /// diffracts it.
  std::complex<double> waves(double wavelength) const;
};

class EdgeBlock {
public:
  enum class Kind {
    none,   ///< an edge is no wedge for light by way of both, or the common face is irradiated from both ends
    apart,  ///< light between the edges runs freely
    face    ///< it runs along a face that both edges bound
  };
  /// `first` and `second`: passages of both edges in their order along the segment. `is_open`: whether the segment
  /// is unoccluded.
  EdgeBlock(const OutlineEdges& edges, const EdgePassage& first, const EdgePassage& second,
            const EdgeSegment& segment, bool is_open);

  Kind kind() const { return kind_; }
  /// The wedges of both edges. For `face`, the common face is the o-face of both; otherwise they are those of
  /// light by way of both edges.
  const EdgeWedge& wedge(int i) const { return wedges_[std::size_t(i)]; }

  /// Returns the boundary waves of both edges of a face over those of half planes that absorb. `face`: the
  /// reflection coefficient of the common face at grazing incidence. That face has the effect of a mirror image of
  /// the end of the segment that lies behind its plane: between the half planes, waves are even or odd about the
  /// plane. The result is exact in the parabolic approximation; the other faces are those of the uniform theory.
  std::complex<double> over_half_planes(double wavelength, std::complex<double> face) const;

private:
  Kind kind_ = Kind::none;
  std::array<EdgeWedge, 2> wedges_;
  HalfPlanes direct_, image_;
  double extra_ = 0;      ///< length of the segment to the image minus that of the segment
  double amplitude_ = 1;  ///< inverse ratio of the two lengths
};

}  // namespace aureole
