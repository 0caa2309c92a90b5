// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/splat/splat_blend.h"

#include <cstring>

namespace aureole {

namespace {

constexpr int kLaneCount = 8;
using FloatLanes = float __attribute__((vector_size(kLaneCount * sizeof(float))));
using IntLanes = int __attribute__((vector_size(kLaneCount * sizeof(int))));

bool any_lane(const IntLanes& m) {
  std::uint64_t words[sizeof(IntLanes) / 8];
  std::memcpy(words, &m, sizeof m);
  std::uint64_t all = 0;
  for (const std::uint64_t w : words) all |= w;
  return all != 0;
}
FloatLanes all_lanes(float f) { return f - FloatLanes{}; }

/// exp(x) for x in [-80, 0], with a relative error below 2e-7: 2^n times a polynomial of x - n ln 2 in [-0.35, 0.35].
FloatLanes exp_lanes(const FloatLanes& x) {
  constexpr float kRound = 0x1.8p23f;  // adding it leaves an integer in the last bits
  const FloatLanes shifted = x * 1.44269504f + kRound, n = shifted - kRound;
  const FloatLanes r = x - n * 0.693359375f - n * -2.12194440e-4f;
  FloatLanes p = r * 1.9875691500e-4f + 1.3981999507e-3f;
  p = p * r + 8.3334519073e-3f;
  p = p * r + 4.1665795894e-2f;
  p = p * r + 1.6666665459e-1f;
  p = p * r + 5.0000001201e-1f;
  p = p * r * r + r + 1.f;
  IntLanes bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  const IntLanes power = (bits << 23) + (127 << 23);  // the upper bits of `shifted` are shifted out
  FloatLanes scale;
  std::memcpy(&scale, &power, sizeof scale);
  return p * scale;
}

/// The samples of eight lanes.
struct LaneState {
  FloatLanes x, y, limit;
  FloatLanes red{}, green{}, blue{};
  FloatLanes transmittance = all_lanes(1), distance = all_lanes(kInfinity);
  FloatLanes sum{};  ///< sum of weights
  IntLanes active;
  float low_y, high_y;
};

enum class BlendKind { perspective, tangential, interpolated, flat, point };

/// The exponent of a footprint at each lane, and a mask of the lanes within its reach.
template <BlendKind kKind>
IntLanes exponent(const SplatFootprint& f, const LaneState& s, FloatLanes& power) {
  const FloatLanes dx = s.x - f.x, dy = s.y - f.y;
  if constexpr (kKind == BlendKind::point) {
    power = FloatLanes{};
    return (dx >= -0.5f) & (dx < 0.5f) & (dy >= -0.5f) & (dy < 0.5f);
  }
  const FloatLanes a = dx * f.a0 + dy * f.a1, b = dx * f.b0 + dy * f.b1;
  power = (a * a + b * b) * -0.5f;
  IntLanes inside = dx == dx;
  if constexpr (kKind == BlendKind::tangential) {
    const FloatLanes d = dx * f.d0 + dy * f.d1 + 1.f;
    inside = d > 0.f;
    power = power / (d * d);
  }
  return inside & (power >= f.min_exponent);
}

void add_color(LaneState& s, const SplatFootprint& f, const FloatLanes& weight) {
  s.red += weight * f.color[0], s.green += weight * f.color[1], s.blue += weight * f.color[2];
}

/// Blends from front to back (Kerbl and others 2023, equation 3).
template <BlendKind kKind>
void blend(LaneState& s, const SplatFootprint& f, const SplatSettings& settings) {
  FloatLanes power;
  const IntLanes inside = exponent<kKind>(f, s, power) & s.active & (s.limit > f.distance);
  if (!any_lane(inside)) return;
  const FloatLanes raw = exp_lanes(inside ? power : FloatLanes{}) * f.weight,
                   capped = raw < settings.opacity_cap ? raw : all_lanes(settings.opacity_cap);
  IntLanes covered = inside & (capped >= settings.opacity_limit);
  const FloatLanes left = s.transmittance * (1.f - capped);
  const IntLanes ends = covered & (left < settings.termination);
  s.active &= ~ends;
  covered &= ~ends;
  const FloatLanes alpha = covered ? capped * s.transmittance : FloatLanes{};
  add_color(s, f, alpha);
  s.transmittance = covered ? left : s.transmittance;
  const IntLanes halved = (s.transmittance <= 0.5f) & (s.distance >= kInfinity) & covered;
  s.distance = halved ? all_lanes(f.distance) : s.distance;
}

/// Adds the points of the first surface, weighted by their footprints.
template <BlendKind kKind>
void interpolate(LaneState& s, const SplatFootprint& f) {
  FloatLanes power;
  const IntLanes inside = exponent<kKind>(f, s, power) & (s.limit >= f.distance);
  if (!any_lane(inside)) return;
  FloatLanes weight = all_lanes(f.weight);
  if constexpr (kKind == BlendKind::interpolated)
    weight = exp_lanes(inside ? power : FloatLanes{}) * f.weight;
  weight = inside ? weight : FloatLanes{};
  add_color(s, f, weight);
  s.sum += weight;
  const IntLanes first = inside & (s.distance >= kInfinity);
  s.distance = first ? all_lanes(f.distance) : s.distance;
  const FloatLanes behind = all_lanes(f.distance + f.range);
  s.limit = first ? (s.limit < behind ? s.limit : behind) : s.limit;
}

template <BlendKind kKind>
void blend_tile(const ProjectedSplats& splats, const SplatSettings& settings,
                std::span<const std::uint32_t> list, LaneState& s) {
  const SplatFootprint* all = splats.footprints().data();
  for (const std::uint32_t index : list) {
    const SplatFootprint& f = all[index];
    if (f.y + f.reach_y < s.low_y || f.y - f.reach_y > s.high_y) continue;
    if constexpr (kKind == BlendKind::perspective || kKind == BlendKind::tangential) {
      blend<kKind>(s, f, settings);
      if (!any_lane(s.active)) return;
    } else {
      interpolate<kKind>(s, f);
    }
  }
}

void finish_interpolation(const SplatSettings& settings, LaneState& s) {
  const IntLanes covered = s.sum > 0.f;
  s.transmittance = covered ? FloatLanes{} : all_lanes(1);
  if (settings.normalization == SplatSettings::Normalization::none) return;
  const FloatLanes scale = covered ? 1.f / (covered ? s.sum : all_lanes(1)) : FloatLanes{};
  s.red *= scale, s.green *= scale, s.blue *= scale;
}

}  // namespace

void blend_splats(const ProjectedSplats& splats, const SplatSettings& settings,
                  std::span<SplatSample> samples) {
  using Footprint = SplatSettings::Footprint;
  int tiles[kSplatLanes];
  const int count = int(samples.size());
  for (int i = 0; i < count; ++i) tiles[i] = splats.tile_of(samples[std::size_t(i)].film);
  int lanes[kLaneCount];
  bool done[kSplatLanes] = {};
  for (int first = 0; first < count; ++first) {
    if (done[first]) continue;
    // Up to eight samples of one tile are blended together.
    int n = 0;
    for (int i = first; i < count && n < kLaneCount; ++i)
      if (!done[i] && tiles[i] == tiles[first]) done[i] = true, lanes[n++] = i;
    LaneState s;
    s.low_y = kInfinity, s.high_y = -kInfinity;
    for (int k = 0; k < kLaneCount; ++k) {
      const SplatSample& sample = samples[std::size_t(lanes[k < n ? k : 0])];
      s.x[k] = sample.film.x, s.y[k] = sample.film.y, s.limit[k] = k < n ? sample.limit : -1.f;
      s.active[k] = k < n ? -1 : 0;
      s.low_y = std::min(s.low_y, sample.film.y), s.high_y = std::max(s.high_y, sample.film.y);
    }
    const auto list = splats.tile(tiles[first]);
    switch (settings.footprint) {
      case Footprint::blended:
        if (splats.conventions().projection == SplatHints::Projection::tangential)
          blend_tile<BlendKind::tangential>(splats, settings, list, s);
        else
          blend_tile<BlendKind::perspective>(splats, settings, list, s);
        break;
      case Footprint::point:
        blend_tile<BlendKind::point>(splats, settings, list, s);
        break;
      case Footprint::disc:
        blend_tile<BlendKind::flat>(splats, settings, list, s);
        break;
      case Footprint::gaussian:
      case Footprint::ewa:
        blend_tile<BlendKind::interpolated>(splats, settings, list, s);
    }
    if (!settings.blends()) finish_interpolation(settings, s);
    for (int k = 0; k < n; ++k) {
      SplatSample& sample = samples[std::size_t(lanes[k])];
      sample.color[0] = s.red[k], sample.color[1] = s.green[k], sample.color[2] = s.blue[k];
      sample.transmittance = s.transmittance[k], sample.distance = s.distance[k];
    }
  }
}

}  // namespace aureole
