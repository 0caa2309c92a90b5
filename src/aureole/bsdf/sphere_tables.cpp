// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/sphere_tables.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "aureole/core/parallel.h"
#include "aureole/math/warp.h"
#include "aureole/optics/mie.h"
#include "aureole/optics/sphere_layer.h"

namespace aureole {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi, kRootTwo = std::numbers::sqrt2;

/// Where light from one direction may go: its scattering angle and the azimuth about where it came from.
struct Incidence {
  double cosine, sine;
  struct Direction {
    double transverse, cosine;
  };
  /// v = 2 sin(theta/2), w = 2 cos(theta/2).
  Direction scattered(double v, double w, double cos_phi, double sin_phi) const {
    // w_o + w_i, of which -w_i is the way straight on.
    const double along = 0.5 * v * v, across = 0.5 * v * w;
    const double x = along * sine + across * cos_phi * cosine, y = across * sin_phi;
    return {std::sqrt(x * x + y * y), std::abs(along * cosine - across * cos_phi * sine - cosine)};
  }
};

}  // namespace

struct SphereTables::Worker {
  std::vector<double> mu, phase, ring;
  std::vector<optics::MieAmplitudes> at, mirrored, specular;
  std::vector<double> energy, matrix, h, next;
  struct Point {
    double v, w, cos_phi, sin_phi, weight;
  };
  std::vector<Point> points;
};

double SphereTables::AngleGrid::radius(double position) const {
  return position < double(fine) * double(split) ? position / double(fine)
                                                 : (position - double(offset)) / double(coarse);
}

void SphereTables::plan(const SphereLayer& layer, const SpectralGrid& grid) {
  // Rings of the phase function follow x v: linear interpolation over steps of 1/6 keeps them to 1/300. Far
  // from the centre of a large sphere's pattern they are averaged over a cell; nobody resolves them there.
  constexpr double kStep = 0.16, kFineEnd = 64;
  constexpr int kLeastCells = 64, kCoarseCells = 384;
  const double largest =
      kTwoPi * layer.radius_nm * layer.sizes.largest() *
      std::max(layer.medium(grid.min_nm) / grid.min_nm, layer.medium(grid.max_nm) / grid.max_nm);
  const double fine = std::max(largest / kStep, kLeastCells / kRootTwo), split = kFineEnd / largest;
  if (fine * kRootTwo < kFineEnd / kStep + kCoarseCells) {
    angles_.half = int(std::ceil(fine * kRootTwo));
    angles_.fine = angles_.coarse = float(angles_.half / kRootTwo);
    angles_.split = float(kRootTwo);
  } else {
    const int fine_cells = int(std::lround(kFineEnd / kStep));
    angles_.half = fine_cells + kCoarseCells;
    angles_.split = float(split);
    angles_.fine = float(fine_cells) / angles_.split;
    angles_.coarse = float(kCoarseCells / (kRootTwo - double(angles_.split)));
    angles_.offset = float(angles_.half - kRootTwo * double(angles_.coarse));
  }
  for (int i = 0; i <= angles_.half; ++i) {
    const double r = std::min(angles_.radius(i), kRootTwo);
    const double before = i > 0 ? angles_.radius(i - 0.5) : 0,
                 after = i < angles_.half ? angles_.radius(i + 0.5) : kRootTwo;
    const bool averaged = after - before > 4 * kStep / largest;
    const int count = averaged ? int(std::ceil((after - before) * largest / 1.2)) : 1;
    for (int k = 0; k < count; ++k) {
      const double at = averaged ? before + (k + 0.5) * (after - before) / count : r;
      samples_.push_back(std::clamp(1 - at * at / 2, 0.0, 1.0));
    }
    sample_ends_.push_back(int(samples_.size()));
  }
  for (int i = 0; i < cells(); ++i) {
    const double a = angles_.radius(ring(i)), b = angles_.radius(ring(i) + 1);
    areas_.push_back(kTwoPi * 0.5 * (b - a) * (b + a));
  }

  // Nodes of wavelength: phases between the rays through a sphere and past it turn with x; a spread of sizes
  // hides what is narrower than itself.
  constexpr double kSizeStep = 0.2;
  constexpr int kLeastNodes = 32, kMostNodes = 128;
  const double range = 1 / grid.min_nm - 1 / grid.max_nm;
  double count = kTwoPi * layer.radius_nm * layer.medium(grid.min_nm) * range / kSizeStep;
  if (layer.spread > 0) count = std::min(count, 4 * std::log(grid.max_nm / grid.min_nm) / layer.spread);
  // The work per node grows with the square of the size.
  const int most = largest > 2000 ? kMostNodes / 2 : kMostNodes, least = layer.spread > 0 ? 12 : kLeastNodes;
  const int cells_of_four = int(std::ceil(std::clamp(count, double(least), double(most)) / kStride));
  wavelengths_ = cells_of_four * kStride + 1;
  first_ = 1 / grid.max_nm;
  scale_ = (wavelengths_ - 1) / range;
}

