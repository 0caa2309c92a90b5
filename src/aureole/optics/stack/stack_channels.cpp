// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/stack_channels.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace aureole::optics {
namespace {

/// Returns the squared invariant (n sin(theta))^2.
double invariant(const IndexedCosine& c) { return c.index * c.index * (1 - c.mu) * (1 + c.mu); }

/// Returns the cosine after refraction into a medium of index n; 0 under total internal reflection. The
/// difference of indices makes it exact if they are equal. Rounding never makes it exceed 1.
double refracted(const IndexedCosine& from, double n) {
  const double square = (n - from.index) * (n + from.index) + from.index * from.index * from.mu * from.mu;
  return square > 0 ? std::min(std::sqrt(square) / n, 1.0) : 0;
}

}  // namespace

Channels::Channels(std::vector<double> indices, int half_streams, std::span<const IndexedCosine> extra,
                   std::span<const IndexedCosine> cuts)
    : indices_(std::move(indices)) {
  std::sort(indices_.begin(), indices_.end());
  indices_.erase(std::unique(indices_.begin(), indices_.end()), indices_.end());

  std::vector<IndexedCosine> ends(cuts.begin(), cuts.end());
  for (const double n : indices_) ends.push_back({n, 0});
  std::sort(ends.begin(), ends.end(),
            [](const IndexedCosine& a, const IndexedCosine& b) { return invariant(a) < invariant(b); });
  // Limits that are equal up to rounding are merged: for instance a cut at grazing incidence would leave an
  // empty piece.
  const double most = indices_.back() * indices_.back();
  std::vector<IndexedCosine> distinct;
  double last = 0;
  for (const IndexedCosine& end : ends)
    if (invariant(end) > last + 1e-12 * most) {
      distinct.push_back(end);
      last = invariant(end);
    } else if (!distinct.empty() && end.mu == 0) {
      distinct.back() = end;
    }

  extra_.resize(extra.size());
  const int pieces = int(distinct.size());
  IndexedCosine from{indices_.front(), 1};
  for (int piece = 0; piece < pieces; ++piece) {
    const IndexedCosine to = distinct[piece];
    const double n =
        *std::lower_bound(indices_.begin(), indices_.end(), std::sqrt(invariant(to)) * (1 - 1e-12));
    const double steep = refracted(from, n), grazing = refracted(to, n);
    const int nodes = std::max(1, half_streams / pieces + (piece < half_streams % pieces));
    const Quadrature q = gauss_legendre(nodes, grazing, steep);
    double end = steep;
    for (std::size_t i = 0; i < q.x.size(); ++i) {
      const double next = end - q.weight[i];
      channels_.push_back({{n, q.x[i]},
                           2 * std::numbers::pi * n * n * q.x[i] * q.weight[i],
                           false,
                           end,
                           std::max(next, 0.0)});
      end = next;
    }
    for (std::size_t i = 0; i < extra.size(); ++i) {
      const double s = invariant(extra[i]);
      const bool is_here = (piece == 0 || s > invariant(from)) && (piece + 1 == pieces || s <= invariant(to));
      if (!is_here) continue;
      extra_[i] = size();
      channels_.push_back({extra[i], kNoEtendue, true, extra[i].mu, extra[i].mu});
    }
    from = to;
  }
  for (const double n : indices_) {
    const auto beyond = std::find_if(channels_.begin(), channels_.end(),
                                     [&](const Channel& c) { return !(refracted(c.at, n) > 0); });
    counts_.push_back(int(beyond - channels_.begin()));
  }
}

int Channels::count(double index) const {
  const auto found = std::lower_bound(indices_.begin(), indices_.end(), index);
  if (found == indices_.end() || *found != index)
    throw std::logic_error("channels of an index that was not given");
  return counts_[found - indices_.begin()];
}

double Channels::mu(int channel, double index) const { return refracted(channels_[channel].at, index); }

Quadrature Channels::within(int channel, double index, int nodes) const {
  const Channel& c = channels_[channel];
  if (c.is_extra) return {{mu(channel, index)}, {1}};
  Quadrature q = gauss_legendre(nodes, c.most_grazing, c.steepest);
  double sum = 0;
  for (std::size_t i = 0; i < q.x.size(); ++i) sum += q.weight[i] *= q.x[i];
  for (std::size_t i = 0; i < q.x.size(); ++i) {
    q.weight[i] /= sum;
    q.x[i] = refracted({c.at.index, q.x[i]}, index);
  }
  return q;
}

double Channels::width(int channel, double index) const {
  const Channel& c = channels_[channel];
  return std::acos(refracted({c.at.index, c.most_grazing}, index)) -
         std::acos(std::min(1.0, refracted({c.at.index, c.steepest}, index)));
}

}  // namespace aureole::optics
