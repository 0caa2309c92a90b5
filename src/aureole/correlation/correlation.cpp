// SPDX-License-Identifier: Apache-2.0
#include "aureole/correlation/correlation.h"

#include <algorithm>
#include <cmath>

namespace aureole {

std::vector<double> Correlation::nodes(double least, double most) const {
  constexpr double kStep = 1.0 / 32;
  const int cells = std::max(1, int(std::ceil((most - least) / kStep)));
  std::vector<double> nodes;
  for (int i = 0; i <= cells; ++i) nodes.push_back(least + (most - least) * i / cells);
  return nodes;
}

}  // namespace aureole
