// SPDX-License-Identifier: Apache-2.0
// Box filter over one pixel: every sample contributes only to its own pixel.
#include <cmath>

#include "aureole/filter/filter.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class BoxFilter final : public Filter {
public:
  explicit BoxFilter(const Properties& p) : Filter(p) {}
  float radius() const override { return 0.5f; }
  float eval(float x) const override { return std::abs(x) <= 0.5f ? 1.f : 0.f; }
};

AUREOLE_PLUGIN(BoxFilter, "rfilter", "box",
               PluginDoc{"Box over one pixel: every sample contributes only to its own pixel.",
                         "",
                         {},
                         {R"(<rfilter type="box"/>)"}});

}  // namespace
}  // namespace aureole
