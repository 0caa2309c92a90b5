// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/splat/splat_cloud.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "aureole/core/letter_case.h"
#include "aureole/core/parallel.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/splat/splat_reader.h"

namespace aureole {

namespace {

using SplatReaderFunction = SplatCloud (*)(const std::filesystem::path&, const SharedBytes&,
                                           const SplatFileOptions&);

bool starts_with(std::span<const std::byte> bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

/// Returns the reader of a file, or null.
SplatReaderFunction splat_reader_of(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  const std::string extension = lower_extension(file);
  if (starts_with(bytes, "ply\n") || starts_with(bytes, "ply\r")) return splat_reader::read_ply;
  if (starts_with(bytes, "NGSP") || (starts_with(bytes, "\x1f\x8b") && extension == ".spz"))
    return splat_reader::read_spz;
  if (starts_with(bytes, "glTF") || extension == ".gltf") return splat_reader::read_gltf;
  if (starts_with(bytes, "#usda ")) return splat_reader::read_usda;
  if (extension == ".splat") return splat_reader::read_splat32;
  return nullptr;
}

bool is_finite_splat(const SplatCloud& c, std::size_t i) {
  const auto& q = c.rotations[i];
  bool finite = is_finite(c.positions[i]) && is_finite(c.scales[i]) && std::isfinite(c.opacities[i]);
  for (const float v : q) finite &= std::isfinite(v);
  const float* h = c.harmonics_of(i);
  for (std::size_t k = 0; k < 3 * c.coefficients(); ++k) finite &= std::isfinite(h[k]);
  return finite;
}

bool has_colors(const SplatCloud& c, std::size_t i) {
  const float* h = c.harmonics_of(i);
  return std::all_of(h, h + 3 * c.coefficients(), [](float v) { return std::abs(v) <= kMostHarmonic; });
}

/// Leaves out splats for which `is_good` is false. Returns their number, and the index of the first.
template <class IsGood>
std::size_t keep_splats(SplatCloud& c, const IsGood& is_good, std::size_t& first) {
  std::vector<char> good(c.size());
  for_ranges(c.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) good[i] = is_good(i);
  });
  std::size_t kept = 0;
  const std::size_t numbers = 3 * c.coefficients();
  first = c.size();
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (!good[i]) {
      first = std::min(first, i);
      continue;
    }
    if (kept != i) {
      c.positions[kept] = c.positions[i], c.scales[kept] = c.scales[i], c.rotations[kept] = c.rotations[i];
      c.opacities[kept] = c.opacities[i];
      std::copy_n(&c.harmonics[i * numbers], numbers, &c.harmonics[kept * numbers]);
    }
    ++kept;
  }
  const std::size_t dropped = c.size() - kept;
  if (dropped > 0) c.resize(kept, c.degree);
  return dropped;
}

/// Changes the cloud from the file's axes to its own: some axes are reversed, S = diag(+-1). A rotation R
/// becomes S R S, which rotates the mirrored ellipsoid.
void reverse_axes(SplatCloud& c) {
  const Vec3 s{c.axes[0] == 'R' ? 1.f : -1.f, c.axes[1] == 'U' ? 1.f : -1.f, c.axes[2] == 'B' ? 1.f : -1.f};
  if (s == Vec3{1, 1, 1}) return;
  const float determinant = s.x * s.y * s.z;
  const int count = int(c.coefficients());
  float signs[16];
  for (int k = 0; k < count; ++k) {
    signs[k] = 1;
    for (int axis = 0; axis < 3; ++axis)
      if (s[axis] < 0 && is_odd_harmonic(k, axis)) signs[k] = -signs[k];
  }
  for_ranges(c.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      c.positions[i] = c.positions[i] * s;
      for (int axis = 0; axis < 3; ++axis) c.rotations[i][std::size_t(axis) + 1] *= determinant * s[axis];
      float* h = &c.harmonics[3 * std::size_t(count) * i];
      for (int k = 0; k < 3 * count; ++k) h[k] *= signs[k / 3];
    }
  });
}

