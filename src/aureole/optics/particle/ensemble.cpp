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

/// radii that one task sums; fixed, so that results do not depend on threads
constexpr std::size_t kChunk = 16;
/// Nodes per unit of 2 pi radius n/lambda, and per unit of ln(radius), of the first grid.
constexpr double kPerSize = 1 / 1.2, kPerLog = 8;

double wave_number(double lambda_nm, double host) { return 2 * kPi * host / (lambda_nm * 1e-9); }

/// Returns the cosines of the probes in front of the particle; the probes behind it have the negative
/// cosines.
std::vector<double> front_probes() {
  std::vector<double> mu;
  for (const double degrees :
       {0.0, 1.0, 3.0, 7.0, 12.0, 18.0, 25.0, 33.0, 42.0, 50.0, 58.0, 66.0, 74.0, 82.0, 89.0})
    mu.push_back(std::cos(degrees * kPi / 180));
  return mu;
}

/// Drops the largest radii that contribute less than 1e-4 of the forward peak and of the absorption, and the
/// smallest that contribute less than 1e-6 of the absorption. The forward peak is roughly proportional to x^6 for
/// small particles and x^4 for large ones, the absorption to x^3 and x^2.
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

/// Returns the absorption cross section of a particle with the radius nodes[i], averaged over the radii nearer
/// to it than to other nodes.
double mean_absorption(const ParticleKind& kind, const Particle& particle, std::span<const RadiusNode> nodes,
                       std::size_t i, double lambda_nm, double host) {
  // Without absorption there is nothing to average; strong absorption leaves no narrow resonance.
  const double part = particle.absorption() / particle.extinction();
  if (nodes.size() < 2 || !(part > 1e-12)) return std::max(0.0, particle.absorption());
  if (part > 0.3) return particle.absorption();
  constexpr double kStep = 1e-5;
  const std::size_t low = i > 0 ? i - 1 : i, high = std::min(i + 1, nodes.size() - 1);
  const double radius = nodes[i].radius,
               spacing = (nodes[high].radius - nodes[low].radius) / double(high - low);
  return particle.mean_absorption(*kind.make(radius * (1 - kStep), lambda_nm, host),
                                  *kind.make(radius * (1 + kStep), lambda_nm, host), 0.5 * spacing / radius);
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
  double absorption = 0, scattering = 0,
         cosine = 0;  // cross sections; `cosine` is scattering times asymmetry
  double extinction() const { return absorption + scattering; }
  std::size_t radii = 0;              // number of nodes of these sums
  std::vector<double> at, mirrored;   // differential cross section at the probes
  double last_change = 0;             // absolute change of the absorption in the last round
  double last_scattering_change = 0;  // change of the scattering in the last round
  // absolute changes of `at` and `mirrored` in the last round
  std::vector<double> at_change, mirrored_change;
  bool done = false, converged = false;
  std::vector<RadiusNode> nodes;                 // nodes of the phase function
  double correlated = 0, correlated_cosine = 0;  // scattering and cosine including structure factors

  /// Sets the changes since the round before, if there was one.
  void compare_with(const Average& before) {
    if (before.radii == 0) return;
    last_change = std::abs(absorption - before.absorption);
    last_scattering_change = std::abs(scattering - before.scattering);
  }
};

