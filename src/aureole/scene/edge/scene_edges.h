// SPDX-License-Identifier: Apache-2.0
// `SceneEdges`: the edges of a scene as scatterers of light (docs/diffraction_beams.md): sampling of a point
// on an edge and of a diffracted direction, and the diffraction coefficient K.
//
// A point x on an edge is a path vertex whose measure is length. Under an irradiance E perpendicular to the
// direction of travel d_i a length dl of the edge radiates the intensity E K(x; d_i -> d_o) dl. K is that of
// optics/diffraction/edge_kernel.h, `mean_edge_kernel` with `add_straight_edge_corrections`. So K is the same
// for reversed light, and waves of edges that are closer to each other than the beam width interfere and may
// cancel: K may be negative at a point, but not on average over points.
#pragma once

#include <memory>
#include <numbers>
#include <optional>

#include "aureole/scene/edge/beam_width.h"
#include "aureole/scene/edge/edge_clusters.h"
#include "aureole/scene/edge/edge_covers.h"
#include "aureole/scene/edge/edge_distance.h"
#include "aureole/scene/edge/edge_index.h"
#include "aureole/scene/edge/edge_tree.h"
#include "aureole/scene/edge/straight_edges.h"
#include "aureole/scene/scene_parts.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

namespace optics {
struct ProjectedEdge;
}

/// A sampled point on an edge.
struct EdgePoint {
  const MeshEdge* edge = nullptr;
  double at = 0;  ///< distance from edge->a
  Double3 x;      ///< the point on the edge
  Vec3 p;         ///< the point moved off the adjacent surfaces, so that they do not block rays from it
  float pdf = 0;  ///< density of the choice, per length

  Vec3 on_edge() const { return x.to_float(); }
  /// Returns the unit direction from a point to this one, by their difference in double precision: far from
  /// the origin `on_edge` is off the edge.
  Vec3 direction_from(const Vec3& place) const { return normalize(x - Double3(place)).to_float(); }
};

class SceneEdges {
public:
  /// Takes the edges of the shapes that diffract (diffracting_shapes.h). Throws BeamWidthError if beams are
  /// narrower than half of the longest wavelength, or if that wavelength is longer than the scene, and Error
  /// if BSDFs disagree about the beam width.
  SceneEdges(const SceneParts& parts, const BeamWidth& width);
  // The tree refers to the edges of the index, to the clusters and to their groups: no copies.
  SceneEdges(const SceneEdges&) = delete;
  SceneEdges& operator=(const SceneEdges&) = delete;

  /// sigma and wave number at the wavelengths of a path, in units of the scene.
  struct Beams {
    Spectrum k, sigma;
    float widest;     ///< the largest sigma
    float angle;      ///< the largest 1/(2 k sigma): width of the cone into which a straight edge diffracts
    bool achromatic;  ///< whether 1/(2 k sigma) is equal for all wavelengths
  };
  Beams beams(const Wavelengths& w) const;
  /// Returns the largest sigma of any wavelength that the film records.
  float widest_beam() const { return widest_beam_; }

  /// A sampled leaf of the tree: an edge around which light may go between two ends, or a cluster, of which
  /// an edge is sampled later.
  struct EdgesBetween {
    EdgeTree::Leaf leaf;
    /// An estimate of the light around all edges of the scene over that of the straight segment between the
    /// ends.
    float part_of_direct;
  };
  /// Samples a leaf; the density does not depend on which wavelength is the hero. `u`: two random numbers.
  /// `lit`: the data of LitEdges::from for the end that is a lamp, or null.
  std::optional<EdgesBetween> choose_between(const PathEnd& a, const PathEnd& b, const Beams& beams,
                                             const float* u, const float* lit = nullptr) const;
  /// Samples a point around which light may go between the ends; `u`: two random numbers.
  EdgePoint place_between(const EdgesBetween& edges, const PathEnd& a, const PathEnd& b, const Beams& beams,
                          const float* u) const;
  /// Samples a point on an edge that was chosen with that probability.
  EdgePoint place_between(const MeshEdge& edge, float probability, const PathEnd& a, const PathEnd& b,
                          const Beams& beams, const float* u) const;
  /// Returns an approximate upper bound of `part_of_direct`, from 1 over the distance of each end from edges.
  /// A straight edge diffracts the fraction lambda (1/r_a + 1/r_b)/(4 pi^2 theta^2) of the direct light, and
  /// theta is at least 1/(2 k sigma).
  static float most_of_direct(float per_distance_a, float per_distance_b, const Beams& beams) {
    return within_reach(beams) * (per_distance_a + per_distance_b);
  }
  /// Returns the distance from an edge at which `most_of_direct` is 1.
  static float within_reach(const Beams& beams) {
    constexpr float kAtOnce = 4;  // assumed number of edges near one segment
    return kAtOnce / std::numbers::pi_v<float> * beams.widest / beams.angle;
  }
  /// Returns 1/`least` if an edge is within that distance of a point, else about 1 over the distance of the
  /// nearest edge.
  float per_distance(const Vec3& p, float least) const {
    if (least > 0 && are_within(least, p)) return 1 / least;
    return 1 / std::max(least, distance_.at_least(p) + 0.5f * distance_.cell());
  }
  /// Samples a point on an edge that light from or to `a` may reach; `u`: three random numbers. `leaving`: an
  /// edge on which `a` lies, which is left out.
  std::optional<EdgePoint> choose_from(const PathEnd& a, const float* u, const MeshEdge* leaving = nullptr,
                                       const float* lit = nullptr) const;
  /// Returns the point at the fraction `t` of an edge's length, with density 1.
  EdgePoint place_on(const MeshEdge& edge, double t) const {
    const EdgeLine line(edge);
    return point_on(edge, line, t * line.length, 1);
  }

