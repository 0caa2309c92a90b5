// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/spheres/sphere_tables.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "aureole/core/parallel.h"
#include "aureole/math/warp.h"
#include "aureole/optics/layer/coherent_layer.h"
#include "aureole/optics/particle/mie_sphere.h"
#include "aureole/spectrum/neighbours.h"

namespace aureole {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi, kRootTwo = std::numbers::sqrt2;

}  // namespace

struct SphereTables::Worker {
  std::vector<double> mu, phase, ring;
  std::vector<optics::MieAmplitudes> at, mirrored, specular;
  std::vector<double> energy, matrix, h, next;
  int points = 0;  // number of points in the following arrays
  // Data of points on the sphere of directions: `Scattered` and weights; then for one incidence their
  // positions in the table of h and their power.
  std::vector<float> along, in, out, weight, place, share;
};

void SphereTables::plan(const SphereLayer& layer, const SpectralGrid& grid) {
  const double largest =
      kTwoPi * layer.radius_nm * layer.sizes.largest() *
      std::max(layer.medium(grid.min_nm) / grid.min_nm, layer.medium(grid.max_nm) / grid.max_nm);
  const double terms = largest + 4 * std::cbrt(largest);
  angles_ = SphereAngles(terms);
  // Far from the centre of a large sphere's pattern, rings are averaged over a cell: they are too fine to be
  // visible there.
  for (int i = 0; i <= angles_.half(); ++i) {
    const double r = std::min(angles_.radius(i), kRootTwo);
    const double before = i > 0 ? angles_.radius(i - 0.5) : 0,
                 after = i < angles_.half() ? angles_.radius(i + 0.5) : kRootTwo;
    const bool averaged = after - before > 4 * SphereAngles::kStep / terms;
    const int count = averaged ? int(std::ceil((after - before) * terms / 1.2)) : 1;
    for (int k = 0; k < count; ++k) {
      const double at = averaged ? before + (k + 0.5) * (after - before) / count : r;
      samples_.push_back(std::clamp(1 - at * at / 2, 0.0, 1.0));
    }
    sample_ends_.push_back(int(samples_.size()));
  }
  // Wavelength nodes: phases between rays through a sphere and rays past it vary with x; a spread of sizes
  // blurs narrower features.
  constexpr double kSizeStep = 0.05;
  const double range = 1 / grid.min_nm - 1 / grid.max_nm, width = grid.max_nm / grid.min_nm - 1;
  double count = kTwoPi * layer.radius_nm * layer.medium(grid.min_nm) * range / kSizeStep;
  if (layer.spread > 0) count = std::min(count, 3 * width / layer.spread);
  // Smooth spectra need few nodes. The cost per node grows with the square of the size.
  const double least = std::clamp((layer.spread > 0 ? 9 : 25) * width, 4.0, 32.0);
  double most = 1024;
  if (largest > 800) most = 512;
  if (has_peaks_) most = 256;
  if (largest > 2000) most = 128;
  const double cells = std::clamp(count, least, most);
  // Samples and h vary less with the wavelength than the phase function; peaks of the structure factor move
  // over the angles of h, so that h is computed at each node where there are peaks.
  constexpr int kMostSampleCells = 32, kMostBalanced = 128;
  stride_ = std::max(4, int(std::ceil(cells / kMostSampleCells)));
  per_stride_ = 1 / float(stride_);
  wavelengths_ = int(std::ceil(cells / stride_)) * stride_ + 1;
  balance_stride_ = wavelengths_ - 1 > kMostBalanced && !has_peaks_ ? stride_ : 1;
  first_ = 1 / grid.max_nm;
  scale_ = (wavelengths_ - 1) / range;
}

