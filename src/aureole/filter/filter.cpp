// SPDX-License-Identifier: Apache-2.0
#include "aureole/filter/filter.h"

#include <cmath>

#include "aureole/plugin/registry.h"

namespace aureole {

FilterTable::FilterTable(const Filter& filter)
    : radius_(filter.radius()),
      scale_(float(kCells) / filter.radius()),
      border_(std::max(0, int(std::ceil(filter.radius() - 0.5f - 1e-4f)))),
      values_(kCells + 1) {
  for (int i = 0; i <= kCells; ++i) values_[size_t(i)] = filter.eval(radius_ * float(i) / kCells);
}

AUREOLE_FAMILY(FamilyInfo{.name = "rfilter", .fallback = "gaussian"});

}  // namespace aureole