std::vector<double> Ensemble::probes() {
  std::vector<double> mu = front_probes();
  for (std::size_t i = mu.size(); i-- > 0;) mu.push_back(-mu[i]);
  return mu;
}

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
  refine_phases(averages, parallel_for);
  const std::vector<Average> of_phases = averages;
  if (accuracy_.most_coefficient_radii > 0) refine_coefficients(averages, parallel_for);
  correlate(averages, parallel_for);
  nodes_.resize(averages.size());
  for (std::size_t w = 0; w < lambda_nm_.size(); ++w) {
    EnsembleCoefficients c;
    c.lambda_nm = lambda_nm_[w];
    double cosine = 0, independent_cosine = 0;
    for (std::size_t i = 0; i < kinds; ++i) {
      Average& a = averages[w * kinds + i];
      const double density = populations_[i].number_density;
      c.absorption += density * a.absorption;
      c.independent_scattering += density * a.scattering;
      c.scattering += density * a.correlated;
      cosine += density * a.correlated_cosine;
      independent_cosine += density * a.cosine;
      c.radii += a.nodes.size(), c.coefficient_radii += a.radii;
      c.converged = c.converged && a.converged;
      c.absorption_error += density * a.last_change;
      c.scattering_error += density * a.last_scattering_change;
      c.phase_converged = c.phase_converged && of_phases[w * kinds + i].converged;
      nodes_[w * kinds + i] = std::move(a.nodes);
      for (RadiusNode& n : nodes_[w * kinds + i]) n.weight *= density;
    }
    c.asymmetry = c.scattering > 0 ? cosine / c.scattering : 0;
    c.independent_asymmetry =
        c.independent_scattering > 0 ? independent_cosine / c.independent_scattering : 0;
    // Values at the probes in front, and behind in reverse order, as in `probes`.
    const auto at_probes = [&](auto front, auto behind) {
      std::vector<double> all;
      for (const auto part : {front, behind}) {
        std::vector<double> sum(front_probes().size());
        for (std::size_t i = 0; i < kinds; ++i)
          for (std::size_t j = 0; j < sum.size(); ++j)
            sum[j] += populations_[i].number_density * (of_phases[w * kinds + i].*part)[j] /
                      c.independent_scattering;
        if (part == behind) std::reverse(sum.begin(), sum.end());
        all.insert(all.end(), sum.begin(), sum.end());
      }
      return all;
    };
    if (c.independent_scattering > 0) {
      c.phase = at_probes(&Average::at, &Average::mirrored);
      c.phase_error = at_probes(&Average::at_change, &Average::mirrored_change);
    }
    coefficients_.push_back(std::move(c));
  }
}

/// Returns the sums over `nodes` (one list for each average; an empty one gives zeros), with differential cross
/// sections at `mu`.
std::vector<Ensemble::Average> Ensemble::sum_over(std::span<const std::vector<RadiusNode>> nodes,
                                                  std::span<const double> mu,
                                                  const ParallelFor& parallel_for) const {
  const std::size_t kinds = populations_.size();
  struct Task {
    std::size_t average, first, last;
    Average sum = {};
  };
  std::vector<Task> tasks;
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (std::size_t i = 0; i < nodes[a].size(); i += kChunk)
      tasks.push_back({a, i, std::min(i + kChunk, nodes[a].size())});
  parallel_for(
      tasks.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<double> at(mu.size()), mirrored(mu.size());
        for (std::size_t t = begin; t < end; ++t) {
          Task& task = tasks[t];
          Average& sum = task.sum;
          sum.at.assign(mu.size(), 0), sum.mirrored.assign(mu.size(), 0);
          for (std::size_t i = task.first; i < task.last; ++i) {
            const RadiusNode& node = nodes[task.average][i];
            const auto particle = populations_[task.average % kinds].kind->make(
                node.radius, lambda_nm_[task.average / kinds], host_[task.average / kinds]);
            // The closed form of the absorption is left out where phase functions are computed, since no
            // result uses it there.
            const ParticleKind& kind = *populations_[task.average % kinds].kind;
            sum.absorption +=
                node.weight *
                (mu.empty() ? mean_absorption(kind, *particle, nodes[task.average], i,
                                              lambda_nm_[task.average / kinds], host_[task.average / kinds])
                            : std::max(0.0, particle->absorption()));
            sum.scattering += node.weight * particle->scattering();
            sum.cosine += node.weight * particle->scattering() * particle->asymmetry();
            if (mu.empty()) continue;
            particle->differential(mu, at, mirrored);
            for (std::size_t j = 0; j < mu.size(); ++j)
              sum.at[j] += node.weight * at[j], sum.mirrored[j] += node.weight * mirrored[j];
          }
        }
      },
      1);
  std::vector<Average> sums(nodes.size());
  for (std::size_t a = 0; a < nodes.size(); ++a)
    sums[a].at.assign(mu.size(), 0), sums[a].mirrored.assign(mu.size(), 0), sums[a].radii = nodes[a].size();
  for (const Task& task : tasks) {
    Average& a = sums[task.average];
    a.absorption += task.sum.absorption, a.scattering += task.sum.scattering, a.cosine += task.sum.cosine;
    for (std::size_t j = 0; j < mu.size(); ++j)
      a.at[j] += task.sum.at[j], a.mirrored[j] += task.sum.mirrored[j];
  }
  return sums;
}

