// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/contact_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "aureole/core/random.h"
#include "aureole/scene/boxes.h"

namespace aureole {

bool have_same_index(const Surface& a, const Surface& b, const Wavelengths& w) {
  Spectrum of_a, of_b;
  return a.bsdf->interior_index(w, of_a) && b.bsdf->interior_index(w, of_b) && !any(of_a.v != of_b.v);
}

namespace {

constexpr std::size_t kMostPairs = 20000, kRaysOfAllPairs = 100000;

/// Wavelengths over the range of the scene's sensor, on whose grid indices are tabulated.
Wavelengths sensor_wavelengths(const SpectralGrid& grid) {
  const double step = (grid.max_nm - grid.min_nm) / kWavelengths;
  return Wavelengths::at(grid, make_spectrum([&](int i) { return float(grid.min_nm + (i + 0.5) * step); }));
}

Bounds3 common(const Bounds3& a, const Bounds3& b) {
  Bounds3 box;
  box.lower = max(a.lower, b.lower), box.upper = min(a.upper, b.upper);
  return box;
}

/// Whether two objects are the same or were described by the same text.
bool are_equal(const Object* a, const Object* b) {
  if (a == b) return true;
  return a && b && a->properties().content() != 0 && a->properties().content() == b->properties().content();
}

/// A body in the scene: its number, and the instance through which a ray hits it.
using BodyKey = std::pair<std::uint32_t, const Instance*>;

/// Lengths that rays through a pair of bodies have measured.
struct Overlap {
  double both = 0, first_alone = 0, second_alone = 0;  ///< lengths in both bodies and in one of them
  const Surface *first = nullptr, *second = nullptr;
};

/// The search: marks surfaces as it goes.
class Search {
public:
  Search(const SceneParts& parts, SceneSurfaces& surfaces)
      : parts_(parts.surfaces), surfaces_(surfaces), wavelengths_(sensor_wavelengths(parts.context->grid)) {}

  Contacts run() {
    number_bodies();
    const std::vector<std::pair<std::size_t, std::size_t>> pairs = near_pairs();
    if (!pairs.empty()) {
      const std::size_t rays = std::clamp<std::size_t>(kRaysOfAllPairs / pairs.size(), 12, 768);
      for (const auto& [i, j] : pairs) look_at(i, j, int(std::sqrt(double(rays) / 3)));
    }
    judge_overlaps();
    rank();
    bound_ranked();
    return std::move(found_);
  }

private:
  struct Event {
    float t, tolerance;
    Surface* surface;
    BodyKey body;
    bool inwards;

    bool is_of_body() const { return body.first != 0; }
    bool lets_light_pass() const { return is_of_body() || !surface->is_opaque(); }
  };

  /// Calls f for each surface of a primitive: its own, or the surfaces of its group.
  template <class F>
  void for_surfaces(std::size_t part, F&& f) {
    Surface& own = surfaces_.all[part];
    if (!own.instance) return f(own);
    const std::size_t count = own.instance->list().shapes.size();
    for (std::size_t k = 0; k < count; ++k) f(const_cast<Surface&>(own.members[k]));
  }

  /// Whether the surface bounds a body that light may enter: with a medium or an index of refraction of its own.
  bool may_bound_body(const Surface& surface) const {
    if (!surface.bsdf || surface.has_exit()) return false;
    if (surface.rank != 0 || (surface.bounds_media && surface.outside != surface.inside)) return true;
    Spectrum n;
    return surface.bsdf->interior_index(wavelengths_, n);
  }
  void number_bodies();
  std::vector<std::pair<std::size_t, std::size_t>> near_pairs();
  void look_at(std::size_t i, std::size_t j, int per_side);
  void follow(const Ray& ray, std::size_t i, std::size_t j);
  void note_contacts();
  void note_laid_on(const Event& laid, const Event& body);
  void note_overlaps();
  void judge_overlaps();
  void rank();
  void bound_ranked();
  std::string place_of(const Surface& s) const;

