// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "aureole/core/parallel.h"
#include "aureole/scene/contact_search.h"
#include "aureole/scene/edge/outline_edges.h"
#include "aureole/scene/edge/scene_diffraction.h"
#include "aureole/scene/instanced_light.h"
#include "aureole/spectrum/wavelength_choice.h"

namespace aureole {

namespace {

/// Returns the largest coordinate magnitude of a box; 0 if it is empty, infinity if a coordinate is NaN.
float reach_of(const Bounds3& box) {
  float reach = 0;
  for (const Vec3& corner : {box.lower, box.upper})
    for (int i = 0; i < 3 && !box.empty(); ++i)
      reach = std::isnan(corner[i]) ? kInfinity : std::max(reach, std::abs(corner[i]));
  return reach;
}

/// Returns an error located at the parameter that positions the object.
Error misplaced(const Properties& object, const std::string& message) {
  for (const char* name : {"to_world", "position", "origin", "center", "radius"})
    if (object.has(name)) return object.error(name, message);
  return Error(object.where(), "\"" + object.type() + "\": " + message);
}

/// Throws Error if the box exceeds kFarthestPlace.
void require_near(const Properties& object, const Bounds3& box) {
  if (reach_of(box) > float(kFarthestPlace))
    throw misplaced(object, "reaches beyond the coordinate 9e17, where rays end");
}

/// Returns a note on shapes that are so far from the origin, compared with their size, that single precision holds few
/// positions on them; empty if there are none. The limit is a fraction of the diagonal of the bounds. In a
/// room 2 wide with a glass ball, moved by 1e3, 1e4 and 1e5 along each axis, the mean changes by -0.01, -0.2
/// and -3 %.
std::string rounding_note(const std::vector<Primitive>& parts) {
  constexpr double kPart = 5e-4;
  const Primitive* first = nullptr;
  std::size_t count = 0;
  double step = 0, size = 0, reach = 0;  // values of the first such shape
  for (const Primitive& part : parts) {
    const Bounds3 box = part.bounds();
    const float at = reach_of(box), step_here = std::nextafter(at, kInfinity) - at;
    const double diagonal = double(length(box.diagonal()));
    if (!(diagonal > 0) || double(step_here) <= kPart * diagonal) continue;
    if (count++ == 0) first = &part, step = double(step_here), size = diagonal, reach = double(at);
  }
  if (!first) return {};
  return fmt::format(
      "{}: positions on this shape of size {:.3g} are rounded to {:.2g}, because it lies {:.3g} from the origin and "
      "single precision has 7 digits: the picture may be wrong. Move the scene to the origin{}",
      first->element->where().str(), size, step, reach,
      count == 1 ? "" : fmt::format(" (so for {} shapes)", count));
}

}  // namespace

Scene::Scene(SceneParts parts, const Scene* reuse) : parts_(std::move(parts)) {
  if (!parts_.sensor) throw Error("the scene has no sensor");
  set_in_motion();
  Bounds3 places;
  std::unordered_set<const ShapeList*> groups;
  for (const Primitive& part : parts_.surfaces) {
    if (part.instance && groups.insert(&part.instance->list()).second)
      for (const ShapePtr& shape : part.instance->list().shapes)
        require_near(shape->properties(), shape->bounds());
    require_near(*part.element, part.bounds());
    places.extend(part.bounds());
  }
  if (std::string note = rounding_note(parts_.surfaces); !note.empty()) notes_.push_back(std::move(note));
  make_lights();
  for (const Light& light : emitters_)
    if (!light.shape && !light.is_infinite()) {
      require_near(light.properties(), light.emission_bounds(0).box);
      places.extend(light.emission_bounds(0).box);
    }
  make_surfaces();
  find_media();
  bound_emitters();
  surfaces_.tracer = reuse && reuse->surfaces_.tracer->is_for(parts_.surfaces)
                         ? reuse->surfaces_.tracer
                         : std::make_shared<const RayTracer>(parts_.surfaces,
                                                             reuse ? reuse->surfaces_.tracer.get() : nullptr);
  look_for_contacts();
  find_closed_media();

  const Bounds3 box = surfaces_.tracer->bounds();
  const Vec3 center = box.empty() ? Vec3{} : box.center();
  const float radius = box.empty() ? 1.f : std::max(1e-6f, 0.5f * length(box.diagonal()));
  sensor_ = PlacedSensor::of(*parts_.sensor, parts_.sensor_area, center, radius);
  place_sensor(places);
  note_clipping();
  check_sensor_medium();
  for (Light& light : emitters_) light.scene_center = center, light.scene_radius = radius;
  weigh_lights();
  find_changes();
  if (!parts_.diffraction) {
    if (std::string note = note_without_diffraction(parts_); !note.empty()) notes_.push_back(std::move(note));
    return;
  }
  if (parts_.diffraction->model == DiffractionSettings::Model::segments) {
    const bool same = reuse && reuse->outline_edges_ && has_same_outlines(parts_, reuse->parts_);
    outline_edges_ = same ? reuse->outline_edges_ : std::make_shared<const OutlineEdges>(parts_);
    notes_.insert(notes_.end(), outline_edges_->notes().begin(), outline_edges_->notes().end());
    return;
  }
  const bool reuses = reuse && reuse->diffraction_;
  const std::optional<DiffractionInput> before =
      reuses ? std::optional(reuse->diffraction_input()) : std::nullopt;
  diffraction_ = std::make_shared<const SceneDiffraction>(
      diffraction_input(), reuses ? reuse->diffraction_.get() : nullptr, before ? &*before : nullptr);
  notes_.insert(notes_.end(), diffraction_->notes().begin(), diffraction_->notes().end());
}

DiffractionInput Scene::diffraction_input() const {
  return {parts_, surfaces_, emitters_, lights_, sensor_, has_binary_visibility()};
}

void Scene::set_in_motion() {
  const Exposure& exposure = parts_.sensor->exposure();
  constexpr double kNotable = 1e-3;
  for (Primitive& part : parts_.surfaces) {
    if (!part.instance || !part.instance->is_moving()) continue;
    if (parts_.diffraction)
      throw part.element->error("to_world", "an instance cannot move where edges diffract light");
    part.instance = part.instance->during(exposure.open, exposure.close + exposure.readout);
    changes_ = true;
    const double size = double(length(part.bounds().diagonal())), off = part.instance->deviation();
    if (off > kNotable * size)
      notes_.push_back(
          part.element
              ->error("to_world", fmt::format("moves too far during the exposure for the 128 straight pieces "
                                              "of its path: it is up to {:.2g} off its place",
                                              off))
              .what());
  }
}

void Scene::find_changes() {
  const bool moves = sensor_.motion;
  changes_ |= moves || std::any_of(emitters_.begin(), emitters_.end(),
                                   [](const Light& light) { return light.changes(); });
  if (parts_.diffraction)
    for (const Light& light : emitters_)
      if (light.motion)
        throw light.properties().error(
            "to_world", "a light cannot move, nor be part of an instance, where edges diffract light");
  const Properties& p = sensor_.properties();
  const Exposure& exposure = sensor_.sensor->exposure();
  if (moves && parts_.diffraction)
    throw p.error("to_world", "a sensor cannot move where edges diffract light");
  const bool stated = p.has("shutter_open") || p.has("shutter_close") || p.has("readout_time");
  if (stated && !changes_ && !film().integrates_over_time())
    notes_.push_back(
        p.error("shutter_open", "nothing changes over time: the exposure has no effect on the picture")
            .what());
  if (changes_ && exposure.is_instant())
    notes_.push_back(
        p.error("shutter_close",
                "the scene changes over time, and the sensor sees an instant of it: \"shutter_open\" and "
                "\"shutter_close\" make an exposure")
            .what());
}

void Scene::note_clipping() {
  std::vector<Bounds3> boxes;
  for (const Primitive& part : parts_.surfaces) boxes.push_back(part.bounds());
  const auto add = [&](const PlacedSensor& sensor) {
    if (std::string note = sensor.sensor->clipping_note(boxes); !note.empty())
      notes_.push_back(std::move(note));
  };
  add(sensor_);
  for (const PlacedSensor& member : sensor_.members) add(member);
}

void Scene::place_sensor(Bounds3 places) const {
  const FilmPart& part = sensor_.part;
  for (const Vec2 film : {part.lower, part.upper, 0.5f * (part.lower + part.upper)}) {
    const SensorRay seen = sensor_.sample_ray(film, {0.5f, 0.5f});
    Bounds3 start;
    start.lower = start.upper = seen.ray.o;
    if (!is_finite(seen.ray.d)) throw misplaced(sensor_.properties(), "its rays have no direction");
    if (reach_of(start) > float(kFarthestPlace))
      throw misplaced(sensor_.properties(), "its rays begin beyond the coordinate 9e17, where rays end");
    places.extend(start);
  }
  // The direction of a ray between two of these points has up to twice their coordinates.
  const float reach = 2 * reach_of(places);
  if (reach <= surfaces_.tracer->farthest()) return;
  for (const Primitive& instance : parts_.surfaces)
    if (instance.instance && !(instance.instance->farthest(kFarthest) >= reach))
      throw misplaced(
          *instance.element,
          "makes its group so small that rays of this scene have coordinates beyond 1.8e18 in it");
}

void Scene::make_lights() {
  for (const Primitive& part : parts_.surfaces)
    if (part.emitter) {
      Light light;
      light.emitter = part.emitter.get(), light.shape = part.shape.get();
      light.area = part.area.get(), light.surface_area = part.area->area();
      emitters_.push_back(light);
    }
  for (const Primitive& part : parts_.surfaces)
    if (part.instance && part.instance->list().shines()) make_lights_of(part);
  const Exposure& exposure = parts_.sensor->exposure();
  for (const auto& emitter : parts_.emitters) {
    Light& light = emitters_.emplace_back();
    light.emitter = emitter.get();
    if (!emitter->motion()) continue;
    light_motions_.push_back(std::make_unique<KeyFramedLight>(*emitter->motion()));
    light.motion = light_motions_.back().get();
  }
  for (Light& light : emitters_)
    light.first_time = float(exposure.open), light.last_time = float(exposure.close + exposure.readout);
  for (std::size_t i = 0; i < emitters_.size(); ++i) {
    emitters_[i].index = std::uint32_t(i);
    if (emitters_[i].is_infinite() && !emitters_[i].is_delta()) infinite_.push_back(&emitters_[i]);
  }
}

void Scene::make_lights_of(const Primitive& part) {
  const Instance& instance = *part.instance;
  for (const float time : {float(parts_.sensor->exposure().open), float(parts_.sensor->exposure().close)}) {
    const Transform place = instance.to_world_at(time);
    if (place.determinant3() < 0 || !Motion(std::vector<KeyFrame>{{0, Transform()}, {1, place}}).is_rigid())
      throw part.element->error(
          "to_world",
          "the group has a shape that emits: its instances may be turned and moved, but not scaled, "
          "sheared or mirrored");
  }
  light_motions_.push_back(std::make_unique<InstancedLight>(instance));
  const ShapeList& list = instance.list();
  for (std::size_t i = 0; i < list.shapes.size(); ++i) {
    if (!list.emitters[i]) continue;
    Light& light = emitters_.emplace_back();
    light.emitter = list.emitters[i].get(), light.shape = list.shapes[i].get();
    light.area = list.areas[i].get(), light.surface_area = list.areas[i]->area();
    light.motion = light_motions_.back().get();
  }
}

void Scene::bound_emitters() {
  constexpr std::ptrdiff_t kMaxBoundedEmitters = 8;
  const auto& emitters = parts_.emitters;
  emits_everywhere_ = any_medium_emits_ || std::any_of(emitters.begin(), emitters.end(),
                                                       [](const auto& e) { return e->is_infinite(); });
  many_shapes_shine_ = std::ptrdiff_t(emitters_.size() - emitters.size()) > kMaxBoundedEmitters;
  if (many_shapes_shine_) return;
  for (const Light& light : emitters_)
    if (light.shape) {
      Bounds3 b = light.motion ? Bounds3() : light.shape->bounds();
      for (std::size_t part = 0; light.motion && part < light.part_count(); ++part) {
        const Bounds3 moved = light.emission_bounds(part).box;
        b.extend(moved);
      }
      // Margin by which rounding may put a hit outside of the bounds.
      const Vec3 margin = (abs(b.lower) + abs(b.upper)) * 1e-5f;
      b.lower = b.lower - margin, b.upper = b.upper + margin;
      emitter_bounds_.push_back(b);
    }
}

void Scene::make_surfaces() {
  // Instances of a group share the group's surfaces, unless a shape emits, media are placed with the instance, or the shapes
  // have priorities, for which a path must know which of the instances contain it (InteriorList).
  struct Members {
    const Primitive* instance;
    std::size_t begin;
  };
  std::size_t count = parts_.surfaces.size();
  std::vector<Members> members;  // surfaces of groups, in their order
  // index of the first shared surface of each list of shapes
  std::unordered_map<const ShapeList*, std::size_t> shared;
  std::vector<std::size_t> members_of(parts_.surfaces.size());  // index of the first surface of each instance
  const auto has_priority = [](const SurfaceMedia& media) { return media.priority != 0; };
  for (std::size_t i = 0; i < parts_.surfaces.size(); ++i) {
    const Primitive& part = parts_.surfaces[i];
    if (!part.instance) continue;
    const ShapeList& list = part.instance->list();
    members_of[i] = count;
    if (part.placed_media.empty() && !list.shines() &&
        std::none_of(list.media.begin(), list.media.end(), has_priority)) {
      const auto [known, is_new] = shared.try_emplace(&list, count);
      members_of[i] = known->second;
      if (!is_new) continue;
    }
    members.push_back({&part, count});
    count += list.shapes.size();
  }
  std::vector<std::pair<std::size_t, const Bssrdf*>> entries;
  const auto note_entry = [&](std::size_t index, const SurfaceMedia& media) {
    if (media.bssrdf) entries.emplace_back(index, media.bssrdf.get());
  };
  for (const Members& m : members)
    for (std::size_t i = 0; i < m.instance->member_media().size(); ++i)
      note_entry(m.begin + i, m.instance->member_media()[i]);
  for (std::size_t i = 0; i < parts_.surfaces.size(); ++i) note_entry(i, parts_.surfaces[i].media);
  surfaces_.all.resize(count + entries.size());
  for (const Members& m : members) {
    const ShapeList& list = m.instance->instance->list();
    for (std::size_t i = 0; i < list.shapes.size(); ++i)
      surfaces_.all[m.begin + i] = Surface(*list.shapes[i], *list.bsdfs[i], m.instance->member_media()[i]);
  }
  const Light* light = emitters_.data();
  // Lights of instances follow those of shapes.
  const Light* light_of_instance =
      light + std::count_if(parts_.surfaces.begin(), parts_.surfaces.end(),
                            [](const Primitive& part) { return part.emitter != nullptr; });
  for (std::size_t i = 0; i < parts_.surfaces.size(); ++i) {
    const Primitive& part = parts_.surfaces[i];
    Surface& surface = surfaces_.all[i];
    if (part.instance) {
      surface.instance = part.instance.get();
      surface.members = &surfaces_.all[members_of[i]];
      const ShapeList& list = part.instance->list();
      for (std::size_t k = 0; k < list.shapes.size(); ++k)
        if (list.emitters[k]) surfaces_.all[members_of[i] + k].light = light_of_instance++;
    } else {
      surface = Surface(*part.shape, *part.bsdf, part.media);
      if (part.emitter) surface.light = light++;
    }
  }
  for (const Surface& surface : surfaces_.all) surfaces_.any_passable |= surface.passable;
  for (const auto& [entry, bssrdf] : entries) {
    surfaces_.all[count] = Surface(surfaces_.all[entry], *bssrdf);
    surfaces_.all[entry].exit = &surfaces_.all[count++];
  }
  has_exits_ = !entries.empty();
}

void Scene::find_media() {
  std::unordered_set<const Medium*> known;
  const auto add = [&](const Medium* medium) {
    if (!medium || (!media_.empty() && media_.back() == medium)) return;
    has_media_ = true;
    if (known.insert(medium).second) media_.push_back(medium);
    any_medium_emits_ |= medium->emits();
  };
  add(parts_.sensor->medium());
  for (const Light& light : emitters_) add(light.emitter->medium());
  for (const Surface& surface : surfaces_.all) {
    add(surface.outside), add(surface.inside);
    any_medium_outside_ |= surface.outside != nullptr;
  }
  surfaces_.any_passable |= has_media_;
  const auto extend = [](Bounds3& box, const Primitive& part, auto has) {
    const auto* list = part.instance ? &part.instance->list().media : nullptr;
    if (list ? std::any_of(list->begin(), list->end(), has) : has(part.media)) box.extend(part.bounds());
  };
  for (const Primitive& part : parts_.surfaces) {
    extend(media_bounds_, part, [](const SurfaceMedia& m) { return m.given() && m.priority == 0; });
  }
}

void Scene::look_for_contacts() {
  Contacts found = find_contacts(parts_, surfaces_);
  has_contacts_ = found.any;
  ranked_bounds_ = found.ranked;
  has_media_ |= found.any || !found.ranked.empty();
  surfaces_.any_passable |= has_media_;
  notes_.insert(notes_.end(), found.notes.begin(), found.notes.end());
}

void Scene::weigh_lights() {
  const SpectralGrid& grid = parts_.context->grid;
  const SampledSpectrum response = film().response();
  if (!(response.maximum() < 1e18f))
    throw Error(sensor_.properties().where(), "the sensor's response is too large to be computed with");
  std::vector<double> powers(emitters_.size());
  std::vector<SampledSpectrum> spectra(emitters_.size());
  for_ranges(
      emitters_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          spectra[i] = emitters_[i].power_spectrum();
          powers[i] = overlap(spectra[i], response);
        }
      },
      256);
  for (std::size_t i = 0; i < emitters_.size(); ++i)
    if (!std::isfinite(powers[i]))
      throw Error(
          emitters_[i].properties().where(),
          "the emitter's power is too large to be computed with; scale the scene or the emission down");
  find_emitting_media(response, spectra);
  if (std::none_of(powers.begin(), powers.end(), [](double p) { return p > 0; }) && !any_medium_emits_)
    notes_.push_back("no emitter has power where the film sees: the picture will be black");
  choose_times(powers);
  // An emitter with sampling weight 0 is never chosen by light sampling, but BSDF sampling may hit it. Light
  // tracing has no second technique, so there such an emitter keeps its power.
  std::vector<double> emitted_powers = powers;
  std::vector<double> modulations(emitters_.size());
  for (std::size_t i = 0; i < emitters_.size(); ++i) {
    modulations[i] = mean_modulation(emitters_[i]);
    const double weight = emitters_[i].sampling_weight() * modulations[i];
    powers[i] *= weight;
    if (weight > 0 || emitters_[i].is_delta()) emitted_powers[i] *= weight;
  }
  const Exposure& exposure = sensor_.sensor->exposure();
  if (exposure.is_instant() && !(exposure.readout > 0)) modulations.clear();
  run_together(
      [&] {
        wavelengths_ = std::make_unique<WavelengthDistribution>(
            choose_wavelengths(response, channel_responses(film(), grid), spectra));
      },
      [&] { lights_ = LightSampler(emitters_, powers, emitted_powers, modulations); });
}

