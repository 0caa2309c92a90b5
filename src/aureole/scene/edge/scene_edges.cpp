// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/scene_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "aureole/optics/diffraction/edge_group.h"
#include "aureole/optics/diffraction/edge_kernel.h"
#include "aureole/optics/lanes.h"
#include "aureole/scene/edge/diffracting_shapes.h"
#include "aureole/scene/edge/place_density.h"

namespace aureole {
namespace {

using std::numbers::pi;

/// Beyond this many sigma edges do not interfere: their light is coherent by exp(-r^2/(8 sigma^2)), 2e-3 there.
constexpr double kCoherent = 7;
/// Within this distance along the light, in sigma, edges belong to one beam.
constexpr double kDepth = 3;
/// Beyond this many sigma from its ends an edge is as good as endless, to exp(-12.5).
constexpr double kEndless = 10;

/// The closed form of the power that an edge diffracts holds for cones narrower than kWidestCone, and where no edge side by side with it is
/// within kApart wavelengths: what of their waves has no direction is not in it (7 % of the power of a wire of half a wavelength, -.7 % of one
/// and a half, .3 % of two and a half; at corners its errors cancel along the edges). Edges are side by side where the cosine of their angle is
/// above kParallel and the way to the other one leaves that by a sine above kBeside: pieces of one curve follow each other instead.
constexpr float kWidestCone = 1 / 60.f;
constexpr double kApart = 2, kBeside = 0.25, kParallel = 0.7;

/// Cauchy's distribution wrapped around the circle, of mode 0.
double sample_wrapped_cauchy(double gamma, double u) {
  return 2 * std::atan(std::tanh(0.5 * gamma) * std::tan(pi * (u - 0.5)));
}
double wrapped_cauchy_pdf(double gamma, double cosine) {
  return std::sinh(gamma) / (2 * pi * (std::cosh(gamma) - cosine));
}

/// A frame about an edge in which the light that arrives along d_i goes on at the azimuth 0.
struct EdgeFrame {
  EdgeFrame(const MeshEdge& edge, const Double3& d_i) : e(EdgeLine(edge).direction) {
    cosine = dot(d_i, e);
    Double3 across = d_i - e * cosine;
    sine = length(across);
    if (sine > 1e-9) {
      x = across * (1 / sine);
      y = cross(e, x);
    } else {
      make_basis(e, x, y);
    }
  }
  /// How fast K falls with the azimuth, for a cone of that angle.
  double gamma(double angle) const { return std::min(3.0, 1.5 * angle / std::max(sine, 1e-3)); }

