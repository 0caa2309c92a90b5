// SPDX-License-Identifier: Apache-2.0
// The loop of `dvr` over the steps of one volume, from front to back. Without lights, colours are added up as weights, and
// become spectra once for each ray.
#include <algorithm>
#include <cmath>

#include "aureole/integrator/dvr/march.h"

namespace aureole {

VolumeResult VolumeMarch::composite_one(float length) {
  VolumeResult result;
  const Part& part = parts_.front();
  const ClassifiedMedium& medium = *part.medium;
  const Classification& classification = medium.classification();
  const TransferFunction* const function = classification.only_function();
  const bool is_preintegrated = settings_.preintegrated,
             is_xray = settings_.method == DvrSettings::Method::xray;
  const bool is_lit =
      settings_.gradient_lighting || settings_.method == DvrSettings::Method::single_scattering;
  const float offset = phase_;
  const int count = divide_into_steps(end_ - begin_, length);
  const float termination = settings_.termination;
  /// The sums along the ray. Each segment works on a copy of them in registers.
  struct Sums {
    ColorWeights light;
    float transmittance = 1, thickness = 0;
    int lookups = 0;
    float last_end = -1, last_value = 0;  // end of the last preintegrated step, and the volume's value there
  } sums;
  medium.field().along(ray_, [&](const auto& value_at) {
    /// Composites the step from a to b. Returns whether the ray ends. `starts_at_last`: the last step ended at a.
    const auto take_step = [&](Sums & s, float a, float b, bool starts_at_last)
        __attribute__((always_inline)) {
      const float middle = a + offset * (b - a);
      Sample sample;
      float value;
      if (is_preintegrated) {
        const float first = starts_at_last ? s.last_value : value_at(a);
        s.last_value = value_at(b), s.last_end = b;
        s.lookups += starts_at_last ? 1 : 2;
        value = 0.5f * (first + s.last_value);
        sample = function ? function->mean(first, s.last_value)
                          : classification.mean(at(middle), first, s.last_value);
      } else {
        value = value_at(middle);
        ++s.lookups;
        sample = function ? function->at(value) : classification.at(at(middle), value);
      }
      if (!(sample.extinction > 0)) return false;
      const float step = sample.extinction * (b - a), opacity = opacity_of(step),
                  part_of_light = opacity * s.transmittance;
      if (is_lit) {
        result.radiance += color_at(medium, at(middle), sample) * part_of_light;
      } else {
        s.light.white += part_of_light * sample.color.white, s.light.red += part_of_light * sample.color.red;
        s.light.green += part_of_light * sample.color.green,
            s.light.blue += part_of_light * sample.color.blue;
      }
      const float before = s.transmittance;
      s.transmittance *= 1 - opacity, s.thickness += step;
      if (before > 0.5f && s.transmittance <= 0.5f) {
        result.transmittance = s.transmittance;
        note_half(result, before, value, 0.5f * (a + b));
      }
      if (!(s.transmittance < termination)) return false;
      s.transmittance = 0;
      return true;
    };

    if (settings_.steps == DvrSettings::Steps::by_opacity) {
      // No step may absorb more than a given fraction of the light from behind, by the bound of its block.
      constexpr float kLongest = 8;  // longest step, in units of `step`
      float t = begin_;
      medium.majorants().visit_segments(ray_, part.end, [&](const MajorantSegment& block) {
        Sums s = sums;
        const float to = std::min(block.end, part.end);
        bool is_over = false;
        for (t = std::max(t, std::max(block.begin, part.begin)); t < to && !is_over;) {
          const float wanted = settings_.step_opacity / (s.transmittance * block.bound);
          float end = t + std::clamp(wanted, length, kLongest * length);
          // The last step of a block ends with the block, or crosses its end by less than `step` where it
          // would be shorter.
          if (end > to - 0.5f * length) end = std::min(std::max(to, t + length), end_);
          is_over = take_step(s, t, end, s.last_end == t);
          t = end;
        }
        sums = s;
        return is_over;
      });
      return;
    }

    int next = 0, last_step = -2;  // the next step, and the last one that was evaluated
    // Evaluates the steps that touch a segment which may absorb. Returns whether the ray ends.
    const auto follow_segment = [&](float from, float to) {
      Sums s = sums;
      const float begin = begin_, end = end_;
      bool is_over = false;
      int k = std::max(next, int((from - begin) / length));
      for (; k < count && !is_over; ++k) {
        const float a = begin + float(k) * length;
        if (a >= to) break;
        const float b = k + 1 == count ? end : std::min(begin + float(k + 1) * length, end);
        if (b <= from) continue;
        is_over = take_step(s, a, b, last_step + 1 == k);
        last_step = k;
      }
      next = k, sums = s;
      return is_over;
    };
    // As `follow_segment`, for the most frequent settings: all steps but the last one of the ray have one length.
    const bool is_plain = function && !is_preintegrated && !is_lit;
    const auto follow_plain_segment = [&](float from, float to) {
      Sums s = sums;
      const auto line = value_at;
      const float begin = begin_, part_of_step = offset * length;
      bool is_over = false;
      int k = std::max(next, int((from - begin) / length));
      if (begin + float(k + 1) * length <= from) ++k;
      for (; k + 1 < count && !is_over; ++k) {
        const float a = begin + float(k) * length;
        if (a >= to) break;
        const float value = line(a + part_of_step);
        ++s.lookups;
        const Sample sample = function->at(value);
        if (!(sample.extinction > 0)) continue;
        // Both ends are multiples of the length, so that steps add up to the ray.
        const float step = sample.extinction * (begin + float(k + 1) * length - a),
                    opacity = opacity_of(step), before = s.transmittance, part_of_light = opacity * before;
        s.light.white += part_of_light * sample.color.white, s.light.red += part_of_light * sample.color.red;
        s.light.green += part_of_light * sample.color.green,
            s.light.blue += part_of_light * sample.color.blue;
        s.transmittance = before - part_of_light, s.thickness += step;
        if (before > 0.5f && s.transmittance <= 0.5f) {
          result.transmittance = s.transmittance;
          note_half(result, before, value, a + 0.5f * length);
        }
        is_over = s.transmittance < termination;
      }
      if (is_over) s.transmittance = 0;
      next = k, sums = s;
      return is_over || (k + 1 == count && begin + float(k) * length < to && follow_segment(from, to));
    };
    const auto follow_part = [&](float from, float to) {
      return is_plain ? follow_plain_segment(from, to) : follow_segment(from, to);
    };
    if (!settings_.skip_empty) {
      follow_part(part.begin, part.end);
      return;
    }
    // Blocks that follow each other are composited together, some at a time, since a ray may end early.
    constexpr int kMostBlocks = 8;
    float from = 0, to = 0;
    int blocks = 0;
    bool is_over = false;
    medium.majorants().visit_segments(ray_, part.end, [&](const MajorantSegment& s) {
      const float block_begin = std::max(s.begin, part.begin), block_end = std::min(s.end, part.end);
      if (!(block_end > block_begin)) return false;
      if (blocks > 0 && (block_begin > to || blocks == kMostBlocks))
        is_over = follow_part(from, to), blocks = 0;
      if (blocks == 0) from = block_begin;
      to = block_end, ++blocks;
      return is_over;
    });
    if (!is_over && blocks > 0) follow_part(from, to);
  });
  result.transmittance = sums.transmittance, result.optical_thickness = sums.thickness;
  result.lookups = float(sums.lookups);
  if (!is_lit && !is_xray) result.radiance = basis_.eval(sums.light) * d65_ * medium.emission_scale();
  return shown(result);
}

}  // namespace aureole
