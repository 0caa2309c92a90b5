// SPDX-License-Identifier: Apache-2.0
// Gaussian filter truncated at 4 standard deviations and shifted to be zero there. It is the default.
#include <cmath>

#include "aureole/filter/filter.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class GaussianFilter final : public Filter {
public:
  explicit GaussianFilter(const Properties& p)
      : Filter(p), stddev_(float(p.get_float("stddev", 0.5, {0.15, 8}))) {}
  float radius() const override { return 4 * stddev_; }
  float eval(float x) const override {
    const float t = x / stddev_;
    return std::max(0.f, std::exp(-0.5f * t * t) - std::exp(-8.f));
  }

private:
  float stddev_;
};

AUREOLE_PLUGIN(GaussianFilter, "rfilter", "gaussian",
               PluginDoc{
                   "Gaussian truncated at 4 standard deviations and shifted to be zero there. The default.",
                   "",
                   {{"stddev", "float", "pixels", "0.5", "standard deviation"}},
                   {R"(<rfilter type="gaussian"><float name="stddev" value="0.5"/></rfilter>)"}});

}  // namespace
}  // namespace aureole
