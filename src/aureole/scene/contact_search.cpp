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

/// Returns wavelengths over the range of the scene's sensor, on whose grid indices are tabulated.
Wavelengths sensor_wavelengths(const SpectralGrid& grid) {
  const double step = (grid.max_nm - grid.min_nm) / kWavelengths;
  return Wavelengths::at(grid, make_spectrum([&](int i) { return float(grid.min_nm + (i + 0.5) * step); }));
}

Bounds3 common(const Bounds3& a, const Bounds3& b) {
  Bounds3 box;
  box.lower = max(a.lower, b.lower), box.upper = min(a.upper, b.upper);
  return box;
}

/// Whether two objects are identical or were described by equal text.
bool are_equal(const Object* a, const Object* b) {
  if (a == b) return true;
  return a && b && a->properties().content() != 0 && a->properties().content() == b->properties().content();
}

/// A body in the scene: its number, and the instance through which a ray hits it.
using BodyKey = std::pair<std::uint32_t, const Instance*>;

/// Lengths that rays through a pair of bodies have measured.
struct Overlap {
  /// lengths within both bodies, and within each of them alone
  double both = 0, first_alone = 0, second_alone = 0;
  const Surface *first = nullptr, *second = nullptr;
};

/// The search for contacts, which marks the surfaces that it finds.
class Search {
public:
  Search(const SceneParts& parts, SceneSurfaces& surfaces)
      : parts_(parts.surfaces),
        surfaces_(surfaces),
        adds_media_(parts.adds_media),
        wavelengths_(sensor_wavelengths(parts.context->grid)) {}

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
    number_in_order();
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
  std::unordered_map<std::uint32_t, std::size_t> order_of_bodies() const;
  void note_within(Surface& inner, const Surface& outer);
  void note_cut(const Surface& first, const Surface& second);
  void rank();
  void bound_ranked();
  void number_in_order();
  std::string place_of(const Surface& s) const;

  /// Whether the coefficients of the media in both bodies add up where they overlap.
  bool add_up(const Surface& a, const Surface& b) const {
    return adds_media_ && a.inside && b.inside && a.is_null() && b.is_null();
  }

  const std::vector<Primitive>& parts_;
  SceneSurfaces& surfaces_;
  const bool adds_media_;
  const Wavelengths wavelengths_;
  Contacts found_;
  std::vector<bool> has_body_;  ///< whether each primitive bounds a body
  std::uint32_t bodies_ = 0;
  std::map<std::pair<BodyKey, BodyKey>, Overlap> overlaps_;
  /// position of each body in the order of bodies; those that fill common space come first
  std::unordered_map<std::uint32_t, std::size_t> order_;
  std::set<Surface*> ranked_;
  std::set<std::pair<const Surface*, const Surface*>> laid_on_;
  /// pairs of bodies of which the first ranks above the second
  std::set<std::pair<std::uint32_t, std::uint32_t>> above_;
  std::vector<RayTracer::Hit> hits_;
  std::vector<Event> events_;
};

