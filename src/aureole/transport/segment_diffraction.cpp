// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/segment_diffraction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <deque>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "aureole/optics/diffraction/uniform_theory.h"
#include "aureole/scene/edge/edge_block.h"
#include "aureole/scene/edge/edge_screens.h"
#include "aureole/transport/edge_rows.h"
#include "aureole/transport/edge_unfolding.h"

namespace aureole {

namespace {

/// Whether the straight line from `from` to shortly before `to` is unoccluded except for null surfaces.
bool is_free(const Scene& scene, const Vec3& from, const Vec3& to, bool infinite, const Wavelengths& w) {
  // The end lies on a surface: the test ends before it, by more than the rounding of its coordinates.
  constexpr float kPart = 0.99999f;
  if (scene.has_binary_visibility()) {
    Ray ray = infinite ? Ray{from, to, kInfinity} : Ray{from, to - from, kPart};
    ray.time = w.time;
    return !scene.tracer().occluded(ray);
  }
  TestSegment test;
  if (infinite)
    test.set(RayOrigin::in_space(from), to);
  else
    test.set(RayOrigin::in_space(from), normalize(to - from),
             RayOrigin::in_space(from + (to - from) * kPart));
  test.passage = test.clear_passage = 1.f;
  return is_visible(scene, test, w) && max_component(test.passage) >= TestSegment::kOpaque;
}

/// Whether the line across the plane of a mirror meets a mirror there. `normal`: the unit normal of that plane.
bool meets_mirror(const Scene& scene, const Double3& from, const Double3& to, const Double3& normal,
                  float time) {
  Ray ray{from.to_float(), (to - from).to_float(), 1.f};
  ray.time = time;
  const RayTracer::Hit hit = scene.tracer().intersect(ray);
  if (!hit || hit.is_lost()) return false;
  const SurfacePoint point = scene.surface_point(hit, ray);
  constexpr double kLeastCosine = 1 - 1e-6;
  return has(point.surface->lobes, Lobe::delta) && std::abs(dot(Double3(point.ng), normal)) > kLeastCosine &&
         is_flat(point);
}

/// Whether the line between two points of unfolded space, by way of the mirrors between their legs, is unoccluded.
/// `leg_a` is at most `leg_b`; `b` is a direction if `is_infinite`.
bool is_free(const Scene& scene, const UnfoldedPath& path, const Double3& a, std::size_t leg_a,
             const Double3& b, std::size_t leg_b, bool is_infinite, const Wavelengths& w) {
  return path.visit_pieces(
      a, leg_a, b, leg_b, is_infinite,
      [&](const Double3& from, const Double3& to, bool to_infinity) {
        return is_free(scene, from.to_float(), to.to_float(), to_infinity, w);
      },
      [&](const Double3& from, const Double3& to, const Double3& normal) {
        return meets_mirror(scene, from, to, normal, w.time);
      });
}

/// The field u/u0 at the far end of a segment, as a sum over the parts of edges beside it.
class SegmentField {
public:
  /// `begin` and `end` are the endpoints, offset from their surfaces; `end` is a direction where the segment
  /// is infinite. `path`: the path between mirrors whose unfolded segment it is, or null.
  SegmentField(const Scene& scene, const EdgeSegment& segment, const Vec3& begin, const Vec3& end,
               bool is_open, const Wavelengths& w, const UnfoldedPath* path = nullptr)
      : scene_(scene),
        path_(path),
        edges_(*scene.outline_edges()),
        segment_(segment),
        begin_(begin),
        end_(end),
        is_open_(is_open),
        w_(w) {
    for (std::size_t i = 0; i < wavelengths_.size(); ++i) {
      wavelengths_[i] = edges_.wavelength(w.nm[int(i)]);
      shortest_ = std::min(shortest_, wavelengths_[i]), longest_ = std::max(longest_, wavelengths_[i]);
    }
    // All wavelengths of a path share one field if they differ by less than this fraction of its phase.
    constexpr double kAlike = 1e-5;
    if (longest_ - shortest_ < kAlike * longest_) count_ = 1;
  }
  /// Returns |u/u0|^2 at each wavelength.
  Spectrum factor() {
    std::vector<EdgeBeside>& beside = beside_edges();
    visit_edges([&](const EdgePassage& passage) {
      // An edge that is no outline for light diffracted by it alone may be one for light that another edge
      // also diffracts.
      EdgeBeside edge{passage, {}, true};
      const Double3 &in = passage.in, &out = passage.out;
      edge.is_outline = edges_.find_side(passage, segment_, in, out, false, edge.side);
      if (edge.is_outline || edges_.find_side(passage, segment_, in, out, true, edge.side) ||
          edges_.find_side(passage, segment_, in, in, true, edge.side) ||
          edges_.find_side(passage, segment_, out, out, true, edge.side))
        beside.push_back(edge);
    });
    if (beside.empty()) return is_open_ ? 1.f : 0.f;
    beside_ = beside;
    const EdgeScreens screens(edges_, segment_, beside);
    screens_ = &screens;
    std::vector<EdgePart>& parts = edge_parts();
    for (std::size_t i = 0; i < beside.size(); ++i) add_parts(i, beside[i], parts);
    RowParts row_parts;
    std::array<Row, kMaxRows> rows;
    std::size_t row_count = 0;
    if (parts.size() > 1 && !screens.is_one_sheet()) row_count = find_rows(parts, row_parts, rows);
    // The loop has two passes, for the waves of soft and of hard polarisation, or one for all waves.
    using Polarisation = DiffractionSettings::Polarisation;
    const Polarisation polarisation = scene_.parts().diffraction->polarisation;
    const bool has_both = polarisation == Polarisation::both;
    Spectrum result = 0.f;
    for (int k = 0; k < (has_both ? 2 : 1); ++k) {
      is_wedge_ = polarisation != Polarisation::none;
      is_hard_ = has_both ? k == 1 : polarisation == Polarisation::hard;
      field_.fill(is_open_ ? 1.0 : 0.0);
      for (const EdgePart& part : parts) subtract(part);
      for (std::size_t i = 0; i < row_count; ++i) add(rows[i], row_parts);
      if (!any_) return is_open_ ? 1.f : 0.f;
      for (std::size_t i = 0; i < field_.size(); ++i)
        result[int(i)] += float(std::norm(field_[count_ == 1 ? 0 : i])) * (has_both ? 0.5f : 1.f);
    }
    return result;
  }

private:
  using Field = std::array<std::complex<double>, kWavelengths>;
  /// A part of an edge that no other edge crosses.
  struct EdgePart {
    std::size_t edge;  ///< index into the edges beside the segment
    EdgePassage passage;
    EdgeSide side;
    bool is_outline;
    /// visibility, from the segment's two endpoints, of a point just beside the edge on its open side
    bool seen_from_begin, seen_from_end;
    double v = 0;  ///< |v| for a wavelength of 1, at the point of the part with the smallest detour
    double length_weight = 1;  ///< 1: it acts like an infinite edge, 0: like a point
    double in_rows = 0;        ///< weight with which the part acts in rows (1) instead of by itself (0)

