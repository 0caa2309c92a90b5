// SPDX-License-Identifier: Apache-2.0
// Splatting of a grid (Westover 1990, "Footprint evaluation for volume rendering"): each voxel is classified, spread by a
// Gaussian kernel, and added to sheets that are then composited. The picture's value along a ray is a sum over the voxels
// whose footprints hold the ray. Westover adds each voxel to the pixels; here each ray gathers its voxels,
// which gives the same sums.
#include <algorithm>
#include <cmath>

#include "aureole/integrator/dvr/march.h"

namespace aureole {

namespace {

/// Number of standard deviations beyond which the kernel is cut.
constexpr float kKernelReach = 4;

/// Integral of the normal distribution up to x standard deviations.
float normal_integral(float x) { return 0.5f * std::erfc(-x * 0.70710678f); }

struct SplatSheet {
  float thickness = 0, value = 0;  ///< value: sum of thickness times value of the volume
  ColorWeights emission;           ///< sum of thickness times colour

  void add(const TransferFunction::Sample& s, float number, float t) {
    thickness += t, value += t * number;
    emission.white += t * s.color.white, emission.red += t * s.color.red;
    emission.green += t * s.color.green, emission.blue += t * s.color.blue;
  }
};

/// The axis of a grid that is nearest to a direction in the world.
int nearest_axis(const ScalarField& field, const Vec3& direction) {
  int nearest = 0;
  float largest = -1;
  const Vec3 corner = field.point_of_index({0, 0, 0});
  for (int k = 0; k < 3; ++k) {
    Vec3 index;
    index[k] = 1;
    const Vec3 axis = field.point_of_index(index) - corner;
    const float cosine = std::abs(dot(axis, direction)) / length(axis);
    if (cosine > largest) largest = cosine, nearest = k;
  }
  return nearest;
}

}  // namespace

VolumeResult VolumeMarch::splat() {
  VolumeResult result;
  const Part& part = parts_.front();
  const ClassifiedMedium& medium = *part.medium;
  const ScalarField& field = medium.field();
  const std::array<int, 3>& size = field.size();
  const TransferFunction* const function = medium.classification().only_function();
  const bool are_parallel = settings_.sheets == DvrSettings::Sheets::image;
  // The ray o + t d in units of voxels; a length of 1 in world space has length `scale` there.
  const Vec3 o = field.index_of(ray_.o), d = field.index_vector(ray_.d);
  const float scale = length(d);
  const Vec3 u = d * (1 / scale);
  // Layers of voxels are crossed from the near one to the far one. Rays at a large angle to the sensor's axis would cross
  // layers in too many voxels.
  constexpr float kSmallestCosine = 0.3f;
  int axis = nearest_axis(field, are_parallel ? ray_.d : settings_.view);
  if (std::abs(u[axis]) < kSmallestCosine) axis = nearest_axis(field, ray_.d);
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  const float sigma = settings_.kernel_width, reach = kKernelReach * sigma;
  // thickness of a footprint at its centre, as a length in world space
  const float density = 1 / (2 * kPi * sigma * sigma * scale);
  // A footprint is a circle about the ray, and an ellipse in the layer.
  const auto half_of = [&](int k) { return reach * std::hypot(u[axis], u[k]) / std::abs(u[axis]); };
  const float half_a = half_of(a), half_b = half_of(b);

  // Slabs parallel to the image, by distance along the ray in the world: slab k ends at (k + 1) * slab.
  const float cosine = std::max(0.05f, std::abs(dot(settings_.view, ray_.d)));
  float slab = settings_.step / cosine;
  const float behind =
      (half_a + half_b + reach) / scale;  // how far before its layer's crossing a kernel may begin
  const float limit = part.end;
  std::vector<SplatSheet> sheets;
  float from = 0;
  if (are_parallel) {
    constexpr float kMaxSheets = 1 << 20;
    slab = std::max(slab, (limit - part.begin + 2 * behind) / kMaxSheets);
    // Slabs lie on one grid of distances from the ray's origin, which all rays of a picture share.
    from = std::floor((part.begin - behind + shift_) / slab) * slab - shift_;
    sheets.resize(std::size_t(std::ceil((limit + behind - from) / slab)) + 1);
  }
  std::size_t done = 0;
  const auto composite_sheet = [&](const SplatSheet& sheet, float t) {
    if (!(sheet.thickness > 0)) return;
    const float before = result.transmittance;
    result.optical_thickness += sheet.thickness;
    const float opacity = opacity_of(sheet.thickness);
    result.radiance +=
        basis_.eval(sheet.emission) * d65_ * (medium.emission_scale() * before * (opacity / sheet.thickness));
    result.transmittance *= 1 - opacity;
    note_half(result, before, sheet.value / sheet.thickness, t);
  };
  const auto composite_until = [&](float t) {  // Composites the slabs that end before the distance t.
    for (; done < sheets.size() && from + float(done + 1) * slab <= t; ++done)
      composite_sheet(sheets[done], from + (float(done) + 0.5f) * slab);
  };

  const int count = size[std::size_t(axis)], way = d[axis] > 0 ? 1 : -1;
  for (int k = way > 0 ? 0 : count - 1; k >= 0 && k < count; k += way) {
    const float t = (float(k) - o[axis]) / d[axis];
    // the sample is behind the sensor, or behind a surface
    if (t + shift_ < 0 || t > length_ - shift_) continue;
    const Vec3 q = o + d * t;
    const auto first = [](float c, float half) {
      return std::max(0, int(std::ceil(std::max(c - half, -1e6f))));
    };
    const auto last = [](float c, float half, int n) {
      return std::min(n - 1, int(std::floor(std::min(c + half, 1e9f))));
    };
    SplatSheet sheet;
    const int last_a = last(q[a], half_a, size[std::size_t(a)]),
              last_b = last(q[b], half_b, size[std::size_t(b)]);
    for (int j = first(q[b], half_b); j <= last_b; ++j)
      for (int i = first(q[a], half_a); i <= last_a; ++i) {
        const float va = float(i) - q[a], vb = float(j) - q[b];
        const float along = va * u[a] + vb * u[b], r2 = va * va + vb * vb - along * along;
        if (!(r2 <= reach * reach)) continue;
        int index[3];
        index[a] = i, index[b] = j, index[axis] = k;
        const float number = field.voxel(index[0], index[1], index[2]);
        ++result.lookups;
        Sample s;
        if (function) {
          s = function->at(number);
          if (!(s.extinction > 0)) continue;
        }
        const Vec3 centre = field.point_of_index({float(index[0]), float(index[1]), float(index[2])});
        if (!function) s = medium.classify(centre, number);
        if (!(s.extinction > 0) || !medium.contains(centre)) continue;
        const float thickness = s.extinction * density * std::exp(-0.5f * r2 / (sigma * sigma));
        if (!are_parallel) {
          sheet.add(s, number, thickness);
          continue;
        }
        // The fraction of the kernel within each slab.
        const float at = t + along / scale, width = sigma / scale;
        const auto slab_of = [&](float distance) {
          return std::size_t(std::clamp((distance - from) / slab, 0.f, float(sheets.size() - 1)));
        };
        const std::size_t end = slab_of(at + kKernelReach * width);
        float passed = 0;
        for (std::size_t n = slab_of(at - kKernelReach * width); n <= end; ++n) {
          const float until = n == end ? 1 : normal_integral((from + float(n + 1) * slab - at) / width);
          sheets[n].add(s, number, thickness * (until - passed));
          passed = until;
        }
      }
    if (are_parallel)
      composite_until(t - behind);
    else
      composite_sheet(sheet, t);
    if (result.transmittance < settings_.termination) {
      result.transmittance = 0;
      return result;
    }
  }
  composite_until(kInfinity);
  if (result.transmittance < settings_.termination) result.transmittance = 0;
  return result;
}

}  // namespace aureole
