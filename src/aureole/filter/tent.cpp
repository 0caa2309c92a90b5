// SPDX-License-Identifier: Apache-2.0
// Tent (linear) filter.
#include <cmath>

#include "aureole/filter/filter.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class TentFilter final : public Filter {
public:
  explicit TentFilter(const Properties& p) : Filter(p), radius_(float(p.get_float("radius", 1, {0.6, 32}))) {}
  float radius() const override { return radius_; }
  float eval(float x) const override { return std::max(0.f, 1.f - std::abs(x) / radius_); }

private:
  float radius_;
};

AUREOLE_PLUGIN(TentFilter, "rfilter", "tent",
               PluginDoc{"Tent (linear) filter.",
                         "",
                         {{"radius", "float", "pixels", "1", "half width"}},
                         {R"(<rfilter type="tent"><float name="radius" value="1"/></rfilter>)"}});

}  // namespace
}  // namespace aureole
