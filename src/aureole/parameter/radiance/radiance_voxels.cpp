// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/radiance/radiance_voxels.h"

#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "aureole/core/letter_case.h"
#include "aureole/core/memory.h"
#include "aureole/core/output_file.h"
#include "aureole/core/parallel.h"
#include "aureole/parameter/grid/grid_reader.h"
#include "aureole/parameter/grid/zip_archive.h"
#include "aureole/parameter/radiance/radiance_reader.h"
#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

namespace {

using grid_reader::NpyHeader;

constexpr std::int64_t kLongestRadianceAxis = 4096;

/// A number of numpy's type as it is stored.
template <class T>
T stored_number(const std::byte* at, bool is_swapped) {
  std::byte bytes[sizeof(T)];
  std::memcpy(bytes, at, sizeof(T));
  if (is_swapped) std::reverse(bytes, bytes + sizeof(T));
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// An array of an archive.
class ArchiveArray {
public:
  ArchiveArray(const ZipArchive& archive, const std::string& name) : name_(name) {
    const auto* member = archive.find(name + ".npy");
    if (!member) throw Error("has no array \"" + name + "\"");
    try {
      bytes_ = archive.read(*member);
      header_ = grid_reader::read_npy_header(bytes_);
    } catch (const Error& problem) {
      throw Error("array \"" + name + "\": " + problem.message());
    }
    double count = 1;
    for (const std::int64_t n : header_.sizes) {
      if (n < 0) throw fault("of a negative size");
      count *= double(n);
    }
    constexpr double kMost = double(std::uint64_t(1) << 40);
    if (count > kMost) throw fault("of more numbers than any file has");
    count_ = std::uint64_t(count);
    const std::uint64_t needed = count_ * bytes_of(header_.type), there = bytes_.size() - header_.start;
    if (needed > there)
      throw fault(
          fmt::format("which is truncated: its numbers need {} bytes, but there are {}", needed, there));
    if (header_.is_fortran && header_.sizes.size() > 1)
      throw fault("in the order of Fortran, but the order of C is expected");
  }

  const std::vector<std::int64_t>& sizes() const { return header_.sizes; }
  std::uint64_t count() const { return count_; }
  std::string shape() const {
    return header_.sizes.empty() ? "one" : fmt::format("{}", fmt::join(header_.sizes, " x "));
  }
  Error fault(const std::string& what) const {
    return Error(fmt::format("has an array \"{}\" of {} {}", name_, shape(), what));
  }

  /// Calls visit(i, number) for all numbers, on all cores. The numbers have the type `Number`.
  template <class Number, class Visit>
  void for_each(const Visit& visit) const {
    const std::byte* from = bytes_.bytes.data() + header_.start;
    grid_reader::with_type(header_.type, [&](auto example) {
      using T = decltype(example);
      const bool is_half = header_.type == ScalarType::float16;
      for_ranges(std::size_t(count_), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const T v = stored_number<T>(from + sizeof(T) * i, header_.is_swapped);
          if constexpr (std::is_same_v<T, std::uint16_t>) {
            if (is_half) {
              visit(i, Number(imath_half_to_float(v)));
              continue;
            }
          }
          visit(i, Number(v));
        }
      });
    });
  }
  std::vector<double> numbers() const {
    std::vector<double> all(static_cast<std::size_t>(count_));
    for_each<double>([&](std::size_t i, double v) { all[i] = v; });
    return all;
  }
  bool is_integer() const { return header_.type < ScalarType::float16; }

private:
  std::string name_;
  SharedBytes bytes_;
  NpyHeader header_;
  std::uint64_t count_ = 0;
};

Vec3 three_numbers(const ZipArchive& archive, const std::string& name, const Vec3& fallback) {
  if (!archive.find(name + ".npy")) return fallback;
  const ArchiveArray array(archive, name);
  if (array.count() != 3) throw array.fault("numbers; 3 are expected, of x, y and z");
  const std::vector<double> v = array.numbers();
  const Vec3 all{float(v[0]), float(v[1]), float(v[2])};
  if (!is_finite(all)) throw array.fault("numbers, of which one is not finite");
  return all;
}