    /// Whether it diffracts light by itself.
    bool is_seen() const { return is_outline && seen_from_begin && seen_from_end; }
  };
  /// Edges that act together, as indices into RowParts.
  struct Row {
    std::array<std::size_t, RowParts::kCapacity> parts;
    std::size_t count = 0;
    double weight = 1;
  };
  static constexpr std::size_t kMaxRows = RowParts::kCapacity / 2;

  // Scratch memory is kept between calls, since scenes may have thousands of edges beside a segment.
  static std::vector<EdgeBeside>& beside_edges() {
    static thread_local std::vector<EdgeBeside> all;
    all.clear();
    return all;
  }
  static std::deque<MeshEdge>& rims() {
    static thread_local std::deque<MeshEdge> all;
    if (!all.empty()) all.clear();
    return all;
  }
  static std::vector<EdgePart>& edge_parts() {
    static thread_local std::vector<EdgePart> all;
    all.clear();
    return all;
  }

  /// Calls visit(passage) for the edges beside the segment or, between mirrors, beside each leg of the path.
  template <class Visit>
  void visit_edges(const Visit& visit) const {
    std::deque<MeshEdge>& all = rims();
    if (!path_) return edges_.visit(segment_, is_open_, shortest_, longest_, all, visit);
    for (std::size_t leg = 0; leg < path_->size(); ++leg) {
      std::deque<MeshEdge> rims_of_leg;
      edges_.visit(path_->seen_from(leg), is_open_, shortest_, longest_, rims_of_leg,
                   [&](const EdgePassage& passage) {
                     MeshEdge edge;
                     EdgePassage unfolded;
                     if (!path_->unfold(passage, leg, edge, unfolded)) return;
                     unfolded.edge = &all.emplace_back(edge);
                     visit(edges_.part(unfolded, segment_, unfolded.begin, unfolded.end, false, false));
                   });
    }
  }

