// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/spectral_nodes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aureole {

SpectralNodes::SpectralNodes(const SpectralGrid& grid, std::span<const float> nm) {
  const auto not_above = [&](double x) {
    const auto above = std::upper_bound(nm.begin(), nm.end(), float(x)) - nm.begin();
    return above > 0 ? std::size_t(above) - 1 : std::size_t(0);
  };
  first_ = not_above(grid.min_nm);
  std::size_t last = std::size_t(std::lower_bound(nm.begin(), nm.end(), float(grid.max_nm)) - nm.begin());
  last = std::min(last, nm.size() - 1);
  nm_.assign(nm.begin() + std::ptrdiff_t(first_), nm.begin() + std::ptrdiff_t(last) + 1);
  is_single_ = nm_.size() == 1;
  if (is_single_) nm_.push_back(nm_[0] + 1);
  for (std::size_t i = 0; i + 1 < nm_.size(); ++i) inverse_step_.push_back(1 / (nm_[i + 1] - nm_[i]));
  const double step = (double(nm_.back()) - double(nm_.front())) / double(nm_.size() - 1);
  is_even_ = true;
  for (std::size_t i = 0; i < nm_.size(); ++i)
    is_even_ &= std::abs(double(nm_[i]) - double(nm_[0]) - step * double(i)) < 5e-7 * double(nm_.back());
  if (is_even_) inverse_step_[0] = float(1 / step);
  for (int c = 0; c < grid.cells; ++c) {
    const auto above = std::upper_bound(nm_.begin(), nm_.end() - 1, float(grid.node(c))) - nm_.begin();
    const std::size_t below = above > 0 ? std::size_t(above) - 1 : 0;
    guess_.push_back(std::int32_t(below));
    bound_.push_back(below + 2 < nm_.size() ? nm_[below + 1] : std::numeric_limits<float>::infinity());
    cells_hold_several_ |= below + 3 < nm_.size() && double(nm_[below + 2]) <= grid.node(c + 1);
  }
}

}  // namespace aureole
