// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/dvr/lighting.h"

#include <algorithm>
#include <cmath>

#include "aureole/integrator/first_surface.h"

namespace aureole {

namespace {

/// Largest number of delta lights that are all sampled; among more lights one is chosen for each sample.
constexpr std::size_t kMaxSampled = 8;

/// Whether a surface that is not null lies between a point in space and another one at a distance along `d`, or infinitely
/// far away. The surface of the light itself, at the end, does not count.
bool is_occluded(const Scene& scene, const Vec3& p, const Vec3& d, float distance) {
  const Ray ray{p, d, distance * (1 - 1e-4f)};
  FirstSurface found;
  find_first_surfaces(scene, {&ray, 1}, RayTracer::Rays::incoherent, &found);
  return found.distance < kInfinity;
}

}  // namespace

bool VolumeLighting::samples_all_lights(const Scene& scene) {
  const auto& lights = scene.emitters();
  return lights.size() <= kMaxSampled && std::all_of(lights.begin(), lights.end(), [](const Light& l) {
           return l.is_delta() && l.part_count() == 1;
         });
}

float VolumeLighting::transmittance(const Ray& ray, float length, float step) const {
  constexpr double kOpaque =
      16;  // optical thickness behind which nothing is counted, a transmittance of 1e-7
  double thickness = 0;
  for (const ClassifiedMedium* medium : media_) {
    float begin = 0, end = length;
    medium->clip(ray, begin, end);
    if (!(end > begin)) continue;
    const Classification& classification = medium->classification();
    const TransferFunction* const function = classification.only_function();
    medium->field().along(ray, [&](const auto& value_at) {
      medium->majorants().visit_segments(ray, end, [&](const MajorantSegment& s) {
        const float from = std::max(s.begin, begin), to = std::min(s.end, end);
        if (!(to > from)) return false;
        const int count = std::max(1, int(std::ceil(std::min((to - from) / step, 1e6f))));
        const float ds = (to - from) / float(count);
        float sum = 0;
        for (int k = 0; k < count; ++k) {
          const float t = from + (float(k) + 0.5f) * ds, value = value_at(t);
          sum +=
              function ? function->extinction(value) : classification.at(ray.o + ray.d * t, value).extinction;
        }
        thickness += double(sum) * double(ds);
        return thickness > kOpaque;
      });
    });
    if (thickness > kOpaque) return 0;
  }
  return float(std::exp(-thickness));
}

template <class Visit>
void VolumeLighting::visit_lights(const Vec3& p, bool shadows, const Visit& visit) {
  if (scene_.lights().empty()) return;
  const bool all = samples_all_lights(scene_);
  const std::size_t count = all ? scene_.emitters().size() : 1;
  for (std::size_t k = 0; k < count; ++k) {
    LightChoice choice{nullptr, 0, 1};
    if (all) {
      choice.light = &scene_.emitters()[k];
    } else {
      const auto chosen = scene_.lights().choose(p, {}, random_.next(), path_.wavelengths.time);
      if (!chosen || !(chosen->probability > 0)) continue;
      choice = *chosen;
    }
    const Vec2 u{random_.next(), random_.next()};
    const auto direct = choice.light->sample_direct(p, choice.part, u, path_.wavelengths);
    if (!direct || !(direct->pdf > 0) || is_black(direct->radiance)) continue;
    float factor = 1 / (choice.probability * direct->pdf);
    if (shadows) {
      const float distance = direct->infinite ? kInfinity : length(direct->p - p);
      factor *= transmittance({p, direct->wo}, distance, settings_.step);
      if (!(factor > 0) || is_occluded(scene_, p, direct->wo, distance)) continue;
    }
    visit(direct->wo, direct->radiance * factor);
  }
}

float VolumeLighting::ambient(const Vec3& p, const Vec3& n) {
  const int count = settings_.occlusion_samples;
  if (count == 0) return 1;
  const Frame frame = Frame::from_normal(n);
  const float voxel = 2 * settings_.step;
  float sum = 0;
  for (int k = 0; k < count; ++k) {
    const float u = (float(k) + random_.next()) / float(count), r = std::sqrt(u),
                phi = 2 * kPi * random_.next();
    const Vec3 d = frame.to_world({r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.f, 1 - u))});
    // The shadow ray begins two steps off the point, so that the surface does not occlude itself.
    sum += transmittance({p + d * voxel, d}, settings_.occlusion_radius, voxel);
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
  const float part = s.ambient * medium.emission_scale();
  Spectrum radiance = part > 0 ? color * d65_ * (part * ambient(p, n)) : Spectrum(0.f);
  if (!has_normal || !(s.diffuse + s.specular > 0)) return radiance;
  visit_lights(p, settings_.shadows, [&](const Vec3& to_light, const Spectrum& irradiance) {
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
  visit_lights(p, true, [&](const Vec3& to_light, const Spectrum& irradiance) {
    radiance += albedo * medium.phase().eval_pdf(-path_.ray.d, to_light, context).value * irradiance;
  });
  return radiance;
}

}  // namespace aureole