  /// Whether a point beside an edge, on a leg of the path, is visible from an end of the segment.
  bool sees(const Double3& p, std::size_t leg, bool is_begin) const {
    const bool is_infinite = !is_begin && segment_.is_infinite();
    if (!path_) return is_free(scene_, p.to_float(), is_begin ? begin_ : end_, is_infinite, w_);
    if (is_begin) return is_free(scene_, *path_, Double3(begin_), 0, p, leg, false, w_);
    return is_free(scene_, *path_, p, leg, Double3(end_), path_->size() - 1, is_infinite, w_);
  }
  bool sees(const EdgeSide& side, bool is_begin) const { return sees(side.beside, side.leg, is_begin); }
  /// Whether two points beside edges, on legs of the path, are visible from each other.
  bool is_free_between(const Double3& a, std::size_t leg_a, const Double3& b, std::size_t leg_b) const {
    if (!path_) return is_free(scene_, a.to_float(), b.to_float(), false, w_);
    return leg_a <= leg_b ? is_free(scene_, *path_, a, leg_a, b, leg_b, false, w_)
                          : is_free(scene_, *path_, b, leg_b, a, leg_a, false, w_);
  }

  void add_parts(std::size_t index, const EdgeBeside& edge, std::vector<EdgePart>& parts) {
    cuts_.clear();
    if (!screens_->is_one_sheet()) screens_->find_cuts(index, cuts_);
    for (std::size_t i = 0; i <= cuts_.size(); ++i) {
      EdgePart part{index, edge.passage, edge.side, edge.is_outline, false, false};
      if (!cuts_.empty()) {
        const bool is_first = i == 0, is_last = i == cuts_.size();
        part.passage = edges_.part(edge.passage, segment_, is_first ? edge.passage.begin : cuts_[i - 1],
                                   is_last ? edge.passage.end : cuts_[i], !is_first, !is_last);
        // A part of an edge that is no outline for this light keeps the sides of the whole edge.
        if (!edges_.find_side(part.passage, segment_, part.passage.in, part.passage.out, !edge.is_outline,
                              part.side)) {
          if (edge.is_outline) continue;
          part.side.beside = segment_.from + part.passage.p + part.side.normal * part.side.offset;
        }
      }
      if (!screens_->is_one_sheet()) {
        const DetourLine line(*part.passage.edge, segment_);
        part.v = line.parameter(std::clamp(part.passage.middle, part.passage.begin, part.passage.end));
        part.length_weight = length_weight(line, part.passage);
      }
      if (screens_->is_copy(index, part.passage, longest_)) continue;
      part.seen_from_begin = sees(part.side, true);
      // If the part is not visible from the begin, its visibility from the end matters only where another
      // edge diffracts light towards the begin.
      part.seen_from_end = (part.seen_from_begin || !screens_->is_one_sheet()) && sees(part.side, false);
      parts.push_back(part);
    }
  }

  /// Weight in [0, 1] of a part acting like an infinite edge: whether it is long enough in both directions
  /// from the point with the smallest detour.
  double length_weight(const DetourLine& line, const EdgePassage& passage) const {
    if (!passage.passes_middle()) return 0;
    const double v = line.parameter(passage.middle);
    const double end = std::min(line.parameter(passage.begin), line.parameter(passage.end));
    const double along = std::sqrt(std::max(0.0, end * end - v * v) / longest_);
    constexpr double kShort = 0.5, kLong = 1.5;
    return optics::smooth_step((along - kShort) / (kLong - kShort));
  }

