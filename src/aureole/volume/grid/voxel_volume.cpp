// SPDX-License-Identifier: Apache-2.0
#include "aureole/volume/grid/voxel_volume.h"

#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole {

namespace {

/// Returns the largest value of a colour over all wavelengths.
float most_of(const UpsampledColor& c) { return c.range().second; }

float interpolate(const float* v, std::ptrdiff_t sy, std::ptrdiff_t sz, float tx, float ty, float tz) {
  const auto along_x = [&](const float* q) { return q[0] + (q[1] - q[0]) * tx; };
  const auto along_y = [&](const float* q) {
    const float a = along_x(q);
    return a + (along_x(q + sy) - a) * ty;
  };
  const float a = along_y(v);
  return a + (along_y(v + sz) - a) * tz;
}

/// Interpolates the spectra of eight colours. Successive corners of one chromaticity are evaluated once,
/// since smoke has a constant chromaticity.
Spectrum interpolate(const UpsampledColor* v, std::ptrdiff_t sy, std::ptrdiff_t sz, float tx, float ty,
                     float tz, const Spectrum& nm) {
  Spectrum sum;
  float offset = 0;
  UpsampledColor last{};
  for (int corner = 0; corner < 8; ++corner) {
    const UpsampledColor& c = v[(corner & 1) + (corner >> 1 & 1) * sy + (corner >> 2) * sz];
    const float part = (corner & 1 ? tx : 1 - tx) * (corner & 2 ? ty : 1 - ty) * (corner & 4 ? tz : 1 - tz);
    const float weight = c.scale * part;
    if (weight == 0) continue;
    if (weight < 0) offset += part;
    if (c.c0 == last.c0 && c.c1 == last.c1 && c.c2 == last.c2) {
      last.scale += weight;
      continue;
    }
    if (last.scale != 0) sum += last.shape(nm) * last.scale;
    last = {c.c0, c.c1, c.c2, weight};
  }
  if (last.scale != 0) sum += last.shape(nm) * last.scale;
  return sum + offset;
}

/// Wavelength intervals in which the envelope is constant.
constexpr int kEnvelopeParts = 94;  // intervals of 5 nm
constexpr float kPartNm = (SigmoidPolynomial::kMaxNm - SigmoidPolynomial::kMinNm) / kEnvelopeParts;

}  // namespace

VoxelFilter VoxelFilter::read_without_wrap(const Properties& p) {
  return {p.get_choice("filter_type", "trilinear", {"trilinear", "nearest"}) == "nearest", VoxelWrap::clamp};
}

VoxelFilter VoxelFilter::read(const Properties& p) {
  VoxelFilter filter = read_without_wrap(p);
  const std::string wrap = p.get_choice("wrap_mode", "clamp", {"clamp", "repeat", "mirror"});
  filter.wrap = wrap == "clamp" ? VoxelWrap::clamp : wrap == "repeat" ? VoxelWrap::repeat : VoxelWrap::mirror;
  return filter;
}

std::vector<ParameterDoc> VoxelFilter::rows() {
  return {{"filter_type", "string", "", "trilinear",
           "interpolation between the centres of voxels: trilinear, or nearest for none"},
          {"wrap_mode", "string", "", "clamp",
           "outside the box: clamp to its faces, repeat, or mirror. A medium still ends at the box of its "
           "extinction"}};
}

void VoxelVolume::set_size(const std::array<int, 3>& size) {
  size_ = size;
  const Transform::Matrix& m = to_box_.matrix();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 4; ++j) rows_[i][j] = float(m[i][j] * size[i]);
    // A point of the box has |rows . p| <= |offset| + size; the products have about that size.
    constexpr float kEpsilon = std::numeric_limits<float>::epsilon();
    slip_[i] = 1e-4f + 8 * kEpsilon * (2 * std::abs(rows_[i][3]) + float(size[i]));
  }
}

