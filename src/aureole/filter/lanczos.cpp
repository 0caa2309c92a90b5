// SPDX-License-Identifier: Apache-2.0
// Windowed sinc filter: sharp, with negative lobes.
#include <cmath>

#include "aureole/filter/filter.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class LanczosFilter final : public Filter {
public:
  explicit LanczosFilter(const Properties& p) : Filter(p), lobes_(float(p.get_int("lobes", 3, {1, 16}))) {}
  float radius() const override { return lobes_; }
  float eval(float x) const override {
    x = std::abs(x);
    if (x < 1e-5f) return 1;
    if (x >= lobes_) return 0;
    constexpr float pi = 3.14159265358979f;
    return std::sin(pi * x) * std::sin(pi * x / lobes_) * lobes_ / (pi * pi * x * x);
  }

private:
  float lobes_;
};

AUREOLE_PLUGIN(LanczosFilter, "rfilter", "lanczos",
               PluginDoc{"Windowed sinc filter: sharp, with negative lobes.",
                         "Lanczos window (Duchon 1979, \"Lanczos filtering in one and two dimensions\").",
                         {{"lobes", "integer", "", "3", "number of lobes; also the half width in pixels"}},
                         {R"(<rfilter type="lanczos"><integer name="lobes" value="3"/></rfilter>)"}});

}  // namespace
}  // namespace aureole
