// SPDX-License-Identifier: Apache-2.0
// Fields of view in blocks, the units of the bootstrap, and the points that estimators of g(r) and S(q) see
// of them. For microstructure.cpp alone.
#pragma once

#include <functional>
#include <vector>

#include "aureole/instrument/microscopy/microstructure.h"
#include "aureole/instrument/microscopy/observation_window.h"

namespace aureole {

/// One block of a field, the unit that the bootstrap draws.
struct Block {
  double window = 0, covered = 0;  ///< m^2
  double area = 0;                 ///< of the eroded window, m^2
  double centres = 0;
  std::vector<int> particles;  ///< whole ones with their centre here
};

struct FieldPool {
  std::vector<ObservationWindow> windows;
  std::vector<double> margin;  ///< pixels
  std::vector<Block> blocks;
  std::vector<int> side, first;  ///< blocks of a field: side^2 from first
};

/// The block of a point of field f.
int block_of(const FieldPool& p, size_t f, double x, double y);

/// Reads, segments and measures all fields: their particles and reports go into `m`, the area they cover
/// into blocks.
void pool_fields(size_t count, const std::function<Micrograph(size_t)>& read,
                 const SegmentationOptions& options, const FieldVisitor& visit, Microstructure& m,
                 FieldPool& pool);

/// Centres of a field farther than its margin from pixels that do not count, in metres.
PointField point_field(const FieldPool& pool, const Microstructure& m, size_t f);

}  // namespace aureole