  std::size_t find_rows(std::vector<EdgePart>& parts, RowParts& candidates, std::array<Row, kMaxRows>& rows) {
    bool is_dark = !is_open_;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const EdgePart& part = parts[i];
      if (part.is_seen()) is_dark = false;
      RowPart candidate{part.passage};
      candidate.weight = part.length_weight;
      if (candidate.weight == 0) continue;
      candidate.part = i;
      candidate.v = part.v / std::sqrt(longest_);
      if (part.is_seen()) candidate.subtracted = part.side.takes_open(is_open_);
      candidates.add(candidate);
    }
    // Fewer than three edges make no row: two edges are screens of each other.
    if (candidates.size() < 3) return 0;
    candidates.sort(segment_);
    const EdgeRows edge_rows(
        edges_, segment_, candidates,
        [&](const EdgeSide& side, bool is_begin) { return sees(side, is_begin); },
        [&](const EdgeSide& a, const EdgeSide& b) {
          return is_free_between(a.beside, a.leg, b.beside, b.leg);
        });
    std::size_t count = 0;
    edge_rows.for_each(is_dark, [&](const std::size_t* row, std::size_t length_of_row) {
      if (count == kMaxRows) return;
      Row& added = rows[count++];
      added.count = length_of_row;
      std::copy(row, row + length_of_row, added.parts.begin());
      for (std::size_t i = 0; i < length_of_row; ++i)
        added.weight = std::min(added.weight, candidates[row[i]].weight);
      for (std::size_t i = 0; i < length_of_row; ++i) parts[candidates[row[i]].part].in_rows = added.weight;
    });
    return count;
  }

  /// A part of an edge as light passes it: what its screens and wedges make of its wave.
  struct Passing {
    Field weight;    ///< factor of the wave
    Field together;  ///< wedges of the part and of screens on whose open side light passes, over half planes
    double share = 1;  ///< fraction of the wave that is that of a single edge, without `together`
    /// Weight in [0, 1] with which light is diffracted at all: 1 at outlines and in the shadow of screens. On
    /// unoccluded segments an edge that is no outline has weight near the plane of a face that it shares with its
    /// screen, such as a roof.
    double turns = 0;
    /// Whether the sides of the part and of another edge of one face agree with the segment's visibility.
    bool is_sure = false;
  };

  /// Changes `passing` by the screens between a part and one end of the segment. Light that does not see the part from
  /// that end may arrive around both sides of what lies between them. Returns false if no light arrives.
  bool pass_screens(const EdgePart& part, bool is_begin, Passing& passing) const {
    const bool is_seen = is_begin ? part.seen_from_begin : part.seen_from_end;
    const auto is_open = [&](const EdgeScreens::Screen& s) {
      const std::size_t leg = beside_[s.edge].passage.edge->leg;
      return is_free_between(part.side.beside, part.side.leg, s.beside, leg) && sees(s.beside, leg, is_begin);
    };
    bool arrives = is_seen;
    Field sum{};
    for (const int side : {1, -1}) {
      const auto screen = screens_->find_screen(part.edge, part.passage, !is_begin, is_seen,
                                                is_seen ? 0 : side, longest_, std::cref(is_open));
      if (screen) {
        arrives = true;
        const EdgeBeside& other = beside_[screen->edge];
        const bool is_of_one_face = OutlineEdges::have_common_face(part.passage, other.passage);
        // Where the sides contradict the segment's visibility within rounding errors, the segment lies in the plane of
        // both edges.
        const bool agrees = (part.side.is_open && other.side.is_open) == is_open_;
        double v = part.v, w = screen->v;
        constexpr double kNothing = 1e-9;
        const bool is_in_plane = part.side.is_at_border && screen->is_touched &&
                                 (!agrees || v + std::abs(w) < kNothing * std::sqrt(shortest_));
        if (is_in_plane)
          set_in_plane(part, *screen, is_begin, v, w);
        else if (is_of_one_face && agrees)
          passing.is_sure = true;
        if (screen->v < 0 || screen->is_at_border)
          passing.turns = 1;
        else if (is_of_one_face && is_open_)
          passing.turns = std::max(passing.turns, 1 - far_from(*screen));
        Field wave;
        for (std::size_t i = 0; i < std::size_t(count_); ++i) {
          const double scale = 1 / std::sqrt(wavelengths_[i]);
          wave[i] = screen->obliquity * optics::wave_past_edge(v * scale, w * scale, part.length_weight);
        }
        if (is_wedge_) make_pair_of_wedges(part, *screen, is_begin, is_seen, is_in_plane, passing, wave);
        for (std::size_t i = 0; i < std::size_t(count_); ++i) sum[i] += wave[i];
      }
      if (!is_seen) continue;
      if (screen)
        for (std::size_t i = 0; i < std::size_t(count_); ++i) passing.weight[i] *= sum[i];
      return true;
    }
    for (std::size_t i = 0; i < std::size_t(count_); ++i) passing.weight[i] *= sum[i];
    return arrives;
  }

