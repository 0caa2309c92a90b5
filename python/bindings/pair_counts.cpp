// SPDX-License-Identifier: Apache-2.0
#include "pair_counts.h"

#include <cmath>
#include <vector>

namespace aureole::python {
namespace {

struct Point {
  double x, y;
};

/// Points in the order of cells that are wide enough for neighbours to be in adjacent ones.
class CellList {
public:
  CellList(const std::vector<Point>& points, Point box, double reach, bool periodic) : periodic_(periodic) {
    // Not many more cells than points.
    const double most = std::ceil(std::sqrt(double(points.size())));
    columns_ = int(std::clamp(std::floor(box.x / reach), 1.0, most));
    rows_ = int(std::clamp(std::floor(box.y / reach), 1.0, most));
    scale_ = {columns_ / box.x, rows_ / box.y};
    start_.assign(std::size_t(columns_) * rows_ + 1, 0);
    for (const Point& p : points) ++start_[cell(p) + 1];
    for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    sorted_.resize(points.size());
    for (const Point& p : points) sorted_[next[cell(p)]++] = p;
  }

  const std::vector<Point>& points() const { return sorted_; }

  /// Calls visit(j) for all points that may be near to p, each once.
  template <class Visit>
  void near(const Point& p, const Visit& visit) const {
    int xs[3], ys[3];
    const int nx = adjacent(column(p), columns_, xs), ny = adjacent(row(p), rows_, ys);
    for (int b = 0; b < ny; ++b)
      for (int a = 0; a < nx; ++a) {
        const std::size_t c = std::size_t(ys[b]) * columns_ + xs[a];
        for (std::size_t j = start_[c]; j < start_[c + 1]; ++j) visit(j);
      }
  }

private:
  int column(const Point& p) const { return std::clamp(int(p.x * scale_.x), 0, columns_ - 1); }
  int row(const Point& p) const { return std::clamp(int(p.y * scale_.y), 0, rows_ - 1); }
  std::size_t cell(const Point& p) const { return std::size_t(row(p)) * columns_ + column(p); }
  int adjacent(int at, int count, int* found) const {
    int n = 0;
    for (int k = at - 1; k <= at + 1; ++k) {
      if (!periodic_ && (k < 0 || k >= count)) continue;
      const int wrapped = (k + count) % count;
      // With one or two cells along a side, neighbours coincide.
      if (std::find(found, found + n, wrapped) == found + n) found[n++] = wrapped;
    }
    return n;
  }

  bool periodic_;
  int columns_, rows_;
  Point scale_;
  std::vector<std::size_t> start_;
  std::vector<Point> sorted_;
};

}  // namespace

void count_pairs(const Array<const double, 2>& positions, double box_x, double box_y, bool periodic,
                 const Reals& edges, int tiles, const Array<double, 2>& result) {
  const std::size_t n = positions.shape(0), bins = result.shape(1);
  require_size(positions.shape(1) == 2 && edges.size() == bins + 1 && tiles > 0 && tiles < 1000 && bins > 0 &&
                   result.shape(0) == std::size_t(tiles) * tiles && box_x > 0 && box_y > 0,
               "count_pairs");
  const double* const edge = edges.data();
  const double *const last = edge + bins, reach = *last;
  require_size(reach > 0 && reach <= 0.5 * std::min(box_x, box_y) * (1 + 1e-9), "count_pairs");
  std::vector<Point> points(n);
  for (std::size_t i = 0; i < n; ++i) points[i] = {positions.data()[2 * i], positions.data()[2 * i + 1]};
  const CellList cells(points, {box_x, box_y}, reach, periodic);
  const std::vector<Point>& p = cells.points();

  // Tasks are runs of points, short enough for signals to be seen. Each of a batch adds to sums of its own,
  // so that results do not depend on the threads.
  const double near = std::min(1.0, 9 * reach * reach / (box_x * box_y)) * double(n);
  const std::size_t run = std::size_t(std::clamp(3e5 / near, 1.0, 1e4)), tasks = (n + run - 1) / run;
  const std::size_t parts = std::size_t(tiles) * tiles, batch = kPairCountBatch;
  std::vector<double> sums(std::min(batch, tasks) * parts * bins, 0.0);
  const auto tile = [tiles](double at, double side) {
    return std::clamp(int(at / side * tiles), 0, tiles - 1);
  };
  SignalCheck signals;
  for (std::size_t first = 0; first < tasks; first += batch) {
    const auto work = [&](std::size_t k) {
      double* const sum = &sums[k * parts * bins];
      const std::size_t begin = (first + k) * run;
      for (std::size_t i = begin; i < std::min(n, begin + run); ++i) {
        const std::size_t part = std::size_t(tile(p[i].y, box_y)) * tiles + tile(p[i].x, box_x);
        cells.near(p[i], [&](std::size_t j) {
          double dx = std::abs(p[i].x - p[j].x), dy = std::abs(p[i].y - p[j].y);
          if (periodic) dx = std::min(dx, box_x - dx), dy = std::min(dy, box_y - dy);
          const double squared = dx * dx + dy * dy;
          if (i == j || squared >= reach * reach) return;
          const double* const above = std::upper_bound(edge, last, std::sqrt(squared));
          if (above == edge) return;
          const double place = periodic ? box_x * box_y : (box_x - dx) * (box_y - dy);
          sum[part * bins + std::size_t(above - edge) - 1] += 1 / place;
        });
      }
    };
    for_each(std::min(batch, tasks - first), work, signals);
  }
  std::fill(result.data(), result.data() + parts * bins, 0.0);
  for (std::size_t k = 0; k < sums.size(); ++k) result.data()[k % (parts * bins)] += sums[k];
}

}  // namespace aureole::python
