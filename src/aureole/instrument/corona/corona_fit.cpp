// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/corona/corona_fit.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "aureole/core/error.h"
#include "aureole/math/simplex.h"

namespace aureole {
namespace {

constexpr double kFirstRing = 2.548;  // u of the first maximum at area fraction 1/2
constexpr double kMiddleWavelength = 550e-9;

/// Weighted linear least squares fit of one colour by a few functions.
struct Linear {
  cv::Mat coefficients;
  double misfit = 0;
};
Linear solve(const std::vector<std::vector<double>>& columns, const std::vector<double>& y,
             const std::vector<double>& weight) {
  const int n = int(columns.size());
  cv::Mat m(n, n, CV_64F, cv::Scalar(0)), right(n, 1, CV_64F, cv::Scalar(0));
  for (int a = 0; a < n; ++a)
    for (size_t i = 0; i < y.size(); ++i) {
      for (int b = 0; b <= a; ++b)
        m.at<double>(a, b) += weight[i] * columns[size_t(a)][i] * columns[size_t(b)][i];
      right.at<double>(a) += weight[i] * columns[size_t(a)][i] * y[i];
    }
  cv::completeSymm(m, true);
  Linear out;
  // Columns differ greatly in size, so they are scaled to unit diagonal.
  cv::Mat scale(n, 1, CV_64F);
  for (int a = 0; a < n; ++a) scale.at<double>(a) = 1 / std::sqrt(std::max(m.at<double>(a, a), 1e-300));
  cv::Mat scaled = m.mul(scale * scale.t()), x;
  cv::solve(scaled, right.mul(scale), x, cv::DECOMP_SVD);
  out.coefficients = x.mul(scale);
  for (size_t i = 0; i < y.size(); ++i) {
    double v = y[i];
    for (int a = 0; a < n; ++a) v -= out.coefficients.at<double>(a) * columns[size_t(a)][i];
    out.misfit += weight[i] * v * v;
  }
  return out;
}

/// The unknowns of the scatterers: ln(radius), area fraction, and for several sizes the spread, or ln(second
/// radius) and the second share.
using Unknowns = std::vector<double>;

CoronaScatterers scatterers(CoronaSizes sizes, const Unknowns& x) {
  CoronaScatterers s{std::exp(x[0]), x[1]};
  if (sizes == CoronaSizes::spread) s.spread = x[2] < 1e-3 ? 0 : x[2];
  if (sizes == CoronaSizes::two) s.second_radius = std::exp(x[2]), s.second_share = x[3];
  return s;
}

class Fitter {
public:
  Fitter(const ScatteredProfile& p, CoronaModel& model, CoronaSizes sizes)
      : p_(p), model_(model), sizes_(sizes) {
    const size_t n = p.s.size();
    for (size_t c = 0; c < 3; ++c) {
      std::vector<double> y(n), w(n), sd;
      double least = INFINITY, most = -INFINITY;
      for (size_t i = 0; i < n; ++i) {
        y[i] = p.mean[i][c], sd.push_back(p.sd[i][c]);
        least = std::min(least, y[i]), most = std::max(most, y[i]);
      }
      std::nth_element(sd.begin(), sd.begin() + long(n / 2), sd.end());
      range_[c] = most - least;
      // The error of a ring is at least 0.1 % of the range and half the median error.
      const double floor = std::hypot(0.5 * sd[n / 2], 1e-3 * range_[c]);
      for (size_t i = 0; i < n; ++i) {
        const double e = std::hypot(p.sd[i][c], floor);
        w[i] = e > 0 ? 1 / (e * e) : 0;
      }
      y_[c] = std::move(y), base_[c] = w, weight_[c] = std::move(w);
    }
  }