  const std::vector<Primitive>& parts_;
  SceneSurfaces& surfaces_;
  const Wavelengths wavelengths_;
  Contacts found_;
  std::vector<bool> has_body_;  ///< for each primitive
  std::uint32_t bodies_ = 0;
  std::map<std::pair<BodyKey, BodyKey>, Overlap> overlaps_;
  std::set<Surface*> ranked_;
  std::set<std::pair<const Surface*, const Surface*>> laid_on_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> above_;  ///< the first body ranks above the second
  std::vector<RayTracer::Hit> hits_;
  std::vector<Event> events_;
};

void Search::number_bodies() {
  // The primitives of one asset, such as the parts of an OBJ file with several materials, bound one body.
  std::unordered_map<const Properties*, std::size_t> count;
  for (const Primitive& part : parts_) ++count[part.element.get()];
  std::unordered_map<const Properties*, std::uint32_t> known;
  const auto number_of = [&](const Primitive& part) {
    const auto [entry, is_new] = known.try_emplace(part.element.get(), bodies_ + 1);
    bodies_ += is_new;
    return entry->second;
  };
  has_body_.resize(parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Primitive& part = parts_[i];
    for_surfaces(i, [&](Surface& s) {
      if (s.body == 0) {
        if (!may_bound_body(s)) return;
        const bool is_whole = part.instance || count[part.element.get()] == 1;
        const bool is_closed =
            s.rank != 0 || part.encloses_medium || (is_whole && s.shape->opening().empty());
        if (!is_closed) return;
        s.body = part.instance ? ++bodies_ : number_of(part);
      }
      has_body_[i] = true;
    });
  }
}

std::vector<std::pair<std::size_t, std::size_t>> Search::near_pairs() {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  if (std::none_of(has_body_.begin(), has_body_.end(), [](bool b) { return b; })) return pairs;
  std::vector<std::pair<Bounds3, std::size_t>> boxes;
  for (std::size_t i = 0; i < parts_.size(); ++i) boxes.emplace_back(widened(parts_[i].bounds()), i);
  std::sort(boxes.begin(), boxes.end(),
            [](const auto& a, const auto& b) { return a.first.lower.x < b.first.lower.x; });
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    if (has_body_[boxes[a].second]) pairs.emplace_back(boxes[a].second, boxes[a].second);
    for (std::size_t b = a + 1; b < boxes.size() && boxes[b].first.lower.x <= boxes[a].first.upper.x; ++b) {
      if (!has_body_[boxes[a].second] && !has_body_[boxes[b].second]) continue;
      if (overlap(boxes[a].first, boxes[b].first))
        pairs.push_back(std::minmax(boxes[a].second, boxes[b].second));
    }
    if (pairs.size() <= kMostPairs) continue;
    found_.notes.push_back(fmt::format(
        "more than {} pairs of shapes are near each other: whether bodies touch or overlap was tried for these alone",
        kMostPairs));
    break;
  }
  return pairs;
}

/// Rays along each axis through what the bounds of the two primitives have in common, from outside of both.
void Search::look_at(std::size_t i, std::size_t j, int per_side) {
  const Bounds3 a = widened(parts_[i].bounds()), b = widened(parts_[j].bounds()), both = common(a, b);
  Bounds3 all = a;
  all.extend(b);
  const float reach = length(all.diagonal());
  for (int axis = 0; axis < 3; ++axis) {
    // A slight tilt avoids rays within faces and through edges of boxes.
    Vec3 d{0.0131f, 0.0173f, 0.0147f};
    d[axis] = 1;
    d = normalize(d);
    for (int k = 0; k < per_side * per_side; ++k) {
      const std::uint32_t key = std::uint32_t(combine_bits(std::uint32_t(k), std::uint32_t(axis)));
      Vec3 at = both.center();
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const Vec3 size = both.diagonal();
      at[u] = both.lower[u] + size[u] * (float(k % per_side) + unit_float(key)) / float(per_side);
      at[v] = both.lower[v] + size[v] *
                                  (float(k / per_side) + unit_float(std::uint32_t(combine_bits(key, 1)))) /
                                  float(per_side);
      follow({at - d * reach, d, 2 * reach}, i, j);
    }
  }
}

void Search::follow(const Ray& ray, std::size_t i, std::size_t j) {
  surfaces_.tracer->all_hits(ray, 0, hits_);
  events_.clear();
  for (const RayTracer::Hit& hit : hits_) {
    if (hit.shape != i && hit.shape != j) continue;
    Surface& s = const_cast<Surface&>(surfaces_.of(hit));  // an element of `all`
    const SurfacePoint point = surfaces_.surface_point(hit, ray);
    events_.push_back(
        {hit.t, contact_distance(point, ray.d), &s, {s.body, point.instance}, dot(point.ng, ray.d) < 0});
  }
  note_contacts();
  note_overlaps();
}

void Search::note_contacts() {
  for (std::size_t k = 0; k < events_.size(); ++k)
    for (std::size_t l = k + 1; l < events_.size(); ++l) {
      const Event &x = events_[k], &y = events_[l];
      if (!(y.t - x.t <= x.tolerance + y.tolerance)) break;
      if (!x.is_of_body() && !y.is_of_body()) continue;
      // Within one body, rays that graze an edge cross two faces, too; faces that touch end the body and begin it
      // again.
      if (x.body == y.body && (x.inwards || !y.inwards)) continue;
      found_.any = true;
      for (const Event* e : {&x, &y})
        if (e->lets_light_pass()) e->surface->touches = true;
      if (!x.lets_light_pass() || !y.lets_light_pass()) continue;
      for (const Event* e : {&x, &y})
        if (e->is_of_body()) ranked_.insert(e->surface);
      if (!x.is_of_body()) note_laid_on(x, y);
      if (!y.is_of_body()) note_laid_on(y, x);
    }
}

/// Notes that a surface which transmits light lies on a body.
void Search::note_laid_on(const Event& laid, const Event& body) {
  if (laid.surface->is_null() || !laid_on_.insert({laid.surface, body.surface}).second) return;
  found_.notes.push_back(
      fmt::format("{}: this surface lies on that of {}: light meets that one alone there. Move them apart",
                  laid.surface->shape->properties().where().str(), place_of(*body.surface)));
}

void Search::note_overlaps() {
  std::map<BodyKey, std::pair<bool, const Surface*>> inside;
  float last = 0;
  for (const Event& e : events_)
    if (e.is_of_body()) inside.try_emplace(e.body, false, e.surface);
  if (inside.size() < 2) return;
  for (const Event& e : events_) {
    if (!e.is_of_body()) continue;
    for (auto a = inside.begin(); a != inside.end(); ++a)
      for (auto b = std::next(a); b != inside.end(); ++b) {
        if (!a->second.first && !b->second.first) continue;
        Overlap& o = overlaps_[{a->first, b->first}];
        o.first = a->second.second, o.second = b->second.second;
        double& length = a->second.first && b->second.first ? o.both
                         : a->second.first                  ? o.first_alone
                                                            : o.second_alone;
        length += e.t - last;
      }
    inside[e.body].first = e.inwards;
    last = e.t;
  }
}

std::string Search::place_of(const Surface& s) const {
  const Properties& element = s.shape->properties();
  const std::string where = element.where().str();
  return fmt::format("\"{}\"{}", element.type(), where.empty() ? "" : " at " + where);
}

void Search::judge_overlaps() {
  constexpr double kLeast = 1e-4;  // part of a length that counts
  for (const auto& [pair, o] : overlaps_) {
    const double first = o.first_alone + o.both, second = o.second_alone + o.both;
    if (!(o.both > kLeast * std::min(first, second))) continue;
    Surface &a = const_cast<Surface&>(*o.first), &b = const_cast<Surface&>(*o.second);
    const bool a_within = o.first_alone <= kLeast * first, b_within = o.second_alone <= kLeast * second;
    const bool cut = a_within == b_within;
    if (cut) ranked_.insert(&a), ranked_.insert(&b);
    if (a.body == b.body) continue;  // two instances of one group
    if (cut) {
      const bool same_matter =
          are_equal(a.inside, b.inside) && (have_same_index(a, b, wavelengths_) || are_equal(a.bsdf, b.bsdf));
      if ((a.rank == 0 || b.rank == 0) && !same_matter)
        found_.notes.push_back(fmt::format(
            "{}: this shape and the {} fill the same space and have no priorities to decide whose matter is there: "
            "it is taken to be that of {}. State a \"priority\" for both",
            a.shape->properties().where().str(), place_of(b),
            a.rank != 0 || b.rank != 0 ? "the one that has a priority" : "the first of them"));
    }
    // The body within the other one, or the first in the scene, is the one that fills the space.
    const bool a_first = cut ? a.body < b.body : a_within;
    above_.emplace(a_first ? a.body : b.body, a_first ? b.body : a.body);
  }
}

void Search::rank() {
  std::map<std::uint32_t, int> level;
  for (const Surface* s : ranked_)
    if (s->rank == 0) level[s->body] = 1;
  if (level.empty()) return;
  constexpr int kLevels = 127;
  for (int pass = 0; pass < kLevels; ++pass) {
    bool changed = false;
    for (const auto& [high, low] : above_) {
      const auto h = level.find(high), l = level.find(low);
      if (h == level.end() || l == level.end() || h->second > l->second || l->second >= kLevels) continue;
      h->second = l->second + 1, changed = true;
    }
    if (!changed) break;
  }
  for (Surface& s : surfaces_.all)
    if (s.body != 0 && s.rank == 0)
      if (const auto at = level.find(s.body); at != level.end())
        s.rank = std::int8_t(at->second - kLevels - 1);
}

void Search::bound_ranked() {
  for (std::size_t i = 0; i < parts_.size(); ++i)
    for_surfaces(i, [&](const Surface& s) {
      if (s.rank != 0) found_.ranked.extend(parts_[i].bounds());
    });
}

}  // namespace

Contacts find_contacts(const SceneParts& parts, SceneSurfaces& surfaces) {
  return Search(parts, surfaces).run();
}

}  // namespace aureole