SphereTables::SphereTables(const SphereLayer& layer, const SpectralGrid& grid) {
  structure_.resize(kStructureCells + 1);
  for (int i = 0; i <= kStructureCells; ++i)
    structure_[i] = float(std::max(layer.structure->eval(double(i) / kStructureRate), 0.0));
  has_peaks_ = *std::max_element(structure_.begin(), structure_.end()) > 1.5;
  plan(layer, grid);
  const std::size_t w = std::size_t(wavelengths_), n = std::size_t(cells());
  sizes_.resize(w), albedos_.resize(w);
  phase_.resize((n + 1) * w);
  h_.resize((kCosines + 1) * w);
  transmitted_ = reflected_ = lost_ = h_;
  sampling_ = SphereSamples(angles_, (wavelengths_ - 1) / stride_ + 1);

  std::atomic<int> next{0};
  run_workers(std::min(default_thread_count(), wavelengths_), [&](int) {
    Worker worker;
    for (int node; (node = next.fetch_add(1)) < wavelengths_;) {
      scatter(node, layer, worker);
      if (node % balance_stride_ == 0) balance(node, worker);
      if (node % stride_ == 0) prepare_samples(node, worker);
    }
  });
  if (balance_stride_ > 1) {
    next = 0;
    run_workers(std::min(default_thread_count(), wavelengths_), [&](int) {
      Worker worker;
      for (int node; (node = next.fetch_add(1)) < wavelengths_;)
        if (node % balance_stride_ != 0) interpolate_balance(node, worker);
    });
  }
  samples_ = {}, sample_ends_ = {}, albedos_ = {};
}

/// Computes Mie's theory at one node: the phase function, the coherent light and the energies.
void SphereTables::scatter(int node, const SphereLayer& layer, Worker& w) {
  const double nm = 1 / (first_ + node / scale_), k = kTwoPi * layer.medium(nm) / nm;
  const std::complex<double> index = layer.relative_index(nm);
  const std::size_t stride = std::size_t(wavelengths_);

  // Mie's theory is evaluated by one call for all cosines: those of the phase function, then those of
  // specular reflection.
  w.mu = samples_;
  for (int i = 0; i <= kCosines; ++i) {
    const double t = double(i) / kCosines, cosine = t * t;
    w.mu.push_back(1 - 2 * cosine * cosine);
  }
  w.at.resize(w.mu.size()), w.mirrored.resize(w.mu.size());
  w.phase.assign(std::size_t(cells()) + 1, 0.0);
  w.specular.assign(kCosines + 1, {});
  optics::LayerSpheres spheres{0, 0};
  double extinction = 0, scattering = 0;
  for (const auto& size : layer.sizes.nodes()) {
    const double x = k * layer.radius_nm * size.size;
    const optics::Mie sphere(x, index);
    sphere.amplitudes(w.mu, w.at, w.mirrored);
    for (int i = 0, begin = 0; i <= angles_.half(); begin = sample_ends_[i++]) {
      const double share = size.weight / (sample_ends_[i] - begin);
      double forward = 0, backward = 0;
      for (int s = begin; s < sample_ends_[i]; ++s)
        forward += w.at[s].intensity(), backward += w.mirrored[s].intensity();
      w.phase[i] += share * (i == angles_.half() ? 0.5 * (forward + backward) : backward);
      if (i < angles_.half()) w.phase[cells() - i] += share * forward;
    }
    for (int i = 0; i <= kCosines; ++i) {
      const auto& s = w.at[samples_.size() + std::size_t(i)];
      w.specular[i].s1 += size.weight * s.s1, w.specular[i].s2 += size.weight * s.s2;
    }
    spheres.size_squared += size.weight * x * x;
    spheres.forward += size.weight * sphere.forward();
    extinction += size.weight * x * x * sphere.extinction();
    scattering += size.weight * x * x * sphere.scattering();
  }
  // The spheres cover the plane as equal discs of their mean cross section would.
  sizes_[node] = float(std::sqrt(spheres.size_squared));

  double power = 0;
  for (int i = 0; i < cells(); ++i) power += angles_.area(i) * 0.5 * (w.phase[i] + w.phase[i + 1]);
  for (double& p : w.phase) p = power > 0 ? p / power : 0.5 / kTwoPi;
  for (int i = 0; i <= cells(); ++i) phase_[std::size_t(i) * stride + std::size_t(node)] = float(w.phase[i]);

  const double albedo = extinction > 0 ? scattering / extinction : 1;
  albedos_[std::size_t(node)] = albedo;
  w.energy.resize(kCosines + 1);
  for (int i = 0; i <= kCosines; ++i) {
    const double t = double(i) / kCosines;
    const optics::CoherentLayer c =
        optics::coherent_layer(t * t, layer.area_fraction, spheres, w.specular[i]);
    w.energy[i] = c.loss() * albedo;
    lost_[std::size_t(i) * stride + std::size_t(node)] = float(c.loss());
    transmitted_[std::size_t(i) * stride + std::size_t(node)] = float(c.transmittance());
    reflected_[std::size_t(i) * stride + std::size_t(node)] = float(c.reflectance());
  }
}

