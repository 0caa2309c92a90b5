// SPDX-License-Identifier: Apache-2.0
// Fields of view in blocks, the units of the bootstrap, and the points of the fields for estimators of g(r)
// and S(q). Used by microstructure.cpp only.
#pragma once

#include <functional>
#include <vector>

#include "aureole/instrument/microscopy/microstructure.h"
#include "aureole/instrument/microscopy/observation_window.h"

namespace aureole {

/// One block of a field, the unit of resampling in the bootstrap.
struct Block {
  double window = 0, covered = 0;  ///< area of the window, and covered area in it [m^2]
  double area = 0;                 ///< area of the eroded window [m^2]
  double centres = 0;
  std::vector<int> particles;  ///< uncut particles whose centre is in the block
};

struct FieldPool {
  std::vector<ObservationWindow> windows;
  std::vector<double> margin;  ///< margin of each field within which points are not used [pixels]
  std::vector<Block> blocks;
  std::vector<int> side, first;  ///< the blocks of a field: side^2 blocks starting at index `first`
};

/// Index of the block that contains a point of field f.
int block_of(const FieldPool& p, size_t f, double x, double y);

/// Reads, segments and measures all fields. Their particles and reports are added to `m`, their covered area
/// to the blocks.
void pool_fields(size_t count, const std::function<Micrograph(size_t)>& read,
                 const SegmentationOptions& options, const FieldVisitor& visit, Microstructure& m,
                 FieldPool& pool);

/// Centres of a field whose distance from excluded pixels is larger than the field's margin, in metres.
PointField point_field(const FieldPool& pool, const Microstructure& m, size_t f);

}  // namespace aureole