  /// Misfit for these unknowns; `out` receives the model's values.
  double misfit(const Unknowns& x, std::vector<std::array<double, 3>>* out = nullptr) {
    model_.set(scatterers(sizes_, x));
    const size_t n = p_.s.size();
    std::vector<std::vector<double>> columns(3, std::vector<double>(n));
    double sum = 0;
    std::vector<std::array<double, 3>> shape(n);
    for (size_t i = 0; i < n; ++i) shape[i] = model_.at(p_.s[i]);
    if (out) out->assign(n, {});
    for (size_t c = 0; c < 3; ++c) {
      for (size_t i = 0; i < n; ++i) columns[0][i] = shape[i][c], columns[1][i] = 1, columns[2][i] = p_.s[i];
      Linear l = solve(columns, y_[c], weight_[c]);
      factor_[c] = l.coefficients.at<double>(0);
      // For a colour that the source hardly emits the linear fit may give a negative factor, which is
      // invalid.
      if (factor_[c] < 0) {
        factor_[c] = 0;
        l = solve({columns[1], columns[2]}, y_[c], weight_[c]);
        l.coefficients =
            (cv::Mat_<double>(3, 1) << 0, l.coefficients.at<double>(0), l.coefficients.at<double>(1));
      }
      sum += l.misfit;
      if (out)
        for (size_t i = 0; i < n; ++i)
          (*out)[i][c] = l.coefficients.at<double>(0) * columns[0][i] + l.coefficients.at<double>(1) +
                         l.coefficients.at<double>(2) * p_.s[i];
    }
    return sum;
  }

  /// Misfit of smooth light without rings, a cubic polynomial for each colour.
  double smooth_misfit() const {
    double sum = 0;
    for (size_t c = 0; c < 3; ++c) {
      std::vector<std::vector<double>> columns(4, std::vector<double>(p_.s.size()));
      for (size_t i = 0; i < p_.s.size(); ++i)
        for (int k = 0; k < 4; ++k) columns[size_t(k)][i] = std::pow(p_.s[i] / p_.s.back(), k);
      sum += solve(columns, y_[c], weight_[c]).misfit;
    }
    return sum;
  }

  /// Reweights by residuals (Huber, 1964), so that bright objects on some rings count less.
  void reweight(const std::vector<std::array<double, 3>>& model) {
    for (size_t c = 0; c < 3; ++c) {
      std::vector<double> r;
      for (size_t i = 0; i < p_.s.size(); ++i)
        r.push_back(std::sqrt(base_[c][i]) * std::abs(y_[c][i] - model[i][c]));
      std::vector<double> sorted = r;
      std::nth_element(sorted.begin(), sorted.begin() + long(r.size() / 2), sorted.end());
      const double limit = 1.345 * std::max(1.4826 * sorted[r.size() / 2], 1e-12);
      for (size_t i = 0; i < r.size(); ++i) weight_[c][i] = base_[c][i] * (r[i] > limit ? limit / r[i] : 1);
    }
  }