void Search::number_bodies() {
  // The shapes of one asset, such as the parts of an OBJ file with several materials, bound one body.
  std::unordered_map<const Properties*, std::uint32_t> known;
  has_body_.resize(parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Primitive& part = parts_[i];
    std::size_t member = 0;
    for_surfaces(i, [&](Surface& s) {
      const ShapeList* group = part.instance ? &part.instance->list() : nullptr;
      const std::size_t at = member++;
      if (s.body == 0) {
        if (!may_bound_body(s)) return;
        const bool is_part = group ? group->is_part_of_closed[at] : part.is_part_of_closed;
        if (!(s.rank != 0 || part.encloses_medium || is_part || s.shape->opening().empty())) return;
        const Properties* element = group ? group->elements[at].get() : part.element.get();
        const auto [entry, is_new] = known.try_emplace(element, bodies_ + 1);
        bodies_ += is_new;
        s.body = entry->second;
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
  std::size_t alone = 0;
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    // A pair of equal primitives counts as well, since a body's faces may touch one another.
    if (has_body_[boxes[a].second]) pairs.emplace_back(boxes[a].second, boxes[a].second), ++alone;
    for (std::size_t b = a + 1; b < boxes.size() && boxes[b].first.lower.x <= boxes[a].first.upper.x; ++b) {
      if (!has_body_[boxes[a].second] && !has_body_[boxes[b].second]) continue;
      if (overlap(boxes[a].first, boxes[b].first))
        pairs.push_back(std::minmax(boxes[a].second, boxes[b].second));
    }
    if (pairs.size() - alone <= kMostPairs) continue;
    found_.notes.push_back(fmt::format(
        "more than {} pairs of shapes are near each other: whether bodies touch or overlap was tried for these alone",
        kMostPairs));
    break;
  }
  return pairs;
}

/// Traces rays along each axis through the common bounds of the two primitives, starting outside of both.
void Search::look_at(std::size_t i, std::size_t j, int per_side) {
  const Bounds3 a = widened(parts_[i].bounds()), b = widened(parts_[j].bounds()), both = common(a, b);
  Bounds3 all = a;
  all.extend(b);
  const float reach = length(all.diagonal());
  for (int axis = 0; axis < 3; ++axis) {
    // Direction with a slight tilt, which avoids rays within faces and through edges of boxes.
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
    Surface& s = const_cast<Surface&>(surfaces_.of(hit));  // the hit surface as a mutable element of `all`
    // Surfaces of other primitives of the two bodies count as well.
    const auto is_of = [&](std::size_t part) {
      return hit.shape == part || (s.body != 0 && !s.instance && s.body == surfaces_.all[part].body);
    };
    if (!is_of(i) && !is_of(j)) continue;
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
      // Rays that graze an edge also cross two faces of one body. The body touches itself only where a ray
      // leaves and enters it again.
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

/// Notes that a surface that transmits light lies on a body.
void Search::note_laid_on(const Event& laid, const Event& body) {
  const bool is_nothing = laid.surface->is_null() && !laid.surface->light;
  if (is_nothing || !laid_on_.insert({laid.surface, body.surface}).second) return;
  found_.notes.push_back(fmt::format(
      "{}: this surface lies on that of {}: only that of the body acts there, and this one is as if it "
      "were not there. Move them apart",
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
  constexpr double kLeast = 1e-4;  // smallest fraction of a length that counts
  struct Cut {
    Surface *a, *b;
  };
  std::vector<Cut> cuts;
  for (const auto& [pair, o] : overlaps_) {
    const double first = o.first_alone + o.both, second = o.second_alone + o.both;
    if (!(o.both > kLeast * std::min(first, second))) continue;
    Surface &a = const_cast<Surface&>(*o.first), &b = const_cast<Surface&>(*o.second);
    const bool a_within = o.first_alone <= kLeast * first, b_within = o.second_alone <= kLeast * second;
    if (a_within != b_within) {
      // A body within another one fills the common space.
      Surface &inner = a_within ? a : b, &outer = a_within ? b : a;
      if (a.body != b.body) above_.emplace(inner.body, outer.body), note_within(inner, outer);
      continue;
    }
    ranked_.insert(&a), ranked_.insert(&b);
    cuts.push_back({&a, &b});
  }
  // Where bodies cut each other, the first in the scene fills the common space, except that bodies within
  // others precede them. There is one order of all bodies, so that no three bodies contradict each other.
  order_ = order_of_bodies();
  for (const auto& [a, b] : cuts) {
    if (a->body != b->body) {
      const bool a_first = order_.at(a->body) < order_.at(b->body);
      above_.emplace(a_first ? a->body : b->body, a_first ? b->body : a->body);
      note_cut(a_first ? *a : *b, a_first ? *b : *a);
    } else if (a->inside && !a->inside->is_uniform()) {
      found_.notes.push_back(fmt::format(
          "{}: instances of this shape overlap, but their medium differs from place to place: where they "
          "do, that of one of them counts",
          a->shape->properties().where().str()));
    }
  }
}

std::unordered_map<std::uint32_t, std::size_t> Search::order_of_bodies() const {
  std::unordered_map<std::uint32_t, int> waiting;  // number of bodies that must precede each body
  for (const auto& [high, low] : above_) ++waiting[low];
  std::set<std::uint32_t> ready;
  for (std::uint32_t body = 1; body <= bodies_; ++body)
    if (waiting.find(body) == waiting.end()) ready.insert(body);
  std::unordered_map<std::uint32_t, std::size_t> order;
  while (order.size() < bodies_) {
    // Measured lengths along rays may contradict each other: the remaining bodies then follow in the order of
    // the scene.
    if (ready.empty())
      for (std::uint32_t body = 1; body <= bodies_; ++body)
        if (order.find(body) == order.end()) ready.insert(body);
    const std::uint32_t next = *ready.begin();
    ready.erase(ready.begin());
    if (!order.try_emplace(next, order.size()).second) continue;
    for (auto at = above_.lower_bound({next, 0}); at != above_.end() && at->first == next; ++at)
      if (--waiting[at->second] == 0) ready.insert(at->second);
  }
  return order;
}

/// Notes that a body within another one states another exterior medium or index than the other body has
/// inside, unless the priorities of both decide.
void Search::note_within(Surface& inner, const Surface& outer) {
  const bool both_stated = inner.rank != 0 && outer.rank != 0;
  // both bodies have a rank, since they touch
  const bool both_ranked = ranked_.count(&inner) != 0 && outer.rank == 0;
  if (both_stated || both_ranked || add_up(inner, outer)) return;
  const bool other_medium =
      outer.bounds_media && inner.bounds_media && !are_equal(inner.outside, outer.inside);
  Spectrum stated, within;
  const bool other_index = inner.bsdf->exterior_index(wavelengths_, stated) &&
                           outer.bsdf->interior_index(wavelengths_, within) && any(stated.v != within.v);
  if (!other_medium && !other_index) return;
  found_.notes.push_back(fmt::format(
      "{}: this shape lies within the {} but states {} around it, in which light that leaves it goes on. State {} "
      "here, or a \"priority\" for both, the higher one here",
      inner.shape->properties().where().str(), place_of(outer),
      other_medium ? "another medium" : "another index of refraction",
      other_medium ? "that medium as \"exterior\"" : "that index as \"ext_ior\""));
}

/// Notes that two bodies fill the same space where their priorities do not decide which body counts.
void Search::note_cut(const Surface& first, const Surface& second) {
  const bool same_matter =
      are_equal(first.inside, second.inside) && (!first.inside || first.inside->is_uniform()) &&
      (have_same_index(first, second, wavelengths_) || are_equal(first.bsdf, second.bsdf));
  if ((first.rank != 0 && second.rank != 0 && first.rank != second.rank) || same_matter) return;
  if (add_up(first, second)) return;
  const Surface& winner = first.rank != 0 || second.rank == 0 ? first : second;
  const Surface& other = &winner == &first ? second : first;
  found_.notes.push_back(fmt::format(
      "{}: this shape and the {} fill the same space and have no different priorities to decide whose matter is "
      "there: it is taken to be that of the {}. State a \"priority\" for both",
      winner.shape->properties().where().str(), place_of(other),
      winner.rank != other.rank ? "one that has a priority" : "first of them"));
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

/// Renumbers the bodies in their order, which decides among equal ranks.
void Search::number_in_order() {
  for (Surface& s : surfaces_.all)
    if (s.body != 0) s.body = std::uint32_t(order_.at(s.body)) + 1;
}

}  // namespace

Contacts find_contacts(const SceneParts& parts, SceneSurfaces& surfaces) {
  return Search(parts, surfaces).run();
}

}  // namespace aureole
