// SPDX-License-Identifier: Apache-2.0
// Second moments of the samples of other integrators, for the variance of a sample: m2 - mean^2.
#include <algorithm>
#include <span>

#include "aureole/integrator/aov_channels.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class MomentIntegrator final : public NestingIntegrator {
public:
  explicit MomentIntegrator(const Properties& p) : NestingIntegrator(p) {
    if (nested_.empty()) throw p.error("integrator", "needs a nested integrator");
    for (const NestedIntegrator& n : nested_) {
      for (size_t i = 0; i < n.channels.size(); ++i) {
        names_.push_back(n.name + "." + n.channels[i]);
        meanings_.push_back(n.meanings[i]);
      }
      for (const char* c : {".X", ".Y", ".Z"}) {
        names_.push_back(n.name + c);
        meanings_.push_back("CIE XYZ of the integrator " + n.name);
      }
    }
    first_moments_ = names_.size();
    for (size_t i = 0; i < first_moments_; ++i) {
      meanings_.push_back("mean of the squares of the samples of " + names_[i]);
      names_.push_back("m2_" + names_[i]);
    }
    require_distinct(p, "integrator", names_);
  }

  void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
             const BatchLog& log) const override {
    const Arena::Frame frame;
    const std::span<RadianceEstimate> results = frame.arena().make<RadianceEstimate>(paths.size());
    for (size_t k = 0; k < nested_.size(); ++k) {
      nested_[k].integrator->estimate(scene, paths, splats, log);
      for (size_t i = 0; i < paths.size(); ++i) {
        Path& p = paths[i];
        if (k == 0) results[i] = p.result;
        p.aovs = write_colour(p.result, p.wavelengths, p.aovs + nested_[k].channels.size());
      }
    }
    for (size_t i = 0; i < paths.size(); ++i) {
      paths[i].result = results[i];
      paths[i].aovs -= first_moments_;
      write_squares(paths[i].aovs);
    }
  }

private:
  float* write_colour(const RadianceEstimate& r, const Wavelengths& w, float* out) const {
    double xyz[3];
    meter_.xyz(r.estimate, w, xyz);
    return std::copy(xyz, xyz + 3, out);
  }
  void write_squares(float* aovs) const {
    for (size_t i = 0; i < first_moments_; ++i) aovs[first_moments_ + i] = aovs[i] * aovs[i];
  }

  size_t first_moments_ = 0;
};

AUREOLE_PLUGIN(
    MomentIntegrator, "integrator", "moment",
    PluginDoc{
        "The picture of the first nested integrator, and for each of them, of name N, the channels N.X, N.Y, "
        "N.Z (CIE XYZ of its samples; the mean over the range for sensors outside the visible) with its own "
        "further channels, and m2_N.X, ..., the means of their squares. With a box filter and the sampler "
        "`independent`, m2 - mean^2 over the number of samples is the variance of a pixel; mean and square "
        "are filtered alike. Without a name N is _arg_0, _arg_1, ... Use `component_format` float32: a "
        "difference of half floats is rounding.",
        "",
        {{"integrator", "integrator", "", "required", "one or more nested integrators"}},
        {R"(<integrator type="moment"><integrator type="path" name="img"/></integrator>)"}});

}  // namespace
}  // namespace aureole
