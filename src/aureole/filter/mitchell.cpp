// SPDX-License-Identifier: Apache-2.0
// Mitchell-Netravali cubic filter.
#include <cmath>

#include "aureole/filter/filter.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class MitchellFilter final : public Filter {
public:
  explicit MitchellFilter(const Properties& p)
      : Filter(p),
        b_(float(p.get_float("B", 1.0 / 3, {-2, 2}))),
        c_(float(p.get_float("C", 1.0 / 3, {-2, 2}))) {}
  float radius() const override { return 2; }
  float eval(float x) const override {
    x = std::abs(x);
    if (x >= 2) return 0;
    if (x < 1)
      return ((12 - 9 * b_ - 6 * c_) * x * x * x + (-18 + 12 * b_ + 6 * c_) * x * x + (6 - 2 * b_)) / 6;
    return ((-b_ - 6 * c_) * x * x * x + (6 * b_ + 30 * c_) * x * x + (-12 * b_ - 48 * c_) * x +
            (8 * b_ + 24 * c_)) /
           6;
  }

private:
  float b_, c_;
};

AUREOLE_PLUGIN(
    MitchellFilter, "rfilter", "mitchell",
    PluginDoc{
        "Mitchell-Netravali cubic filter.",
        "Mitchell & Netravali 1988, \"Reconstruction filters in computer graphics\", Eq. 8.",
        {{"B", "float", "", "1/3", "blur"}, {"C", "float", "", "1/3", "ringing"}},
        {R"(<rfilter type="mitchell"><float name="B" value="0.3333"/><float name="C" value="0.3333"/></rfilter>)"}});

}  // namespace
}  // namespace aureole
