// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/pair_statistics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

using FloatLanes [[gnu::vector_size(32)]] = float;
// numbers of discs that are summed at once
constexpr int kFloatLanes = 8, kGroups = 4, kBlock = kFloatLanes * kGroups;

/// Computes cos and sin of k angle for k = 0..largest, [k][2][kBlock]; 0 in lanes without a disc.
void phase_powers(const double* angle, int used, int largest, float* out) {
  double c1[kBlock] = {}, s1[kBlock] = {}, c[kBlock] = {}, s[kBlock] = {};
  for (int i = 0; i < used; ++i) c1[i] = std::cos(angle[i]), s1[i] = std::sin(angle[i]), c[i] = 1;
  for (int k = 0; k <= largest; ++k, out += 2 * kBlock)
    for (int i = 0; i < kBlock; ++i) {
      out[i] = float(c[i]), out[kBlock + i] = float(s[i]);
      const double next = c[i] * c1[i] - s[i] * s1[i];
      s[i] = s[i] * c1[i] + c[i] * s1[i], c[i] = next;
    }
}

double sum_lanes(const FloatLanes& v) {
  return (double(v[0]) + v[4]) + (double(v[1]) + v[5]) + (double(v[2]) + v[6]) + (double(v[3]) + v[7]);
}

}  // namespace

RingStructureFactor::RingStructureFactor(double box_x, double box_y, const std::vector<double>& edges,
                                         int per_ring, DiscClasses class_of)
    : box_x_(box_x), box_y_(box_y), class_of_(std::move(class_of)) {
  if (!(box_x > 0 && box_y > 0) || edges.size() < 2 || !(edges[0] >= 0) || per_ring < 1 ||
      !std::is_sorted(edges.begin(), edges.end()))
    throw std::domain_error("rings of wave vectors need a box, increasing edges and at least one vector");
  for (const int c : class_of_) {
    if (c < 0) throw std::domain_error("classes of discs are counted from 0");
    classes_ = std::max(classes_, c + 1);
  }
  const double dx = 2 * kPi / box_x, dy = 2 * kPi / box_y;
  if (!(edges.back() / std::min(dx, dy) <= 4096))
    throw std::domain_error("rings of wave vectors end at 4096 waves per side of the box");
  struct Candidate {
    int ring, kx, ky;
    double q;
  };
  std::vector<Candidate> found;
  for (int kx = 0; kx * dx <= edges.back(); ++kx)
    for (int ky = 0; std::hypot(kx * dx, ky * dy) <= edges.back(); ++ky) {
      const double q = std::hypot(kx * dx, ky * dy);
      const auto edge = std::upper_bound(edges.begin(), edges.end(), q);
      if (edge == edges.begin() || edge == edges.end() || kx + ky == 0) continue;
      found.push_back({int(edge - edges.begin()) - 1, kx, ky, q});
    }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.ring < b.ring; });
  const size_t wanted = size_t(per_ring + 1) / 2;  // each pair of vectors counts for two
  for (size_t begin = 0, end; begin < found.size(); begin = end) {
    for (end = begin; end < found.size() && found[end].ring == found[begin].ring;) ++end;
    std::vector<Candidate> ring(found.begin() + std::ptrdiff_t(begin), found.begin() + std::ptrdiff_t(end));
    if (ring.size() > wanted) {
      // Among the 2 `wanted` vectors nearest the ring's middle, every other one is kept, in the order of
      // directions.
      const double middle = 0.5 * (edges[ring[0].ring] + edges[size_t(ring[0].ring) + 1]);
      std::stable_sort(ring.begin(), ring.end(), [&](const Candidate& a, const Candidate& b) {
        return std::abs(a.q - middle) < std::abs(b.q - middle);
      });
      ring.resize(std::min(ring.size(), 2 * wanted));
      std::stable_sort(ring.begin(), ring.end(), [&](const Candidate& a, const Candidate& b) {
        return std::atan2(a.ky * dy, a.kx * dx) < std::atan2(b.ky * dy, b.kx * dx);
      });
      for (size_t i = 0; i < wanted; ++i) ring[i] = ring[i * ring.size() / wanted];
      ring.resize(wanted);
    }
    Ring r;
    r.first = int(pairs_.size());
    for (const Candidate& c : ring) {
      const int n = c.kx > 0 && c.ky > 0 ? 2 : 1;
      r.q += n * c.q, r.vectors += n;
      pairs_.push_back({c.kx, c.ky});
      largest_kx_ = std::max(largest_kx_, c.kx), largest_ky_ = std::max(largest_ky_, c.ky);
    }
    r.q /= r.vectors;
    r.last = int(pairs_.size());
    if (classes_ > 1) r.partial.resize(size_t(classes_ * (classes_ + 1) / 2));
    rings_.push_back(std::move(r));
  }
  class_count_.assign(size_t(classes_), 0);
  for (const int c : class_of_) class_count_[c] += 1;
  sums_.resize(pairs_.size() * size_t(classes_) * 4);
  powers_.resize(size_t(largest_kx_ + largest_ky_ + 2) * 2 * kBlock);
}