  /// Sets the errors of `fit`, whose values are those of x.
  void errors(const Unknowns& x, CoronaFit& fit);
  double range(size_t c) const { return range_[c]; }

private:
  const ScatteredProfile& p_;
  CoronaModel& model_;
  CoronaSizes sizes_;
  std::array<std::vector<double>, 3> y_, base_, weight_;
  std::array<double, 3> range_{}, factor_{};
};

/// Covariance of all unknowns: (X^T W X)^-1 times the mean square of the residuals, times the number of
/// correlated neighbouring residuals.
void Fitter::errors(const Unknowns& x, CoronaFit& fit) {
  const size_t n = p_.s.size(), k = x.size();
  const int all = int(k) + 9;
  const Unknowns steps{1e-3, x[1] > 0.6 ? -2e-3 : 2e-3, sizes_ == CoronaSizes::two ? 1e-3 : 5e-3,
                       x.back() > 0.5 ? -5e-3 : 5e-3};
  std::vector<std::vector<std::array<double, 3>>> shape(k + 1);
  for (size_t a = 0; a <= k; ++a) {
    Unknowns at = x;
    if (a > 0) at[a - 1] += steps[a - 1];
    model_.set(scatterers(sizes_, at));
    for (size_t i = 0; i < n; ++i) shape[a].push_back(model_.at(p_.s[i]));
  }
  cv::Mat m(all, all, CV_64F, cv::Scalar(0));
  double neighbours = 0, squares = 0;
  std::vector<double> row(k + 9);
  for (size_t c = 0; c < 3; ++c) {
    double before = 0;
    for (size_t i = 0; i < n; ++i) {
      std::fill(row.begin(), row.end(), 0.0);
      for (size_t a = 0; a < k; ++a) row[a] = factor_[c] * (shape[a + 1][i][c] - shape[0][i][c]) / steps[a];
      row[k + 3 * c] = shape[0][i][c], row[k + 3 * c + 1] = range_[c],
                  row[k + 3 * c + 2] = range_[c] * p_.s[i] / p_.s.back();
      for (int a = 0; a < all; ++a)
        for (int b = 0; b < all; ++b) m.at<double>(a, b) += weight_[c][i] * row[size_t(a)] * row[size_t(b)];
      const double r = std::sqrt(weight_[c][i]) * (y_[c][i] - fit.model[i][c]);
      squares += r * r, neighbours += before * r;
      before = r;
    }
  }
  cv::Mat scale(all, 1, CV_64F), inverse;
  for (int a = 0; a < all; ++a)
    scale.at<double>(a) = m.at<double>(a, a) > 0 ? 1 / std::sqrt(m.at<double>(a, a)) : 0;
  cv::invert(m.mul(scale * scale.t()), inverse, cv::DECOMP_SVD);
  inverse = inverse.mul(scale * scale.t());
  const double correlation = squares > 0 ? std::clamp(neighbours / squares, 0.0, 0.98) : 0;
  const double factor =
      squares / std::max(1.0, 3.0 * double(n) - all) * (1 + correlation) / (1 - correlation);
  const auto error = [&](int a) { return std::sqrt(std::max(factor * inverse.at<double>(a, a), 0.0)); };
  fit.radius_error = fit.radius * error(0);
  fit.area_fraction_error = error(1);
  if (sizes_ == CoronaSizes::spread) fit.spread_error = error(2);
  if (sizes_ == CoronaSizes::two)
    fit.second_radius_error = fit.second_radius * error(2), fit.second_share_error = error(3);
  const double both = std::sqrt(inverse.at<double>(0, 0) * inverse.at<double>(1, 1));
  fit.correlation = both > 0 ? inverse.at<double>(0, 1) / both : 0;
  if (sizes_ == CoronaSizes::two) {
    const double others = std::sqrt(inverse.at<double>(2, 2) * inverse.at<double>(1, 1));
    fit.second_correlation = others > 0 ? inverse.at<double>(2, 1) / others : 0;
  }
}

/// Minimises the misfit of a fitter with N unknowns, from a grid of starts.
template <int N>
class Search {
public:
  using Point = std::array<double, N>;
  Search(Fitter& fitter, CoronaSizes sizes, double least, double most)
      : fitter_(fitter), sizes_(sizes), least_(least), most_(most) {}

  Unknowns run(CoronaFit& fit) {
    std::vector<std::pair<double, Point>> candidates;
    const auto visit = [&](const Point& x) { candidates.push_back({misfit(x), x}); };
    const bool one = sizes_ == CoronaSizes::one;
    const double step = one ? 0.05 : 0.1, fraction_step = one ? 0.06 : 0.12;
    const int steps = std::max(8, int(std::log(most_ / least_) / step));
    for (double fraction = 0.05; fraction < kMaxFittedFraction; fraction += fraction_step)
      for (int i = 0; i <= steps; ++i) {
        Point x{std::log(least_ * std::pow(most_ / least_, double(i) / steps)), fraction};
        if (one) visit(x);
        if (sizes_ == CoronaSizes::spread)
          for (const double spread : {0.05, 0.15, 0.3}) x[2] = spread, visit(x);
        if (sizes_ == CoronaSizes::two)
          for (const double ratio : {0.4, 0.55, 0.7, 0.82})
            for (const double share : {0.25, 0.5, 0.75})
              x[2] = x[0] + std::log(ratio), x[3] = share, visit(x);
      }
    std::sort(candidates.begin(), candidates.end());
    const auto minimum = [&](const Point& from, double size, int evaluations) {
      Point step{0.02 * size, 0.03 * size};
      if (N > 2) step[2] = (sizes_ == CoronaSizes::two ? 0.03 : 0.05) * size;
      if (N > 3) step[3] = 0.1 * size;
      return simplex_minimum<N>([&](const Point& x) { return misfit(x); }, from, step, evaluations);
    };
    Point best{};
    double least = INFINITY;
    for (size_t k = 0; k < (one ? 4 : 6); ++k) {
      const Point x = minimum(candidates[k].second, 1, 30 * N);
      if (const double m = misfit(x); m < least) least = m, best = x;
    }
    for (int pass = 0; pass < 3; ++pass) {
      fitter_.misfit(unknowns(best), &fit.model);
      fitter_.reweight(fit.model);
      best = minimum(best, 0.3, 35 * N);
    }
    return unknowns(best);
  }

private:
  static Unknowns unknowns(const Point& x) { return {x.begin(), x.end()}; }
  double misfit(const Point& x) {
    if (!(x[1] > 0.005 && x[1] < kMaxFittedFraction) || std::abs(x[0] - std::log(least_)) > 10)
      return INFINITY;
    if (sizes_ == CoronaSizes::spread && !(x[2] >= 0 && x[2] <= 0.6)) return INFINITY;
    // Sizes that differ by less than 5 % are one size.
    if (sizes_ == CoronaSizes::two && !(x[0] - x[2] > 0.05 && x[0] - x[2] < 2 && x[3] > 0.01 && x[3] < 0.99))
      return INFINITY;
    return fitter_.misfit(unknowns(x));
  }