  /// Weight in [0, 1] of light that passes a screen so far on its open side that it is light of the part alone.
  double far_from(const EdgeScreens::Screen& screen) const {
    constexpr double kNear = 4, kFar = 10;
    return std::clamp((screen.v / std::sqrt(longest_) - kNear) / (kFar - kNear), 0.0, 1.0);
  }

  /// Sets Fresnel's parameters of a part and of its screen for a segment in the plane of both edges. Both vanish there, and
  /// the field depends on their ratio: it is that of ends beside the plane at equal small angles, above it for
  /// unoccluded segments, else below it.
  void set_in_plane(const EdgePart& part, const EdgeScreens::Screen& screen, bool is_begin, double& v,
                    double& w) const {
    const Double3 &p = part.passage.p, &q = beside_[screen.edge].passage.p;
    const double to_begin = length(is_begin ? q : p);
    const bool is_infinite = segment_.is_infinite();
    const double to_end = is_infinite ? 1 : length(segment_.d * segment_.length - (is_begin ? p : q));
    const double between = length(q - p), own = is_begin ? to_end : to_begin,
                 other = is_begin ? to_begin : to_end;
    constexpr double kSmall = 1e-5;
    const double angle = kSmall * std::sqrt(shortest_ / between);
    // The two limits are those of an end at infinity, on the part's side and on the screen's side.
    if (is_infinite && is_begin) {
      v = angle * (between + 2 * other) * std::sqrt(2 / (between + other));
    } else if (is_infinite) {
      v = angle * 2 * std::sqrt(2 * own);
    } else {
      v = angle * (between + 2 * other) * std::sqrt(2 * own / ((between + other) * (own + between + other)));
    }
    w = angle * std::sqrt(2 * between * (is_infinite && !is_begin ? 1 : other / (between + other)));
    if (!is_open_) w = -w;
  }

  /// Subtracts the wave of a part of an edge.
  void subtract(const EdgePart& part) {
    bool is_open = part.side.takes_open(is_open_);
    if (screens_->is_one_sheet() && !is_wedge_) {
      if (!part.is_seen()) return;
      any_ = true;
      edges_.subtract(part.passage, segment_, is_open, wavelengths_.data(), count_, field_.data());
      return;
    }
    Passing passing;
    Field& weight = passing.weight;
    weight.fill(1 - part.in_rows), passing.together.fill(1);
    passing.turns = part.is_outline ? 1 : 0;
    // The light at the end from which the part is not seen is computed first: often there is none.
    const bool first = part.seen_from_end && !part.seen_from_begin;
    const bool arrives = screens_->is_one_sheet()
                             ? part.is_seen()
                             : part.in_rows < 1 && pass_screens(part, first, passing) &&
                                   pass_screens(part, !first, passing) && passing.turns > 0;
    if (!arrives) weight.fill(0);
    if (passing.turns < 1)
      for (auto& x : weight) x *= passing.turns;
    if (is_wedge_ && arrives) make_wedge(part, passing);
    if (part.is_seen())
      for (auto& x : weight) x += part.in_rows;
    if (std::all_of(weight.begin(), weight.begin() + count_, [](const auto& x) { return x == 0.0; })) return;
    any_ = true;
    if (passing.is_sure) is_open = part.side.is_open;
    Field wave{};
    edges_.subtract(part.passage, segment_, is_open, wavelengths_.data(), count_, wave.data());
    for (std::size_t i = 0; i < std::size_t(count_); ++i) field_[i] += weight[i] * wave[i];
  }

