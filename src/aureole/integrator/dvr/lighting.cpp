// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/dvr/lighting.h"

#include <algorithm>
#include <cmath>

#include "aureole/transport/connection.h"
#include "aureole/transport/diffraction.h"

namespace aureole {

namespace {

/// Up to so many lights without extent are all asked; of more, or of others, one is chosen for each sample.
constexpr std::size_t kMaxAsked = 8;

bool asks_all(const Scene& scene) {
  const auto& lights = scene.emitters();
  return lights.size() <= kMaxAsked && std::all_of(lights.begin(), lights.end(), [](const Light& l) {
           return l.is_delta() && l.part_count() == 1;
         });
}

}  // namespace

float optical_thickness(const ClassifiedMedium& medium, const Ray& ray, float length, float step) {
  float begin = 0, end = length;
  medium.clip(ray, begin, end);
  if (!(end > begin)) return 0;
  const int count = std::max(1, int(std::ceil((end - begin) / step)));
  const float ds = (end - begin) / float(count);
  float sum = 0;
  for (int k = 0; k < count; ++k) {
    const Vec3 p = ray.o + ray.d * (begin + (float(k) + 0.5f) * ds);
    sum += medium.classify(p, medium.field().value(p)).extinction;
  }
  return sum * ds;
}

template <class Visit>
void VolumeLighting::visit_lights(const ClassifiedMedium& medium, const Vec3& p, bool shadows,
                                  const Visit& visit) {
  if (scene_.lights().empty()) return;
  const Wavelengths& w = path_.wavelengths;
  const bool all = asks_all(scene_);
  const std::size_t count = all ? scene_.emitters().size() : 1;
  for (std::size_t k = 0; k < count; ++k) {
    LightChoice choice{nullptr, 0, 1};
    if (all) {
      choice.light = &scene_.emitters()[k];
    } else {
      const auto chosen = scene_.lights().choose(p, {}, random_.next());
      if (!chosen || !(chosen->probability > 0)) continue;
      choice = *chosen;
    }
    const Vec2 u{random_.next(), random_.next()};
    const auto direct = choice.light->sample_direct(p, choice.part, u, w);
    if (!direct || !(direct->pdf > 0) || is_black(direct->radiance)) continue;
    const float pdf = choice.probability * direct->pdf;
    if (!shadows) {
      visit(direct->wo, direct->radiance * (1 / pdf));
      continue;
    }
    if (start_medium_ != &medium) {
      start_.emplace();
      start_->ray = Ray{p, direct->wo};
      find_interiors(scene_, *start_);
      start_medium_ = &medium;
    }
    const RayOrigin from = RayOrigin::in_space(p);
    Connection c;
    if (direct->infinite)
      c.set(from, direct->wo);
    else
      c.set(from, direct->wo, RayOrigin::of(*direct));
    c.near = Weight(Spectrum(1.f));
    c.far = Unpolarised::emitted(direct->radiance);
    c.begin_in(*start_, std::uint32_t(random_.next() * 0x1p32f));
    c.weigh(true, pdf, 0.f, w);
    if (arrives(scene_, c, w, std::uint32_t(random_.next() * 0x1p32f)))
      visit(direct->wo, c.estimate() * (w.pdf * float(kWavelengths)));
  }
}

float VolumeLighting::ambient(const ClassifiedMedium& medium, const Vec3& p, const Vec3& n) {
  const int count = settings_.occlusion_samples;
  if (count == 0) return 1;
  const Frame frame = Frame::from_normal(n);
  const float step = 2 * medium.field().spacing();
  float sum = 0;
  for (int k = 0; k < count; ++k) {
    const float u = (float(k) + random_.next()) / float(count), r = std::sqrt(u),
                phi = 2 * kPi * random_.next();
    const Vec3 d = frame.to_world({r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.f, 1 - u))});
    // Begins a voxel off the point, so that the surface does not occlude itself.
    const Ray ray{p + d * medium.field().spacing(), d};
    sum += std::exp(-optical_thickness(medium, ray, settings_.occlusion_radius, step));
  }
  return sum / float(count);
}

Spectrum VolumeLighting::shaded(const ClassifiedMedium& medium, const Vec3& p, const Spectrum& color,
                                const Vec3& gradient) {
  const ClassifiedMedium::Shading& s = medium.shading();
  const Vec3 to_sensor = -path_.ray.d;
  const float size = length(gradient);
  const bool has_normal = size > 0;
  Vec3 n = has_normal ? gradient * (1 / size) : to_sensor;
  if (dot(n, to_sensor) < 0) n = -n;
  Spectrum radiance = color * d65_ * (s.ambient * medium.emission_scale() * ambient(medium, p, n));
  if (!has_normal || !(s.diffuse + s.specular > 0)) return radiance;
  visit_lights(medium, p, settings_.shadows, [&](const Vec3& to_light, const Spectrum& irradiance) {
    const float cosine = std::abs(dot(n, to_light));
    float lobe = 0;
    if (settings_.halfway) {
      const Vec3 h = to_light + to_sensor;
      lobe = length(h) > 0 ? std::abs(dot(n, h)) / length(h) : 0;
    } else {
      const Vec3 side = dot(n, to_light) < 0 ? -n : n;
      lobe = std::max(0.f, dot(side * (2 * cosine) - to_light, to_sensor));
    }
    const float highlight = cosine > 0 && s.specular > 0 ? s.specular * std::pow(lobe, s.shininess) : 0;
    radiance += (color * (s.diffuse * cosine) + highlight) * irradiance * (1 / kPi);
  });
  return radiance;
}

Spectrum VolumeLighting::scattered(const ClassifiedMedium& medium, const Vec3& p, const Spectrum& albedo) {
  Spectrum radiance = 0.f;
  const PhaseContext context{path_.wavelengths, p};
  visit_lights(medium, p, true, [&](const Vec3& to_light, const Spectrum& irradiance) {
    radiance += albedo * medium.phase().eval_pdf(-path_.ray.d, to_light, context).value * irradiance;
  });
  return radiance;
}

}  // namespace aureole
