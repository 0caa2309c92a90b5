// SPDX-License-Identifier: Apache-2.0
// `SceneEdges`: the edges of a scene as scatterers of light (docs/diffraction.md): choice of a place on an edge, of a
// direction behind it, and the kernel K of both.
//
// A place x on an edge has the measure of length. Light of irradiance E across its direction of travel d_i leaves dl of the
// edge with the intensity E K(x; d_i -> d_o) dl. K is that of optics/diffraction/edge_kernel.h, `mean_edge_kernel` with
// `add_straight_edge_corrections`, so that it is the same when the light runs backwards, waves of edges nearer to each other than the beams are wide
// interfere, and may cancel: K may be negative at a place, never on the average over places.
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

/// A place on an edge.
struct EdgePoint {
  const MeshEdge* edge = nullptr;
  double at = 0;  ///< distance from edge->a
  Double3 x;      ///< on the edge
  Vec3 p;         ///< the same, off the surfaces that meet there, so that they don't block rays from it
  float pdf = 0;  ///< density of the choice, per length

  Vec3 on_edge() const { return x.to_float(); }
  /// The unit direction from a place to it, from their difference in double precision: far from the origin `on_edge` is off the edge.
  Vec3 direction_from(const Vec3& place) const { return normalize(x - Double3(place)).to_float(); }
};

class SceneEdges {
public:
  /// Of the shapes that diffract (diffracting_shapes.h). Throws BeamWidthError where beams are narrower than half of the longest wavelength
  /// or that is longer than the scene, and Error where BSDFs disagree about their width.
  SceneEdges(const SceneParts& parts, const BeamWidth& width);
  // The tree refers to the edges of the index, to the clusters and to their groups.
  SceneEdges(const SceneEdges&) = delete;
  SceneEdges& operator=(const SceneEdges&) = delete;

  /// sigma and wave number at the wavelengths of a path, in units of the scene.
  struct Beams {
    Spectrum k, sigma;
    float widest;     ///< sigma
    float angle;      ///< the largest 1/(2 k sigma): width of the cone into which a straight edge diffracts
    bool achromatic;  ///< all have the same angle
  };
  Beams beams(const Wavelengths& w) const;
  /// The largest sigma of any wavelength that the film sees.
  float widest_beam() const { return widest_beam_; }

  /// A leaf of the tree: an edge around which light may go between two ends, or a cluster, of whose edges one is chosen later.
  struct EdgesBetween {
    EdgeTree::Leaf leaf;
    /// About the light that goes around all edges of the scene over that of the ends' straight connection.
    float part_of_direct;
  };
  /// The density of the choice does not depend on which wavelength is the hero. `u`: two numbers. `lit`: LitEdges::from the end that is a
  /// lamp, or null.
  std::optional<EdgesBetween> choose_between(const PathEnd& a, const PathEnd& b, const Beams& beams,
                                             const float* u, const float* lit = nullptr) const;
  /// A place around which light may go; two numbers.
  EdgePoint place_between(const EdgesBetween& edges, const PathEnd& a, const PathEnd& b, const Beams& beams,
                          const float* u) const;
  /// The same on an edge that was chosen with that probability.
  EdgePoint place_between(const MeshEdge& edge, float probability, const PathEnd& a, const PathEnd& b,
                          const Beams& beams, const float* u) const;
  /// About the most that `part_of_direct` may be, by one over the distance of each end from edges. A straight edge sends
  /// lambda (1/r_a + 1/r_b)/(4 pi^2 theta^2) of the direct light around itself, theta no less than 1/(2 k sigma).
  static float most_of_direct(float per_distance_a, float per_distance_b, const Beams& beams) {
    return within_reach(beams) * (per_distance_a + per_distance_b);
  }
  /// The distance from an edge at which `most_of_direct` is one.
  static float within_reach(const Beams& beams) {
    constexpr float kAtOnce = 4;  // edges that send light to one place so near to its straight way
    return kAtOnce / std::numbers::pi_v<float> * beams.widest / beams.angle;
  }
  /// One over `least` where an edge is within that distance of a place; else about one over the distance of the nearest one.
  float per_distance(const Vec3& p, float least) const {
    if (least > 0 && are_within(least, p)) return 1 / least;
    return 1 / std::max(least, distance_.at_least(p) + 0.5f * distance_.cell());
  }
  /// A place that light from or to `a` may reach; three numbers. `leaving`: an edge on which `a` lies, and which is left out.
  std::optional<EdgePoint> choose_from(const PathEnd& a, const float* u, const MeshEdge* leaving = nullptr,
                                       const float* lit = nullptr) const;
  /// The place at the fraction `t` of an edge's length, with density 1.
  EdgePoint place_on(const MeshEdge& edge, double t) const {
    const EdgeLine line(edge);
    return point_on(edge, line, t * line.length, 1);
  }

