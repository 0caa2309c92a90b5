// SPDX-License-Identifier: Apache-2.0
// `EdgeTree`: samples an edge that diffracts light between two points, or from one point, in proportion to an
// estimate of that light. The tree over edges is descended at random, as light trees are (Conty Estevez &
// Kulla 2018). The estimate has distances, the angle by which the light turns, and Keller's condition that
// light leaves an edge at the angle at which it has come (Keller 1962, "Geometrical theory of diffraction").
// The edges of a cluster (edge_clusters.h) are one leaf, and are sampled in proportion to their share of the
// light that they diffract together.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "aureole/optics/diffraction/edge_group.h"
#include "aureole/scene/edge/beam_tree.h"
#include "aureole/scene/edge/edge_clusters.h"
#include "aureole/scene/edge/mesh_edges.h"
#include "aureole/shape/geometry/double3.h"

namespace aureole {

/// An end of a path around an edge: a point, or a direction to infinity.
struct PathEnd {
  Vec3 p;  ///< the point, or the unit direction towards infinity
  bool is_infinite = false;
};

/// A straight line through the points of an edge, in double precision.
struct EdgeLine {
  explicit EdgeLine(const MeshEdge& edge)
      : origin(edge.a), direction(Double3(edge.b) - Double3(edge.a)), length(aureole::length(direction)) {
    direction = direction * (1 / length);
  }
  Double3 at(double l) const { return origin + direction * l; }

  Double3 origin, direction;
  double length;
};

class EdgeTree {
public:
  EdgeTree() = default;
  /// `groups` has one group for each cluster. All arguments must outlive the tree.
  EdgeTree(std::span<const MeshEdge> edges, const EdgeClusters& clusters,
           std::span<const optics::EdgeGroup> groups);

  struct Choice {
    std::uint32_t edge;
    float probability;
  };
  /// A sampled leaf: an edge or a cluster.
  struct Leaf {
    std::uint32_t node;
    float probability;
    double estimate;  ///< of the light of all edges, in the units of an edge's importance
    double u;         ///< random number in [0, 1) for further choices
  };
  /// Returns a random number in [0, 1) of 48 bits, made of two of 24: one of millions of edges may have a
  /// probability of 1e-9.
  static double random_from(float high, float low) { return double(high) + double(low) * 0x1p-24; }

  /// Samples an edge or cluster around which light goes from `b` to `a`, in beams of width `sigma`. `angle` =
  /// 1/(2 k sigma) is the width of the cone into which long edges diffract. `lit` is the irradiated fraction
  /// of each node for the lamp at one of the ends (of_nodes), or null. Edges that are no outlines between the
  /// two ends have a small probability.
  std::optional<Leaf> choose_between(const PathEnd& a, const PathEnd& b, float angle, float sigma, double u,
                                     const float* lit = nullptr) const;
  /// Samples one edge of the leaf.
  Choice edge_between(const Leaf& leaf, const PathEnd& a, const PathEnd& b) const;
  /// Returns the estimate of the light around one edge.
  static double estimate(const MeshEdge& edge, const PathEnd& a, const PathEnd& b, float angle, float sigma);
  /// Samples an edge that light from or to `a` may reach. `leaving` is an edge that is left out, or null.
  std::optional<Choice> choose_from(const PathEnd& a, double u, const MeshEdge* leaving = nullptr,
                                    const float* lit = nullptr) const;
  /// Returns the mean, over the edges of each node, of a number for each edge, weighted by the edges'
  /// lengths.
  std::vector<float> of_nodes(std::span<const float> edge_values) const;

  /// Returns an estimate of the irradiance at `p` from edges of uniform intensity per length, in all
  /// directions, over that of surfaces all around with that intensity as their radiance times length.
  float seen_from(const Vec3& p) const;

  bool empty() const { return nodes_.empty(); }
  std::size_t memory_bytes() const { return nodes_.size() * sizeof(Node); }

private:
  struct Node {
    Vec3 center;
    float radius = 0;
    float length = 0;     ///< total length of the edges
    float shortest = 0;   ///< shortest length of an edge
    float count = 0;      ///< number of edges
    NormalCone normals;   ///< of the faces at the edges
    NormalCone lines;     ///< of the edges' directions, up to sign
    std::uint32_t index;  ///< of the first of two children, or of the edge or cluster
    bool is_leaf;
    bool is_cluster;
  };
  /// Data of an edge or cluster from which its node follows. Items are sorted in place, so that those of a
  /// node are adjacent in memory.
  struct Item;

  void build(std::uint32_t node, std::span<Item> items, int depth);
  template <class Importance>
  std::optional<Leaf> descend(double u, const Importance& importance) const;
  void set_directions(Node& leaf) const;

  std::span<const MeshEdge> edges_;
  const EdgeClusters* clusters_ = nullptr;
  std::span<const optics::EdgeGroup> groups_;
  std::vector<Node> nodes_;
};

/// Returns the point on the line of an edge at which light from `b` to `a` fulfils Keller's condition, as a
/// distance from its start; empty if no point or every point does.
std::optional<double> keller_point(const EdgeLine& line, const PathEnd& a, const PathEnd& b);

}  // namespace aureole