void RingStructureFactor::sum_waves(const HardDiscs& discs) {
  const int n = discs.size();
  std::fill(sums_.begin(), sums_.end(), 0.0);
  float* const px = powers_.data();
  float* const py = px + size_t(largest_kx_ + 1) * 2 * kBlock;
  std::vector<int> order;
  for (int m = 0; m < classes_; ++m) {
    order.clear();
    for (int i = 0; i < n; ++i)
      if (class_of_.empty() || class_of_[i] == m) order.push_back(i);
    for (size_t start = 0; start < order.size(); start += kBlock) {
      const int used = int(std::min<size_t>(kBlock, order.size() - start));
      double ax[kBlock], ay[kBlock];
      for (int i = 0; i < used; ++i) {
        const size_t j = size_t(order[start + size_t(i)]);
        ax[i] = 2 * kPi / box_x_ * discs.x[j], ay[i] = 2 * kPi / box_y_ * discs.y[j];
      }
      phase_powers(ax, used, largest_kx_, px);
      phase_powers(ay, used, largest_ky_, py);
      double* sum = &sums_[size_t(m) * 4];
      for (const VectorPair& v : pairs_) {
        const float* x = px + size_t(v.kx) * 2 * kBlock;
        const float* y = py + size_t(v.ky) * 2 * kBlock;
        FloatLanes cc{}, ss{}, cs{}, sc{};
        for (int g = 0; g < kGroups; ++g) {
          FloatLanes xc, xs, yc, ys;
          __builtin_memcpy(&xc, x + g * kFloatLanes, sizeof xc);
          __builtin_memcpy(&xs, x + kBlock + g * kFloatLanes, sizeof xs);
          __builtin_memcpy(&yc, y + g * kFloatLanes, sizeof yc);
          __builtin_memcpy(&ys, y + kBlock + g * kFloatLanes, sizeof ys);
          cc += xc * yc, ss += xs * ys, cs += xc * ys, sc += xs * yc;
        }
        sum[0] += sum_lanes(cc), sum[1] += sum_lanes(ss), sum[2] += sum_lanes(cs), sum[3] += sum_lanes(sc);
        sum += size_t(classes_) * 4;
      }
    }
  }
}