  Double3 e, x, y;
  double cosine, sine;
};

}  // namespace

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
  for (const ModelPart& part : parts.surfaces) box.extend(part.bounds());
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
  has_mirrors_ = std::ranges::any_of(parts.surfaces, [&](const ModelPart& part) {
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
  // Every sample looks at all edges within its beam; clusters need little time for it.
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
  const Spectrum unit = float(1e9 * unit_m_);  // in nanometres
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
  // Away from both faces. At a boundary the surface ends.
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
  // The rounding of places on faces, and of rays that come from afar: theirs grows with the way.
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
  // Keller's coefficient times the ends' squared distance; ends at infinity have none.
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
    // Light from edges shorter than a beam comes from all of their length.
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
  // Evenly by the angle under which it is seen: as the inverse square of the distance.
  const Double3 to = Double3(a.p) - line.origin;
  const double foot = dot(to, line.direction);
  const double across = std::max(length(to - line.direction * foot), 1e-6 * line.length);
  const double begin = std::atan(-foot / across), end = std::atan((line.length - foot) / across);
  const double l = std::clamp(foot + across * std::tan(begin + u[2] * (end - begin)), 0.0, line.length);
  const double r = l - foot;
  const double pdf = across / ((end - begin) * (across * across + r * r));
  return point_on(edge, line, l, float(choice->probability * pdf));
}

namespace {

/// Edges seen along a direction, in the plane of x and y about a place. The obstacle is on the left of an edge where its first face is lit.
struct Projection {
  Double3 origin, x, y;
  Vec3 d;

  optics::ProjectedEdge operator()(const MeshEdge& edge, const EdgeStretch& part = {}) const {
    // Pointers are exchanged without a branch, which could not be predicted.
    const bool left = is_left(edge);
    const Vec3 *from = left ? &edge.a : &edge.b, *to = left ? &edge.b : &edge.a;
    Double3 a = Double3(*from) - origin, b = Double3(*to) - origin;
    if (part.from > 0 || part.to < 1) {
      const Double3 way = b - a;
      const double begin = left ? part.from : 1 - part.to, end = left ? part.to : 1 - part.from;
      b = a + way * end, a = a + way * begin;
    }
    return {{dot(a, x), dot(a, y)}, {dot(b, x), dot(b, y)}, length(b - a)};
  }
  bool is_left(const MeshEdge& edge) const { return dot(edge.n0, d) < 0; }
};

/// The fraction of a place along its edge.
double fraction_of(const EdgePoint& point) { return point.at / EdgeLine(*point.edge).length; }

}  // namespace

struct SceneEdges::Neighbours {
  /// `near` is the thread's, until the next call.
  const std::vector<const MeshEdge*>* near;
  bool is_cluster;               ///< `near` has the edge itself, too
  EdgeStretch own;               ///< the part of the edge about the place that no face covers
  double before = 0, after = 0;  ///< of its straight line, from the place to the ends
  bool alone = false;            ///< there are none but parts of that line, whose ends are far
};

std::optional<SceneEdges::Neighbours> SceneEdges::neighbours(const EdgePoint& point, const Vec3& d,
                                                             const Beams& beams) const {
  const std::size_t number = index_.number(*point.edge);
  const double length = EdgeLine(*point.edge).length, at = fraction_of(point);
  EdgeStretch own;
  if (covers_.may_be(number)) {
    const auto open = covers_.open(*point.edge, number, d, float(kDepth * beams.widest));
    const auto part =
        std::ranges::find_if(open, [&](const EdgeStretch& part) { return part.from <= at && at <= part.to; });
    if (part == open.end()) return {};
    own = *part;
  }
  thread_local std::vector<const MeshEdge*> near;
  near.clear();
  if (const auto cluster = clusters_.of(number); !cluster.empty()) {
    // Without branches: which edges are outlines cannot be predicted.
    near.resize(cluster.size());
    std::size_t count = 0;
    for (const std::uint32_t i : cluster) {
      const MeshEdge& edge = index_.edges()[i];
      near[count] = &edge;
      count += edge.is_outline(d);
    }
    near.resize(count);
    return Neighbours{.near = &near, .is_cluster = true, .own = own};
  }
  const float radius = float(kCoherent * beams.widest), depth = float(kDepth * beams.widest);
  const StraightEdges::Place place = straight_.of(number);
  bool others = false;  // that are no part of the same line
  index_.visit_edges({point.x.to_float(), d, radius, -depth, depth}, [&](const MeshEdge& edge) {
    if (&edge == point.edge) return;
    near.push_back(&edge);
    const std::uint32_t other = index_.number(edge);
    others |= straight_.of(other).line != place.line || covers_.may_be(other);
  });
  const double ends = kEndless * beams.widest,
               before = (at - own.from) * length + (own.from > 0 ? 0 : double(place.before)),
               after = (own.to - at) * length + (own.to < 1 ? 0 : double(place.after));
  return Neighbours{&near, false, own, before, after, !others && before > ends && after > ends};
}

/// `projected` receives what is seen of the edges; the place lies on the one of that number, `at` a fraction of it.
struct SceneEdges::Projected {
  std::size_t own = 0;
  double at = 0;
};
template <class Project>
SceneEdges::Projected SceneEdges::project(const Neighbours& around, const EdgePoint& point,
                                          const Project& projection, const Beams& beams,
                                          std::vector<optics::ProjectedEdge>& projected) const {
  projected.clear();
  Projected result;
  const auto add = [&](const MeshEdge& edge) {
    const std::size_t number = index_.number(edge);
    const bool is_own = &edge == point.edge;
    if (!covers_.may_be(number)) {
      if (is_own) result.own = projected.size();
      projected.push_back(projection(edge));
      return;
    }
    const auto own_at = projected.size();
    if (is_own) result.own = own_at, projected.push_back(projection(edge, around.own));
    for (const EdgeStretch& part : covers_.open(edge, number, projection.d, float(kDepth * beams.widest)))
      if (!is_own || part.from != around.own.from) projected.push_back(projection(edge, part));
  };
  if (!around.is_cluster) add(*point.edge);
  for (const MeshEdge* edge : *around.near) add(*edge);
  const double at = (fraction_of(point) - around.own.from) / (around.own.to - around.own.from);
  result.at = projection.is_left(*point.edge) ? at : 1 - at;
  return result;
}

Spectrum SceneEdges::kernel(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o, const Beams& beams,
                            Vec2 u) const {
  Double3 in = normalize(Double3(d_i)), out = normalize(Double3(d_o));
  const Double3 turn = out - in, sum = in + out;
  const double turn2 = dot(turn, turn), sum2 = dot(sum, sum);
  if (!(turn2 > 1e-18) || !(sum2 > 1e-12)) return 0.f;
  const Double3 along = sum * (1 / std::sqrt(sum2));
  const Vec3 d = along.to_float();
  if (!point.edge->is_outline(d)) return 0.f;

  double k[kWavelengths], sigma[kWavelengths], result[kWavelengths];
  for (int i = 0; i < kWavelengths; ++i) k[i] = beams.k[i], sigma[i] = beams.sigma[i];
  const double scale = scale_of(*point.edge);
  const auto scaled = [&] { return make_spectrum([&](int i) { return float(scale * result[i]); }); };

  // In the plane across the mean direction, with the light's turn along x.
  const Double3 x = turn * (1 / std::sqrt(turn2));
  const std::size_t number = index_.number(*point.edge), cluster = clusters_.number_of(number);
  const auto wave = [&] {
    const double radius = std::sqrt(-2 * std::log1p(-double(u.x))), phi = 2 * pi * u.y;
    return optics::PlanePoint{radius * std::cos(phi), radius * std::sin(phi)};
  };
  if (cluster != clusters_.size() && !is_covered_[cluster]) {
    const auto in_space = [](const Double3& v) { return optics::SpaceVector{v.x, v.y, v.z}; };
    groups_[cluster].drawn_kernels(clusters_.place_of(number), in_space(along), in_space(x), wave(),
                                   std::sqrt(turn2), k, sigma, result);
    return scaled();
  }

  const std::optional<Neighbours> around = neighbours(point, d, beams);
  if (!around) return 0.f;
  const Double3 seen = EdgeLine(*point.edge).direction - along * dot(EdgeLine(*point.edge).direction, along);
  const double shown2 = dot(seen, seen);
  if (!(shown2 > 1e-12)) return 0.f;
  const double shown = std::sqrt(shown2), along_edge2 = dot(turn, seen) * dot(turn, seen) / shown2,
               along_edge = std::sqrt(along_edge2), across = std::sqrt(std::max(0.0, turn2 - along_edge2));
  if (around->alone) {
    optics::straight_edge_kernels(across, along_edge, shown, k, sigma, result);
    return scaled();
  }

  const Projection projection{point.x, x, cross(along, x), d};
  thread_local std::vector<optics::ProjectedEdge> projected;
  const Projected own = project(*around, point, projection, beams, projected);
  if (around->is_cluster) {
    optics::drawn_edge_kernels(projected, own.own, wave(), std::sqrt(turn2), k, sigma, result);
  } else {
    optics::mean_edge_kernels(projected, own.at, std::sqrt(turn2), k, sigma, result);
    const double weight = optics::straight_edge_weight(projected, own.own, own.at, around->before * shown,
                                                       around->after * shown, double(beams.widest));
    optics::add_straight_edge_corrections(across, along_edge, shown, weight, k, sigma, result);
  }
  return scaled();
}

namespace {

/// Whether an edge beside it and nearly parallel to it is within that distance of a place on its own edge.
bool has_parallel_within(double distance, std::span<const optics::ProjectedEdge> edges, std::size_t own,
                         double at) {
  const optics::PlanePoint& a = edges[own].from;
  const double vx = edges[own].to.x - a.x, vy = edges[own].to.y - a.y, own2 = vx * vx + vy * vy;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double ex = edges[i].to.x - edges[i].from.x, ey = edges[i].to.y - edges[i].from.y,
                 length2 = ex * ex + ey * ey, both = ex * vx + ey * vy;
    if (i == own || !(both * both > kParallel * kParallel * own2 * length2)) continue;
    const double fx = a.x + at * vx - edges[i].from.x, fy = a.y + at * vy - edges[i].from.y;
    const double t = std::clamp((fx * ex + fy * ey) / length2, 0.0, 1.0);
    const double nx = fx - t * ex, ny = fy - t * ey, nearest2 = nx * nx + ny * ny;
    const double beside = fx * ey - fy * ex;  // to the other's line, times its length
    if (nearest2 < distance * distance && beside * beside > kBeside * kBeside * nearest2 * length2)
      return true;
  }
  return false;
}

}  // namespace

std::optional<Spectrum> SceneEdges::power(const EdgePoint& point, const Vec3& direction,
                                          const Beams& beams) const {
  if (beams.angle > kWidestCone) return {};
  const Double3 along = normalize(Double3(direction));
  const Vec3 d = along.to_float();
  if (!point.edge->is_outline(d)) return Spectrum(0.f);
  double k[kWavelengths], sigma[kWavelengths], result[kWavelengths];
  for (int i = 0; i < kWavelengths; ++i) k[i] = beams.k[i], sigma[i] = beams.sigma[i];
  const double scale = scale_of(*point.edge);
  const std::optional<Neighbours> around = neighbours(point, d, beams);
  if (!around) return Spectrum(0.f);
  if (around->alone) {
    const Double3 own = EdgeLine(*point.edge).direction;
    const double cosine = dot(own, along);
    return make_spectrum(
        [&](int i) { return float(scale * optics::straight_edge_power(cosine, k[i], sigma[i])); });
  }
  Double3 x, y;
  make_basis(along, x, y);
  // y turned from x as it is for `kernel`: the obstacle's side must be the same.
  const Projection projection{point.x, x, cross(along, x), d};
  thread_local std::vector<optics::ProjectedEdge> projected;
  const Projected own = project(*around, point, projection, beams, projected);
  if (has_parallel_within(kApart * 2 * pi / min_component(beams.k), projected, own.own, own.at)) return {};
  optics::mean_edge_powers(projected, own.own, own.at, k, sigma, result);
  if (!around->is_cluster) {
    const double cosine = dot(EdgeLine(*point.edge).direction, along),
                 shown = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double weight = optics::straight_edge_weight(projected, own.own, own.at, around->before * shown,
                                                       around->after * shown, double(beams.widest));
    for (int i = 0; i < kWavelengths; ++i)
      result[i] += weight * optics::straight_edge_power_correction(cosine, sigma[i]);
  }
  return make_spectrum([&](int i) { return float(scale * result[i]); });
}

Spectrum SceneEdges::far_enough(float distance, bool from_edge, const Beams& beams) {
  const float least = from_edge ? float(kCoherent) : 1.f;
  return make_spectrum([&](int i) { return distance > least * beams.sigma[i] ? 1.f : 0.f; });
}

std::optional<SceneEdges::Direction> SceneEdges::scatter(const EdgePoint& point, const Vec3& d_i,
                                                         const Beams& beams, const float* u) const {
  const EdgeFrame frame(*point.edge, Double3(d_i));
  const int chosen = beams.achromatic ? 0 : std::min(int(u[3] * kWavelengths), kWavelengths - 1);
  const double angle = 0.5 / (double(beams.k[chosen]) * beams.sigma[chosen]);
  // Box and Muller's Gaussian across the cone, Cauchy's distribution around it.
  const double normal = std::sqrt(-2 * std::log1p(-double(u[0]))) * std::cos(2 * pi * u[1]);
  const double cosine = frame.cosine + std::max(frame.sine, 1e-3) * angle * normal;
  if (!(std::abs(cosine) < 1)) return {};
  const double azimuth = sample_wrapped_cauchy(frame.gamma(angle), u[2]),
               sine = std::sqrt(1 - cosine * cosine);
  const Double3 d =
      frame.e * cosine + frame.x * (sine * std::cos(azimuth)) + frame.y * (sine * std::sin(azimuth));
  Direction result{normalize(d.to_float()), 0};
  result.pdf = scatter_pdf(point, d_i, result.d, beams);
  if (!(result.pdf > 0)) return {};
  return result;
}

float SceneEdges::scatter_pdf(const EdgePoint& point, const Vec3& d_i, const Vec3& d_o,
                              const Beams& beams) const {
  const EdgeFrame frame(*point.edge, Double3(d_i));
  const Double3 out(d_o);
  const double off = dot(out, frame.e) - frame.cosine, x = dot(out, frame.x), y = dot(out, frame.y);
  const double cosine = x / std::max(std::hypot(x, y), 1e-300);
  double sum = 0;
  const int count = beams.achromatic ? 1 : kWavelengths;
  for (int i = 0; i < count; ++i) {
    const double angle = 0.5 / (double(beams.k[i]) * beams.sigma[i]),
                 deviation = std::max(frame.sine, 1e-3) * angle;
    const double z = off / deviation;
    sum += std::exp(-0.5 * z * z) / (deviation * std::sqrt(2 * pi)) *
           wrapped_cauchy_pdf(frame.gamma(angle), cosine);
  }
  return float(sum / count);
}

}  // namespace aureole
