// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/scatterer_mixture.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/arrangement/ring_mean.h"

namespace aureole::optics {
namespace {

/// Ring means of a shape's amplitude and intensity; their highest harmonic is |q| times its radius.
struct ShapeRing {
  double amplitude, intensity;
};
ShapeRing shape_ring(const ApertureShape& shape, double q, double radius) {
  const int n = 24 + int(std::ceil(1.2 * q * radius));
  ShapeRing sum{};
  visit_half_ring(q, n, [&](double qx, double qy) {
    const std::complex<double> f = shape.transform(qx, qy);
    sum.amplitude += f.real();  // the other half of the ring has the conjugate values
    sum.intensity += std::norm(f);
  });
  return {sum.amplitude / n, sum.intensity / n};
}

}  // namespace

struct ScattererMixture::Part {
  Scatterer scatterer;
  double unit;     ///< reciprocal of the correlation radius
  bool isotropic;  ///< whether the shape is circular, or has random rotation
  double cosine = 1, sine = 0;
  /// Ring means of a shape without circular symmetry over w = |q| times its own radius, computed once.
  std::shared_ptr<const RadialFunction> amplitude, intensity;
  std::vector<int> classes;  ///< class of each node of the size distribution, if sizes are correlated

  Part(Scatterer s, double correlation_radius, const ParallelFor& parallel_for)
      : scatterer(std::move(s)), unit(1 / correlation_radius) {
    isotropic = scatterer.random_rotation || scatterer.shape->is_circular();
    cosine = std::cos(scatterer.rotation), sine = std::sin(scatterer.rotation);
    if (scatterer.random_rotation && !scatterer.shape->is_circular()) {
      constexpr int kEnd = 256;
      const double radius = scatterer.shape->bounding_radius(), area = scatterer.shape->area();
      std::vector<double> amplitudes = RadialFunction::places(kEnd), intensities(amplitudes.size());
      parallel_for(
          amplitudes.size(),
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
              const ShapeRing ring = shape_ring(*scatterer.shape, amplitudes[i] / radius, radius);
              amplitudes[i] = ring.amplitude / area, intensities[i] = ring.intensity / (area * area);
            }
          },
          64);
      amplitude = std::make_shared<RadialFunction>(amplitudes, kEnd, false);
      intensity = std::make_shared<RadialFunction>(intensities, kEnd, true);
    }
  }

  /// Adds P <F> at u to the sum of the size's class, or to the first sum, and P <|F|^2> to `intensity_sum`.
  void add(double ux, double uy, std::complex<double>* amplitude_sums, double& intensity_sum) const {
    const ApertureShape& shape = *scatterer.shape;
    for (std::size_t i = 0; i < scatterer.sizes.nodes().size(); ++i) {
      const auto [size, weight] = scatterer.sizes.nodes()[i];
      std::complex<double>& amplitude_sum = amplitude_sums[classes.empty() ? 0 : classes[i]];
      // The transform of a shape scaled by s is s^2 F(s q).
      const double scale = size * unit, factor = size * size * unit * unit, p = weight * scatterer.fraction;
      // The wave vector q in the shape's own unit: u/a times the relative size.
      const double qx = ux * scale, qy = uy * scale;
      if (amplitude) {
        const double area = shape.area() * factor;
        const double w = std::hypot(qx, qy) * shape.bounding_radius();
        amplitude_sum += p * area * double(amplitude->eval(float(w)));
        intensity_sum += p * area * area * double(intensity->eval(float(w)));
      } else {
        const std::complex<double> f =
            factor * shape.transform(qx * cosine + qy * sine, qy * cosine - qx * sine);
        amplitude_sum += p * f;
        intensity_sum += p * std::norm(f);
      }
    }
  }
};

ScattererMixture::ScattererMixture(const ScattererMixture&) = default;
ScattererMixture::~ScattererMixture() = default;

ScattererMixture::ScattererMixture(std::vector<Scatterer> scatterers, double correlation_radius,
                                   const ParallelFor& parallel_for) {
  mean_disc_area_ = std::numbers::pi;
  if (scatterers.empty()) throw std::domain_error("a mixture needs a scatterer");
  if (!(correlation_radius > 0 && std::isfinite(correlation_radius)))
    throw std::domain_error("correlation radius must be positive and finite, got " +
                            std::to_string(correlation_radius));
  double sum = 0;
  for (const Scatterer& s : scatterers) sum += s.fraction;
  if (!(std::abs(sum - 1) <= 1e-6))
    throw std::domain_error("fractions of the scatterers must sum to 1, but sum to " + std::to_string(sum));
  for (Scatterer& s : scatterers) {
    const double largest = s.shape->bounding_radius() * s.sizes.largest();
    if (!(largest <= correlation_radius * (1 + 1e-6)))
      throw std::domain_error("a scatterer reaches " + std::to_string(largest / correlation_radius) +
                              " correlation radii from its centre; at most 1 leaves them apart");
    const double unit = 1 / correlation_radius;
    mean_area_ += s.fraction * s.shape->area() * s.sizes.moment(2) * unit * unit;
    mean_squared_area_ += s.fraction * s.shape->squared_area() * s.sizes.moment(2) * unit * unit;
    parts_.emplace_back(std::move(s), correlation_radius, parallel_for);
    isotropic_ = isotropic_ && parts_.back().isotropic;
  }
  const Scatterer& first = parts_.front().scatterer;
  uniform_ =
      parts_.size() == 1 && first.sizes.is_single() && (first.shape->is_circular() || !first.random_rotation);
}

