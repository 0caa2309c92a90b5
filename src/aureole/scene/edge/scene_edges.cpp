// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/scene_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/scene/edge/diffracting_shapes.h"
#include "aureole/scene/edge/place_density.h"

namespace aureole {

using std::numbers::pi;

SceneEdges::SceneEdges(const SceneParts& parts, const BeamWidth& width)
    : unit_m_(parts.context->length_unit_m),
      shortest_nm_(parts.context->grid.min_nm),
      longest_nm_(parts.context->grid.max_nm) {
  DiffractingShapes shapes(parts);
  width_ = shapes.width(width);
  const double longest = parts.context->grid.max_nm * 1e-9;
  if (width_.at(longest) < 0.5 * longest)
    throw BeamWidthError(
        "beams are narrower than half of the longest wavelength, which has no direction then");
  Bounds3 box;
  for (const Primitive& part : parts.surfaces) box.extend(part.bounds());
  if (!box.empty()) diameter_ = length(box.diagonal());
  widest_beam_ = float(width_.at(longest) / unit_m_);
  index_ = EdgeIndex(shapes.sets, EdgeIndex::Of::edges);
  clusters_ = EdgeClusters(index_, float(kCoherent) * widest_beam_);
  group_clusters();
  tree_ = EdgeTree(index_.edges(), clusters_, groups_);
  distance_ = EdgeDistance(index_, kMargin * widest_beam_);
  straight_ = StraightEdges(index_);
  FaceTree faces(shapes.sets);
  const std::string crossings = tree_.empty() ? "" : remark_on_crossings(faces);
  covers_ = EdgeCovers(index_, clusters_, std::move(faces), float(kDepth) * widest_beam_);
  for (std::size_t c = 0; c < clusters_.size(); ++c)
    is_covered_.push_back(
        std::ranges::any_of(clusters_.edges(c), [&](std::uint32_t i) { return covers_.may_be(i); }));
  lift_ = std::move(shapes.lift);
  if (std::any_of(shapes.scale.begin(), shapes.scale.end(), [](float scale) { return scale != 1; }))
    scale_ = std::move(shapes.scale);
  notes_ = std::move(shapes.remarks);
  if (!crossings.empty()) notes_.push_back(crossings);
  if (!tree_.empty() && longest > diameter_ * unit_m_)
    throw BeamWidthError(
        "the longest wavelength is longer than the scene, whose edges cannot diffract it as edges do");
  remark_crowds();
  const auto is_mirror = [](const BsdfPtr& bsdf) { return bsdf && has(bsdf->lobes(), Lobe::delta); };
  has_mirrors_ = std::ranges::any_of(parts.surfaces, [&](const Primitive& part) {
    return is_mirror(part.bsdf) ||
           (part.instance && std::ranges::any_of(part.instance->list().bsdfs, is_mirror));
  });
}

void SceneEdges::group_clusters() {
  const auto in_space = [](const Vec3& v) { return optics::SpaceVector{v.x, v.y, v.z}; };
  std::vector<optics::EdgeGroup::Edge> group;
  for (std::size_t c = 0; c < clusters_.size(); ++c) {
    group.clear();
    for (const std::uint32_t i : clusters_.edges(c)) {
      const MeshEdge& edge = index_.edges()[i];
      group.push_back({in_space(edge.a), in_space(edge.b), in_space(edge.n0), in_space(edge.n1)});
    }
    groups_.emplace_back(group);
  }
}

void SceneEdges::remark_crowds() {
  // Every sample evaluates all edges within its beam; clusters take little time, so that they do not count.
  constexpr std::size_t kPlaces = 64, kCrowd = 500;
  const std::vector<MeshEdge>& edges = index_.edges();
  const double metres = 1e-9 * 0.5 * (shortest_nm_ + longest_nm_);
  const auto radius = float(kCoherent * width_.at(metres) / unit_m_),
             depth = radius * float(kDepth / kCoherent);
  std::size_t most = 0;
  for (std::size_t i = 0; i < std::min(kPlaces, edges.size()); ++i) {
    const std::size_t number = i * edges.size() / std::min(kPlaces, edges.size());
    if (!clusters_.of(number).empty()) continue;
    const MeshEdge& edge = edges[number];
    std::size_t count = 0;
    index_.visit_edges({0.5f * (edge.a + edge.b), edge.across(), radius, -depth, depth},
                       [&](const MeshEdge&) { ++count; });
    most = std::max(most, count);
  }
  if (most > kCrowd)
    notes_.push_back("edges: a beam of light holds up to " + std::to_string(most) +
                     " of them, all of which each sample goes through; a smaller beam_width is faster");
}

SceneEdges::Beams SceneEdges::beams(const Wavelengths& w) const {
  Beams b;
  b.achromatic = width_.is_achromatic();
  const Spectrum unit = float(1e9 * unit_m_);  // the scene's unit in nanometres
  b.k = float(2 * pi) * unit / w.nm;
  switch (width_.unit) {
    case BeamWidth::Unit::wavelengths:
      b.sigma = w.nm * float(width_.value * 1e-9 / unit_m_);
      break;
    case BeamWidth::Unit::length:
      b.sigma = float(width_.value / unit_m_);
      break;
    case BeamWidth::Unit::fresnel:
      b.sigma = sqrt(w.nm * float(width_.value * 1e-9 / (unit_m_ * unit_m_)));
      break;
  }
  b.widest = max_component(b.sigma);
  b.angle = 0.5f / min_component(b.k * b.sigma);
  return b;
}

EdgePoint SceneEdges::point_on(const MeshEdge& edge, const EdgeLine& line, double l, float pdf) const {
  EdgePoint point{&edge, l, line.at(l), {}, pdf};
  // The point is moved away from both faces; at a boundary it is moved across the edge, away from the
  // surface.
  Vec3 off;
  if (edge.is_boundary) {
    off = cross(line.direction.to_float(), edge.n0);
  } else {
    off = edge.n0 + edge.n1;
    const float size = length(off);
    off =
        size > 1e-3f ? off * ((edge.is_concave ? -1 : 1) / size) : cross(line.direction.to_float(), edge.n0);
  }
  const Vec3 p = point.x.to_float();
  // Bounds the rounding of points on faces, and of rays that come from afar, whose error grows with their
  // length.
  const float reach =
      max_component(abs(edge.a)) + max_component(abs(edge.b)) + float(line.length) + diameter_;
  point.p = p + off * (reach * gamma_bound(32) + lift_[edge.face0.set]);
  return point;
}

std::optional<SceneEdges::EdgesBetween> SceneEdges::choose_between(const PathEnd& a, const PathEnd& b,
                                                                   const Beams& beams, const float* u,
                                                                   const float* lit) const {
  const auto leaf =
      tree_.choose_between(a, b, beams.angle, beams.widest, EdgeTree::random_from(u[0], u[1]), lit);
  if (!leaf) return {};
  // The estimate is Keller's coefficient over the squared distances; an end at infinity has no distance.
  const double distance2 = a.is_infinite || b.is_infinite ? 1 : double(length_squared(a.p - b.p));
  return EdgesBetween{*leaf, float(leaf->estimate * distance2 / (2 * pi * min_component(beams.k)))};
}

EdgePoint SceneEdges::place_between(const EdgesBetween& edges, const PathEnd& a, const PathEnd& b,
                                    const Beams& beams, const float* u) const {
  const EdgeTree::Choice choice = tree_.edge_between(edges.leaf, a, b);
  return place_between(index_.edges()[choice.edge], choice.probability, a, b, beams, u);
}

EdgePoint SceneEdges::place_between(const MeshEdge& edge, float probability, const PathEnd& a,
                                    const PathEnd& b, const Beams& beams, const float* u) const {
  const EdgeLine line(edge);
  const std::optional<double> keller = keller_point(line, a, b);
  double deviation = line.length;
  if (keller) {
    const Double3 x = line.at(*keller);
    const auto rate = [&](const PathEnd& end) {  // sin^2/r
      if (end.is_infinite) return 0.0;
      const Double3 to = Double3(end.p) - x;
      const double r2 = std::max(dot(to, to), 1e-300), along = dot(to, line.direction);
      return std::max(1 - along * along / r2, 1e-6) / std::sqrt(r2);
    };
    const Double3 to = a.is_infinite ? Double3(b.p) - x : Double3(a.p) - x;
    const double along = dot(to, line.direction),
                 sine = std::sqrt(std::max(1 - along * along / dot(to, to), 1e-6));
    // An edge shorter than a beam diffracts light from all of its length.
    const double width = beams.angle * std::max(1.0, 4 * beams.widest / line.length);
    deviation = 1.1 * width * sine / (rate(a) + rate(b));
  }
  const PlaceDensity places(keller, deviation, 2.0 * beams.widest, line.length);
  const double l = places.sample(u[0], u[1]);
  return point_on(edge, line, l, float(double(probability) * places.pdf(l)));
}

std::optional<EdgePoint> SceneEdges::choose_from(const PathEnd& a, const float* u, const MeshEdge* leaving,
                                                 const float* lit) const {
  const auto choice = tree_.choose_from(a, EdgeTree::random_from(u[0], u[1]), leaving, lit);
  if (!choice) return {};
  const MeshEdge& edge = index_.edges()[choice->edge];
  const EdgeLine line(edge);
  if (a.is_infinite)
    return point_on(edge, line, u[2] * line.length, float(choice->probability / line.length));
  // Uniform in the angle that the edge subtends at `a`, that is, by the inverse square of the distance.
  const Double3 to = Double3(a.p) - line.origin;
  const double foot = dot(to, line.direction);
  const double across = std::max(length(to - line.direction * foot), 1e-6 * line.length);
  const double begin = std::atan(-foot / across), end = std::atan((line.length - foot) / across);
  const double l = std::clamp(foot + across * std::tan(begin + u[2] * (end - begin)), 0.0, line.length);
  const double r = l - foot;
  const double pdf = across / ((end - begin) * (across * across + r * r));
  return point_on(edge, line, l, float(choice->probability * pdf));
}

Spectrum SceneEdges::far_enough(float distance, bool from_edge, const Beams& beams) {
  const float least = from_edge ? float(kCoherent) : 1.f;
  return make_spectrum([&](int i) { return distance > least * beams.sigma[i] ? 1.f : 0.f; });
}

}  // namespace aureole
