// SPDX-License-Identifier: Apache-2.0
// Adaptive steps of `dvr`: each step is composited once as a whole and once in two halves, and halved until both agree.
#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/integrator/dvr/march.h"

namespace aureole {

namespace {

/// The emission of a layer as weights of the colours' basis spectra, and its transmittance.
struct AdaptiveLayer {
  float thickness = 0;
  ColorWeights emission;  ///< sum of thickness times colour

  /// Adds a step of a given length; `scale` is the scale of the emitted light.
  void add(const TransferFunction::Sample& s, float length, float scale) {
    const float t = s.extinction * length, e = t * scale;
    thickness += t;
    emission.white += e * s.color.white, emission.red += e * s.color.red;
    emission.green += e * s.color.green, emission.blue += e * s.color.blue;
  }
  float opacity() const { return opacity_of(thickness); }
  /// Factor of `emission` in the light that leaves the layer.
  float escape() const { return thickness > 0 ? opacity() / thickness : 1; }
};

/// Largest difference, in emission and in transmittance, between a whole layer and the two halves of it.
float difference_of(const AdaptiveLayer& whole, const AdaptiveLayer& near, const AdaptiveLayer& far) {
  const float passed = 1 - near.opacity(), w = whole.escape(), n = near.escape(), f = far.escape() * passed;
  const auto at = [&](float ColorWeights::*c) {
    return std::abs(w * whole.emission.*c - n * near.emission.*c - f * far.emission.*c);
  };
  return std::max({std::abs(whole.opacity() - (near.opacity() + far.opacity() * passed)),
                   at(&ColorWeights::white), at(&ColorWeights::red), at(&ColorWeights::green),
                   at(&ColorWeights::blue)});
}

}  // namespace

VolumeResult VolumeMarch::adapt() {
  constexpr float kLongest = 8,
                  kShortest = 1.f / 64;  // longest and shortest step, in units of the first step
  constexpr int kMaxSteps = 1 << 20;
  VolumeResult result;
  const float longest = settings_.step * kLongest,
              shortest = std::max(settings_.step * kShortest, (end_ - begin_) / float(kMaxSteps));
  // Half of the tolerance is for lengths, half for the light that is absorbed: both add up to the tolerance at most.
  const float allowed_per_length = 0.5f * settings_.tolerance / (end_ - begin_),
              allowed_per_opacity = 0.5f * settings_.tolerance;
  const bool is_shaded = settings_.gradient_lighting;
  ColorWeights light;  // emission in scenes without lights; converted to a spectrum at the end
  float length = settings_.step, t = begin_;
  bool is_continued = false;  // whether the sampled values at t are known
  for (Part& part : parts_) part.next = 0;
  while (t < end_) {
    // Distance of the first interval that may absorb, and distance at which the next interval begins or ends:
    // no step crosses it.
    float next = kInfinity, limit = kInfinity;
    for (Part& part : parts_) {
      while (part.next < part.active.size() && part.active[part.next][1] <= t) ++part.next;
      if (part.next < part.active.size()) next = std::min(next, part.active[part.next][0]);
    }
    if (next == kInfinity) break;
    if (next > t) t = next, length = settings_.step, is_continued = false;
    const auto is_active = [&](const Part& part) {
      return part.next < part.active.size() && part.active[part.next][0] <= t;
    };
    for (Part& part : parts_)
      if (part.next < part.active.size())
        limit = std::min(limit, part.active[part.next][is_active(part) ? 1 : 0]);
    const auto look_up = [&](float Part::*number, float distance) {
      for (Part& part : parts_) {
        if (!is_active(part)) continue;
        part.*number = part.medium->field().value(at(distance));
        ++result.lookups;
      }
    };
    // The mean of a parabola through three values differs from the mean of its two chords by a twelfth of the
    // second difference. Both ends of a half are moved by that, within the range of the numbers.
    const auto ends_of = [](const Part& part, float Part::*from, float Part::*to) {
      const float shift = (2 * part.middle - part.first - part.last) * (1.f / 12);
      const auto [low, high] = std::minmax({part.first, part.middle, part.last});
      return std::array{std::clamp(part.*from + shift, low, high), std::clamp(part.*to + shift, low, high)};
    };
    const auto half_of = [&](float a, float b, float Part::*from, float Part::*to) {
      AdaptiveLayer layer;
      for (const Part& part : parts_) {
        if (!is_active(part)) continue;
        const auto ends = ends_of(part, from, to);
        layer.add(part.medium->classify(at(0.5f * (a + b)), ends[0], ends[1]), b - a,
                  part.medium->emission_scale());
      }
      return layer;
    };
    const auto layer_of = [&](float a, float b, float Part::*from, float Part::*to) {
      AdaptiveLayer layer;
      for (const Part& part : parts_)
        if (is_active(part))
          layer.add(part.medium->classify(at(0.5f * (a + b)), part.*from, part.*to), b - a,
                    part.medium->emission_scale());
      return layer;
    };
    if (!is_continued) look_up(&Part::first, t);
    // The last step before the limit is lengthened by up to a half, instead of adding a short step after it.
    float end = limit - t < 1.5f * length ? limit : t + length, middle = 0.5f * (t + end);
    look_up(&Part::last, end);
    look_up(&Part::middle, middle);
    AdaptiveLayer whole = layer_of(t, end, &Part::first, &Part::last), near, far;
    float difference = 0, allowed = 0;
    for (;;) {
      near = half_of(t, middle, &Part::first, &Part::middle);
      far = half_of(middle, end, &Part::middle, &Part::last);
      difference = result.transmittance * difference_of(whole, near, far);
      const float absorbed = result.transmittance * (near.opacity() + far.opacity() * (1 - near.opacity()));
      allowed = allowed_per_length * (end - t) + allowed_per_opacity * absorbed;
      if (difference <= allowed || end - t <= shortest) break;
      end = middle, middle = 0.5f * (t + end);
      for (Part& part : parts_) part.last = part.middle;
      whole = layer_of(t, end, &Part::first, &Part::last);
      look_up(&Part::middle, middle);
    }
    const auto cover_half = [&](const AdaptiveLayer& layer, float a, float b, float Part::*from,
                                float Part::*to) {
      if (!(layer.thickness > 0)) return;
      const float before = result.transmittance, part_of_light = layer.escape() * before;
      result.optical_thickness += layer.thickness;
      result.transmittance *= 1 - layer.opacity();
      if (!is_shaded) {
        light.white += part_of_light * layer.emission.white, light.red += part_of_light * layer.emission.red;
        light.green += part_of_light * layer.emission.green,
            light.blue += part_of_light * layer.emission.blue;
        note_half(result, before, 0.5f * (parts_.back().*from + parts_.back().*to), 0.5f * (a + b));
        return;
      }
      Spectrum emission = 0.f;
      float value = 0;
      for (const Part& part : parts_) {
        if (!is_active(part)) continue;
        const Vec3 p = at(0.5f * (a + b));
        const auto ends = ends_of(part, from, to);
        const Sample s = part.medium->classify(p, ends[0], ends[1]);
        if (!(s.extinction > 0)) continue;
        value = 0.5f * (part.*from + part.*to);
        emission += color_at(*part.medium, p, s) * (s.extinction * (b - a));
      }
      result.radiance += emission * part_of_light;
      note_half(result, before, value, 0.5f * (a + b));
    };
    cover_half(near, t, middle, &Part::first, &Part::middle);
    cover_half(far, middle, end, &Part::middle, &Part::last);
    if (result.transmittance < settings_.termination) {
      result.transmittance = 0;
      break;
    }
    // The estimate falls with the third power of the length: a step of twice the length would still be accepted.
    length = end - t;
    if (difference <= allowed / 8) length = std::min(2 * length, longest);
    length = std::max(length, shortest);
    t = end, is_continued = true;
    for (Part& part : parts_) part.first = part.last;
    if (end == limit) is_continued = false;
  }
  if (!is_shaded) result.radiance = basis_.eval(light) * d65_;
  return shown(result);
}

}  // namespace aureole
