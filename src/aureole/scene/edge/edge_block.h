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

  /// Returns the boundary waves of both, each as the other one diffracts it. Their sum is u/u0 minus the field of an
  /// unoccluded segment.
  std::array<std::complex<double>, 2> waves(double wavelength) const;
};

class EdgeBlock {
public:
  enum class Kind {
    none,   ///< an edge is no wedge for light by way of both
    apart,  ///< light between the edges runs freely
    face    ///< it runs along a face that both edges bound
  };
  /// `first` and `second`: passages of both edges in their order along the segment. `is_open`: whether the segment
  /// is unoccluded by the body of both edges. `is_in_plane`: whether the segment lies in the plane of both edges, within rounding errors.
  EdgeBlock(const OutlineEdges& edges, const EdgePassage& first, const EdgePassage& second,
            const EdgeSegment& segment, bool is_open, bool is_in_plane);

  Kind kind() const { return kind_; }
  /// The wedges of both edges. For `face`, the common face is the o-face of both; otherwise they are those of
  /// light by way of both edges.
  const EdgeWedge& wedge(int i) const { return wedges_[std::size_t(i)]; }

  /// Returns the factor of the boundary wave of the first or the second edge (`part`) of a face, each as the other
  /// edge diffracts it, over waves of half planes that absorb. `face`: the reflection coefficient of the common face
  /// at grazing incidence.
  ///
  /// Between the two edges light runs above the plane of the face, which reflects it: waves are those of two half
  /// planes for the segment, and `face` times those for its mirror image, whose first half plane has its open side
  /// below. That is exact in the parabolic approximation, wherever the ends of the segment lie. The faces beyond both
  /// edges change the waves by coefficients of the uniform theory.
  std::complex<double> over_half_planes(int part, double wavelength, std::complex<double> face) const;

private:
  /// An edge for light that it alone diffracts, on its way past the other edge to the far end of the segment.
  struct EdgeAlone {
    double angle_near;  ///< [radians] from the common face to the end on the edge's own side
    double angle_far;   ///< to the end beyond the other edge, negative behind the plane of the face
    double slope;       ///< change of that angle with the other edge's parameter at a unit wavelength
    double turn;        ///< cos(theta/2) at the other edge
  };
  /// Returns what the face beyond an edge adds to the field: the wave of that edge minus that of the half planes for
  /// segment and image, past the other edge, which acts as a half plane. `image`: the reflection coefficient of the
  /// common face, times the weight of the image.
  std::complex<double> beyond(int edge, double wavelength, std::complex<double> image,
                              std::complex<double> face) const;

  Kind kind_ = Kind::none;
  std::array<EdgeWedge, 2> wedges_;
  std::array<EdgeAlone, 2> alone_;
  HalfPlanes direct_, image_;
  bool is_above_ = false;  ///< whether both ends lie above the plane of the face
  double product_ = 0;     ///< weight of the product of both wedges' factors
  double extra_ = 0;       ///< length of the image's segment minus that of the segment
  double amplitude_ = 1;   ///< inverse ratio of the two lengths
};

}  // namespace aureole
