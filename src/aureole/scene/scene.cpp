// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/scene.h"

#include <algorithm>

#include "aureole/spectrum/wavelength_choice.h"

namespace aureole {

namespace {

/// Rays go no farther than kFarthest; sums and squares of coordinates stay finite, too.
void require_near(const Object& object, const Bounds3& box) {
  for (const Vec3& corner : {box.lower, box.upper})
    for (int i = 0; i < 3; ++i)
      if (!(std::abs(corner[i]) <= kFarthest) && !box.empty())
        throw Error(
            object.properties().where(),
            "\"" + object.properties().type() + "\" reaches beyond the coordinate 1.8e18, where rays end");
}

}  // namespace

Scene::Scene(LoadedScene loaded, const Scene* previous)
    : loaded_(std::move(loaded)), shapes_(loaded_.shapes) {
  sensor_ = std::dynamic_pointer_cast<Sensor>(loaded_.sensor);
  if (!sensor_) throw Error({loaded_.file.string(), 0, 0}, "the scene has no sensor");
  for (const auto& shape : shapes_)
    if (shape->shared_emitter()) {
      shape->shared_emitter()->attach(*shape);
      emitters_.push_back(shape->emitter());
    }
  for (const auto& shape : shapes_) require_near(*shape, shape->bounds());
  for (const auto& emitter : loaded_.emitters)
    if (!emitter->is_infinite()) require_near(*emitter, emitter->emission_bounds(0).box);
  constexpr std::size_t kFewEmitters = 8;
  if (std::none_of(loaded_.emitters.begin(), loaded_.emitters.end(),
                   [](const auto& e) { return e->is_infinite(); }) &&
      emitters_.size() <= kFewEmitters)
    for (const auto& shape : shapes_)
      if (shape->emitter()) {
        Bounds3 b = shape->bounds();
        // As far as a hit may lie outside by rounding.
        const Vec3 margin = (abs(b.lower) + abs(b.upper)) * 1e-5f;
        b.lower = b.lower - margin, b.upper = b.upper + margin;
        emitter_bounds_.push_back(b);
      }
  for (const auto& shape : shapes_)
    if (shape->sensor()) shape->sensor()->attach(*shape);
  for (const auto& shape : shapes_) any_passable_ |= shape->is_passable();
  const bool same_shapes = previous && previous->shapes_ == shapes_;
  tracer_ = same_shapes ? previous->tracer_ : std::make_shared<const RayTracer>(shapes_);

  const Bounds3 box = tracer_->bounds();
  const Vec3 center = box.empty() ? Vec3{} : box.center();
  const float radius = box.empty() ? 1.f : std::max(1e-6f, 0.5f * length(box.diagonal()));
  sensor_->set_scene_bounds(center, radius);
  for (const auto& emitter : loaded_.emitters) {
    emitter->set_scene_bounds(center, radius);
    emitters_.push_back(emitter.get());
    if (emitter->is_infinite() && !emitter->is_delta()) infinite_.push_back(emitter.get());
  }

  const SpectralGrid& grid = loaded_.context->grid;
  const SampledSpectrum response = film().response();
  if (!(response.maximum() < 1e18f))
    throw Error(sensor_->properties().where(), "the sensor's response is too large to be computed with");
  std::vector<double> powers;
  std::vector<SampledSpectrum> lights;
  for (const Emitter* e : emitters_) {
    const SampledSpectrum power = e->power_spectrum();
    powers.push_back(overlap(power, response));
    if (!std::isfinite(powers.back()))
      throw Error(
          e->properties().where(),
          "the emitter's power is too large to be computed with; scale the scene or the emission down");
    lights.push_back(power);
  }
  if (std::none_of(powers.begin(), powers.end(), [](double p) { return p > 0; }))
    loaded_.notes.push_back("no emitter has power where the film sees: the picture will be black");
  wavelengths_ = std::make_unique<WavelengthDistribution>(
      choose_wavelengths(response, channel_responses(film(), grid), lights));
  // An emitter that is never chosen is met by chance, by paths from the sensor; paths from the emitters know
  // no such chance.
  std::vector<double> emitted_powers = powers;
  for (size_t e = 0; e < emitters_.size(); ++e) {
    const float weight = emitters_[e]->sampling_weight();
    powers[e] *= weight;
    if (weight > 0 || emitters_[e]->is_delta()) emitted_powers[e] *= weight;
  }
  lights_ = LightSampler(emitters_, powers, emitted_powers);
}

Spectrum Scene::null_transmittance(const SurfacePoint& point, const Vec3& d, const Wavelengths& w) {
  const Bsdf& bsdf = *point.shape->bsdf();
  if (!bsdf.is_passable()) return 0.f;
  return bsdf.null_transmittance(point.shading.to_local(-d), BsdfContext{w, point});
}

bool Scene::may_meet_emitter(const Ray& ray) const {
  if (emitter_bounds_.empty()) return true;
  const Vec3 inverse{1 / ray.d.x, 1 / ray.d.y, 1 / ray.d.z};
  for (const Bounds3& b : emitter_bounds_) {
    float near = 0, far = ray.t_max;
    for (int k = 0; k < 3; ++k) {
      const float t0 = (b.lower[k] - ray.o[k]) * inverse[k], t1 = (b.upper[k] - ray.o[k]) * inverse[k];
      // NaN, of a ray within a face, leaves the interval as it is.
      near = std::max(near, std::min(t0, t1)), far = std::min(far, std::max(t0, t1));
    }
    // Rounding of the distances, relative to themselves.
    if (near <= far * 1.0001f) return true;
  }
  return false;
}

Spectrum Scene::connect(const SurfacePoint& from, const DirectSample& to, const Wavelengths& w,
                        bool through_emitters) const {
  Ray ray = connection_ray(from, to);
  if (has_binary_visibility() && !through_emitters) return tracer_->occluded(ray) ? 0.f : 1.f;
  const Vec3 target = to.infinite ? Vec3{} : connection_target(ray.o, to);
  Spectrum passed = 1.f;
  while (const auto hit = intersect(ray)) {
    if (!(through_emitters && hit->shape->emitter())) passed *= null_transmittance(*hit, to.wo, w);
    if (is_black(passed)) return 0.f;
    ray.o = offset_origin(*hit, to.wo);
    if (to.infinite) continue;
    ray.d = target - ray.o;
    // Beyond a surface that the target lies on, too; the way back would meet it again and again.
    if (!(dot(ray.d, to.wo) > 0)) break;
  }
  return passed;
}

}  // namespace aureole