/// Checks all numbers, normalises the quaternions and changes the axes.
void finish_cloud(SplatCloud& c, const SplatFileOptions& options) {
  const std::size_t all = c.size();
  std::size_t first;
  if (const std::size_t n = keep_splats(
          c, [&](std::size_t i) { return is_finite_splat(c, i); }, first))
    c.notes.push_back(fmt::format(
        "has {} of {} splats with a number that is not finite, the first of them number {}: they are left out",
        n, all, first));
  if (const std::size_t n = keep_splats(
          c, [&](std::size_t i) { return has_colors(c, i); }, first))
    c.notes.push_back(fmt::format(
        "has {} splats with a coefficient of their colour beyond {:g}, the first of them number {}: they are left out",
        n, kMostHarmonic, first));
  const auto norm = [&](std::size_t i) {
    const auto& q = c.rotations[i];
    return std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  };
  if (const std::size_t n = keep_splats(
          c, [&](std::size_t i) { return norm(i) > 1e-30f && std::isfinite(norm(i)); }, first))
    c.notes.push_back(fmt::format(
        "has {} splats whose rotation is the quaternion 0, which is none, the first of them number {}: "
        "they are left out",
        n, first));
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.scales[i].x < 0 || c.scales[i].y < 0 || c.scales[i].z < 0)
      throw Error(fmt::format("has the scales {:g}, {:g}, {:g} of splat {}; a scale is 0 or more",
                              c.scales[i].x, c.scales[i].y, c.scales[i].z, i));
  for (std::size_t i = 0; i < c.size(); ++i)
    if (!(c.opacities[i] >= 0 && c.opacities[i] <= 1))
      throw Error(
          fmt::format("has the opacity {:g} of splat {}; an opacity lies in [0, 1]", c.opacities[i], i));
  if (c.size() == 0 && all > 0)
    throw Error(fmt::format("has no splat that can be drawn: it {}", fmt::join(c.notes, "; it ")));
  for_ranges(c.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float scale = 1 / norm(i);
      for (float& v : c.rotations[i]) v *= scale;
    }
  });
  if (c.kind == SplatCloud::Kind::gaussians) {
    std::size_t flat = 0;
    for (std::size_t i = c.size(); i-- > 0;)
      if (max_component(c.scales[i]) == 0) ++flat, first = i;
    if (flat > 0)
      c.notes.push_back(fmt::format(
          "has {} splats whose three scales are 0, the first of them number {}: they have no extent", flat,
          first));
  }
  if (!options.axes.empty()) c.axes = options.axes;
  reverse_axes(c);
}

}  // namespace

void SplatCloud::resize(std::size_t count, int new_degree) {
  degree = new_degree;
  positions.resize(count), scales.resize(count), rotations.resize(count), opacities.resize(count);
  harmonics.resize(3 * coefficients() * count);
}

std::size_t SplatCloud::memory_bytes() const {
  return size() * (2 * sizeof(Vec3) + sizeof(rotations[0]) + sizeof(float) * (1 + 3 * coefficients()));
}

const std::vector<std::string>& splat_axes() {
  static const std::vector<std::string> kAxes = {"RUB", "RDF", "LUF", "RUF", "LUB", "RDB", "LDF", "LDB"};
  return kAxes;
}

SplatCloud turned_axes(const SplatCloud& cloud, const std::string& axes) {
  SplatCloud turned = cloud;
  turned.axes = axes;
  reverse_axes(turned);
  return turned;
}

bool is_splat_file(const std::filesystem::path& file) {
  const SharedBytes bytes = map_file(file);
  const auto reader = splat_reader_of(file, bytes.bytes);
  if (reader == splat_reader::read_ply) {
    const auto start = bytes.bytes.first(std::min<std::size_t>(bytes.size(), 1 << 14));
    const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
    return text.find("f_dc_0") != text.npos;
  }
  return reader && reader != splat_reader::read_gltf;
}

SplatCloud read_splat_file(const std::filesystem::path& file, const SplatFileOptions& options) {
  return read_mapped(file, [&](const SharedBytes& bytes) {
    const auto reader = splat_reader_of(file, bytes.bytes);
    if (!reader && (starts_with(bytes.bytes, "PXR-USDC") || lower_extension(file) == ".usdz"))
      throw Error(
          "is a binary file of OpenUSD: text is read, which \"usdcat --flatten -o FILE.usda\" writes");
    if (!reader)
      throw Error(
          "is no file of splats that is known here: PLY, .spz, .glb and .usda by their first bytes, .gltf and "
          ".splat by their names");
    SplatCloud cloud = reader(file, bytes, options);
    finish_cloud(cloud, options);
    return cloud;
  });
}

}  // namespace aureole
