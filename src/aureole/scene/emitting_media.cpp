// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/emitting_media.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"

namespace aureole {

namespace {

constexpr int kMaxCells = 64;      // upper bound of the cells along an axis
constexpr int kVaryingCells = 32;  // cells along an axis of media without a grid whose emission varies
constexpr int kPlaces = 256;       // number of positions at which a region's spectrum is evaluated

/// Returns wavelengths at equal quantiles of a spectral response, or equally spaced wavelengths if the
/// response is zero.
Wavelengths wavelengths_of(const SampledSpectrum& response) {
  const std::span<const float> nodes = response.nodes();
  double total = 0;
  for (const float v : nodes) total += double(v);
  const SpectralGrid& grid = response.grid();
  if (!(total > 0))
    return Wavelengths::at(
        grid, make_spectrum([&](int i) {
          return float(grid.min_nm + (grid.max_nm - grid.min_nm) * (i + 0.5) / kWavelengths);
        }));
  Spectrum nm;
  double sum = 0;
  int next = 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    sum += double(nodes[k]);
    while (next < kWavelengths && sum >= total * (next + 0.5) / kWavelengths)
      nm.v[next++] = float(grid.node(int(k)));
  }
  while (next < kWavelengths) nm.v[next++] = float(grid.max_nm);
  return Wavelengths::at(grid, nm);
}

/// Returns the approximate fraction of emitted light that escapes a body of this optical thickness.
Spectrum escaping(const Spectrum& depth) {
  return make_spectrum([&](int i) { return depth[i] > 1e-3f ? -std::expm1(-depth[i]) / depth[i] : 1.f; });
}

/// Returns point i of a low-discrepancy sequence in [0, 1)^3 (generalised golden ratio, Roberts 2018).
Vec3 even_place(int i) {
  const auto turn = [&](double by) { return float(std::fmod(0.5 + by * (i + 1), 1.0)); };
  return {turn(0.8191725133961645), turn(0.6710436067037893), turn(0.5497004779019703)};
}

}  // namespace

EmittingMedia::Region EmittingMedia::region_of(const Filled& filled) {
  const Medium& medium = *filled.medium;
  Region r{&medium, {}, {}, {1, 1, 1}, 0, {}};
  if (const Majorants majorants = medium.majorants()) {
    r.to_unit = majorants.to_box();
    for (std::size_t i = 0; i < 3; ++i) r.cells[i] = std::min(majorants.cells()[i], kMaxCells);
  } else {
    const Vec3 size = filled.box.diagonal();
    if (!(size.x > 0 && size.y > 0 && size.z > 0)) return r;
    r.to_unit = Transform::scale(1 / double(size.x), 1 / double(size.y), 1 / double(size.z)) *
                Transform::translate(-double(filled.box.lower.x), -double(filled.box.lower.y),
                                     -double(filled.box.lower.z));
    if (!medium.has_uniform_emission()) r.cells = {kVaryingCells, kVaryingCells, kVaryingCells};
  }
  r.from_unit = r.to_unit.inverse();
  r.volume = std::abs(r.from_unit.determinant3());
  return r;
}

EmittingMedia::EmittingMedia(std::span<const Filled> filled, const SampledSpectrum& response) {
  const Wavelengths w = wavelengths_of(response);
  const SpectralGrid& grid = response.grid();
  std::vector<EmissionBounds> bounds;
  std::vector<float> seen;
  for (const Filled& f : filled) {
    Region r = region_of(f);
    if (!(r.volume > 0) || !std::isfinite(r.volume)) continue;
    const std::size_t nx = std::size_t(r.cells[0]), ny = std::size_t(r.cells[1]);
    std::vector<float> weights(nx * ny * std::size_t(r.cells[2]));
    const auto emission = [&](const Vec3& unit, const Wavelengths& at_w, MediumCoefficients& at) {
      const Vec3 p = r.from_unit.point(unit);
      if (!r.medium->emits_by_direction()) {
        r.medium->eval(p, {0, 0, 1}, at_w, at);
        return;
      }
      // The mean over the directions to the corners of a cube, so that a position that emits to one side alone has a
      // probability, too.
      Spectrum sum = 0.f;
      for (int corner = 0; corner < 8; ++corner) {
        constexpr float k = 0.57735027f;
        r.medium->eval(p, {corner & 1 ? k : -k, corner & 2 ? k : -k, corner & 4 ? k : -k}, at_w, at);
        sum += at.emission;
      }
      at.emission = sum * (1.f / 8);
    };
    for_ranges(
        weights.size(),
        [&](std::size_t begin, std::size_t end) {
          MediumCoefficients at;
          for (std::size_t k = begin; k < end; ++k)
            for (int corner = 0; corner < 8; ++corner) {
              emission({(float(k % nx) + (corner & 1 ? .75f : .25f)) / float(r.cells[0]),
                        (float(k / nx % ny) + (corner & 2 ? .75f : .25f)) / float(r.cells[1]),
                        (float(k / nx / ny) + (corner & 4 ? .75f : .25f)) / float(r.cells[2])},
                       w, at);
              weights[k] += mean(at.emission);
            }
        },
        256);
    r.cell = Piecewise1D(weights);
    if (!(r.cell.total() > 0)) continue;
    // The spectrum is estimated over the full range of wavelengths, at positions sampled as in light
    // sampling.
    const double size = std::cbrt(r.volume);
    constexpr int kNodes = 32;
    std::vector<double> nm(kNodes), power(kNodes);
    for (int node = 0; node < kNodes; ++node)
      nm[std::size_t(node)] = grid.min_nm + (grid.max_nm - grid.min_nm) * node / (kNodes - 1);
    static_assert(kNodes % kWavelengths == 0);
    for (int first = 0; first < kNodes; first += kWavelengths) {
      const Wavelengths some =
          Wavelengths::at(grid, make_spectrum([&](int i) { return float(nm[std::size_t(first + i)]); }));
      Spectrum sum = 0.f;
      MediumCoefficients at;
      for (int i = 0; i < kPlaces; ++i) {
        const Vec3 e = even_place(i);
        std::size_t k;
        float density;
        r.cell.sample((float(i) + .5f) / kPlaces, &density, &k);
        emission({(float(k % nx) + e.x) / float(r.cells[0]), (float(k / nx % ny) + e.y) / float(r.cells[1]),
                  (float(k / nx / ny) + e.z) / float(r.cells[2])},
                 some, at);
        sum += at.emission * escaping(at.sigma_t * float(size)) * (1 / density);
      }
      for (int i = 0; i < kWavelengths; ++i)
        power[std::size_t(first + i)] = 4 * double(kPi) * r.volume * double(sum[i]) / kPlaces;
    }
    const SampledSpectrum spectrum = SampledSpectrum::from_points(grid, nm, power);
    // A lower bound keeps every emissive region selectable, however little the sensor responds to it.
    seen.push_back(std::clamp(float(overlap(spectrum, response)), 1e-20f, 1e20f));
    const float weight = std::min(f.medium->sampling_weight(), 1e10f);
    EmissionBounds b{{}, {0, 0, 1}, -1, 0, seen.back() * weight, 0.25f};
    for (int corner = 0; corner < 8; ++corner)
      b.box.extend(
          r.from_unit.point({corner & 1 ? 1.f : 0.f, corner & 2 ? 1.f : 0.f, corner & 4 ? 1.f : 0.f}));
    can_be_connected_ |= b.power > 0;
    bounds.push_back(b);
    powers_.push_back(spectrum);
    regions_.push_back(std::move(r));
  }
  tree_ = LightTree(std::move(bounds));
  if (!seen.empty()) region_ = Piecewise1D(seen);
}