void VoxelVolume::set(std::vector<Numbers> numbers) {
  numbers_ = std::move(numbers);
  set_size(numbers_.front().size());
  minimum_ = std::numeric_limits<float>::infinity(), maximum_ = -minimum_;
  for (const Numbers& grid : numbers_)
    grid.for_each([&](float v) { minimum_ = std::min(minimum_, v), maximum_ = std::max(maximum_, v); });
}

void VoxelVolume::set_later(const std::array<int, 3>& size, const std::array<float, 2>& range,
                            std::function<Numbers()> make) {
  set_size(size);
  minimum_ = range[0], maximum_ = range[1];
  make_ = std::move(make);
  is_pending_ = true;
}

void VoxelVolume::make_numbers() const {
  const std::lock_guard lock(making_);
  if (!is_pending_.load(std::memory_order_relaxed)) return;
  std::vector<Numbers> made;
  made.push_back(make_());
  numbers_ = std::move(made), make_ = nullptr;
  is_pending_.store(false, std::memory_order_release);
}

void VoxelVolume::set(Colors colors) {
  has_colors_ = true;
  colors_ = std::move(colors);
  set_size(colors_.size());
  minimum_ = std::numeric_limits<float>::infinity(), maximum_ = 0;
  envelope_.assign(kEnvelopeParts, 0.f);
  UpsampledColor last{};
  colors_.for_each([&](const UpsampledColor& c) {
    const auto [least, most] = c.range();
    minimum_ = std::min(minimum_, least), maximum_ = std::max(maximum_, most);
    // Colours of one chromaticity, as in smoke, share one spectral shape, unless a part of them is below
    // white.
    const bool same_shape = c.c0 == last.c0 && c.c1 == last.c1 && c.c2 == last.c2;
    if (!(most > 0) || (same_shape && (c.scale == last.scale || (c.scale > 0 && last.scale > 0)))) return;
    last = c;
    for (int i = 0; i < kEnvelopeParts; ++i) {
      const float from = SigmoidPolynomial::kMinNm + kPartNm * float(i);
      envelope_[std::size_t(i)] =
          std::max(envelope_[std::size_t(i)], c.range(from, from + kPartNm).second / most);
    }
  });
  constexpr float kRounding = 1e-5f;
  for (float& e : envelope_) e *= 1 + kRounding;
}

VoxelVolume::Place VoxelVolume::place(const Vec3& p) const {
  int base[3];
  float t[3];
  for (int i = 0; i < 3; ++i) {
    const float* m = rows_[i];
    const float n = float(size_[std::size_t(i)]);
    float x = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
    if (filter_.wrap == VoxelWrap::repeat)
      x -= n * std::floor(x / n);
    else if (filter_.wrap == VoxelWrap::mirror) {
      x -= 2 * n * std::floor(x / (2 * n));
      x = std::min(x, 2 * n - x);
    }
    x = x > 0 ? std::min(x, n) : 0.f;  // a NaN coordinate becomes 0
    if (!filter_.nearest) {
      x -= .5f;
      // With `repeat`, the outer halves of border voxels are interpolated between the last voxel and the
      // first.
      if (filter_.wrap != VoxelWrap::repeat) x = std::min(std::max(x, 0.f), n - 1);
    }
    const float floor = std::floor(x);
    base[i] = std::min(int(floor), size_[std::size_t(i)] - 1);
    t[i] = x - floor;
  }
  return {base[0], base[1], base[2], t[0], t[1], t[2]};
}

Spectrum VoxelVolume::eval(const Vec3& p, const Wavelengths& w) const {
  if (colors_.empty()) return eval_scalar(p);
  const Spectrum nm = UpsampledColor::model_range(w.nm);
  const Place at = place(p);
  const UpsampledColor* v = colors_.corner(at.x, at.y, at.z);
  if (filter_.nearest) return v->eval(nm);
  return interpolate(v, colors_.stride_y(), colors_.stride_z(), at.tx, at.ty, at.tz, nm);
}

