// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/ensemble.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"
#include "aureole/optics/gauss_legendre.h"
#include "aureole/optics/particle/hard_spheres.h"

namespace aureole::optics {
namespace {

constexpr std::size_t kChunk =
    16;  ///< radii that one task sums; fixed, so that results do not depend on threads
/// Nodes per unit of 2 pi radius n/lambda, and per unit of ln(radius), of the first grid.
constexpr double kPerSize = 1 / 1.2, kPerLog = 8;

double wave_number(double lambda_nm, double host) { return 2 * kPi * host / (lambda_nm * 1e-9); }

/// Returns the angles at which averages over radii are compared; their supplements are compared too.
std::vector<double> probes() {
  std::vector<double> mu;
  for (const double degrees :
       {1.0, 3.0, 7.0, 12.0, 18.0, 25.0, 33.0, 42.0, 50.0, 58.0, 66.0, 74.0, 82.0, 89.0})
    mu.push_back(std::cos(degrees * kPi / 180));
  return mu;
}

/// Drops the largest and smallest radii that contribute less than 1e-4 of the forward peak and 1e-6 of the
/// absorption. The forward peak is roughly proportional to x^6 for small particles and x^4 for large ones,
/// the absorption to x^3 and x^2.
std::vector<RadiusNode> without_ends(std::vector<RadiusNode> nodes, double k) {
  const auto forward = [&](const RadiusNode& n) {
    const double x2 = k * k * n.radius * n.radius;
    return n.weight * x2 * x2 * x2 / (1 + x2);
  };
  const auto absorbed = [&](const RadiusNode& n) {
    const double x = k * n.radius;
    return n.weight * x * x * x / (1 + x);
  };
  double all_forward = 0, all_absorbed = 0;
  for (const RadiusNode& n : nodes) all_forward += forward(n), all_absorbed += absorbed(n);
  std::size_t first = 0, last = nodes.size();
  double sum = 0, area = 0;
  while (last > first + 1 && (sum += forward(nodes[last - 1])) < 1e-4 * all_forward &&
         (area += absorbed(nodes[last - 1])) < 1e-4 * all_absorbed)
    --last;
  sum = area = 0;
  while (last > first + 1 && (area += absorbed(nodes[first])) < 1e-6 * all_absorbed) ++first;
  return {nodes.begin() + std::ptrdiff_t(first), nodes.begin() + std::ptrdiff_t(last)};
}

/// Adds the intensities of `nodes`, times the structure factor, to `at` and `mirrored`.
void add_differential(const ParticlePopulation& population, std::span<const RadiusNode> nodes,
                      double lambda_nm, double host, std::span<const double> mu, std::span<double> at,
                      std::span<double> mirrored) {
  std::vector<double> one(mu.size()), other(mirrored.size());
  const double k = wave_number(lambda_nm, host);
  const double fraction = population.hard_spheres ? population.volume_fraction() : 0;
  for (const RadiusNode& node : nodes) {
    population.kind->make(node.radius, lambda_nm, host)->differential(mu, one, other);
    for (std::size_t i = 0; i < mu.size(); ++i) {
      const auto structure = [&](double cosine) {
        return fraction > 0
                   ? hard_sphere_structure_factor(k * std::sqrt(2 * (1 - cosine)) * node.radius, fraction)
                   : 1;
      };
      at[i] += node.weight * one[i] * structure(mu[i]);
      if (!mirrored.empty()) mirrored[i] += node.weight * other[i] * structure(-mu[i]);
    }
  }
}

}  // namespace

/// Averages over radii of one population at one wavelength, per particle.
struct Ensemble::Average {
  std::vector<RadiusNode> nodes;
  double extinction = 0, scattering = 0, cosine = 0;  // cosine: scattering times asymmetry
  std::vector<double> at, mirrored;
  bool done = false, converged = false;
  /// Values with structure factors, computed once `done`.
  double correlated = 0, correlated_cosine = 0;
};

Ensemble::Ensemble(std::vector<ParticlePopulation> populations, std::vector<double> lambda_nm,
                   const SpectralFunction& host, const EnsembleAccuracy& accuracy,
                   const ParallelFor& parallel_for)
    : populations_(std::move(populations)), lambda_nm_(std::move(lambda_nm)), accuracy_(accuracy) {
  for (const ParticlePopulation& p : populations_) {
    if (!(p.number_density >= 0 && std::isfinite(p.number_density)))
      throw std::domain_error("number density of particles must not be negative, got " +
                              std::to_string(p.number_density) + " per m^3");
    if (p.hard_spheres && p.volume_fraction() > kMaxHardSphereFraction)
      throw std::domain_error("hard spheres must fill at most 0.6 of the volume, got " +
                              std::to_string(p.volume_fraction()));
  }
  for (const double lambda : lambda_nm_) {
    if (!(lambda > 0 && std::isfinite(lambda)))
      throw std::domain_error("wavelength must be positive and finite, got " + std::to_string(lambda) +
                              " nm");
    host_.push_back(host(lambda));
    if (!(host_.back() > 0 && std::isfinite(host_.back())))
      throw std::domain_error("index of the medium around particles must be positive, got " +
                              std::to_string(host_.back()) + " at " + std::to_string(lambda) + " nm");
  }
  const std::size_t kinds = populations_.size();
  std::vector<Average> averages(kinds * lambda_nm_.size());
  refine(averages, parallel_for);
  correlate(averages, parallel_for);
  nodes_.resize(averages.size());
  for (std::size_t w = 0; w < lambda_nm_.size(); ++w) {
    EnsembleCoefficients c;
    c.lambda_nm = lambda_nm_[w];
    double cosine = 0, independent_cosine = 0;
    for (std::size_t i = 0; i < kinds; ++i) {
      Average& a = averages[w * kinds + i];
      const double density = populations_[i].number_density;
      c.absorption += density * std::max(0.0, a.extinction - a.scattering);
      c.independent_scattering += density * a.scattering;
      c.scattering += density * a.correlated;
      cosine += density * a.correlated_cosine;
      independent_cosine += density * a.cosine;
      c.radii += a.nodes.size();
      c.converged = c.converged && a.converged;
      nodes_[w * kinds + i] = std::move(a.nodes);
      for (RadiusNode& n : nodes_[w * kinds + i]) n.weight *= density;
    }
    c.asymmetry = c.scattering > 0 ? cosine / c.scattering : 0;
    c.independent_asymmetry =
        c.independent_scattering > 0 ? independent_cosine / c.independent_scattering : 0;
    coefficients_.push_back(c);
  }
}

/// Doubles the number of radii of each average until it has converged.
void Ensemble::refine(std::vector<Average>& averages, const ParallelFor& parallel_for) {
  const std::vector<double> mu = probes();
  const std::size_t kinds = populations_.size();
  struct Task {
    std::size_t average, first, last;
    double extinction = 0, scattering = 0, cosine = 0;
    std::vector<double> at = {}, mirrored = {};
  };
  for (double density = 1;; density *= 2) {
    std::vector<Average> finer(averages.size());
    std::vector<Task> tasks;
    for (std::size_t a = 0; a < averages.size(); ++a) {
      if (averages[a].done) continue;
      const double k = wave_number(lambda_nm_[a / kinds], host_[a / kinds]);
      finer[a].nodes = without_ends(populations_[a % kinds].radii.nodes(
                                        density * kPerSize * k, density * kPerLog, accuracy_.most_radii),
                                    k);
      for (std::size_t i = 0; i < finer[a].nodes.size(); i += kChunk)
        tasks.push_back({.average = a, .first = i, .last = std::min(i + kChunk, finer[a].nodes.size())});
    }
    if (tasks.empty()) return;
    parallel_for(
        tasks.size(),
        [&](std::size_t begin, std::size_t end) {
          std::vector<double> at(mu.size()), mirrored(mu.size());
          for (std::size_t t = begin; t < end; ++t) {
            Task& task = tasks[t];
            task.at.assign(mu.size(), 0), task.mirrored.assign(mu.size(), 0);
            for (std::size_t i = task.first; i < task.last; ++i) {
              const RadiusNode& node = finer[task.average].nodes[i];
              const auto particle = populations_[task.average % kinds].kind->make(
                  node.radius, lambda_nm_[task.average / kinds], host_[task.average / kinds]);
              task.extinction += node.weight * particle->extinction();
              task.scattering += node.weight * particle->scattering();
              task.cosine += node.weight * particle->scattering() * particle->asymmetry();
              particle->differential(mu, at, mirrored);
              for (std::size_t j = 0; j < mu.size(); ++j)
                task.at[j] += node.weight * at[j], task.mirrored[j] += node.weight * mirrored[j];
            }
          }
        },
        1);
    for (const Task& task : tasks) {
      Average& a = finer[task.average];
      a.at.resize(mu.size()), a.mirrored.resize(mu.size());
      a.extinction += task.extinction, a.scattering += task.scattering, a.cosine += task.cosine;
      for (std::size_t j = 0; j < mu.size(); ++j) a.at[j] += task.at[j], a.mirrored[j] += task.mirrored[j];
    }
    for (std::size_t i = 0; i < averages.size(); ++i) {
      Average &before = averages[i], &after = finer[i];
      if (before.done) continue;
      const auto close = [&](double a, double b, double scale) {
        return std::abs(a - b) <= accuracy_.averaging * scale;
      };
      bool converged = populations_[i % kinds].radii.is_single();
      if (!converged && !before.nodes.empty()) {
        converged = close(before.extinction, after.extinction, after.extinction) &&
                    close(before.scattering, after.scattering, after.scattering) &&
                    close(before.cosine, after.cosine, after.scattering) &&
                    close(before.extinction - before.scattering, after.extinction - after.scattering,
                          std::max(after.extinction - after.scattering, 1e-3 * after.extinction));
        double squares = 0;
        const auto compare = [&](double p, double q) { squares += q > 0 ? (p / q - 1) * (p / q - 1) : 0; };
        for (std::size_t j = 0; j < mu.size(); ++j)
          compare(before.at[j], after.at[j]), compare(before.mirrored[j], after.mirrored[j]);
        converged = converged && std::sqrt(squares / (2.0 * mu.size())) <= accuracy_.phase_averaging;
      }
      const bool full = !before.nodes.empty() && after.nodes.size() < 1.5 * double(before.nodes.size());
      before = std::move(after);
      before.converged = converged;
      before.done = converged || full;
    }
  }
}

/// Computes scattering and its mean cosine with structure factors, by Gauss quadrature over mu.
void Ensemble::correlate(std::vector<Average>& averages, const ParallelFor& parallel_for) {
  const std::size_t kinds = populations_.size();
  parallel_for(
      averages.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          Average& a = averages[i];
          const ParticlePopulation& population = populations_[i % kinds];
          a.correlated = a.scattering, a.correlated_cosine = a.cosine;
          if (!population.hard_spheres || a.nodes.empty()) continue;
          const double lambda = lambda_nm_[i / kinds], host = host_[i / kinds];
          // |S|^2 is a polynomial of degree 2 x; the structure factor oscillates as exp(4 i x).
          const double x = wave_number(lambda, host) * a.nodes.back().radius;
          const int half = std::min(2000, 24 + int(2 * x));
          const Quadrature q = gauss_legendre(2 * half);
          const std::span<const double> mu(q.x.data(), half);  // nodes in [0, 1]; each also represents -mu
          std::vector<double> at(half, 0), mirrored(half, 0);
          add_differential(population, a.nodes, lambda, host, mu, at, mirrored);
          a.correlated = a.correlated_cosine = 0;
          for (std::size_t j = 0; j < mu.size(); ++j) {
            a.correlated += 2 * kPi * q.weight[j] * (at[j] + mirrored[j]);
            a.correlated_cosine += 2 * kPi * q.weight[j] * mu[j] * (at[j] - mirrored[j]);
          }
        }
      },
      1);
}

