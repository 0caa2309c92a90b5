// SPDX-License-Identifier: Apache-2.0
// The reconstruction filter family: separable, symmetric kernels over the pixel grid.
#pragma once

#include <vector>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

class Filter : public Object {
public:
  static constexpr const char* kFamily = "a reconstruction filter";
  using Object::Object;
  virtual float radius() const = 0;  ///< radius of the support [-radius, radius], in pixels
  /// value of the kernel, which is not normalised; the film divides by the sum of weights
  virtual float eval(float x) const = 0;
};

/// A filter tabulated finely over [0, radius] and interpolated linearly (error below 1e-5 of the peak; a box
/// is exact).
class FilterTable {
public:
  static constexpr int kMaxReach = 65;  ///< width in pixels of the widest filter that a job accepts, radius
                                        ///< 32
  explicit FilterTable(const Filter& filter);
  float radius() const { return radius_; }
  /// Number of pixels on each side, besides the sample's own pixel, that the support reaches.
  int border() const { return border_; }
  bool is_box() const { return border_ == 0; }
  float eval(float x) const {
    const float t = std::abs(x) * scale_;
    const int i = int(t);
    if (i >= kCells) return 0;
    return values_[size_t(i)] + (values_[size_t(i) + 1] - values_[size_t(i)]) * (t - float(i));
  }

private:
  static constexpr int kCells = 2048;
  float radius_, scale_;
  int border_;
  std::vector<float> values_;
};

}  // namespace aureole