  /// Returns an estimate of the fraction of the light at `p` that comes from edges, if they are irradiated as
  /// the surfaces all around are.
  float seen_from(const Vec3& p, const Beams& beams) const { return tree_.seen_from(p) * beams.widest; }

  /// Returns false if K is 0, since the edge is no outline for light that turns from d_i to d_o.
  static bool turns_around(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o) {
    return point.edge->is_outline(d_i + d_o);
  }
  /// Returns K for unit directions of travel [unit of length of the scene per steradian], by two random
  /// numbers. For edges outside clusters (edge_clusters.h) it is `mean_edge_kernel`, and the numbers have no
  /// effect. Within a cluster it is `drawn_edge_kernels`: its sum over the cluster has an equal mean, but it
  /// is divided among the edges in another way.
  Spectrum kernel(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o, const Beams& beams, Vec2 u) const;
  /// Returns the integral of K over directions, for light along d [unit of length of the scene], by
  /// `mean_edge_powers`, which in clusters divides the power among the edges in another way than K. Empty if
  /// that closed form does not hold: for narrow beams, and between parallel edges less than two wavelengths
  /// apart.
  std::optional<Spectrum> power(const EdgePoint& point, const Vec3& d, const Beams& beams) const;

  /// Returns 1 for wavelengths at which light that comes to an edge from that distance is diffracted as K
  /// says, and 0 if its origin lies within the beam: a vertex within sigma, or another edge within 7 sigma,
  /// whose interference is contained in K.
  static Spectrum far_enough(float distance, bool from_edge, const Beams& beams);

  struct Direction {
    Vec3 d;
    float pdf;  ///< [1/sr], equal for all wavelengths
  };
  /// Samples the direction of diffracted light, for light that arrives along d_i, approximately in proportion
  /// to K; `u`: four random numbers.
  std::optional<Direction> scatter(const EdgePoint& point, const Vec3& d_i, const Beams& beams,
                                   const float* u) const;
  float scatter_pdf(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o, const Beams& beams) const;

  /// Whether some surface of the scene reflects as a mirror or is clear.
  bool has_mirrors() const { return has_mirrors_; }

  /// Returns a distance along a ray up to which no edge is within kMargin times the widest sigma. The free
  /// part of the ray may be longer, unless the result is `length`.
  float free_along(const Vec3& o, const Vec3& d, float length) const {
    return distance_.free_along(o, d, length);
  }
  static constexpr float kMargin = 2.7f;
  /// Returns the fraction of segments beside which edges are sampled: less than 1 if few of them could have
  /// one.
  float looks_beside() const {
    constexpr float kMany = 0.01f, kLeast = 1 / 16.f;
    return std::clamp(distance_.most_beside() / kMany, kLeast, 1.f);
  }
  /// Whether an edge is within `distance` of a point; the distance is enlarged by rounding errors.
  bool are_within(float distance, const Vec3& p) const {
    return distance_.at_least(p) <= distance && index_.has_edge_within(p, distance);
  }

  const EdgeIndex& index() const { return index_; }
  const EdgeTree& tree() const { return tree_; }
  const EdgeClusters& clusters() const { return clusters_; }
  const EdgeCovers& covers() const { return covers_; }
  bool empty() const { return tree_.empty(); }
  /// Notes on the edges.
  const std::vector<std::string>& notes() const { return notes_; }

private:
  /// Distance in sigma beyond which edges do not interfere: the coherence exp(-r^2/(8 sigma^2)) is 2e-3
  /// there.
  static constexpr double kCoherent = 7;
  /// Distance along the light, in sigma, within which edges belong to one beam.
  static constexpr double kDepth = 3;

  EdgePoint point_on(const MeshEdge& edge, const EdgeLine& line, double l, float pdf) const;
  /// Returns the outlines about a point, in light along d, that interfere with its edge: those of its
  /// cluster, or the others nearby. Empty if a face covers the point, which then lies on no outline.
  struct Neighbours;
  std::optional<Neighbours> neighbours(const EdgePoint& point, const Vec3& d, const Beams& beams) const;
  struct Projected;
  template <class Project>
  Projected project(const Neighbours& around, const EdgePoint& point, const Project& projection,
                    const Beams& beams, std::vector<optics::ProjectedEdge>& projected) const;
  /// Sets `straight_edge_weights` of a point whose edge has the projected length `shown` over its length. K
  /// and S have equal weights.
  static void line_weights(const Neighbours& around, std::span<const optics::ProjectedEdge> projected,
                           const Projected& own, double shown, std::span<const double> sigma,
                           std::span<double> weights);

  double scale_of(const MeshEdge& edge) const {
    return scale_.empty() ? 1.0 : double(scale_[edge.face0.set]);
  }
  void remark_crowds();
  void group_clusters();

  BeamWidth width_;
  bool has_mirrors_ = false;
  double unit_m_;  ///< metres per unit of length of the scene
  double shortest_nm_, longest_nm_;
  float widest_beam_ = 0;
  float diameter_ = 0;        ///< of the scene's surfaces
  std::vector<float> lift_;   ///< of each set of triangles (diffracting_shapes.h)
  std::vector<float> scale_;  ///< of each set of triangles; empty if all are 1
  std::vector<std::string> notes_;
  EdgeIndex index_;
  EdgeClusters clusters_;
  std::vector<optics::EdgeGroup> groups_;  ///< of each cluster
  std::vector<std::uint8_t> is_covered_;   ///< of each cluster: whether a face may cover one of its edges
  EdgeTree tree_;
  EdgeDistance distance_;
  StraightEdges straight_;
  EdgeCovers covers_;
};

}  // namespace aureole