namespace {

bool close(double a, double b, double bound) { return std::abs(a - b) <= bound; }

/// Returns the nodes of a distribution of radii, `density` times as dense as in the first round.
std::vector<RadiusNode> nodes_of(const RadiusDistribution& radii, double density, double k,
                                 std::size_t most) {
  return without_ends(radii.nodes(density * kPerSize * k, density * kPerLog, most), k);
}

}  // namespace

/// Returns the nodes of the next round of the averages that are not done, at most `most` for each and half of that in
/// the first round, so that there is another to compare it with. An average is done at this bound, where the next
/// nodes are fewer than 1.5 times as many. Returns nothing once all are done.
std::vector<std::vector<RadiusNode>> Ensemble::next_nodes(std::vector<Average>& averages, double density,
                                                          std::size_t most) const {
  const std::size_t kinds = populations_.size();
  std::vector<std::vector<RadiusNode>> nodes(averages.size());
  bool open = false;
  for (std::size_t i = 0; i < averages.size(); ++i) {
    Average& a = averages[i];
    if (a.done) continue;
    nodes[i] = nodes_of(populations_[i % kinds].radii, density,
                        wave_number(lambda_nm_[i / kinds], host_[i / kinds]), a.radii > 0 ? most : most / 2);
    a.done = a.radii > 0 && double(nodes[i].size()) < 1.5 * double(a.radii);
    if (a.done) nodes[i].clear();
    open = open || !a.done;
  }
  if (!open) nodes.clear();
  return nodes;
}

/// Doubles the number of radii of each average until its phase function and asymmetry have converged.
void Ensemble::refine_phases(std::vector<Average>& averages, const ParallelFor& parallel_for) const {
  const std::vector<double> mu = front_probes();
  const std::size_t kinds = populations_.size();
  for (double density = 1;; density *= 2) {
    std::vector<std::vector<RadiusNode>> nodes = next_nodes(averages, density, accuracy_.most_radii);
    if (nodes.empty()) return;
    std::vector<Average> finer = sum_over(nodes, mu, parallel_for);
    for (std::size_t i = 0; i < averages.size(); ++i) {
      Average &before = averages[i], &after = finer[i];
      if (before.done) continue;
      after.nodes = std::move(nodes[i]);
      after.converged = populations_[i % kinds].radii.is_single();
      after.compare_with(before);
      after.at_change.assign(mu.size(), 0), after.mirrored_change.assign(mu.size(), 0);
      if (!after.converged && before.radii > 0) {
        double squares = 0;
        const auto compare = [&](double p, double q, double& change) {
          squares += q > 0 ? (p / q - 1) * (p / q - 1) : 0;
          change = std::abs(p - q);
        };
        for (std::size_t j = 0; j < mu.size(); ++j)
          compare(before.at[j], after.at[j], after.at_change[j]),
              compare(before.mirrored[j], after.mirrored[j], after.mirrored_change[j]);
        after.converged = close(before.cosine * after.scattering, after.cosine * before.scattering,
                                accuracy_.averaging * after.scattering * before.scattering) &&
                          std::sqrt(squares / (2.0 * double(mu.size()))) <= accuracy_.phase_averaging;
      }
      after.done = after.converged;
      before = std::move(after);
    }
  }
}

