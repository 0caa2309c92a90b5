// SPDX-License-Identifier: Apache-2.0
// `EdgeTree`: chooses an edge that diffracts light between two places, or from one place, in proportion to an
// estimate of that light: a tree over edges that is descended at random, as light trees are (Conty Estevez & Kulla
// 2018), by distances, the angle by which the light turns, and Keller's condition that it leaves an edge in the
// angle at which it has come (Keller 1962, "Geometrical theory of diffraction"). The edges of a cluster (edge_clusters.h) are one leaf, and are
// chosen by what each of them sends of their common light.
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
  Vec3 p;  ///< or the unit direction towards it
  bool is_infinite = false;
};

/// A straight line with the points of an edge, in double precision.
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
  /// A cluster is one item; `groups` has one for each. All must outlive the tree.
  EdgeTree(std::span<const MeshEdge> edges, const EdgeClusters& clusters,
           std::span<const optics::EdgeGroup> groups);

  struct Choice {
    std::uint32_t edge;
    float probability;
  };
  /// An edge or a cluster.
  struct Leaf {
    std::uint32_t node;
    float probability;
    double estimate;  ///< of the light of all edges, in the units of an edge's importance
    double u;         ///< a number in [0, 1) that is left of the choice
  };
  /// A random number in [0, 1) of 48 bits, made of two of 24: an edge of millions may have a probability of 1e-9.
  static double random_from(float high, float low) { return double(high) + double(low) * 0x1p-24; }

  /// Edges around which light goes from `b` to `a`, in beams of that `sigma`. `angle`: the width of the cone into which long
  /// edges diffract, 1/(2 k sigma). Edges that are no outlines between the two are seldom chosen.
  /// `lit`: how much of each node one of the ends shines on (of_nodes), or null.
  std::optional<Leaf> choose_between(const PathEnd& a, const PathEnd& b, float angle, float sigma, double u,
                                     const float* lit = nullptr) const;
  /// One of them.
  Choice edge_between(const Leaf& leaf, const PathEnd& a, const PathEnd& b) const;
  /// That of one edge.
  static double estimate(const MeshEdge& edge, const PathEnd& a, const PathEnd& b, float angle, float sigma);
  /// An edge that light from or to `a` may reach.
  /// `leaving`: one that is left out, or null.
  std::optional<Choice> choose_from(const PathEnd& a, double u, const MeshEdge* leaving = nullptr,
                                    const float* lit = nullptr) const;
  /// The means over the nodes' edges, by their length, of a number for each edge.
  std::vector<float> of_nodes(std::span<const float> edge_values) const;

  /// About the light that comes to `p` from edges of which each length sends as much into all directions, over that of
  /// surfaces all around of that radiance times length.
  float seen_from(const Vec3& p) const;

  bool empty() const { return nodes_.empty(); }
  std::size_t memory_bytes() const { return nodes_.size() * sizeof(Node); }

private:
  struct Node {
    Vec3 center;
    float radius = 0;
    float length = 0;     ///< of all edges
    float shortest = 0;   ///< of them
    float count = 0;      ///< of edges
    NormalCone normals;   ///< of the faces at them
    NormalCone lines;     ///< of their directions, either way
    std::uint32_t index;  ///< of the first of two children, or of the edge or cluster
    bool is_leaf;
    bool is_cluster;
  };
  /// Data of an edge or cluster that its node follows from: items are sorted in place, so that those of a node are adjacent in memory.
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

/// Where on the line of an edge the light from `b` to `a` fulfils Keller's condition, as a distance from its start;
/// nothing where no place or every place does.
std::optional<double> keller_point(const EdgeLine& line, const PathEnd& a, const PathEnd& b);

}  // namespace aureole
