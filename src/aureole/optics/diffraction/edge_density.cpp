// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/edge_density.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace aureole::optics {

EdgeDensity::EdgeDensity(std::span<const DiffractingEdge> edges, ZerothOrder zeroth, std::span<Share> shares)
    : edges_(edges), zeroth_(zeroth), shares_(shares) {
  if (edges.size() != shares.size()) throw std::logic_error("EdgeDensity needs one share per edge");
  double running = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    shares[i].power = edge_power(edges[i], zeroth);
    shares[i].running = running += shares[i].power.total();
  }
  if (!(running < INFINITY))
    throw std::domain_error(
        "density of diffracted directions: the power of an edge is not finite, remove the 0th order");
}

double EdgeDensity::pdf(PlanePoint q) const {
  const double q2 = q.x * q.x + q.y * q.y;
  double sum = 0;
  for (const DiffractingEdge& edge : edges_) {
    const PlanePoint e = edge.vector();
    const double along = q.x * e.x + q.y * e.y, across = q.x * e.y - q.y * e.x,
                 length2 = e.x * e.x + e.y * e.y;
    const double alpha1 = edge_alpha1(along, across), alpha2 = edge_alpha2(along, across);
    sum += length2 * length2 * zeroth_.remainder(q2, std::sqrt(length2)) *
           (std::norm(edge.a - edge.b) * alpha1 * alpha1 + std::norm(edge.mean()) * alpha2 * alpha2);
  }
  return total() > 0 && q2 > 0 ? sum / total() : 0;
}

double sampling_quality(double diffracted_power, std::span<const DiffractingEdge> edges, ZerothOrder zeroth) {
  double sum = 0;
  for (const DiffractingEdge& e : edges) sum += edge_power(e, zeroth).total();
  return diffracted_power / sum;
}

std::vector<DiffractingEdge> balanced_edges(std::span<const DiffractingEdge> edges, ZerothOrder zeroth,
                                            double diffracted_power, std::size_t most_edges) {
  std::vector<DiffractingEdge> all(edges.begin(), edges.end());
  const auto power = [&](const DiffractingEdge& e) { return edge_power(e, zeroth).total(); };
  double sum = 0;
  for (const DiffractingEdge& e : all) sum += power(e);
  const auto is_shorter = [](const DiffractingEdge& x, const DiffractingEdge& y) {
    return x.length() < y.length();
  };

  while (diffracted_power < 0.5 * sum && all.size() < most_edges) {
    const auto longest = std::max_element(all.begin(), all.end(), is_shorter);
    const double before = power(*longest);
    const auto [first, second] = split(*longest);
    const double after = power(first) + power(second);
    if (!(after < before)) break;
    sum += after - before;
    *longest = first;
    all.insert(longest + 1, second);
  }
  const auto follows = [](const DiffractingEdge& x, const DiffractingEdge& y) {
    return x.to.x == y.from.x && x.to.y == y.from.y;
  };
  // The two edges of a closed chain stay, since their join would have no length.
  const auto may_join = [&](std::size_t i, std::size_t j) {
    return i != j && follows(all[i], all[j]) && !follows(all[j], all[i]);
  };
  while (diffracted_power > 2 * sum) {
    // The shortest edge that has a neighbour, and the shorter one of its neighbours.
    std::size_t best_first = all.size(), best_second = all.size();
    double shortest = INFINITY, together = INFINITY;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::size_t j = (i + 1) % all.size();
      if (!may_join(i, j)) continue;
      const double least = std::min(all[i].length(), all[j].length()),
                   both = all[i].length() + all[j].length();
      if (least < shortest || (least == shortest && both < together))
        best_first = i, best_second = j, shortest = least, together = both;
    }
    if (best_first == all.size()) break;
    const DiffractingEdge joined = join(all[best_first], all[best_second]);
    sum += power(joined) - power(all[best_first]) - power(all[best_second]);
    all[best_first] = joined;
    all.erase(all.begin() + std::ptrdiff_t(best_second));
  }
  return all;
}

}  // namespace aureole::optics
