// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/photometry/spectroradiometer.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

namespace aureole::optics {
namespace {

/// The slit function between a pixel's wavelength and that of the light [1/nm]; its integral is 1.
double slit(const ArraySpectrograph& s, double apart_nm) {
  return std::max(0.0, 1 - std::abs(apart_nm) / s.slit_nm) / s.slit_nm;
}

/// The width of a pixel [nm].
double pixel_width(const ArraySpectrograph& s, int i) { return s.nm_at(i + 0.5) - s.nm_at(i - 0.5); }

/// Stray light of unit power at `nm` on pixel i [1/nm], before the responsivity of the light's own wavelength.
double stray(const ArraySpectrograph& s, int i, double nm) {
  const double apart = (s.nm_at(i) - nm) / s.halo_nm;
  return s.scattered / (s.last_nm - s.first_nm) +
         s.halo * std::exp(-0.5 * apart * apart) / (s.halo_nm * std::sqrt(2 * std::numbers::pi));
}

}  // namespace

double ArraySpectrograph::nm_at(double pixel) const {
  const double t = pixel / (pixels - 1);
  return first_nm + (last_nm - first_nm) * t + 4 * curvature_nm * t * (1 - t);
}

double ArraySpectrograph::responsivity(double nm) const {
  const double t = (nm - peak_nm) / width_nm;
  return std::exp(-0.5 * t * t);
}

void check(const ArraySpectrograph& s) {
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw std::domain_error(what);
  };
  require(s.pixels >= 8 && s.pixels <= 8192, "an array has 8 to 8192 pixels");
  require(s.first_nm > 0 && s.last_nm > s.first_nm && s.last_nm < 1e6,
          "wavelengths must be positive and increase");
  require(std::abs(s.curvature_nm) < 0.2 * (s.last_nm - s.first_nm),
          "the scale of wavelengths must increase");
  require(s.slit_nm > 0 && s.slit_nm < 0.5 * (s.last_nm - s.first_nm),
          "a slit function is narrower than half of the range");
  require(s.slit_nm >= 2 * (s.last_nm - s.first_nm) / (s.pixels - 1),
          "a slit function is at least two pixels wide");
  require(s.scattered >= 0 && s.halo >= 0 && s.scattered + s.halo < 0.5,
          "stray light is less than half of the light");
  require(s.halo_nm > 0 && s.width_nm > 0, "widths must be positive");
  require(s.electrons >= 0 && s.read_noise >= 0 && std::isfinite(s.electrons + s.read_noise + s.peak_nm),
          "numbers of electrons must not be negative");
}

std::vector<double> line_signal(const ArraySpectrograph& s, double nm) {
  check(s);
  std::vector<double> signal(std::size_t(s.pixels));
  const double response = s.responsivity(nm);
  for (int i = 0; i < s.pixels; ++i)
    signal[std::size_t(i)] =
        response * ((1 - s.scattered - s.halo) * slit(s, s.nm_at(i) - nm) + stray(s, i, nm));
  return signal;
}

std::vector<double> array_signal(const ArraySpectrograph& s, const std::function<double(double)>& density) {
  check(s);
  std::vector<double> signal(std::size_t(s.pixels), 0.0);
  // Wavelengths beyond the array scatter onto it as well.
  const double step = s.slit_nm / 16, margin = s.slit_nm;
  double all = 0;
  for (double nm = s.first_nm - margin; nm <= s.last_nm + margin; nm += step) {
    const double power = density(nm) * step * s.responsivity(nm);
    if (!(power > 0)) continue;
    all += power * s.scattered / (s.last_nm - s.first_nm);
    for (int i = 0; i < s.pixels; ++i) {
      const double apart = s.nm_at(i) - nm;
      if (std::abs(apart) < s.slit_nm)
        signal[std::size_t(i)] += (1 - s.scattered - s.halo) * power * slit(s, apart);
      const double t = apart / s.halo_nm;
      if (std::abs(t) < 6)
        signal[std::size_t(i)] +=
            power * s.halo * std::exp(-0.5 * t * t) / (s.halo_nm * std::sqrt(2 * std::numbers::pi));
    }
  }
  for (double& v : signal) v += all;
  return signal;
}

std::vector<double> with_array_noise(const ArraySpectrograph& s, std::vector<double> signal,
                                     std::uint64_t seed) {
  check(s);
  const double largest = *std::max_element(signal.begin(), signal.end());
  if (!(s.electrons > 0 && largest > 0)) return signal;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double unit = largest / s.electrons;
  for (double& v : signal) v += unit * std::sqrt(v / unit + s.read_noise * s.read_noise) * normal(random);
  return signal;
}

