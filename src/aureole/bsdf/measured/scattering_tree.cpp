// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/scattering_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/math/warp.h"

namespace aureole {
namespace {

/// Upper bound of the depth of a tree: 16 levels divide each axis into 65536 cells.
constexpr int kMaxTreeDepth = 16;
/// Upper bound of the cells for all incident directions, of 16 bytes each.
constexpr std::size_t kMaxTreeCells = std::size_t(1) << 24;

}  // namespace

/// A part of the tree for all incident directions of a cell: a node, or a part of its grid.
struct TensorTree::Item {
  std::uint32_t node;
  int remaining;  ///< log2 of the values along each axis of the part; 0: one value; -1: a branch
  std::array<std::uint32_t, 4> origin;
  float x, y, size;  ///< position and side of the part in the square of outgoing directions
};

TensorTree::TensorTree(const WindowBlock& block, int rank, WindowNotes& notes) : rank_(rank) {
  NumberReader reader(block.data, block.where);
  parse(reader, 0, notes);
  if (reader.peek()) throw reader.error("there is text after the end of the tree");
  incidents_.emplace_back();
  distribute(0, {{0, nodes_[0].grid_log2, {}, 0, 0, 1}}, block.where);
}

std::uint32_t TensorTree::parse(NumberReader& reader, int depth, WindowNotes& notes) {
  if (depth > kMaxTreeDepth)
    throw reader.error(fmt::format("the tree has more than {} levels", kMaxTreeDepth));
  reader.expect('{', "\"{\"");
  const std::uint32_t index = std::uint32_t(nodes_.size());
  nodes_.push_back({});
  if (reader.peek() == '{') {
    const std::size_t branches = std::size_t(1) << rank_, first = children_.size();
    children_.resize(first + branches);
    nodes_[index] = {-1, std::uint32_t(first)};
    for (std::size_t n = 0; n < branches; ++n) {
      const std::uint32_t child = parse(reader, depth + 1, notes);
      children_[first + n] = child;
    }
  } else {
    const std::size_t first = values_.size();
    while (reader.peek() != '}') {
      const double value = reader.number();
      if (value > 1e30) throw reader.error(fmt::format("{:g} is no scattering per steradian", value));
      if (value < 0) ++notes.negative;
      values_.push_back(float(std::max(value, 0.0)));
    }
    const std::size_t count = values_.size() - first;
    int log2 = 0;
    while (log2 < 8 && (std::size_t(1) << (rank_ * log2)) < count) ++log2;
    if ((std::size_t(1) << (rank_ * log2)) != count)
      throw reader.error(
          fmt::format("{} values in braces; 1, {}, {} and so on are expected in a tree of rank {}", count,
                      1 << rank_, 1 << 2 * rank_, rank_));
    if (depth + log2 > kMaxTreeDepth)
      throw reader.error(fmt::format("the tree has more than {} levels", kMaxTreeDepth));
    nodes_[index] = {log2, std::uint32_t(first)};
  }
  reader.expect('}', "\"}\"");
  return index;
}

void TensorTree::distribute(std::uint32_t into, const std::vector<Item>& items, const SourceLocation& where) {
  const auto value_of = [&](const Item& item) {
    const Node& node = nodes_[item.node];
    std::size_t at = 0;
    for (int axis = 0; axis < rank_; ++axis) at = (at << node.grid_log2) + item.origin[std::size_t(axis)];
    return double(values_[node.first + at]);
  };
  const bool is_constant =
      std::all_of(items.begin(), items.end(), [](const Item& i) { return i.remaining == 0; });
  if (is_constant) {
    if (cells_.size() + items.size() > kMaxTreeCells)
      throw Error(where,
                  fmt::format("the tree has more than {} cells of outgoing directions for all incident ones",
                              kMaxTreeCells));
    Incident& found = incidents_[into];
    found.first = std::uint32_t(cells_.size()), found.count = std::uint32_t(items.size());
    double power = 0;
    for (const Item& item : items) {
      power += value_of(item) * double(item.size) * double(item.size) * kPiD;
      cells_.push_back({item.x, item.y, item.size, float(power)});
    }
    found.power = float(power);
    return;
  }
  const int incident_axes = rank_ - 2, parts = 1 << incident_axes;
  const std::uint32_t first = std::uint32_t(incidents_.size());
  incidents_[into] = {first, 0, 0};
  incidents_.resize(incidents_.size() + std::size_t(parts));
  for (int part = 0; part < parts; ++part) {
    // Sines of the incident angle are at most one, which is the middle of the first axis.
    if (rank_ == 3 && into == 0 && part == 1) continue;
    std::vector<Item> below;
    for (const Item& item : items) {
      if (item.remaining == 0) {
        below.push_back(item);
        continue;
      }
      const Node& node = nodes_[item.node];
      for (int out = 0; out < 4; ++out) {
        const int n = part | out << incident_axes;
        Item child = item;
        child.size *= 0.5f;
        if (out & 1) child.x += child.size;
        if (out & 2) child.y += child.size;
        if (item.remaining < 0) {
          child.node = children_[node.first + std::uint32_t(n)];
          child.remaining = nodes_[child.node].grid_log2;
          child.origin = {};
        } else {
          child.remaining = item.remaining - 1;
          for (int axis = 0; axis < rank_; ++axis)
            if (n >> axis & 1) child.origin[std::size_t(axis)] += 1u << child.remaining;
        }
        below.push_back(child);
      }
      if (below.size() > kMaxTreeCells)
        throw Error(where,
                    fmt::format("the tree has more than {} cells of outgoing directions", kMaxTreeCells));
    }
    distribute(first + std::uint32_t(part), below, where);
  }
}

TensorTree::Position TensorTree::incident_position(const Vec3& i) const {
  Position p;
  if (rank_ == 3) {
    const float sine = std::min(std::sqrt(i.x * i.x + i.y * i.y), 1.f);
    p.x[0] = std::max(0.5f - 1e-6f - 0.5f * sine, 0.f);
    if (sine > 0) p.cos_phi = -i.x / sine, p.sin_phi = -i.y / sine;
  } else {
    const Vec2 s = disc_to_square_concentric({-i.x, -i.y});
    p.x[0] = s.x, p.x[1] = s.y;
  }
  return p;
}

float TensorTree::at(const Vec3& incident, const Vec3& outgoing) const {
  if (empty()) return 0;
  Position p = incident_position(incident);
  const Vec2 turned{outgoing.x * p.cos_phi + outgoing.y * p.sin_phi,
                    outgoing.y * p.cos_phi - outgoing.x * p.sin_phi};
  const Vec2 s = disc_to_square_concentric(turned);
  p.x[std::size_t(rank_) - 2] = s.x, p.x[std::size_t(rank_) - 1] = s.y;
  for (float& x : p.x) x = std::clamp(x, 0.f, kOneMinusEpsilon);
  const Node* node = nodes_.data();
  while (node->grid_log2 < 0) {
    std::uint32_t n = 0;
    for (int axis = 0; axis < rank_; ++axis) {
      float& x = p.x[std::size_t(axis)];
      x *= 2;
      if (x >= 1) x -= 1, n |= 1u << axis;
    }
    node = &nodes_[children_[node->first + n]];
  }
  std::size_t at = 0;
  const int side = 1 << node->grid_log2;
  for (int axis = 0; axis < rank_; ++axis)
    at = (at << node->grid_log2) + std::size_t(std::min(int(p.x[std::size_t(axis)] * float(side)), side - 1));
  return values_[node->first + at];
}

const TensorTree::Incident& TensorTree::incident_cell(const Position& position) const {
  float x = std::clamp(position.x[0], 0.f, kOneMinusEpsilon),
        y = std::clamp(position.x[1], 0.f, kOneMinusEpsilon);
  const Incident* cell = incidents_.data();
  while (cell->count == 0 && cell->first > 0) {
    x *= 2, y *= 2;
    const std::uint32_t right = x >= 1, upper = rank_ == 4 && y >= 1;
    x -= float(right), y -= y >= 1 ? 1.f : 0.f;
    cell = &incidents_[cell->first + right + 2 * upper];
  }
  return *cell;
}

float TensorTree::power(const Vec3& incident) const {
  return empty() ? 0.f : incident_cell(incident_position(incident)).power;
}

std::optional<Vec3> TensorTree::sample(const Vec3& incident, float u1, Vec2 u2) const {
  if (empty()) return {};
  const Position position = incident_position(incident);
  const Incident& chosen = incident_cell(position);
  if (!(chosen.power > 0)) return {};
  const auto begin = cells_.begin() + std::ptrdiff_t(chosen.first),
             end = begin + std::ptrdiff_t(chosen.count);
  auto cell =
      std::upper_bound(begin, end, u1 * chosen.power, [](float u, const Cell& c) { return u < c.cumulated; });
  // Rounding at the end of the list selects the last cell with power.
  if (cell == end)
    cell = std::lower_bound(begin, end, chosen.power, [](const Cell& c, float p) { return c.cumulated < p; });
  const DiscPoint d = square_to_disc_concentric({cell->x + cell->size * u2.x, cell->y + cell->size * u2.y});
  const float z = std::sqrt((1 - d.radius) * (1 + d.radius));
  return Vec3{d.p.x * position.cos_phi - d.p.y * position.sin_phi,
              d.p.y * position.cos_phi + d.p.x * position.sin_phi, z};
}

std::size_t TensorTree::bytes() const {
  return nodes_.size() * sizeof(Node) + children_.size() * 4 + values_.size() * 4 +
         incidents_.size() * sizeof(Incident) + cells_.size() * sizeof(Cell);
}

TensorTreeSheet read_tensor_tree_sheet(const WindowFile& file, WindowNotes& notes) {
  TensorTreeSheet sheet;
  const int rank = file.structure == WindowFile::Structure::tree3 ? 3 : 4;
  for (const WindowBlock& block : file.blocks) {
    if (block.channel != 1) continue;
    (block.is_transmission ? sheet.transmission : sheet.reflection)[block.is_front ? 1 : 0] =
        TensorTree(block, rank, notes);
  }
  notes.reversed_front = sheet.transmission[1].empty() && !sheet.transmission[0].empty();
  notes.reversed_back = sheet.transmission[0].empty() && !sheet.transmission[1].empty();
  return sheet;
}

}  // namespace aureole