  /// Changes a wave by way of a part and of a screen by their wedges: in the shadow of the screen the wave itself,
  /// on its open side `passing`.
  void make_pair_of_wedges(const EdgePart& part, const EdgeScreens::Screen& screen, bool is_begin,
                           bool is_seen, bool is_in_plane, Passing& passing, Field& wave) const {
    const EdgePassage& other = beside_[screen.edge].passage;
    // Another body may occlude a segment that passes both edges on their open sides.
    const auto is_clear = [](const EdgeSide& side) { return side.is_open && !side.is_at_border; };
    const bool passes = is_open_ || (is_clear(part.side) && is_clear(beside_[screen.edge].side));
    const EdgeBlock block(edges_, is_begin ? other : part.passage, is_begin ? part.passage : other, segment_,
                          passes, is_in_plane);
    if (block.kind() == EdgeBlock::Kind::face) {
      const int position = is_begin ? 1 : 0;
      if (!is_seen) return multiply_by_block(block, position, wave);
      passing.share = std::min(passing.share, far_from(screen));
      if (passing.share < 1) multiply_by_block(block, position, passing.together);
    } else if (block.kind() == EdgeBlock::Kind::apart && !is_seen) {
      multiply_by_wedge(block.wedge(0), wave);
      multiply_by_wedge(block.wedge(1), wave);
    }
  }
  /// Multiplies the wave of a part by its wedge over a half plane that absorbs, with `passing.together`.
  void make_wedge(const EdgePart& part, Passing& passing) const {
    const double share = part.is_seen() ? passing.share : 0;
    Field alone;
    alone.fill(1);
    if (share > 0) {
      const EdgePassage& passage = part.passage;
      EdgeWedge wedge;
      const double s_out =
          segment_.is_infinite() ? segment_.length : length(segment_.d * segment_.length - passage.p);
      if (edges_.find_wedge(*passage.edge, {passage.in, passage.out, length(passage.p), s_out}, wedge))
        multiply_by_wedge(wedge, alone);
    }
    for (std::size_t i = 0; i < std::size_t(count_); ++i)
      passing.weight[i] *= (1 - share) * passing.together[i] + share * alone[i];
  }
  void multiply_by_wedge(const EdgeWedge& wedge, Field& weight) const {
    const Faces faces = faces_of(wedge);
    for (std::size_t i = 0; i < std::size_t(count_); ++i)
      weight[i] *= optics::Wedge(wedge.n).over_half_plane(
          2 * std::numbers::pi / wavelengths_[i] * wedge.distance, wedge.phi, wedge.phi_i, faces[i]);
  }
  /// `position`: whether the wave is that of the first (0) or of the second edge (1) of the block.
  void multiply_by_block(const EdgeBlock& block, int position, Field& weight) const {
    const Field face = reflection(block.wedge(0).reflection_o, 0);
    for (std::size_t i = 0; i < std::size_t(count_); ++i)
      weight[i] *= block.over_half_planes(position, wavelengths_[i], face[i]);
  }

  using Faces = std::array<optics::WedgeFaces, kWavelengths>;
  /// Returns the reflection coefficients of a wedge's faces. Each face reflects as at the grazing angle of the end
  /// of the light that is nearer to it. For an observer farther from the o-face than the source that is the
  /// heuristic of Luebbers 1984; his form is not reciprocal, this one is.
  Faces faces_of(const EdgeWedge& wedge) const {
    const Field o =
        reflection(wedge.reflection_o, wedge.sin_beta * std::sin(std::min(wedge.phi, wedge.phi_i)));
    const Field n =
        reflection(wedge.reflection_n,
                   wedge.sin_beta * std::sin(wedge.n * std::numbers::pi - std::max(wedge.phi, wedge.phi_i)));
    Faces faces;
    for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = {o[i], n[i]};
    return faces;
  }

  /// Returns the amplitudes with which a face reflects waves of the polarisation, 0 where it absorbs. `cos_i`: cosine of the angle of
  /// incidence, negative where the light comes from behind the plane of the face.
  Field reflection(const DiffractingShapes::Reflection& face, double cos_i) const {
    Field amplitudes{};
    if (!face.is_mirror) return amplitudes;
    if (!face.amplitudes) {
      amplitudes.fill(is_hard_ ? 1 : -1);
      return amplitudes;
    }
    const SurfacePoint point;
    const auto known =
        face.amplitudes->reflection_amplitudes(float(std::min(std::abs(cos_i), 1.0)), BsdfContext{w_, point});
    return is_hard_ ? known.p : known.s;
  }

  void add(const Row& row, const RowParts& parts) {
    std::array<EdgePairField, RowParts::kCapacity> pairs;
    std::array<OutlineEdges::RowEdge, RowParts::kCapacity> ends;
    for (std::size_t i = 0; i + 1 < row.count; ++i) {
      const RowPart &first = parts[row.parts[i]], &second = parts[row.parts[i + 1]];
      if (!edges_.find_pair(first.passage, second.passage, segment_, pairs[i])) return;
      if (i == 0) ends[0] = {pairs[0].side1.takes_open(is_open_), first.subtracted};
      ends[i + 1] = {pairs[i].side2.takes_open(is_open_), second.subtracted};
    }
    any_ = true;
    edges_.add_row({pairs.data(), row.count - 1}, {ends.data(), row.count}, row.weight, wavelengths_.data(),
                   count_, field_.data());
  }