  Fitter& fitter_;
  CoronaSizes sizes_;
  double least_, most_;
};

}  // namespace

CoronaFit fit_corona(const ScatteredProfile& p, CoronaModel& model, CoronaSizes sizes) {
  if (p.s.size() < 15)
    throw Error("no ring is visible: only " + std::to_string(p.s.size()) +
                " rings of pixels are neither clipped nor left out; 15 are needed");
  Fitter fitter(p, model, sizes);
  for (size_t c = 0; c < 3; ++c)
    if (!(fitter.range(c) > 0))
      throw Error("no ring is visible: a colour of the picture is constant around the lamp");

  // The start assumes that the first maximum or the first minimum is inside the picture.
  const double first = kFirstRing * kMiddleWavelength / (2 * M_PI);
  const double least = first / (0.8 * p.s.back()), most = 2.5 * first / p.s.front();
  CoronaFit fit;
  const Unknowns x = sizes == CoronaSizes::one      ? Search<2>(fitter, sizes, least, most).run(fit)
                     : sizes == CoronaSizes::spread ? Search<3>(fitter, sizes, least, most).run(fit)
                                                    : Search<4>(fitter, sizes, least, most).run(fit);
  const double best = fitter.misfit(x, &fit.model);
  // Rings must explain at least half of the residual of smooth light, and more than noise could by chance.
  const double smooth = fitter.smooth_misfit(),
               per_ring = best / std::max(1.0, 3.0 * double(p.s.size()) - 9 - double(x.size()));
  if (!(best < 0.5 * smooth && smooth - best > 30 * per_ring))
    throw Error("no ring is visible: the profile around the lamp is as smooth as noise allows");
  const CoronaScatterers found = scatterers(sizes, x);
  fit.radius = found.radius, fit.area_fraction = found.area_fraction, fit.spread = found.spread;
  fit.second_radius = found.second_radius, fit.second_share = found.second_share;
  fitter.errors(x, fit);
  if (sizes == CoronaSizes::spread && fit.spread < kMinFittedSpread) {
    // The derivative by the spread vanishes at a spread of zero, and the error of the spread is undefined
    // there: a fit of one size replaces it.
    return fit_corona(p, model, CoronaSizes::one);
  }
  if (fit.second_share > 0.5) {
    std::swap(fit.radius, fit.second_radius), std::swap(fit.radius_error, fit.second_radius_error);
    fit.second_share = 1 - fit.second_share;
    fit.correlation = fit.second_correlation;
  }
  double squares = 0;
  for (size_t i = 0; i < p.s.size(); ++i)
    for (size_t c = 0; c < 3; ++c) squares += std::pow((p.mean[i][c] - fit.model[i][c]) / fitter.range(c), 2);
  fit.residual = std::sqrt(squares / (3 * double(p.s.size())));
  return fit;
}

}  // namespace aureole