/// Places points on the sphere of directions at which the light of a node's phase function is summed.
void SphereTables::place_points(Worker& w) const {
  // Points of a rank-1 lattice over (cumulative power, azimuth).
  const int points_wanted = has_peaks_ ? 16384 : 8192;
  constexpr double kGolden = 0.6180339887498949;
  for (auto* values : {&w.along, &w.in, &w.out, &w.weight, &w.place, &w.share}) values->resize(points_wanted);
  double power = 0;
  int points = 0;
  for (int cell = 0; cell < cells(); ++cell) {
    const double mass = angles_.area(cell) * 0.5 * (w.phase[cell] + w.phase[cell + 1]);
    const bool forward = angles_.is_forward(cell);
    const double a = angles_.radius(angles_.ring(cell)), b = angles_.radius(angles_.ring(cell) + 1);
    for (; points < points_wanted && (points + 0.5) / points_wanted < power + mass; ++points) {
      const double t = std::clamp(((points + 0.5) / points_wanted - power) / mass, 0.0, 1.0);
      const double r = std::sqrt(a * a + (forward ? 1 - t : t) * (b * b - a * a)),
                   other = std::sqrt(4 - r * r);
      const double place = (r - a) / (b - a), here = forward ? 1 - place : place;
      const Scattered s(forward ? r : other, forward ? other : r,
                        std::numbers::pi * std::fmod((points + 0.5) * kGolden, 1.0));
      w.along[points] = s.along, w.in[points] = s.in, w.out[points] = s.out;
      w.weight[points] = float((w.phase[cell] + here * (w.phase[cell + 1] - w.phase[cell])) *
                               angles_.area(cell) / mass / points_wanted);
    }
    power += mass;
  }
  w.points = points;
}

/// Adds to the i-th row of the matrix, which is 0, the light that is scattered from the i-th cosine of the table to
/// all of them, h left out.
void SphereTables::sum_row(int node, int i, Worker& w) const {
  constexpr int n = kCosines + 1;
  const int points = w.points;
  const float t = float(i) / kCosines, cos_i = t * t, sin_i = std::sqrt(1 - cos_i * cos_i);
  const float *along = w.along.data(), *in = w.in.data(), *out = w.out.data(), *weight = w.weight.data(),
              *table = structure_.data(), size = sizes_[node];
  float* __restrict place = w.place.data(), * __restrict share = w.share.data();
  for (int k = 0; k < points; ++k) {
    // Components of `Scattered`, inlined for vectorisation.
    const float x = along[k] * sin_i + in[k] * cos_i;
    const float u = std::min(size * std::sqrt(x * x + out[k] * out[k]) * kStructureRate, kStructureEnd);
    const int cell = int(u);
    const float cosine = std::min(std::abs((along[k] - 1) * cos_i - in[k] * sin_i), 1.f);
    share[k] = weight[k] * cosine * (table[cell] + (u - float(cell)) * (table[cell + 1] - table[cell]));
    place[k] = std::min(std::sqrt(cosine) * kCosines, kCosines - 0.001f);
  }
  // Neighbouring points add to the same nodes; several sums avoid waiting for the previous addition.
  constexpr int kSums = 4;
  float sums[kSums][n + 1] = {};
  for (int k = 0; k < points; ++k) {
    const int j = int(place[k]);
    const float fraction = place[k] - float(j);
    float* s = &sums[k % kSums][j];
    s[0] += share[k] * (1 - fraction), s[1] += share[k] * fraction;
  }
  for (const auto& s : sums)
    for (int j = 0; j < n; ++j) w.matrix[std::size_t(i) * n + std::size_t(j)] += double(s[j]);
}

