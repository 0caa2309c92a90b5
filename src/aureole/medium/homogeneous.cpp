// SPDX-License-Identifier: Apache-2.0
// A medium of constant extinction. Free paths are sampled in closed form.
#include "aureole/medium/content/given_medium.h"

namespace aureole {
namespace {

class Homogeneous final : public GivenMedium {
public:
  explicit Homogeneous(const Properties& p) : GivenMedium(p) {
    if (majorants()) throw p.error("sigma_t", "varies in space; the medium \"heterogeneous\" is for that");
  }
};

AUREOLE_PLUGIN(Homogeneous, "medium", "homogeneous",
               PluginDoc{"A medium of constant extinction. Its albedo and emission may vary. It fills a "
                         "closed shape as its `interior`.",
                         "Chandrasekhar, Radiative Transfer, 1950, chapter I",
                         GivenMedium::rows(),
                         {R"(<medium type="homogeneous">
    <float name="sigma_t" value="2"/>
    <rgb name="albedo" value="0.9, 0.8, 0.5"/>
    <float name="scale" value="0.5"/>
    <float name="emission" value="0"/>
    <float name="temperature" value="0"/>
    <float name="sampling_weight" value="1"/>
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