double Scene::mean_modulation(const Light& light) const {
  const Modulation* modulation = light.emitter->modulation();
  if (!modulation) return 1;
  const Exposure& exposure = sensor_.sensor->exposure();
  const double end = exposure.close + exposure.readout;
  // Rounding of integrals must not hide a light that emits for very short times.
  constexpr double kLeast = 1e-4;
  return std::max(kLeast, !(end > exposure.open)
                              ? double(modulation->at(exposure.open))
                              : modulation->integral(exposure.open, end) / (end - exposure.open));
}

void Scene::choose_times(std::span<const double> powers) {
  const Exposure& exposure = sensor_.sensor->exposure();
  if (exposure.is_instant()) return;
  double steady = 0;
  std::vector<ModulatedPower> modulated;  // each modulation once, in the order of the lights
  std::unordered_map<const Modulation*, std::size_t> known;
  for (std::size_t i = 0; i < emitters_.size(); ++i) {
    const Modulation* modulation = emitters_[i].emitter->modulation();
    if (!modulation) {
      steady += powers[i];
      continue;
    }
    const auto [at, is_new] = known.try_emplace(modulation, modulated.size());
    if (is_new) modulated.push_back({modulation, 0});
    modulated[at->second].power += powers[i];
  }
  if (modulated.empty()) return;
  std::stable_sort(modulated.begin(), modulated.end(),
                   [](const ModulatedPower& a, const ModulatedPower& b) { return a.power > b.power; });
  constexpr std::size_t kMostModulations = 64;
  if (modulated.size() > kMostModulations) modulated.resize(kMostModulations);
  auto times = std::make_unique<const ExposureTimes>(exposure.open, exposure.close + exposure.readout, steady,
                                                     modulated);
  if (times->is_uneven()) exposure_times_ = std::move(times);
}

bool Scene::may_meet_shining_shape(const Ray& ray) const {
  if (many_shapes_shine_) return true;
  const Vec3 inverse{1 / ray.d.x, 1 / ray.d.y, 1 / ray.d.z};
  for (const Bounds3& b : emitter_bounds_) {
    float near = 0, far = ray.t_max;
    for (int k = 0; k < 3; ++k) {
      const float t0 = (b.lower[k] - ray.o[k]) * inverse[k], t1 = (b.upper[k] - ray.o[k]) * inverse[k];
      // For a ray in the plane of a face the distance is NaN, and min and max leave the interval unchanged
      // then.
      near = std::max(near, std::min(t0, t1)), far = std::min(far, std::max(t0, t1));
    }
    // The factor allows for relative rounding errors of the distances.
    if (near <= far * 1.0001f) return true;
  }
  return false;
}

}  // namespace aureole
