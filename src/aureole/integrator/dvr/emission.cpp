// SPDX-License-Identifier: Apache-2.0
// The loop of `dvr` over the steps of one volume that emits and absorbs. Colours are added up as weights, and become
// spectra once for each ray.
#include <algorithm>
#include <cmath>

#include "aureole/integrator/dvr/march.h"

namespace aureole {

VolumeResult VolumeMarch::composite_emission(float length) {
  VolumeResult result;
  const Part& part = parts_.front();
  const ClassifiedMedium& medium = *part.medium;
  const Classification& classification = medium.classification();
  const TransferFunction* const function = classification.only_function();
  const bool is_preintegrated = settings_.preintegrated;
  const float offset = settings_.jitter ? random_.next() : 0.5f;
  const int count = divide_into_steps(end_ - begin_, length);
  ColorWeights light;
  float transmittance = 1, thickness = 0;
  int lookups = 0;
  medium.field().along(ray_, [&](const auto& value_at) {
    int k = 0, last_step = -2;  // the next step, and the last one that was evaluated
    float last_value = 0;       // at its end
    // Evaluates the steps that touch a segment which may absorb. Returns whether the ray ends.
    const auto follow_segment = [&](float from, float to) {
      k = std::max(k, int((from - begin_) / length));
      for (; k < count; ++k) {
        const float a = begin_ + float(k) * length;
        if (a >= to) break;
        const float b = k + 1 == count ? end_ : std::min(a + length, end_);
        if (b <= from) continue;
        const float middle = a + offset * (b - a);
        Sample s;
        float value;
        if (is_preintegrated) {
          const bool is_known = last_step + 1 == k;
          const float first = is_known ? last_value : value_at(a);
          last_value = value_at(b), last_step = k;
          lookups += is_known ? 1 : 2;
          value = 0.5f * (first + last_value);
          s = function ? function->mean(first, last_value)
                       : classification.mean(at(middle), first, last_value);
        } else {
          value = value_at(middle);
          ++lookups;
          s = function ? function->at(value) : classification.at(at(middle), value);
        }
        if (!(s.extinction > 0)) continue;
        const float step = s.extinction * (b - a), opacity = opacity_of(step),
                    part_of_light = opacity * transmittance;
        light.white += part_of_light * s.color.white, light.red += part_of_light * s.color.red;
        light.green += part_of_light * s.color.green, light.blue += part_of_light * s.color.blue;
        const float before = transmittance;
        transmittance *= 1 - opacity, thickness += step;
        if (before > 0.5f && transmittance <= 0.5f) {
          result.transmittance = transmittance;
          note_half(result, before, value, 0.5f * (a + b));
        }
        if (transmittance < settings_.termination) {
          transmittance = 0;
          return true;
        }
      }
      return false;
    };
    if (!settings_.skip_empty) {
      follow_segment(part.begin, part.end);
      return;
    }
    medium.majorants().visit_segments(ray_, part.end, [&](const MajorantSegment& s) {
      const float from = std::max(s.begin, part.begin), to = std::min(s.end, part.end);
      return to > from && follow_segment(from, to);
    });
  });
  result.transmittance = transmittance, result.optical_thickness = thickness, result.lookups = float(lookups);
  if (settings_.method != DvrSettings::Method::xray)
    result.radiance = basis_.eval(light) * d65_ * medium.emission_scale();
  return shown(result);
}

}  // namespace aureole