void RingStructureFactor::add(const HardDiscs& discs) {
  // The box sides may differ by rounding.
  if (!(std::abs(discs.box_x / box_x_ - 1) < 1e-9 && std::abs(discs.box_y / box_y_ - 1) < 1e-9) ||
      (!class_of_.empty() && int(class_of_.size()) != discs.size()))
    throw std::domain_error("snapshots must have the box and the discs that the rings were made for");
  if (class_of_.empty()) class_count_[0] = discs.size();
  sum_waves(discs);
  std::vector<double> re(static_cast<size_t>(classes_)), im(re), mean;
  for (Ring& ring : rings_) {
    double total = 0;
    mean.assign(ring.partial.size(), 0);
    for (int p = ring.first; p < ring.last; ++p) {
      const bool two = pairs_[p].kx > 0 && pairs_[p].ky > 0;
      for (int sign = 1; sign >= (two ? -1 : 1); sign -= 2) {
        double all_re = 0, all_im = 0;
        for (int m = 0; m < classes_; ++m) {
          const double* s = &sums_[(size_t(p) * size_t(classes_) + size_t(m)) * 4];
          re[m] = s[0] - sign * s[1], im[m] = s[3] + sign * s[2];
          all_re += re[m], all_im += im[m];
        }
        total += all_re * all_re + all_im * all_im;
        if (classes_ == 1) continue;
        for (size_t m = 0, k = 0; m < re.size(); ++m)
          for (size_t l = m; l < re.size(); ++l, ++k) mean[k] += re[m] * re[l] + im[m] * im[l];
      }
    }
    ring.total.add(total / (ring.vectors * double(discs.size())));
    for (size_t m = 0, k = 0; k < mean.size(); ++m)
      for (size_t l = m; l < re.size(); ++l, ++k)
        ring.partial[k].add(mean[k] /
                            (ring.vectors * std::sqrt(std::max(1.0, class_count_[m] * class_count_[l]))));
  }
}

void RingStructureFactor::merge(const RingStructureFactor& other) {
  if (other.rings() != rings() || other.classes_ != classes_)
    throw std::domain_error("only statistics of the same rings and classes can be merged");
  for (size_t r = 0; r < rings_.size(); ++r) {
    rings_[r].total.merge(other.rings_[r].total);
    for (size_t k = 0; k < rings_[r].partial.size(); ++k)
      rings_[r].partial[k].merge(other.rings_[r].partial[k]);
  }
}

const BlockAverage& RingStructureFactor::partial(int ring, int m, int l) const {
  const Ring& r = rings_[ring];
  if (classes_ == 1) return r.total;
  if (m > l) std::swap(m, l);
  return r.partial[m * classes_ - m * (m - 1) / 2 + (l - m)];
}

PairHistogram::PairHistogram(double r_max, int bins)
    : r_max_(r_max), width_(r_max / bins), g_(size_t(std::max(bins, 0))) {
  if (!(r_max > 0 && bins > 0)) throw std::domain_error("a histogram of pairs needs a range and bins");
}

void PairHistogram::add(const HardDiscs& discs) {
  if (!(r_max_ <= 0.5 * std::min(discs.box_x, discs.box_y)))
    throw std::domain_error("g(r) of a periodic box is known up to half of its side only");
  const size_t n = size_t(discs.size());
  std::vector<double> pairs(g_.size(), 0.0);
  const double half_x = 0.5 * discs.box_x, half_y = 0.5 * discs.box_y;
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < i; ++j) {
      double x = std::abs(discs.x[i] - discs.x[j]), y = std::abs(discs.y[i] - discs.y[j]);
      if (x > half_x) x = discs.box_x - x;
      if (y > half_y) y = discs.box_y - y;
      const double squared = x * x + y * y;
      if (squared >= r_max_ * r_max_) continue;
      pairs[std::min(size_t(std::sqrt(squared) / width_), g_.size() - 1)] += 2;
    }
  for (size_t b = 0; b < g_.size(); ++b) {
    const double ring = kPi * width_ * width_ * (2 * double(b) + 1);
    const double expected = double(n) * double(n - 1) * ring / (discs.box_x * discs.box_y);
    g_[b].add(pairs[b] / expected);
  }
}

void PairHistogram::merge(const PairHistogram& other) {
  if (other.g_.size() != g_.size() || other.r_max_ != r_max_)
    throw std::domain_error("only histograms of the same bins can be merged");
  for (size_t b = 0; b < g_.size(); ++b) g_[b].merge(other.g_[b]);
}

}  // namespace aureole::optics
