// SPDX-License-Identifier: Apache-2.0
// K of a scene's edges, its integral S over directions, and the sampling of a direction.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "aureole/optics/diffraction/edge_kernel.h"
#include "aureole/optics/lanes.h"
#include "aureole/scene/edge/scene_edges.h"

namespace aureole {
namespace {

using std::numbers::pi;

/// Distance from its ends, in sigma, beyond which an edge counts as infinite, to exp(-12.5).
constexpr double kEndless = 10;

/// The closed form of the power that an edge diffracts holds for cones narrower than kWidestCone, and if no
/// parallel edge is within kApart wavelengths. It lacks the interference of waves to which no direction
/// belongs: 7 % of the power of a wire of half a wavelength, -0.7 % of one and a half, 0.3 % of two and a
/// half; at corners its errors cancel along the edges. Edges count as parallel beside each other if the
/// cosine of their angle is above kParallel and the sine of the angle between the other edge and the
/// connection to it is above kBeside: pieces of one curve follow each other instead.
constexpr float kWidestCone = 1 / 60.f;
constexpr double kApart = 2, kBeside = 0.25, kParallel = 0.7;

/// Samples a Cauchy distribution wrapped around the circle, with its mode at 0.
double sample_wrapped_cauchy(double gamma, double u) {
  return 2 * std::atan(std::tanh(0.5 * gamma) * std::tan(pi * (u - 0.5)));
}
double wrapped_cauchy_pdf(double gamma, double cosine) {
  return std::sinh(gamma) / (2 * pi * (std::cosh(gamma) - cosine));
}

/// A frame about an edge in which light that arrives along d_i, if it is not diffracted, continues at the
/// azimuth 0.
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
  /// Returns the width in azimuth of the sampled directions, for a diffraction cone of width `angle`.
  double gamma(double angle) const { return std::min(3.0, 1.5 * angle / std::max(sine, 1e-3)); }

  Double3 e, x, y;
  double cosine, sine;
};

/// Projection of edges along a direction, onto the plane of x and y about a point. The obstacle is on the
/// left of an edge whose first face is irradiated.
struct Projection {
  Double3 origin, x, y;
  Vec3 d;

  optics::ProjectedEdge operator()(const MeshEdge& edge, const EdgeStretch& part = {}) const {
    // The ends are exchanged by pointers without a branch, which could not be predicted.
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

/// Returns the position of a point on its edge, as a fraction of the edge's length.
double fraction_of(const EdgePoint& point) { return point.at / EdgeLine(*point.edge).length; }

}  // namespace

struct SceneEdges::Neighbours {
  /// Edges nearby; the list belongs to the calling thread and is valid until its next call.
  const std::vector<const MeshEdge*>* near;
  bool is_cluster;               ///< `near` also holds the edge itself
  EdgeStretch own;               ///< the part of the edge about the point that no face covers
  std::size_t of_line = 0;       ///< number of edges, first in `near`, on the edge's own straight line
  double before = 0, after = 0;  ///< distances from the point to the ends of that line
  bool alone = false;            ///< all of `near` are parts of that line, whose ends are far
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
    // A loop without branches: which edges are outlines cannot be predicted.
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
  std::size_t of_line = 0;
  bool is_line_covered = false;
  index_.visit_edges({point.x.to_float(), d, radius, -depth, depth}, [&](const MeshEdge& edge) {
    if (&edge == point.edge) return;
    near.push_back(&edge);
    const std::uint32_t other = index_.number(edge);
    if (straight_.of(other).line != place.line) return;
    is_line_covered |= covers_.may_be(other);
    std::swap(near[of_line++], near.back());
  });
  double before = (at - own.from) * length, after = (own.to - at) * length;
  // If other parts of the line may be covered, the line counts as ended at the edge.
  if (!is_line_covered && !(own.from > 0)) before += double(place.before);
  if (!is_line_covered && !(own.to < 1)) after += double(place.after);
  const double ends = kEndless * beams.widest;
  return Neighbours{.near = &near,
                    .is_cluster = false,
                    .own = own,
                    .of_line = of_line,
                    .before = before,
                    .after = after,
                    .alone = of_line == near.size() && before > ends && after > ends};
}

/// The result of `project`, which writes the projected edges to `projected`: the point lies on the edge
/// number `own`, at the fraction `at` of its length.
struct SceneEdges::Projected {
  std::size_t own = 0;
  double at = 0;
  std::size_t others = 0;  ///< the first edge that is no part of the own edge's line
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
  for (std::size_t i = 0; i < around.near->size(); ++i) {
    if (i == around.of_line) result.others = projected.size();
    add(*(*around.near)[i]);
  }
  if (around.of_line == around.near->size()) result.others = projected.size();
  const double at = (fraction_of(point) - around.own.from) / (around.own.to - around.own.from);
  result.at = projection.is_left(*point.edge) ? at : 1 - at;
  return result;
}

void SceneEdges::line_weights(const Neighbours& around, std::span<const optics::ProjectedEdge> projected,
                              const Projected& own, double shown, std::span<const double> sigma,
                              std::span<double> weights) {
  const auto& [from, to, length] = projected[own.own];
  const optics::PlanePoint place{from.x + own.at * (to.x - from.x), from.y + own.at * (to.y - from.y)};
  optics::straight_edge_weights(place, around.before * shown, around.after * shown,
                                projected.subspan(own.others), sigma, weights);
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

  // Everything is projected onto the plane perpendicular to the mean direction, with the turn of the light
  // along x.
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
    double weights[kWavelengths];
    line_weights(*around, projected, own, shown, sigma, weights);
    optics::add_straight_edge_corrections(across, along_edge, shown, weights, k, sigma, result);
  }
  return scaled();
}

namespace {

/// Whether a nearly parallel edge beside it is within `distance` of a point on the edge `own`.
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
    const double beside = fx * ey - fy * ex;  // distance to the other edge's line, times that edge's length
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
  // y has the orientation that it has in `kernel`, so that the obstacle is on the same side.
  const Projection projection{point.x, x, cross(along, x), d};
  thread_local std::vector<optics::ProjectedEdge> projected;
  const Projected own = project(*around, point, projection, beams, projected);
  if (has_parallel_within(kApart * 2 * pi / min_component(beams.k), projected, own.own, own.at)) return {};
  optics::mean_edge_powers(projected, own.own, own.at, k, sigma, result);
  if (!around->is_cluster) {
    const double cosine = dot(EdgeLine(*point.edge).direction, along),
                 shown = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    double weights[kWavelengths];
    line_weights(*around, projected, own, shown, sigma, weights);
    for (int i = 0; i < kWavelengths; ++i)
      result[i] += weights[i] * optics::straight_edge_power_correction(cosine, sigma[i]);
  }
  return make_spectrum([&](int i) { return float(scale * result[i]); });
}

std::optional<SceneEdges::Direction> SceneEdges::scatter(const EdgePoint& point, const Vec3& d_i,
                                                         const Beams& beams, const float* u) const {
  const EdgeFrame frame(*point.edge, Double3(d_i));
  const int chosen = beams.achromatic ? 0 : std::min(int(u[3] * kWavelengths), kWavelengths - 1);
  const double angle = 0.5 / (double(beams.k[chosen]) * beams.sigma[chosen]);
  // The angle from the cone is normally distributed (Box & Muller's method), the azimuth has a wrapped Cauchy
  // distribution.
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