/// Computes h by Sinkhorn's iteration for a symmetric kernel, so that each angle of incidence scatters its
/// energy.
void SphereTables::balance(int node, Worker& w) {
  constexpr int n = kCosines + 1;
  place_points(w);
  w.matrix.assign(std::size_t(n) * n, 0.0);
  for (int i = 1; i < n; ++i) sum_row(node, i, w);
  w.h.assign(n, 1.0), w.next.assign(n, 0.0);
  for (int iteration = 0; iteration < 1000; ++iteration) {
    double change = 0;
    for (int i = 1; i < n; ++i) {
      double sum = 0;
      for (int j = 0; j < n; ++j) sum += w.matrix[std::size_t(i) * n + std::size_t(j)] * w.h[j];
      w.next[i] = sum > 0 ? std::sqrt(w.h[i] * w.energy[i] / sum) : 0;
      change = std::max(change, std::abs(w.next[i] - w.h[i]) / (w.h[i] + 1e-30));
    }
    w.h.swap(w.next);
    if (change < 1e-6) break;
  }
  w.h[0] = 0;  // all light at grazing incidence is reflected
  for (int i = 0; i < n; ++i)
    h_[std::size_t(i) * std::size_t(wavelengths_) + std::size_t(node)] = float(w.h[i]);
}

/// Sets h at a node between two of those at which it was computed: h/sqrt(energy) is linear between them, since
/// how much light becomes diffuse oscillates with the wavelength, and where it goes varies slowly. A smooth factor
/// then makes the energy right at some angles of incidence.
void SphereTables::interpolate_balance(int node, Worker& w) {
  constexpr int n = kCosines + 1, kSpacing = 8, kRounds = 3;
  static_assert(kCosines % kSpacing == 0);
  const std::size_t stride = std::size_t(wavelengths_), at = std::size_t(node),
                    first = at - at % std::size_t(balance_stride_),
                    last = first + std::size_t(balance_stride_);
  const double t = double(at - first) / double(last - first);
  w.h.assign(n, 0.0), w.energy.assign(n, 0.0), w.phase.resize(std::size_t(cells()) + 1);
  for (std::size_t i = 0; i < n; ++i) {
    const auto energy = [&](std::size_t k) { return double(lost_[i * stride + k]) * albedos_[k]; };
    const auto relative = [&](std::size_t k) {
      return energy(k) > 0 ? double(h_[i * stride + k]) / std::sqrt(energy(k)) : 0;
    };
    w.energy[i] = energy(at);
    w.h[i] = std::lerp(relative(first), relative(last), t) * std::sqrt(energy(at));
  }
  for (std::size_t i = 0; i < w.phase.size(); ++i) w.phase[i] = double(phase_[i * stride + at]);
  place_points(w);
  w.matrix.assign(std::size_t(n) * n, 0.0);
  for (int i = kSpacing; i < n; i += kSpacing) sum_row(node, i, w);
  for (int round = 0; round < kRounds; ++round) {
    double factors[kCosines / kSpacing + 1];
    for (int i = kSpacing; i < n; i += kSpacing) {
      double sum = 0;
      for (int j = 0; j < n; ++j) sum += w.matrix[std::size_t(i) * n + std::size_t(j)] * w.h[j];
      factors[i / kSpacing] = w.h[i] * sum > 0 ? std::sqrt(w.energy[i] / (w.h[i] * sum)) : 1;
    }
    factors[0] = factors[1];
    for (int i = 1; i < n; ++i) {
      const int k = std::min(i / kSpacing, kCosines / kSpacing - 1);
      w.h[i] *= std::lerp(factors[k], factors[k + 1], double(i - k * kSpacing) / kSpacing);
    }
  }
  for (std::size_t i = 0; i < n; ++i) h_[i * stride + at] = float(w.h[i]);
}

