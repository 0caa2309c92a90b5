// SPDX-License-Identifier: Apache-2.0
// Scattering in trees of variable resolution (Radiance's tensor trees): G. Ward, M. Kurt and N. Bonneel, "A practical
// framework for sharing and rendering real-world bidirectional scattering distribution functions", LBNL report 5954E, 2012.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "aureole/bsdf/measured/klems_matrix.h"
#include "aureole/bsdf/measured/window_file.h"
#include "aureole/math/vec.h"

namespace aureole {

/// Scattering of light from one side of a surface to one side. The unit hypercube is divided into halves of all axes,
/// down to cells of constant f [1/sr]. The last two axes are the outgoing direction, projected onto the disc and mapped to
/// the square (Shirley and Chiu 1997). Rank 4: the first two axes are the opposite of the incident direction, likewise.
/// Rank 3: the first axis is (1 - sin theta_i) / 2, and outgoing azimuths are relative to the opposite of the incident one.
class TensorTree {
public:
  TensorTree() = default;
  /// Parses nested braces of 2^rank branches, or of (2^rank)^k values with the last axis fastest. Throws Error located at
  /// the line.
  TensorTree(const WindowBlock& block, int rank, WindowNotes& notes);

  bool empty() const { return nodes_.empty(); }
  int rank() const { return rank_; }
  /// f for two directions with positive z.
  float at(const Vec3& incident, const Vec3& outgoing) const;

  /// The fraction of light from `incident` that is scattered to this side.
  float power(const Vec3& incident) const;
  /// A direction with positive z, distributed as f cos(theta_o). Nothing if there is no power.
  std::optional<Vec3> sample(const Vec3& incident, float u1, Vec2 u2) const;
  std::size_t bytes() const;

private:
  struct Node {
    std::int32_t grid_log2;  ///< log2 of the number of values along each axis; -1: a branch
    std::uint32_t first;     ///< index of the first child in `children_`, or of the first value
  };
  /// A square of outgoing directions with constant f.
  struct Cell {
    /// corner and side of the square, and cumulated power of the cells up to this one, as a fraction of the
    /// power of all cells
    float x, y, size, cumulated;
  };
  /// Incident directions that share the outgoing cells, or that are divided further.
  struct Incident {
    /// index of the first cell and number of cells; count 0: `first` is the index of the first child
    std::uint32_t first = 0, count = 0;
    float power = 0;
  };
  struct Item;
  std::uint32_t parse(NumberReader& reader, int depth, WindowNotes& notes);
  void distribute(std::uint32_t into, const std::vector<Item>& items, const SourceLocation& where);
  struct Position {
    std::array<float, 4> x{};
    /// for rank 3, cosine and sine of the azimuth of the opposite of the incident direction
    float cos_phi = 1, sin_phi = 0;
  };
  Position incident_position(const Vec3& incident) const;
  const Incident& incident_cell(const Position& p) const;

  int rank_ = 0;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> children_;
  std::vector<float> values_;
  std::vector<Incident> incidents_;
  std::vector<Cell> cells_;
};

/// Tensor trees for both sides of a sheet. Index 0: light that arrives on the side of +z, as in KlemsSheet.
struct TensorTreeSheet {
  std::array<TensorTree, 2> reflection, transmission;
};
TensorTreeSheet read_tensor_tree_sheet(const WindowFile& file, WindowNotes& notes);

}  // namespace aureole
