// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/dvr/march.h"

#include <algorithm>
#include <cmath>

#include "aureole/transport/dimensions.h"

namespace aureole {

namespace {

using Method = DvrSettings::Method;

/// The largest magnitude over all wavelengths.
float magnitude(const Spectrum& s) {
  float largest = 0;
  for (int i = 0; i < kWavelengths; ++i) largest = std::max(largest, std::abs(s[i]));
  return largest;
}

}  // namespace

int divide_into_steps(float interval, float& length) {
  constexpr int kMaxSteps = 1 << 20;
  length = std::max(length, interval / float(kMaxSteps));
  return std::max(1, int(std::ceil(interval / length - 1e-4f)));
}

VolumeMarch::VolumeMarch(const Scene& scene, std::span<const ClassifiedMedium* const> media,
                         const DvrSettings& settings, const Path& path, float length,
                         const SampledSpectrum& d65, std::uint32_t key)
    : settings_(settings),
      ray_(path.ray),
      random_(key),
      lighting_(scene, media, settings, path, d65_, random_) {
  length_ = length = std::min(length, ray_.t_max);
  const auto clip = [&](float& begin, float& end, const ClassifiedMedium* medium) {
    begin = 0, end = length - shift_;
    medium->clip(ray_, begin, end);
    return end > begin;
  };
  float begin, end;
  shift_ = 0;
  float first = kInfinity;
  for (const ClassifiedMedium* medium : media)
    if (clip(begin, end, medium)) first = std::min(first, begin);
  if (first == kInfinity) {
    if (settings.method == Method::xray) d65_ = d65.eval(path.wavelengths);
    return;
  }
  if (settings.jitter) {
    // The R2 sequence over the pixels (M. Roberts 2018), in units of 2^-32, or a random number for each pixel.
    constexpr std::uint32_t kRight = 0xc13fa9a9u, kDown = 0x91e10da5u;
    const std::uint32_t shift = settings.interleaves
                                    ? std::uint32_t(std::int32_t(std::floor(path.film.x))) * kRight +
                                          std::uint32_t(std::int32_t(std::floor(path.film.y))) * kDown
                                    : path.samples.pixel_bits(int(Stream::volume_march));
    phase_ = path.samples.spread(shift);
  }
  d65_ = d65.eval(path.wavelengths);
  basis_ = ColorBasis(path.wavelengths.nm);
  // The march begins a little before the media, since this distance is rounded.
  shift_ = std::max(0.f, first - std::abs(first) * 1e-6f);
  for (int k = 0; k < 3; ++k) ray_.o[k] = float(double(ray_.o[k]) + double(ray_.d[k]) * double(shift_));
  begin_ = kInfinity;
  for (const ClassifiedMedium* medium : media) {
    if (!clip(begin, end, medium)) continue;
    begin_ = std::min(begin_, begin), end_ = std::max(end_, end);
    parts_.push_back(Part{.medium = medium, .begin = begin, .end = end, .active = {}});
  }
}

VolumeResult VolumeMarch::follow() {
  if (parts_.empty()) {
    VolumeResult none;
    if (settings_.method == Method::xray) cover(none, d65_, 1);
    return none;
  }
  switch (settings_.method) {
    case Method::isosurface:
      return isosurfaces();
    case Method::mip:
    case Method::average:
      return project();
    case Method::splatting:
      return splat();
    default:
      break;
  }
  const bool is_adaptive = settings_.steps == DvrSettings::Steps::adaptive;
  is_one_ = parts_.size() == 1 && settings_.order == DvrSettings::Order::front_to_back &&
            settings_.form == DvrSettings::Form::opacity_weighted &&
            settings_.alpha == DvrSettings::Alpha::exponential;
  if (!is_one_ || is_adaptive) find_active();
  if (is_adaptive) return adapt();
  // Light that is scattered is found at random places: it would not agree with that of steps of half the length.
  return settings_.method == Method::emission_absorption ? integrate() : composite(settings_.step);
}

void VolumeMarch::find_active() {
  for (Part& part : parts_) {
    if (!settings_.skip_empty) {
      part.active.push_back({part.begin, part.end});
      continue;
    }
    const auto& majorants = part.medium->majorants();
    majorants.visit_segments(ray_, part.end, [&](const MajorantSegment& s) {
      const float from = std::max(s.begin, part.begin), to = std::min(s.end, part.end);
      if (!(to > from)) return false;
      if (!part.active.empty() && from <= part.active.back()[1])
        part.active.back()[1] = to;
      else
        part.active.push_back({from, to});
      return false;
    });
  }
}

Spectrum VolumeMarch::color_at(const ClassifiedMedium& medium, const Vec3& p, const Sample& s) {
  if (settings_.method == Method::xray) return 0.f;
  const Spectrum color = basis_.eval(s.color);
  if (settings_.method == Method::single_scattering && !medium.color_emits())
    return lighting_.scattered(medium, p, min(color, 1.f));
  if (settings_.gradient_lighting) return lighting_.shaded(medium, p, color, medium.field().gradient(p));
  return color * d65_ * medium.emission_scale();
}

void VolumeMarch::add(Part& part, float a, float b, float offset, Step& step) {
  a = std::max(a, part.begin), b = std::min(b, part.end);
  if (!(b > a)) return;
  const ClassifiedMedium& medium = *part.medium;
  const Vec3 p = at(a + offset * (b - a));
  Sample s;
  float value = 0;
  if (settings_.preintegrated) {
    const bool is_known = part.last_end == a;
    step.lookups += is_known ? 1 : 2;
    const float from = is_known ? part.last_value : medium.field().value(at(a));
    const float to = medium.field().value(at(b));
    part.last_end = b, part.last_value = to;
    s = medium.classify(p, from, to);
    value = 0.5f * (from + to);
  } else {
    ++step.lookups;
    value = medium.field().value(p);
    s = medium.classify(p, value);
  }
  if (!(s.extinction > 0)) return;
  step.value = value;
  const float thickness = s.extinction * (b - a);
  step.thickness += thickness;
  step.emission += color_at(medium, p, s) * thickness;
}

VolumeResult VolumeMarch::composite(float length) {
  if (is_one_) return composite_one(length);
  VolumeResult result;
  const float offset = phase_;
  const bool is_forward = settings_.order == DvrSettings::Order::front_to_back;
  const bool is_weighted = settings_.form == DvrSettings::Form::opacity_weighted;
  const bool is_taylor = settings_.alpha == DvrSettings::Alpha::taylor;
  const int count = divide_into_steps(end_ - begin_, length);
  struct Layer {
    Spectrum color;
    float opacity;
  };
  std::vector<Layer> layers;  // layers of the ray, which compositing from back to front needs
  for (Part& part : parts_) part.next = 0, part.last_end = -1;
  for (int k = 0; k < count;) {
    // First step that overlaps an interval which may absorb.
    const float from = begin_ + float(k) * length;
    float next = kInfinity;
    for (Part& part : parts_) {
      while (part.next < part.active.size() && part.active[part.next][1] <= from) ++part.next;
      if (part.next < part.active.size()) next = std::min(next, part.active[part.next][0]);
    }
    if (next == kInfinity) break;
    if (next > from + length) {
      k = std::max(k + 1, int((next - begin_) / length));
      continue;
    }
    // Both ends are multiples of the length, so that steps add up to the ray and one begins where the last one ended.
    const float a = from, b = k + 1 == count ? end_ : std::min(begin_ + float(k + 1) * length, end_);
    ++k;
    Step step;
    for (Part& part : parts_)
      if (part.next < part.active.size() && part.active[part.next][0] < b) add(part, a, b, offset, step);
    result.lookups += float(step.lookups);
    if (!(step.thickness > 0)) continue;
    result.optical_thickness += step.thickness;
    const float opacity = is_taylor ? std::min(step.thickness, 1.f) : opacity_of(step.thickness);
    const Spectrum color = is_weighted ? step.emission * (opacity / step.thickness) : step.emission;
    const float before = result.transmittance;
    result.transmittance *= 1 - opacity;
    note_half(result, before, step.value, 0.5f * (a + b));
    if (!is_forward) {
      layers.push_back({color, opacity});
      continue;
    }
    result.radiance += color * before;
    if (result.transmittance < settings_.termination) {
      result.transmittance = 0;
      break;
    }
  }
  for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer)
    result.radiance = layer->color + result.radiance * (1 - layer->opacity);
  return shown(result);
}

VolumeResult VolumeMarch::shown(VolumeResult result) const {
  if (settings_.method == Method::xray) {
    result.radiance = d65_ * result.transmittance;
    result.transmittance = 0;
  }
  return result;
}

VolumeResult VolumeMarch::integrate() {
  constexpr int kMaxHalvings = 12;
  float step = settings_.step;
  VolumeResult coarse = composite(step);
  int agreements = 0;  // two agreements in a row, since one may be chance
  for (int k = 0; k < kMaxHalvings && agreements < 2; ++k) {
    step *= 0.5f;
    VolumeResult fine = composite(step);
    fine.lookups += coarse.lookups;
    const bool agrees =
        magnitude(fine.radiance - coarse.radiance) <= settings_.tolerance * magnitude(fine.radiance) &&
        std::abs(fine.transmittance - coarse.transmittance) <= settings_.tolerance;
    agreements = agrees ? agreements + 1 : 0;
    coarse = fine;
  }
  return coarse;
}

}  // namespace aureole