void SphereTables::prepare_samples(int node, const Worker& w) {
  sampling_.prepare(node / stride_, w.phase, [&](float transverse, float cos_o) {
    const float x = std::sqrt(cos_o) * kCosines;
    const int j = std::min(int(x), kCosines - 1);
    const double h = w.h[j] + double(x - float(j)) * (w.h[j + 1] - w.h[j]);
    return double(structure(sizes_[node] * transverse) * cos_o) * h;
  });
}

SphereTables::Nodes SphereTables::nodes(const Spectrum& nm) const {
  Nodes n;
  n.position = min(max((Spectrum(1.f) / nm - float(first_)) * float(scale_), 0.f), float(wavelengths_ - 1));
  for (int j = 0; j < kWavelengths; ++j) n.at[j] = std::min(int(n.position[j]), wavelengths_ - 2);
  n.fraction = make_spectrum([&](int j) { return n.position[j] - float(n.at[j]); });
  return n;
}

SphereTables::Cosine SphereTables::cosine(float z) const {
  const float x = std::min(std::sqrt(std::abs(z)), 1.f) * kCosines;
  const int i = std::min(int(x), kCosines - 1);
  return {std::size_t(i) * std::size_t(wavelengths_), x - float(i)};
}

Spectrum SphereTables::mean(const std::vector<float>& table, const Cosine& c, const Nodes& n) const {
  Neighbours p(&table[c.row], n.at);
  p.mix(Neighbours(&table[c.row] + wavelengths_, n.at), c.fraction);
  return p.first + (p.second - p.first) * n.fraction;
}

SphereTables::Shares SphereTables::shares(float cos_i, const Spectrum& nm) const {
  const Nodes n = nodes(nm);
  const Cosine c = cosine(cos_i);
  return {mean(transmitted_, c, n), mean(reflected_, c, n), mean(lost_, c, n)};
}

SphereTables::Eval SphereTables::eval(const Vec3& wi, const Vec3& wo, const Spectrum& nm) const {
  const float position = angles_.position(wi, wo);
  const int cell = std::min(int(position), cells() - 1);
  const Nodes n = nodes(nm);
  const Cosine ci = cosine(wi.z), co = cosine(wo.z);

  const float* row = &phase_[std::size_t(cell) * std::size_t(wavelengths_)];
  Neighbours phase(row, n.at), hi(&h_[ci.row], n.at), ho(&h_[co.row], n.at);
  phase.mix(Neighbours(row + wavelengths_, n.at), position - float(cell));
  hi.mix(Neighbours(&h_[ci.row] + wavelengths_, n.at), ci.fraction);
  ho.mix(Neighbours(&h_[co.row] + wavelengths_, n.at), co.fraction);
  const Neighbours size(sizes_.data(), n.at);
  const float x = wi.x + wo.x, y = wi.y + wo.y, transverse = std::sqrt(x * x + y * y);
  const Spectrum a = phase.first * hi.first * ho.first * structure(size.first * transverse),
                 b = phase.second * hi.second * ho.second * structure(size.second * transverse);

  const SphereSamples::Density density = sampling_.density(wi, wo, cell);
  Eval e;
  e.value = (a + (b - a) * n.fraction) * std::abs(wo.z);
  e.pdf = make_spectrum([&](int j) {
            const int k = sample_node(n.position[j]);
            return density.ring[k] * density.azimuth[k];
          }) *
          mean(lost_, ci, n);
  return e;
}

Spectrum SphereTables::structure(const Spectrum& u) const {
  const Spectrum x = min(u * float(kStructureRate), kStructureEnd);
  int at[kWavelengths];
  for (int j = 0; j < kWavelengths; ++j) at[j] = int(x[j]);
  const Neighbours p(structure_.data(), at);
  return p.first + (p.second - p.first) * make_spectrum([&](int j) { return x[j] - float(at[j]); });
}

Vec3 SphereTables::sample(const Vec3& wi, Vec2 u, float nm) const {
  return sampling_.sample(wi, u, sample_node(nodes(nm).position[0]));
}

std::size_t SphereTables::bytes() const {
  return sizeof(float) * (structure_.size() + phase_.size() + 4 * h_.size()) + sampling_.bytes();
}

}  // namespace aureole
