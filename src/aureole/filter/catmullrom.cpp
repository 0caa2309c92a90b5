// SPDX-License-Identifier: Apache-2.0
// Catmull-Rom cubic filter: sharp, with negative lobes.
#include <cmath>

#include "aureole/filter/filter.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class CatmullRomFilter final : public Filter {
public:
  explicit CatmullRomFilter(const Properties& p) : Filter(p) {}
  float radius() const override { return 2; }
  float eval(float x) const override {
    x = std::abs(x);
    if (x >= 2) return 0;
    if (x < 1) return (1.5f * x - 2.5f) * x * x + 1;
    return ((-0.5f * x + 2.5f) * x - 4) * x + 2;
  }
};

AUREOLE_PLUGIN(CatmullRomFilter, "rfilter", "catmullrom",
               PluginDoc{
                   "Catmull-Rom cubic filter: sharp, with negative lobes.",
                   "Catmull & Rom 1974; the cubic family of Mitchell & Netravali 1988 with B = 0, C = 1/2.",
                   {},
                   {R"(<rfilter type="catmullrom"/>)"}});

}  // namespace
}  // namespace aureole
