// SPDX-License-Identifier: Apache-2.0
// A medium whose extinction is the same everywhere: distances are sampled in closed form.
#include "aureole/medium/content/medium_content.h"

namespace aureole {
namespace {

class Homogeneous final : public Medium {
public:
  explicit Homogeneous(const Properties& p) : Medium(p), content_(p) {
    if (content_.majorants())
      throw p.error("sigma_t", "varies in space; the medium \"heterogeneous\" is for that");
  }

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const override {
    content_.eval(p, d, w, out);
  }
  const PhaseFunction& phase() const override { return content_.phase(); }
  Spectrum majorant(const Vec3& d, const Wavelengths& w) const override { return content_.majorant(d, w); }
  bool is_uniform() const override { return content_.is_uniform(); }
  bool has_uniform_emission() const override { return content_.has_uniform_emission(); }
  bool emits() const override { return content_.emits(); }

private:
  MediumContent content_;
};

AUREOLE_PLUGIN(
    Homogeneous, "medium", "homogeneous",
    PluginDoc{"A medium with the same extinction everywhere. Its albedo and emission may vary. It fills a "
              "closed shape as its `interior`.",
              "Chandrasekhar, Radiative Transfer, 1950, chapter I",
              MediumContent::rows(),
              {R"(<medium type="homogeneous">
    <float name="sigma_t" value="2"/>
    <rgb name="albedo" value="0.9, 0.8, 0.5"/>
    <float name="scale" value="0.5"/>
    <float name="emission" value="0"/>
    <float name="temperature" value="0"/>
    <float name="ior" value="1.33"/>
    <boolean name="sample_emitters" value="true"/>
    <boolean name="has_spectral_extinction" value="true"/>
    <phase type="isotropic"/>
</medium>)",
               R"(<medium type="homogeneous">
    <float name="sigma_a" value="0.1"/>
    <float name="sigma_s" value="1"/>
</medium>)"}});

}  // namespace
}  // namespace aureole