std::vector<double> Ensemble::differential(std::size_t wavelength, std::span<const double> mu) const {
  std::vector<double> at(mu.size(), 0);
  for (std::size_t i = 0; i < populations_.size(); ++i)
    add_differential(populations_[i], nodes_[wavelength * populations_.size() + i], lambda_nm_[wavelength],
                     host_[wavelength], mu, at, {});
  return at;
}

namespace {

/// Estimates the progress of an adaptive refinement, whose number of later angles is unknown. It is first
/// assumed to be 1.2 times that of the present round, then less and less (fitted to spheres of 2 to 60 um at
/// 360 to 830 nm).
class RoundProgress {
public:
  RoundProgress(const TellProgress& tell, std::size_t tasks) : tell_(tell), tasks_(double(tasks)) {}

  void begin(std::size_t angles) {
    finished_ += angles_;
    angles_ = double(angles), tasks_done_ = 0;
    const double ahead = round_++ == 0 ? 1.2 : round_ == 2 ? 0.4 : 0.1;
    expected_ = finished_ + angles_ * (1 + ahead);
  }
  void task_done() {
    if (!tell_) return;
    const double part = (finished_ + angles_ * double(++tasks_done_) / tasks_) / expected_;
    double before = part_;
    while (part > before && !part_.compare_exchange_weak(before, part)) {
    }
    tell_(std::max(part, before));
  }

private:
  const TellProgress& tell_;
  const double tasks_;
  double angles_ = 0, finished_ = 0, expected_ = 1;
  int round_ = 0;
  std::atomic<std::size_t> tasks_done_{0};
  std::atomic<double> part_{0};
};

}  // namespace