float EmittingMedia::Region::pdf(const Vec3& p) const {
  const Vec3 unit = to_unit.point(p);
  std::size_t k = 0, stride = 1;
  for (int i = 0; i < 3; ++i) {
    if (!(unit[i] >= 0 && unit[i] < 1)) return 0;
    const int n = cells[std::size_t(i)];
    k += std::size_t(std::min(int(unit[i] * float(n)), n - 1)) * stride;
    stride *= std::size_t(n);
  }
  return float(double(cell.pdf((float(k) + .5f) / float(cell.size()))) / volume);
}

EmittingMedia::Place EmittingMedia::Region::place(float u, const Vec3& in_cell) const {
  std::size_t k;
  float density;
  const float x = cell.sample(u, &density, &k);
  const std::size_t nx = std::size_t(cells[0]), ny = std::size_t(cells[1]);
  const Vec3 unit{(float(k % nx) + in_cell.x) / float(cells[0]),
                  (float(k / nx % ny) + in_cell.y) / float(cells[1]),
                  // With a single cell, the random number that chose the cell is reused as a coordinate.
                  cell.size() == 1 ? x : (float(k / nx / ny) + in_cell.z) / float(cells[2])};
  return {medium, from_unit.point(unit), float(double(density) / volume)};
}

bool EmittingMedia::sample(const Vec3& from, const Vec3& facing, float u, Vec2 in_cell, float third,
                           Place& out) const {
  const auto choice = tree_.choose(from, facing, u);
  if (!choice) return false;
  out = regions_[choice->leaf].place(choice->u, {in_cell.x, in_cell.y, third});
  // Regions of one medium may overlap, so that the pdfs of all of them are summed.
  if (regions_.size() > 1) out.pdf = pdf(*out.medium, from, facing, out.p);
  return out.pdf > 0;
}

EmittingMedia::Place EmittingMedia::sample_by_power(float u, Vec2 in_cell, float third) const {
  std::size_t chosen;
  float share;
  const float x = region_.sample(u, &share, &chosen) * float(regions_.size()) - float(chosen);
  Place place = regions_[chosen].place(std::clamp(x, 0.f, 0x1.fffffep-1f), {in_cell.x, in_cell.y, third});
  if (regions_.size() == 1) return place;
  place.pdf = 0;
  for (std::size_t i = 0; i < regions_.size(); ++i)
    if (regions_[i].medium == place.medium)
      place.pdf += regions_[i].pdf(place.p) * region_.pdf((float(i) + .5f) / float(regions_.size())) /
                   float(regions_.size());
  return place;
}

float EmittingMedia::pdf(const Medium& medium, const Vec3& from, const Vec3& facing, const Vec3& p) const {
  float sum = 0;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].medium != &medium) continue;
    if (const float density = regions_[i].pdf(p); density > 0)
      sum += density * tree_.probability(from, facing, i);
  }
  return sum;
}

float EmittingMedia::inverse_size(const Medium& medium) const {
  double largest = 0;
  for (const Region& r : regions_)
    if (r.medium == &medium) largest = std::max(largest, r.volume);
  return largest > 0 ? float(1 / std::cbrt(largest)) : 0.f;
}

}  // namespace aureole
