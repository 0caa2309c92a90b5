// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/measured/tensor_tree_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/instrument/measured/sheet_estimate.h"
#include "aureole/math/warp.h"

namespace aureole {
namespace {

constexpr std::size_t kMaxWrittenCells = std::size_t(1) << 24;

/// A direction with z >= 0 of a point of the square (Shirley and Chiu 1997); equal areas have equal projected solid angles.
Vec3 direction_of_square(Vec2 u) {
  const DiscPoint d = square_to_disc_concentric(u);
  return {d.p.x, d.p.y, std::sqrt((1 - d.radius) * (1 + d.radius))};
}

/// A grid of `side` x `side` cells of the square of directions; cell x side + y.
DirectionPatches square_patches(int side) {
  const auto index = [side](float x) { return std::size_t(std::clamp(int(x * float(side)), 0, side - 1)); };
  return {std::size_t(side) * std::size_t(side),
          [side](std::size_t k, Vec2 u) {
            const int x = int(k) / side, y = int(k) % side;
            return direction_of_square({(float(x) + u.x) / float(side), (float(y) + u.y) / float(side)});
          },
          [side, index](const Vec3& d) {
            const Vec2 u = disc_to_square_concentric({d.x, d.y});
            return index(u.x) * std::size_t(side) + index(u.y);
          },
          [side](std::size_t) { return kPiD / (double(side) * double(side)); }};
}

/// Angles of incidence by (1 - sin theta) / 2 below 1/2, in `side` / 2 cells. The light comes from azimuth 180 degrees, so that
/// outgoing azimuths count from its continuation.
DirectionPatches polar_patches(int side) {
  return {std::size_t(side / 2),
          [side](std::size_t k, Vec2 u) {
            const float sine = 1 - 2 * (float(k) + u.x) / float(side);
            return Vec3{sine, 0, std::sqrt(std::max(0.f, (1 - sine) * (1 + sine)))};
          },
          [](const Vec3&) { return std::size_t(0); }, [](std::size_t) { return 1.0; }};
}

/// Values on the finest grid, merged into a tree.
class TreeText {
public:
  TreeText(const std::vector<double>& f, int rank, int levels, double tolerance)
      : f_(f), rank_(rank), levels_(levels), tolerance_(tolerance) {
    double sum = 0;
    for (const double v : f) sum += v;
    // Differences count relative to a cell's mean, but not below a hundredth of the mean of all.
    least_ = std::max(0.01 * sum / double(f.size()), 1e-7);
  }
  std::string text() const { return node({}, 0).first; }

private:
  using Corner = std::array<int, 4>;

  double value(const Corner& c) const {
    const int side = 1 << levels_;
    // The upper half of the first axis of rank 3 holds no directions.
    if (rank_ == 3 && c[0] >= side / 2) return 0;
    std::size_t at = 0;
    for (int axis = 0; axis < rank_; ++axis) at = at * std::size_t(side) + std::size_t(c[std::size_t(axis)]);
    return f_[at];
  }

  struct Range {
    double low, high, sum;
  };
  /// The text of a node and, where it has one value, its range; the corner is in cells of the finest grid.
  std::pair<std::string, std::optional<Range>> node(const Corner& corner, int depth) const {
    if (depth == levels_) {
      const double v = value(corner);
      return {leaf(v), Range{v, v, v}};
    }
    const int half = 1 << (levels_ - depth - 1), branches = 1 << rank_;
    std::vector<std::string> texts;
    std::vector<std::optional<Range>> ranges;
    for (int n = 0; n < branches; ++n) {
      Corner c = corner;
      for (int axis = 0; axis < rank_; ++axis)
        if (n >> axis & 1) c[std::size_t(axis)] += half;
      auto [text, range] = node(c, depth + 1);
      texts.push_back(std::move(text)), ranges.push_back(range);
    }
    const bool are_leaves =
        std::all_of(ranges.begin(), ranges.end(), [](const auto& r) { return r.has_value(); });
    if (are_leaves) {
      Range all{INFINITY, 0, 0};
      for (const auto& r : ranges)
        all.low = std::min(all.low, r->low), all.high = std::max(all.high, r->high), all.sum += r->sum;
      const double cells = std::pow(2.0, rank_ * (levels_ - depth)), mean = all.sum / cells;
      if (all.high - all.low <= tolerance_ * std::max(mean, least_)) return {leaf(mean), all};
    }
    std::string text = std::string(std::size_t(depth), ' ') + "{\n";
    for (const std::string& t : texts) text += t;
    return {text + std::string(std::size_t(depth), ' ') + "}\n", std::nullopt};
  }
  static std::string leaf(double v) { return fmt::format("{{ {:.4g} }}\n", v); }

  const std::vector<double>& f_;
  int rank_, levels_;
  double tolerance_, least_;
};

}  // namespace

std::string tensor_tree_file_content(const ScatteringProbe& probe, const TensorTreeSettings& s) {
  const int rank = s.is_isotropic ? 3 : 4, side = 1 << s.levels;
  const std::size_t cells = std::size_t(1) << (rank * s.levels - (s.is_isotropic ? 1 : 0));
  if (s.levels < 1 || cells > kMaxWrittenCells)
    throw Error(
        fmt::format("a tree of rank {} with {} cells along each axis has {} cells: at most {} are written",
                    rank, side, cells, kMaxWrittenCells));
  const DirectionPatches incident = s.is_isotropic ? polar_patches(side) : square_patches(side),
                         outgoing = square_patches(side);
  // Directions for each pair of cells: more of them in large cells, within which the scattering changes.
  const std::size_t pairs = incident.count * outgoing.count;
  const int even = int(std::clamp<std::size_t>((std::size_t(1) << 23) / pairs, 4, 64));
  const SheetScattering found =
      estimate_sheet(probe, incident, outgoing, s.samples, even, true, s.is_reciprocal);
  std::string text = window_file_head(
      s.name, s.manufacturer,
      fmt::format("\t\t<IncidentDataStructure>TensorTree{}</IncidentDataStructure>\n", rank));
  const std::string basis = "\t\t\t<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n";
  const auto add = [&](const char* direction, const char* kind, std::size_t k) {
    text +=
        window_file_block(basis, direction, kind, TreeText(found.f[k], rank, s.levels, s.tolerance).text());
  };
  add("Transmission Front", "BTDF", 3), add("Transmission Back", "BTDF", 1);
  add("Reflection Front", "BRDF", 2), add("Reflection Back", "BRDF", 0);
  return text + kWindowFileEnd;
}

}  // namespace aureole