SphereTables::SphereTables(const SphereLayer& layer, const SpectralGrid& grid) {
  plan(layer, grid);
  structure_.resize(kStructureCells + 1);
  for (int i = 0; i <= kStructureCells; ++i)
    structure_[i] = float(std::max(layer.structure->eval(double(i) / kStructureRate), 0.0));
  const std::size_t w = std::size_t(wavelengths_), n = std::size_t(cells());
  sizes_.resize(w);
  phase_.resize((n + 1) * w);
  h_.resize((kCosines + 1) * w);
  transmitted_ = reflected_ = h_;
  density_.resize(kTilts * n * std::size_t(sample_nodes()));
  cdf_.resize(kTilts * (n + 1) * std::size_t(sample_nodes()));

  std::atomic<int> next{0};
  run_workers(std::min(default_thread_count(), wavelengths_), [&](int) {
    Worker worker;
    for (int node; (node = next.fetch_add(1)) < wavelengths_;) {
      scatter(node, layer, worker);
      balance(node, worker);
      if (node % kStride == 0) prepare_samples(node, worker);
    }
  });
  samples_ = {}, sample_ends_ = {};
}

/// Mie's theory at one node: the phase function, the coherent light and the energies.
void SphereTables::scatter(int node, const SphereLayer& layer, Worker& w) {
  const double nm = 1 / (first_ + node / scale_), k = kTwoPi * layer.medium(nm) / nm;
  const std::complex<double> index = layer.relative_index(nm);
  const std::size_t stride = std::size_t(wavelengths_);

  // One call for all cosines: those of the phase function, then those of mirrors.
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
    for (int i = 0, begin = 0; i <= angles_.half; begin = sample_ends_[i++]) {
      const double share = size.weight / (sample_ends_[i] - begin);
      double forward = 0, backward = 0;
      for (int s = begin; s < sample_ends_[i]; ++s)
        forward += w.at[s].intensity(), backward += w.mirrored[s].intensity();
      w.phase[i] += share * (i == angles_.half ? 0.5 * (forward + backward) : backward);
      if (i < angles_.half) w.phase[cells() - i] += share * forward;
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
  // Cover the plane as equal discs of the mean cross section would.
  sizes_[node] = float(std::sqrt(spheres.size_squared));

  double power = 0;
  for (int i = 0; i < cells(); ++i) power += areas_[i] * 0.5 * (w.phase[i] + w.phase[i + 1]);
  for (double& p : w.phase) p = power > 0 ? p / power : 0.5 / kTwoPi;
  for (int i = 0; i <= cells(); ++i) phase_[std::size_t(i) * stride + std::size_t(node)] = float(w.phase[i]);

  const double albedo = extinction > 0 ? scattering / extinction : 1;
  w.energy.resize(kCosines + 1);
  for (int i = 0; i <= kCosines; ++i) {
    const double t = double(i) / kCosines;
    const optics::CoherentLayer c =
        optics::coherent_layer(t * t, layer.area_fraction, spheres, w.specular[i]);
    w.energy[i] = c.loss() * albedo;
    transmitted_[std::size_t(i) * stride + std::size_t(node)] = float(c.transmittance());
    reflected_[std::size_t(i) * stride + std::size_t(node)] = float(c.reflectance());
  }
}

/// h by Sinkhorn's iteration for a symmetric kernel, so that each angle of incidence scatters its energy.
void SphereTables::balance(int node, Worker& w) {
  // Points of a rank-1 lattice over (share of the power, azimuth).
  constexpr int kPoints = 4096;
  constexpr double kGolden = 0.6180339887498949;
  w.points.clear();
  double power = 0;
  for (int cell = 0, k = 0; cell < cells(); ++cell) {
    const double mass = areas_[cell] * 0.5 * (w.phase[cell] + w.phase[cell + 1]);
    const bool forward = cell >= angles_.half;
    const int j = ring(cell);
    const double a = angles_.radius(j), b = angles_.radius(j + 1);
    for (; k < kPoints && (k + 0.5) / kPoints < power + mass; ++k) {
      const double t = std::clamp(((k + 0.5) / kPoints - power) / mass, 0.0, 1.0);
      const double share = forward ? 1 - t : t;
      const double r = std::sqrt(a * a + share * (b * b - a * a)), other = std::sqrt(4 - r * r);
      const double place = (r - a) / (b - a), here = forward ? 1 - place : place;
      const double phi = std::numbers::pi * std::fmod((k + 0.5) * kGolden, 1.0);
      w.points.push_back(
          {forward ? r : other, forward ? other : r, std::cos(phi), std::sin(phi),
           (w.phase[cell] + here * (w.phase[cell + 1] - w.phase[cell])) * areas_[cell] / mass / kPoints});
    }
    power += mass;
  }

  constexpr int n = kCosines + 1;
  w.matrix.assign(std::size_t(n) * n, 0.0);
  for (int i = 1; i < n; ++i) {
    const double t = double(i) / kCosines;
    const Incidence in{t * t, std::sqrt(1 - t * t * t * t)};
    double* row = &w.matrix[std::size_t(i) * n];
    for (const auto& p : w.points) {
      const auto out = in.scattered(p.v, p.w, p.cos_phi, p.sin_phi);
      const double x = std::min(std::sqrt(out.cosine), 1.0) * kCosines;
      const int j = std::min(int(x), kCosines - 1);
      const double share = p.weight * out.cosine * double(structure(sizes_[node] * float(out.transverse)));
      row[j] += share * (1 - (x - j)), row[j + 1] += share * (x - j);
    }
  }
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

/// For some angles of incidence, the power scattered into each ring of scattering angles. A few per cent of
/// the density follow the phase function or nothing at all, where other angles or wavelengths may need it.
void SphereTables::prepare_samples(int node, const Worker& w) {
  constexpr int kAzimuths = 16;
  constexpr double kPhaseShare = 0.04, kUniformShare = 0.02;
  const std::size_t nodes = std::size_t(sample_nodes()), at = std::size_t(node / kStride),
                    n = std::size_t(cells());
  std::vector<double> mass(n);
  for (int tilt = 0; tilt < kTilts; ++tilt) {
    const double cosine = tilt_cosine(tilt);
    const Incidence in{cosine, std::sqrt(1 - cosine * cosine)};
    double total = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const bool forward = int(i) >= angles_.half;
      const double r = angles_.radius(ring(int(i)) + 0.5), other = std::sqrt(4 - r * r);
      double sum = 0;
      for (int k = 0; k < kAzimuths; ++k) {
        const double phi = std::numbers::pi * (k + 0.5) / kAzimuths;
        const auto out = in.scattered(forward ? r : other, forward ? other : r, std::cos(phi), std::sin(phi));
        const double x = std::min(std::sqrt(out.cosine), 1.0) * kCosines;
        const int j = std::min(int(x), kCosines - 1);
        const double h = w.h[j] + (x - j) * (w.h[j + 1] - w.h[j]);
        sum += double(structure(sizes_[node] * float(out.transverse))) * out.cosine * h;
      }
      mass[i] = areas_[i] * 0.5 * (w.phase[i] + w.phase[i + 1]) * sum;
      total += mass[i];
    }
    const double rest = 1 - kPhaseShare - kUniformShare;
    double sum = 0;
    float* cdf = &cdf_[(std::size_t(tilt) * nodes + at) * (n + 1)];
    for (std::size_t i = 0; i < n; ++i) {
      mass[i] = (total > 0 ? rest * mass[i] / total : 0) +
                kPhaseShare * areas_[i] * 0.5 * (w.phase[i] + w.phase[i + 1]) +
                kUniformShare * areas_[i] * 0.5 / kTwoPi;
      sum += mass[i];
    }
    double below = 0;
    for (std::size_t i = 0; i < n; ++i) {
      cdf[i] = float(below / sum);
      below += mass[i];
    }
    cdf[n] = 1;
    // The density is that of the rounded table.
    for (std::size_t i = 0; i < n; ++i)
      density_[(std::size_t(tilt) * n + i) * nodes + at] =
          float((double(cdf[i + 1]) - double(cdf[i])) / areas_[i]);
  }
}

float SphereTables::wavelength_position(float nm) const {
  return std::clamp(float((1 / double(nm) - first_) * scale_), 0.f, float(wavelengths_ - 1));
}

SphereTables::Shares SphereTables::shares(float cos_i, const Spectrum& nm) const {
  const float x = std::min(std::sqrt(cos_i), 1.f) * kCosines;
  const int i = std::min(int(x), kCosines - 1);
  const float t = x - float(i);
  const std::size_t row = std::size_t(i) * std::size_t(wavelengths_);
  Shares s;
  for (int j = 0; j < kWavelengths; ++j) {
    const float y = wavelength_position(nm[j]);
    const int l = std::min(int(y), wavelengths_ - 2);
    const auto mean = [&](const std::vector<float>& table) {
      const float *a = &table[row + std::size_t(l)], *b = a + wavelengths_;
      return std::lerp(std::lerp(a[0], b[0], t), std::lerp(a[1], b[1], t), y - float(l));
    };
    s.transmitted[j] = mean(transmitted_), s.reflected[j] = mean(reflected_);
  }
  s.lost = max(Spectrum(1.f) - s.transmitted - s.reflected, 0.f);
  return s;
}

SphereTables::Eval SphereTables::eval(const Vec3& wi, const Vec3& wo, const Spectrum& nm) const {
  const Vec3 sum = wi + wo, difference = wi - wo;
  const float v2 = dot(sum, sum), w2 = dot(difference, difference);
  const float cos_i = std::min(std::abs(wi.z), 1.f), cos_o = std::min(std::abs(wo.z), 1.f);
  const float transverse = std::sqrt(sum.x * sum.x + sum.y * sum.y);
  const float place = std::min(angles_.position(std::sqrt(std::min(v2, w2))), float(angles_.half));
  const float position = v2 <= w2 ? float(cells()) - place : place;
  const int cell = std::min(int(position), cells() - 1);
  const float xi = std::sqrt(cos_i) * kCosines, xo = std::sqrt(cos_o) * kCosines;
  const int ci = std::min(int(xi), kCosines - 1), co = std::min(int(xo), kCosines - 1);
  const float tp = position - float(cell), ti = xi - float(ci), to = xo - float(co);
  const std::size_t stride = std::size_t(wavelengths_), nodes = std::size_t(sample_nodes());
  const float* phase = &phase_[std::size_t(cell) * stride];
  const float* hi = &h_[std::size_t(ci) * stride];
  const float* ho = &h_[std::size_t(co) * stride];
  const float* density =
      &density_[(std::size_t(tilt(cos_i)) * std::size_t(cells()) + std::size_t(cell)) * nodes];
  Eval e;
  for (int j = 0; j < kWavelengths; ++j) {
    const float y = wavelength_position(nm[j]);
    const int l = std::min(int(y), wavelengths_ - 2);
    float node[2];
    for (int k = 0; k < 2; ++k) {
      const auto at = [&](const float* table, float t) {
        const float a = table[l + k], b = table[l + k + int(stride)];
        return a + t * (b - a);
      };
      node[k] = at(phase, tp) * at(hi, ti) * at(ho, to) * structure(sizes_[std::size_t(l + k)] * transverse);
    }
    e.value[j] = (node[0] + (y - float(l)) * (node[1] - node[0])) * cos_o;
    e.pdf[j] = density[int(y * (1.f / kStride) + 0.5f)];
  }
  e.pdf *= shares(cos_i, nm).lost;
  return e;
}

Vec3 SphereTables::sample(const Vec3& wi, Vec2 u, float nm) const {
  const int t = tilt(std::min(std::abs(wi.z), 1.f));
  const std::size_t n = std::size_t(cells()),
                    node = std::size_t(wavelength_position(nm) * (1.f / kStride) + 0.5f);
  const float* cdf = &cdf_[(std::size_t(t) * std::size_t(sample_nodes()) + node) * (n + 1)];
  const std::size_t cell = std::size_t(std::upper_bound(cdf + 1, cdf + n, u.x) - (cdf + 1));
  const float share = (u.x - cdf[cell]) / std::max(cdf[cell + 1] - cdf[cell], 1e-30f);
  // Uniform over the ring's area.
  const bool forward = int(cell) >= angles_.half;
  const int j = ring(int(cell));
  const float a = float(angles_.radius(j)), b = float(angles_.radius(j + 1));
  const float r = std::sqrt(a * a + std::clamp(share, 0.f, 1.f) * (b - a) * (b + a)),
              other = std::sqrt(std::max(4 - r * r, 0.f));
  const float cosine = forward ? 1 - 0.5f * r * r : 0.5f * r * r - 1, sine = 0.5f * r * other;
  const Vec2 azimuth = cos_sin_2pi(u.y);
  return Frame::from_normal(-wi).to_world({azimuth.x * sine, azimuth.y * sine, cosine});
}

std::size_t SphereTables::bytes() const {
  return sizeof(float) * (structure_.size() + phase_.size() + 3 * h_.size() + density_.size() + cdf_.size());
}

}  // namespace aureole