RadianceVoxels read_archive(const SharedBytes& bytes) {
  const ZipArchive archive(bytes);
  RadianceVoxels g;
  g.radius = three_numbers(archive, "radius", g.radius);
  g.center = three_numbers(archive, "center", g.center);
  if (!(g.radius.x > 0 && g.radius.y > 0 && g.radius.z > 0))
    throw Error(fmt::format("has the radius {:g}, {:g}, {:g} of its box; each is larger than 0", g.radius.x,
                            g.radius.y, g.radius.z));
  if (archive.find("basis_type.npy")) {
    const ArchiveArray type(archive, "basis_type");
    constexpr double kHarmonics = 1;
    if (type.count() != 1 || type.numbers()[0] != kHarmonics)
      throw type.fault(
          "number that is not 1: colours by spherical harmonics are read, those of learned functions are not");
  }
  if (archive.find("background_data.npy"))
    g.notes.push_back("has a background of spheres around its grid, which is left out");

  const ArchiveArray links(archive, "links"), densities(archive, "density_data"),
      harmonics(archive, "sh_data");
  const auto& axes = links.sizes();
  if (axes.size() != 3 || !links.is_integer())
    throw links.fault("numbers; whole numbers along three axes, x, y and z, are expected");
  for (std::size_t k = 0; k < 3; ++k) {
    if (axes[k] < 1 || axes[k] > kLongestRadianceAxis)
      throw links.fault(fmt::format("numbers; each size lies in [1, {}]", kLongestRadianceAxis));
    g.size[k] = int(axes[k]);
  }
  const std::uint64_t n = densities.count();
  if (densities.sizes().empty() || std::uint64_t(densities.sizes()[0]) != n || n < 1)
    throw densities.fault("numbers; n x 1 are expected, one of each stored voxel");
  constexpr std::uint64_t kMostVoxels = std::numeric_limits<std::int32_t>::max();
  if (n > kMostVoxels) throw densities.fault(fmt::format("numbers; {} are possible", kMostVoxels));
  if (harmonics.sizes().size() != 2 || std::uint64_t(harmonics.sizes()[0]) != n)
    throw harmonics.fault(fmt::format("numbers; those of {} stored voxels are expected", n));
  const std::int64_t width = harmonics.sizes()[1];
  int degree = -1;
  for (int l = 0; l <= 4; ++l)
    if (width == 3 * (l + 1) * (l + 1)) degree = l;
  if (degree < 0)
    throw harmonics.fault("numbers; 3, 12, 27 or 48 of each voxel are expected, harmonics of degree 0 to 3");
  g.degree = std::min(degree, kMaxHarmonicDegree);
  if (degree > g.degree) g.notes.push_back("has harmonics of degree 4, which are left out");

  // Arrays grow to at most twice what the file holds (float16 to float).
  g.links.resize(std::size_t(links.count()));
  std::atomic<std::uint64_t> outside{0}, linked{0};
  links.for_each<double>([&](std::size_t i, double link) {
    const bool is_stored = link >= 0;
    if (is_stored && link >= double(n)) outside.fetch_add(1, std::memory_order_relaxed);
    if (is_stored) linked.fetch_add(1, std::memory_order_relaxed);
    g.links[i] = is_stored && link < double(n) ? std::int32_t(link) : -1;
  });
  if (outside > 0)
    throw links.fault(fmt::format("numbers, of which {} are beyond the {} stored voxels", outside.load(), n));
  if (linked == 0) throw links.fault("numbers, none of which is a stored voxel: the grid is empty");
  g.densities.resize(std::size_t(n));
  densities.for_each<float>([&](std::size_t i, float v) { g.densities[i] = v; });
  const std::size_t terms = g.coefficients(), stored_terms = std::size_t(width) / 3;
  g.harmonics.resize(3 * terms * std::size_t(n));
  harmonics.for_each<float>([&](std::size_t i, float v) {
    const std::size_t voxel = i / std::size_t(width), column = i % std::size_t(width),
                      color = column / stored_terms, term = column % stored_terms;
    if (term < terms) g.harmonics[3 * (terms * voxel + term) + color] = v;
  });
  radiance_reader::empty_bad_voxels(g);
  return g;
}

