// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/mesh_attribute.h"

#include <algorithm>
#include <mutex>
#include <set>

#include "aureole/math/vec.h"

namespace aureole {

AttributeName::AttributeName(const std::string& text) {
  static std::mutex mutex;
  static std::set<std::string> names;
  const std::lock_guard lock(mutex);
  text_ = &*names.insert(text).first;
}

std::size_t MeshAttribute::memory_bytes() const {
  return numbers_.capacity() * sizeof(float) + colors_.capacity() * sizeof(UpsampledColor);
}

Spectrum MeshAttribute::eval(const std::uint32_t* indices, const float* weights, int count,
                             const Wavelengths& w) const {
  if (!is_color_) {
    float sum = 0;
    for (int i = 0; i < count; ++i) sum += numbers_[indices[i]] * weights[i];
    return sum;
  }
  // Spectra are interpolated, since the coefficients of the upsampling model have no linear meaning.
  const Spectrum nm = UpsampledColor::model_range(w.nm);
  Spectrum sum = 0.f;
  for (int i = 0; i < count; ++i) sum += colors_[indices[i]].eval(nm) * weights[i];
  return sum;
}

std::pair<float, float> MeshAttribute::range() const {
  if (size() == 0) return {0.f, 0.f};
  float minimum = kInfinity, maximum = -kInfinity;
  for (const float v : numbers_) minimum = std::min(minimum, v), maximum = std::max(maximum, v);
  for (const UpsampledColor& c : colors_) {
    const auto [low, high] = c.range();
    minimum = std::min(minimum, low), maximum = std::max(maximum, high);
  }
  return {minimum, maximum};
}

SampledSpectrum MeshAttribute::mean(const SpectralGrid& grid) const {
  if (!is_color_) {
    double sum = 0;
    for (const float v : numbers_) sum += v;
    return SampledSpectrum::constant(grid, size() ? float(sum / double(size())) : 0);
  }
  // Upper bound of the colours that the mean takes, at 64 wavelengths; of more colours a subset is taken.
  constexpr std::size_t kMaxSamples = 1 << 14;
  constexpr int kNodes = 64;
  const std::size_t stride = std::max<std::size_t>(1, size() / kMaxSamples);
  std::vector<double> nm(kNodes), sums(kNodes);
  for (int k = 0; k < kNodes; ++k) nm[k] = grid.min_nm + (grid.max_nm - grid.min_nm) * k / (kNodes - 1);
  std::size_t used = 0;
  for (std::size_t i = 0; i < size(); i += stride, ++used)
    for (int block = 0; block < kNodes; block += kWavelengths) {
      const Spectrum at = make_spectrum([&](int j) { return float(nm[block + j]); });
      const Spectrum value = colors_[i].eval(UpsampledColor::model_range(at));
      for (int j = 0; j < kWavelengths; ++j) sums[block + j] += value[j];
    }
  for (double& s : sums) s /= double(std::max<std::size_t>(used, 1));
  return SampledSpectrum::from_points(grid, nm, sums);
}

}  // namespace aureole