  const Scene& scene_;
  const UnfoldedPath* path_;
  const OutlineEdges& edges_;
  const EdgeSegment& segment_;
  const Vec3 &begin_, &end_;
  bool is_open_;
  const Wavelengths& w_;
  std::array<double, kWavelengths> wavelengths_;
  double shortest_ = kInfinity, longest_ = 0;
  int count_ = kWavelengths;
  Field field_;
  bool any_ = false;
  bool is_wedge_ = false, is_hard_ = false;  ///< whether edges act as wedges, and in which polarisation
  const EdgeScreens* screens_ = nullptr;
  std::span<const EdgeBeside> beside_;
  std::vector<double> cuts_;
};

bool has_edges_near(const Scene& scene, const EdgeSegment& segment, const Wavelengths& w) {
  const OutlineEdges& edges = *scene.outline_edges();
  return edges.has_near(segment, edges.wavelength(max_component(w.nm)));
}

/// Returns the probability with which a ray continues behind all obstacles between `begin`, next to `origin`,
/// and `end`, which is a point or infinity.
float probability_behind_all(const Scene& scene, const Vec3& begin, const Vec3& origin, const Vec3& d,
                             const Vec3& end, bool infinite, const Wavelengths& w) {
  const float once = probability_behind(scene, origin, d, false, w);
  float all = 1;
  constexpr float kLittle = 1e-6f;
  Ray ray{begin, infinite ? d : end - begin, infinite ? kInfinity : 1.f};
  ray.time = w.time;
  while (all * once > kLittle) {
    const RayTracer::Hit hit = scene.tracer().intersect(ray);
    if (!hit || hit.is_lost()) return all;
    const SurfacePoint point = scene.surface_point(hit, ray);
    if (!point.surface->passable) all *= once;
    ray.o = offset_origin(point, d);
    if (!infinite) ray.d = end - ray.o;
    if (!(dot(ray.d, d) > 0)) return all;
  }
  return 0;
}

}  // namespace

Spectrum segment_diffraction(const Scene& scene, const Vec3& origin, const Vec3& d, float length,
                             bool is_open, const Wavelengths& w) {
  const EdgeSegment segment{Double3(origin), normalize(Double3(d)), double(length)};
  if (is_open && !has_edges_near(scene, segment, w)) return 1.f;
  const bool infinite = segment.is_infinite();
  const Vec3 begin = origin + d * (1e-5f * (infinite ? 1 : length)), end = infinite ? d : origin + d * length;
  return SegmentField(scene, segment, begin, end, is_open, w).factor();
}

Spectrum chain_diffraction(const Scene& scene, std::span<const PathLeg> legs, bool begins_at_infinity,
                           const Wavelengths& w) {
  if (legs.size() == 1) {
    const PathLeg& leg = legs[0];
    // A segment of light from infinity is evaluated in reverse, from the point at which it arrives.
    return begins_at_infinity ? segment_diffraction(scene, leg.origin + leg.d * leg.length, -leg.d, kInfinity,
                                                    leg.is_open, w)
                              : segment_diffraction(scene, leg.origin, leg.d, leg.length, leg.is_open, w);
  }
  const UnfoldedPath path(legs, begins_at_infinity);
  const EdgeSegment& segment = path.segment();
  const bool infinite = segment.is_infinite();
  const Vec3 begin = (segment.from + segment.d * (1e-5 * (infinite ? 1 : segment.length))).to_float();
  const Vec3 end = infinite ? segment.d.to_float() : (segment.from + segment.d * segment.length).to_float();
  return SegmentField(scene, segment, begin, end, path.is_open(), w, &path).factor();
}

bool has_edges_near(const Scene& scene, const Vec3& origin, const Vec3& d, const Wavelengths& w) {
  return has_edges_near(scene, {Double3(origin), normalize(Double3(d)), double(kInfinity)}, w);
}