PhaseTables Ensemble::phases(const ParallelFor& parallel_for, const TellProgress& progress) const {
  struct Task {
    std::size_t wavelength, population;
    std::span<const RadiusNode> nodes;
    std::vector<double> at, mirrored;
  };
  std::vector<Task> tasks;
  double size = 1;
  for (std::size_t w = 0; w < lambda_nm_.size(); ++w) {
    if (!(coefficients_[w].scattering > 0))
      throw std::domain_error("particles that scatter nothing have no phase function, at " +
                              std::to_string(lambda_nm_[w]) + " nm");
    for (std::size_t i = 0; i < populations_.size(); ++i) {
      const std::vector<RadiusNode>& nodes = nodes_[w * populations_.size() + i];
      for (std::size_t first = 0; first < nodes.size(); first += kChunk)
        tasks.push_back(
            {w, i, std::span(nodes).subspan(first, std::min(kChunk, nodes.size() - first)), {}, {}});
      size = std::max(size, wave_number(lambda_nm_[w], host_[w]) * nodes.back().radius);
    }
  }
  // The forward peak is 4/x wide, rainbows are x^(-2/3) wide.
  const double step = std::min(kPi / 60, 0.5 * std::pow(size, -2.0 / 3));
  RoundProgress rounds(progress, tasks.size());
  return tabulate_phases(
      [&](std::span<const double> mu, std::vector<std::vector<double>>& at,
          std::vector<std::vector<double>>& mirrored) {
        rounds.begin(mu.size());
        parallel_for(
            tasks.size(),
            [&](std::size_t begin, std::size_t end) {
              for (std::size_t t = begin; t < end; ++t) {
                Task& task = tasks[t];
                task.at.assign(mu.size(), 0), task.mirrored.assign(mu.size(), 0);
                add_differential(populations_[task.population], task.nodes, lambda_nm_[task.wavelength],
                                 host_[task.wavelength], mu, task.at, task.mirrored);
                rounds.task_done();
              }
            },
            1);
        for (const Task& task : tasks)
          for (std::size_t j = 0; j < mu.size(); ++j)
            at[task.wavelength][j] += task.at[j], mirrored[task.wavelength][j] += task.mirrored[j];
      },
      lambda_nm_.size(), std::min(0.2 / size, step), step, accuracy_.phase);
}

DependentScattering dependent_scattering(const ParticlePopulation& population, double lambda_nm, double host,
                                         const EnsembleAccuracy& accuracy, const ParallelFor& parallel_for) {
  ParticlePopulation correlated = population;
  correlated.hard_spheres = true;
  const EnsembleCoefficients c =
      Ensemble(
          {correlated}, {lambda_nm}, [=](double) { return host; }, accuracy, parallel_for)
          .coefficients()[0];
  if (!(c.independent_scattering > 0)) return {};
  return {c.scattering / c.independent_scattering,
          c.scattering * (1 - c.asymmetry) / (c.independent_scattering * (1 - c.independent_asymmetry))};
}

}  // namespace aureole::optics