WavelengthScale calibrate_wavelengths(std::span<const double> signal, std::span<const double> lines_nm,
                                      double first_nm, double last_nm, double search_nm) {
  const int n = int(signal.size());
  if (n < 8) throw std::domain_error("an array has 8 pixels at least");
  std::vector<double> at, nm;
  const double per_nm = (n - 1) / (last_nm - first_nm);
  for (const double line : lines_nm) {
    const double middle = (line - first_nm) * per_nm, reach = search_nm * per_nm;
    const int low = std::max(1, int(std::floor(middle - reach))),
              high = std::min(n - 2, int(std::ceil(middle + reach)));
    if (low > high) continue;
    int peak = low;
    for (int i = low; i <= high; ++i)
      if (signal[std::size_t(i)] > signal[std::size_t(peak)]) peak = i;
    // The part of the peak above half of it.
    const double half = 0.5 * signal[std::size_t(peak)];
    double sum = 0, moment = 0;
    for (int i = peak; i >= 0 && signal[std::size_t(i)] > half; --i)
      sum += signal[std::size_t(i)] - half, moment += i * (signal[std::size_t(i)] - half);
    for (int i = peak + 1; i < n && signal[std::size_t(i)] > half; ++i)
      sum += signal[std::size_t(i)] - half, moment += i * (signal[std::size_t(i)] - half);
    if (sum > 0) at.push_back(moment / sum), nm.push_back(line);
  }
  if (at.size() < 3)
    throw std::domain_error("a scale of wavelengths needs three lines in the array's range, there are " +
                            std::to_string(at.size()));
  Eigen::MatrixXd a(Eigen::Index(at.size()), 3);
  Eigen::VectorXd b(Eigen::Index(at.size()));
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double t = at[k] / n;
    a.row(Eigen::Index(k)) << 1, t, t * t;
    b[Eigen::Index(k)] = nm[k];
  }
  const Eigen::Vector3d c = (a.transpose() * a).ldlt().solve(a.transpose() * b);
  WavelengthScale scale{c[0], c[1] / n, c[2] / (double(n) * n), 0};
  scale.residual_nm = std::sqrt((a * c - b).squaredNorm() / double(at.size()));
  return scale;
}

StrayLightMatrix::StrayLightMatrix(const ArraySpectrograph& s) : n_(s.pixels) {
  check(s);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n_, n_);
  for (int j = 0; j < n_; ++j) {
    const std::vector<double> line = line_signal(s, s.nm_at(j));
    double within = 0;
    for (int i = 0; i < n_; ++i)
      if (std::abs(s.nm_at(i) - s.nm_at(j)) < s.slit_nm) within += line[std::size_t(i)];
    for (int i = 0; i < n_; ++i)
      if (std::abs(s.nm_at(i) - s.nm_at(j)) >= s.slit_nm) matrix(i, j) += line[std::size_t(i)] / within;
  }
  const Eigen::MatrixXd inverse = matrix.partialPivLu().inverse();
  inverse_.resize(std::size_t(n_) * std::size_t(n_));
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j) inverse_[std::size_t(i) * std::size_t(n_) + std::size_t(j)] = inverse(i, j);
}

std::vector<double> StrayLightMatrix::corrected(std::span<const double> signal) const {
  if (int(signal.size()) != n_)
    throw std::domain_error("the signal has another number of pixels than the matrix");
  std::vector<double> result(signal.size());
  for (std::size_t i = 0; i < signal.size(); ++i)
    for (std::size_t j = 0; j < signal.size(); ++j) result[i] += inverse_[i * signal.size() + j] * signal[j];
  return result;
}

std::vector<double> without_slit(const ArraySpectrograph& s, std::span<const double> values, int iterations) {
  check(s);
  const int n = int(values.size());
  if (n != s.pixels) throw std::domain_error("there are other values than pixels");
  // Rows of the slit function, each with a sum of 1, so that an even spectrum stays.
  const int reach = int(std::ceil(s.slit_nm * (n - 1) / (s.last_nm - s.first_nm))) + 4;
  std::vector<std::vector<double>> rows(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    double sum = 0;
    for (int j = std::max(0, i - reach); j <= std::min(n - 1, i + reach); ++j)
      rows[std::size_t(i)].push_back(slit(s, s.nm_at(i) - s.nm_at(j)) * pixel_width(s, j)),
          sum += rows[std::size_t(i)].back();
    for (double& v : rows[std::size_t(i)]) v /= sum;
  }
  const auto first = [&](int i) { return std::max(0, i - reach); };
  std::vector<double> x(values.begin(), values.end());
  for (double& v : x) v = std::max(v, 0.0);
  const std::vector<double> measured = x;
  for (int k = 0; k < iterations; ++k) {
    std::vector<double> ratio(static_cast<std::size_t>(n)), sum(static_cast<std::size_t>(n)),
        weight(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
      double blurred = 0;
      for (std::size_t j = 0; j < rows[std::size_t(i)].size(); ++j)
        blurred += rows[std::size_t(i)][j] * x[std::size_t(first(i)) + j];
      ratio[std::size_t(i)] = blurred > 0 ? measured[std::size_t(i)] / blurred : 0;
    }
    for (int i = 0; i < n; ++i)
      for (std::size_t j = 0; j < rows[std::size_t(i)].size(); ++j) {
        sum[std::size_t(first(i)) + j] += rows[std::size_t(i)][j] * ratio[std::size_t(i)];
        weight[std::size_t(first(i)) + j] += rows[std::size_t(i)][j];
      }
    for (int j = 0; j < n; ++j)
      if (weight[std::size_t(j)] > 0) x[std::size_t(j)] *= sum[std::size_t(j)] / weight[std::size_t(j)];
  }
  return x;
}

}  // namespace aureole::optics