MixtureIntensity ScattererMixture::eval(double ux, double uy) const {
  std::complex<double> amplitudes[kMaxClasses] = {};
  double intensity = 0;
  for (const Part& part : parts_) part.add(ux, uy, amplitudes, intensity);
  if (overlapping_) return {overlapping_->eval(ux, uy, intensity), 0};
  if (!partial_) {
    const double coherent = std::norm(amplitudes[0]);
    return {std::max(intensity - coherent, 0.0), coherent};
  }
  const double u = std::hypot(ux, uy);
  for (int m = 0; m < partial_->classes(); ++m)
    for (int l = m; l < partial_->classes(); ++l) {
      const double scale = 1 / std::sqrt(partial_->fraction(m) * partial_->fraction(l));
      const double product = (amplitudes[m] * std::conj(amplitudes[l])).real() * scale;
      intensity += m == l ? product * (partial_->eval(m, l, u) - 1) : 2 * product * partial_->eval(m, l, u);
    }
  return {std::max(intensity, 0.0), 0};
}

ScattererMixture ScattererMixture::overlapping(double area_fraction, const ParallelFor& parallel_for) const {
  if (partial_) throw std::domain_error("scatterers of correlated sizes do not overlap");
  double reach = 0;
  for (const Part& part : parts_)
    reach =
        std::max(reach, part.scatterer.shape->bounding_radius() * part.scatterer.sizes.largest() * part.unit);
  const auto independent = [this](double ux, double uy) {
    std::complex<double> amplitudes[kMaxClasses] = {};
    double intensity = 0;
    for (const Part& part : parts_) part.add(ux, uy, amplitudes, intensity);
    return intensity;
  };
  ScattererMixture result(*this);
  result.overlapping_ = std::make_shared<const OverlappingScatterers>(
      independent, mean_squared_area_, reach, area_fraction / mean_disc_area_, isotropic_, parallel_for);
  return result;
}

double ScattererMixture::total() const {
  return overlapping_ ? overlapping_->total() : 2 * std::numbers::pi * mean_squared_area_;
}

double ScattererMixture::independent_ring(double u) const {
  std::complex<double> amplitudes[kMaxClasses] = {};
  const int n = isotropic_ ? 1 : 24 + int(std::ceil(1.2 * u));
  double intensity = 0;
  visit_half_ring(u, n, [&](double ux, double uy) {
    for (const Part& part : parts_) part.add(ux, uy, amplitudes, intensity);
  });
  return intensity / n;
}

void ScattererMixture::correlate_sizes(
    double area_fraction,
    const std::function<std::shared_ptr<const PartialStructureFactors>(const HardDiscMixture&)>& structure) {
  // Sizes of all shapes in increasing order, grouped into classes of about equal numbers of scatterers.
  struct Size {
    double radius, weight;
    Part* part;
    std::size_t node;
  };
  std::vector<Size> sizes;
  double largest = 0;
  for (Part& part : parts_) {
    const auto& nodes = part.scatterer.sizes.nodes();
    part.classes.assign(nodes.size(), 0);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double radius = part.scatterer.shape->bounding_radius() * nodes[i].size * part.unit;
      sizes.push_back({radius, nodes[i].weight * part.scatterer.fraction, &part, i});
      largest = std::max(largest, radius);
    }
  }
  std::sort(sizes.begin(), sizes.end(), [](const Size& a, const Size& b) { return a.radius < b.radius; });
  std::vector<double> radii, fractions;
  double done = 0, squares = 0;
  for (std::size_t i = 0, first = 0; i < sizes.size(); ++i) {
    done += sizes[i].weight;
    squares += sizes[i].weight * sizes[i].radius * sizes[i].radius;
    const bool last = i + 1 == sizes.size();
    const bool next_differs = last || sizes[i + 1].radius > sizes[i].radius * (1 + 1e-9);
    if (!last && !(next_differs && int(radii.size()) + 1 < kMaxClasses &&
                   done >= double(radii.size() + 1) / kMaxClasses))
      continue;
    double weight = 0, square = 0;
    for (std::size_t k = first; k <= i; ++k) {
      weight += sizes[k].weight, square += sizes[k].weight * sizes[k].radius * sizes[k].radius;
      sizes[k].part->classes[sizes[k].node] = int(radii.size());
    }
    radii.push_back(std::sqrt(square / weight) / largest), fractions.push_back(weight);
    first = i + 1;
  }
  mean_disc_area_ = std::numbers::pi * squares / (largest * largest);
  partial_ = structure(HardDiscMixture(radii, fractions, area_fraction));
}

double correlation_power(const std::function<double(double)>& f) {
  // Part of the integrand that correlation changes: C falls as u^-3 and S' - 1 as u^-1.5, so that less than
  // 1e-6 of the integral is beyond 400.
  const auto change = [&](double u) { return f(u) * u; };
  using Rule = boost::math::quadrature::gauss<double, 10>;
  double sum = 0;
  // The integration has fine steps, since S' has a sharp peak near u = 3 at high area fractions and
  // oscillates with period pi beyond.
  for (int i = 0; i < 128; ++i) sum += Rule::integrate(change, i / 8.0, (i + 1) / 8.0);
  for (int i = 16; i < 400; ++i) sum += Rule::integrate(change, double(i), double(i + 1));
  return sum;
}

}  // namespace aureole::optics