  /// About the part of the light at `p` that comes from edges, where they are lit as the surfaces all around are.
  float seen_from(const Vec3& p, const Beams& beams) const { return tree_.seen_from(p) * beams.widest; }

  /// False where K is 0, since the edge is no outline for light that turns from d_i to d_o.
  static bool turns_around(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o) {
    return point.edge->is_outline(d_i + d_o);
  }
  /// K by two numbers, for unit directions of travel [unit of length of the scene per steradian]: `mean_edge_kernel` outside clusters
  /// (edge_clusters.h), where the numbers have no effect; within one `drawn_edge_kernels`, whose sum over the cluster has the same mean, and
  /// which divides it among the edges in another way.
  Spectrum kernel(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o, const Beams& beams, Vec2 u) const;
  /// The integral of K over directions, for light along d [unit of length of the scene]: `mean_edge_powers`, which in clusters divides the
  /// light among the edges otherwise. None where that does not hold: for narrow beams, and between edges side by side less than two
  /// wavelengths from each other.
  std::optional<Spectrum> power(const EdgePoint& point, const Vec3& d, const Beams& beams) const;

  /// 1 where light of a wavelength that comes to an edge from a place at that distance is diffracted as K says, 0 where the place
  /// lies in the beam: a vertex within sigma; another edge as far as it interferes, which is in K already.
  static Spectrum far_enough(float distance, bool from_edge, const Beams& beams);

  struct Direction {
    Vec3 d;
    float pdf;  ///< [1/sr], the same for all wavelengths
  };
  /// Where light that arrives along d_i goes on, nearly as K; four numbers.
  std::optional<Direction> scatter(const EdgePoint& point, const Vec3& d_i, const Beams& beams,
                                   const float* u) const;
  float scatter_pdf(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o, const Beams& beams) const;

  /// Some surface of the scene reflects as a mirror or is clear.
  bool has_mirrors() const { return has_mirrors_; }

  /// How far along a ray no edge is within kMargin of the widest beam: perhaps farther, but nowhere before `length` where it is that.
  float free_along(const Vec3& o, const Vec3& d, float length) const {
    return distance_.free_along(o, d, length);
  }
  static constexpr float kMargin = 2.7f;
  /// Of ways that light takes, the part of which edges beside them are looked for: less than 1 where few could have one.
  float looks_beside() const {
    constexpr float kMany = 0.01f, kLeast = 1 / 16.f;
    return std::clamp(distance_.most_beside() / kMany, kLeast, 1.f);
  }
  /// Whether an edge is within that distance of a place, or within a little more.
  bool are_within(float distance, const Vec3& p) const {
    return distance_.at_least(p) <= distance && index_.has_edge_within(p, distance);
  }

  const EdgeIndex& index() const { return index_; }
  const EdgeTree& tree() const { return tree_; }
  const EdgeClusters& clusters() const { return clusters_; }
  const EdgeCovers& covers() const { return covers_; }
  bool empty() const { return tree_.empty(); }
  /// Remarks about the edges.
  const std::vector<std::string>& notes() const { return notes_; }

private:
  /// Beyond this many sigma edges do not interfere: their light is coherent by exp(-r^2/(8 sigma^2)), 2e-3 there.
  static constexpr double kCoherent = 7;
  /// Within this distance along the light, in sigma, edges belong to one beam.
  static constexpr double kDepth = 3;

  EdgePoint point_on(const MeshEdge& edge, const EdgeLine& line, double l, float pdf) const;
  /// The outlines about a place in light along d that interfere with its edge: those of its cluster, or the others near by. None where
  /// a face covers the place, which is no outline then.
  struct Neighbours;
  std::optional<Neighbours> neighbours(const EdgePoint& point, const Vec3& d, const Beams& beams) const;
  struct Projected;
  template <class Project>
  Projected project(const Neighbours& around, const EdgePoint& point, const Project& projection,
                    const Beams& beams, std::vector<optics::ProjectedEdge>& projected) const;
  /// `straight_edge_weights` of a place whose edge is seen by `shown` of its length: K and S have the same.
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
  std::vector<float> scale_;  ///< the same, empty where all are 1
  std::vector<std::string> notes_;
  EdgeIndex index_;
  EdgeClusters clusters_;
  std::vector<optics::EdgeGroup> groups_;  ///< of each cluster
  std::vector<std::uint8_t> is_covered_;   ///< the same: whether a face may cover one of its edges
  EdgeTree tree_;
  EdgeDistance distance_;
  StraightEdges straight_;
  EdgeCovers covers_;
};

}  // namespace aureole