float probability_behind(const Scene& scene, const Vec3& origin, const Vec3& d, bool from_infinity,
                         const Wavelengths& w, const SegmentChain* before) {
  // Upper bound of |v|: less than 1e-3 of the light is diffracted farther into a shadow than 20.
  constexpr double kMost = 20, kHalf = 4;
  const OutlineEdges& edges = *scene.outline_edges();
  const double wavelength = edges.wavelength(max_component(w.nm));
  EdgeSegment ray{Double3(origin), normalize(Double3(d)), double(kInfinity)};
  Vec3 begin = origin;
  // Detours depend on the distance at which light from infinity arrives, which is at most at the far side of the
  // scene.
  const auto far = [&] { return 2 * length(scene.tracer().bounds().diagonal()); };
  double v = double(kInfinity);
  SegmentChain chain;
  if (before) {
    chain = *before;
    chain.arrive({origin, d, from_infinity ? far() : kInfinity, true}, from_infinity);
  }
  if (chain.legs().size() > 1) {
    const UnfoldedPath path(chain.legs(), from_infinity);
    const EdgeSegment& whole = path.segment();
    const std::size_t last = path.size() - 1, leg = from_infinity ? 0 : last;
    const auto is_lit = [&](const Double3& beside) {
      // Light that an edge beside another leg has diffracted comes from about the mirror.
      if (!path.is_open()) {
        const Vec3 p = beside.to_float();
        return is_free(scene, p, origin + d * (1e-5f * length(p - origin)), false, w);
      }
      const Double3 p = path.unfold_point(beside, leg);
      if (from_infinity) return is_free(scene, path, p, leg, whole.d, last, true, w);
      return is_free(scene, path, whole.from + whole.d * (1e-5 * length(p - whole.from)), 0, p, leg, false,
                     w);
    };
    v = edges.smallest_parameter(kMost, path.seen_from(leg), wavelength, std::cref(is_lit));
  } else {
    if (before) begin = chain.legs()[0].origin;
    ray.from = Double3(begin);
    if (from_infinity) {
      ray.from = ray.from + ray.d * double(far());
      ray.d = -ray.d;
    }
    const auto is_lit = [&](const Double3& beside) {
      const Vec3 p = beside.to_float();
      return is_free(scene, p, from_infinity ? ray.d.to_float() : begin + d * (1e-5f * length(p - begin)),
                     from_infinity, w);
    };
    v = edges.smallest_parameter(kMost, ray, wavelength, std::cref(is_lit));
  }
  // The power in the shadow falls with v^-2. A power map shows it in dB, so that the probability falls with v^-1.
  return v <= kMost ? float(0.5 / (1 + v / kHalf)) : 0.f;
}

bool diffract_connection(const Scene& scene, TestSegment& c, bool is_open, const Wavelengths& w,
                         const SegmentChain* before) {
  EdgeSegment segment{Double3(c.origin), normalize(Double3(c.d)), kInfinity};
  if (!c.infinite) {
    const Double3 along = Double3(c.target) - segment.from;
    segment.length = length(along);
    segment.d = along * (1 / segment.length);
  }
  // A march through null surfaces has moved the origin of the ray.
  const float part = 1e-5f * (c.infinite ? 1 : float(segment.length));
  const Vec3 begin = scene.has_binary_visibility() ? c.ray.o : c.origin + c.d * part;
  Spectrum passed = is_open ? c.passage : Spectrum(0.f);
  const bool is_blocked = max_component(passed - c.clear_passage * TestSegment::kOpaque) < 0;
  const Vec3& end = c.infinite ? c.d : c.target;
  if (!before && !is_blocked && !has_edges_near(scene, segment, w)) return true;
  Spectrum u2;
  if (before) {
    SegmentChain chain = *before;
    chain.arrive({c.origin, c.d, c.distance(), !is_blocked}, false);
    u2 = chain_diffraction(scene, chain.legs(), chain.begins_at_infinity(), w);
  } else {
    u2 = SegmentField(scene, segment, begin, end, !is_blocked, w).factor();
  }
  if (!is_blocked) {
    c.passage *= u2;
    return true;
  }
  if (before && !is_black(passed))
    passed *= chain_diffraction(scene, before->legs(), before->begins_at_infinity(), w);
  // A connection that has crossed too many surfaces carries no light.
  if ((!is_open && is_black(u2)) || c.crossings_left < 0) return false;
  const float share = c.others_go_behind && max_component(c.other) > 0
                          ? probability_behind_all(scene, begin, c.origin, c.d, end, c.infinite, w)
                          : 0.f;
  c.passage = passed + c.clear_passage * u2 * (sum(c.own + c.other) / sum(c.own + c.other * share));
  return true;
}

}  // namespace aureole