float VoxelVolume::eval_scalar(const Vec3& p) const {
  if (colors_.empty()) {
    const Place at = place(p);
    const Numbers& grid = numbers().front();
    const float* v = grid.corner(at.x, at.y, at.z);
    return filter_.nearest ? *v : interpolate(v, grid.stride_y(), grid.stride_z(), at.tx, at.ty, at.tz);
  }
  const SpectralGrid& grid = properties().context().grid;
  const Spectrum nm = make_spectrum(
      [&](int i) { return float(grid.min_nm + (grid.max_nm - grid.min_nm) * (i + 0.5) / kWavelengths); });
  return mean(eval(p, Wavelengths::at(grid, nm)));
}

void VoxelVolume::eval_channels(const Vec3& p, float* out) const {
  if (!colors_.empty()) {
    *out = eval_scalar(p);
    return;
  }
  const Place at = place(p);
  for (const Numbers& grid : numbers()) {
    const float* v = grid.corner(at.x, at.y, at.z);
    *out++ = filter_.nearest ? *v : interpolate(v, grid.stride_y(), grid.stride_z(), at.tx, at.ty, at.tz);
  }
}

template <class Value, class Grid>
void VoxelVolume::bound_grid(const Grid& grid, const Value& value, const std::array<int, 3>& cells,
                             std::span<float> bounds) const {
  // Range of voxels on which each cell depends, for each axis.
  std::array<std::vector<std::array<int, 2>>, 3> spans;
  for (std::size_t i = 0; i < 3; ++i) {
    const int n = size_[i];
    const double shift = filter_.nearest ? 0 : .5;
    for (int c = 0; c < cells[i]; ++c) {
      const double from = double(n) * c / cells[i] - double(slip_[i]) - shift;
      const double to = double(n) * (c + 1) / cells[i] + double(slip_[i]) - shift;
      // Beyond the borders there are only copies of border voxels; with `repeat`, cells at a border also
      // depend on the voxels of the opposite border. Positions are clamped before the conversion: far from
      // the origin, rounding errors may exceed the range of int.
      const double lower = std::clamp(std::floor(from), -1.0, n - 1.0);
      const double upper = std::clamp(std::floor(to) + (filter_.nearest ? 0 : 1), 0.0, double(n));
      spans[i].push_back({int(lower), int(upper)});
    }
  }
  const std::size_t nx = std::size_t(cells[0]), ny = std::size_t(cells[1]);
  for_ranges(
      ny * std::size_t(cells[2]),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
          for (std::size_t x = 0; x < nx; ++x) {
            float& most = bounds[row * nx + x];
            grid.for_each_in({{spans[0][x], spans[1][row % ny], spans[2][row / ny]}},
                             [&](const auto& v) { most = std::max(most, value(v)); });
          }
      },
      16);
}

void VoxelVolume::bound(const std::array<int, 3>& cells, std::span<float> bounds) const {
  std::fill(bounds.begin(), bounds.end(), 0.f);
  if (colors_.empty()) {
    for (const Numbers& grid : numbers())
      bound_grid(
          grid, [](float v) { return v; }, cells, bounds);
  } else
    bound_grid(colors_, most_of, cells, bounds);
  // Margin for the rounding of the interpolation.
  constexpr float kRounding = 1e-6f;
  for (float& b : bounds) b *= 1 + kRounding;
}

Spectrum VoxelVolume::envelope(const Wavelengths& w) const {
  if (colors_.empty()) return 1.f;
  const Spectrum at = (UpsampledColor::model_range(w.nm) - SigmoidPolynomial::kMinNm) * (1 / kPartNm);
  return make_spectrum(
      [&](int i) { return envelope_[std::size_t(std::min(int(at.v[i]), kEnvelopeParts - 1))]; });
}

std::size_t VoxelVolume::memory_bytes() const {
  std::size_t sum = colors_.memory_bytes();
  for (const Numbers& grid : numbers_) sum += grid.memory_bytes();
  return sum;
}

}  // namespace aureole