/// An array of numpy, little-endian and in the order of C.
std::string npy_of(const char* type, const std::string& shape, const std::string& numbers) {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, shape);
  constexpr std::size_t kStart = 10, kAlignment = 64;
  header.append(kAlignment - 1 - (kStart + header.size()) % kAlignment, ' ');
  header += '\n';
  std::string out = "\x93NUMPY\x01";
  out += '\0';
  out += char(header.size() & 255), out += char(header.size() >> 8);
  return out + header + numbers;
}

template <class T>
std::string raw_bytes(const T* numbers, std::size_t count) {
  return {reinterpret_cast<const char*>(numbers), count * sizeof(T)};
}

}  // namespace

std::size_t RadianceVoxels::memory_bytes() const {
  return links.size() * sizeof(std::int32_t) + (densities.size() + harmonics.size()) * sizeof(float);
}

bool is_radiance_voxels_file(const std::filesystem::path& file) {
  const SharedBytes bytes = map_file(file);
  return bytes.size() >= 2 && bytes.bytes[0] == std::byte('P') && bytes.bytes[1] == std::byte('K') &&
         lower_extension(file) == ".npz";
}

void radiance_reader::empty_bad_voxels(RadianceVoxels& g) {
  const std::size_t numbers = 3 * g.coefficients();
  const auto empty = [&](const auto& is_good, const std::string& what) {
    std::size_t bad = 0, first = 0;
    for (std::size_t i = 0; i < g.stored(); ++i) {
      float* h = &g.harmonics[numbers * i];
      if (is_good(g.densities[i], std::span<const float>(h, numbers))) continue;
      if (bad++ == 0) first = i;
      g.densities[i] = 0;
      std::fill_n(h, numbers, 0.f);
    }
    if (bad > 0)
      g.notes.push_back(
          fmt::format("has {} of {} stored voxels with {}, the first of them number {}: they are empty", bad,
                      g.stored(), what, first));
  };
  empty(
      [](float density, std::span<const float> h) {
        return std::isfinite(density) &&
               std::all_of(h.begin(), h.end(), [](float v) { return std::isfinite(v); });
      },
      "a number that is not finite");
  empty(
      [](float, std::span<const float> h) {
        return std::all_of(h.begin(), h.end(), [](float v) { return std::abs(v) <= kMostHarmonic; });
      },
      fmt::format("a coefficient of their colour beyond {:g}", kMostHarmonic));
}

RadianceVoxels read_radiance_voxels(const std::filesystem::path& file) {
  return radiance_reader::is_vdb(file) ? radiance_reader::read_vdb(file) : read_mapped(file, read_archive);
}

void write_radiance_voxels(const std::filesystem::path& file, const RadianceVoxels& g) {
  const std::size_t n = g.stored(), terms = g.coefficients();
  std::string harmonics(2 * 3 * terms * n, '\0');
  std::size_t at = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t color = 0; color < 3; ++color)
      for (std::size_t k = 0; k < terms; ++k) {
        constexpr float kLargestHalf = 65504;
        const auto half =
            imath_float_to_half(std::clamp(g.harmonics_of(i)[3 * k + color], -kLargestHalf, kLargestHalf));
        std::memcpy(&harmonics[at], &half, sizeof half);
        at += sizeof half;
      }
  const std::int64_t by_harmonics = 1;
  const std::pair<std::string, std::string> members[] = {
      {"radius.npy", npy_of("<f4", "3,", raw_bytes(&g.radius.x, 3))},
      {"center.npy", npy_of("<f4", "3,", raw_bytes(&g.center.x, 3))},
      {"links.npy", npy_of("<i4", fmt::format("{}, {}, {}", g.size[0], g.size[1], g.size[2]),
                           raw_bytes(g.links.data(), g.links.size()))},
      {"density_data.npy", npy_of("<f4", fmt::format("{}, 1", n), raw_bytes(g.densities.data(), n))},
      {"sh_data.npy", npy_of("<f2", fmt::format("{}, {}", n, 3 * terms), harmonics)},
      {"basis_type.npy", npy_of("<i8", "", raw_bytes(&by_harmonics, 1))}};
  std::string archive;
  try {
    archive = make_zip(members);
  } catch (const Error& problem) {
    throw Error({file.string(), 0, 0}, problem.message());
  }
  write_file_atomically(file, archive);
}

}  // namespace aureole