/// Doubles the number of radii of each average, beginning at about 1.7 per unit of the size parameter, until its
/// coefficients have converged.
void Ensemble::refine_coefficients(std::vector<Average>& averages, const ParallelFor& parallel_for) const {
  const std::size_t kinds = populations_.size();
  for (std::size_t i = 0; i < averages.size(); ++i) {
    averages[i].done = populations_[i % kinds].radii.is_single();
    if (!averages[i].done) averages[i].radii = 0;
  }
  for (double density = 2;; density *= 2) {
    std::vector<std::vector<RadiusNode>> nodes =
        next_nodes(averages, density, accuracy_.most_coefficient_radii);
    if (nodes.empty()) return;
    std::vector<Average> finer = sum_over(nodes, {}, parallel_for);
    for (std::size_t i = 0; i < averages.size(); ++i) {
      Average &before = averages[i], &after = finer[i];
      if (before.done) continue;
      const double bound = accuracy_.averaging;
      after.compare_with(before);
      after.converged =
          before.radii > 0 && close(before.scattering, after.scattering, bound * after.scattering) &&
          close(before.cosine, after.cosine, bound * after.scattering) &&
          after.last_change <=
              bound * std::max(after.absorption, accuracy_.least_absorption * after.extinction());
      after.done = after.converged;
      after.nodes = std::move(before.nodes);
      before = std::move(after);
    }
  }
}

/// Computes scattering and its mean cosine with structure factors, by Gauss quadrature over mu. Some radii
/// suffice for the factor by which these change scattering and its mean cosine, which is applied to the averages.
void Ensemble::correlate(std::vector<Average>& averages, const ParallelFor& parallel_for) const {
  const std::size_t kinds = populations_.size();
  parallel_for(
      averages.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          Average& a = averages[i];
          const ParticlePopulation& population = populations_[i % kinds];
          a.correlated = a.scattering, a.correlated_cosine = a.cosine;
          if (!population.hard_spheres || a.nodes.empty()) continue;
          constexpr std::size_t kMostRadii = 512;
          const double lambda = lambda_nm_[i / kinds], host = host_[i / kinds], k = wave_number(lambda, host);
          const std::vector<RadiusNode> nodes = nodes_of(population.radii, 1, k, kMostRadii);
          // |S|^2 is a polynomial of degree 2 x; the structure factor oscillates as exp(4 i x).
          const double x = k * nodes.back().radius;
          const int half = std::min(2000, 24 + int(2 * x));
          const Quadrature q = gauss_legendre(2 * half);
          // nodes in [0, 1]; each also represents its negative
          const std::span<const double> mu(q.x.data(), half);
          // Returns the integrals of the differential cross section and of its product with mu.
          const auto integrals = [&](const ParticlePopulation& p) {
            std::vector<double> at(half, 0), mirrored(half, 0);
            add_differential(p, nodes, lambda, host, mu, at, mirrored);
            std::pair<double, double> sum{0, 0};
            for (std::size_t j = 0; j < mu.size(); ++j) {
              sum.first += 2 * kPi * q.weight[j] * (at[j] + mirrored[j]);
              sum.second += 2 * kPi * q.weight[j] * mu[j] * (at[j] - mirrored[j]);
            }
            return sum;
          };
          ParticlePopulation independent = population;
          independent.hard_spheres = false;
          const auto [with, cosine_with] = integrals(population);
          const auto [without, cosine_without] = integrals(independent);
          if (!(without > 0)) continue;
          a.correlated *= with / without;
          // The change is added instead of multiplied, since the mean cosine may be 0.
          a.correlated_cosine += a.scattering * (cosine_with - cosine_without) / without;
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

/// Estimates the progress of an adaptive refinement, whose number of later angles is unknown. That number is
/// first assumed to be 1.2 times the number of the present round, then less and less (fitted to spheres of 2
/// to 60 um at 360 to 830 nm).
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
