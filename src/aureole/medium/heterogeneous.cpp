// SPDX-License-Identifier: Apache-2.0
// A medium whose extinction varies in space. Free paths are sampled with null collisions under local
// majorants.
#include "aureole/medium/content/given_medium.h"

namespace aureole {
namespace {

class Heterogeneous final : public GivenMedium {
public:
  using GivenMedium::GivenMedium;
};

AUREOLE_PLUGIN(
    Heterogeneous, "medium", "heterogeneous",
    PluginDoc{"A medium whose coefficients vary in space, as given by `volume` objects. Outside the box of "
              "`sigma_t` space is empty.",
              "Miller, Georgiev & Jarosz 2019, \"A null-scattering path integral formulation of light "
              "transport\"",
              GivenMedium::rows(),
              {R"(<medium type="heterogeneous">
    <float name="sigma_t" value="2"/>
    <float name="albedo" value="0.9"/>
    <float name="scale" value="0.5"/>
    <float name="emission" value="0"/>
    <float name="temperature" value="0"/>
    <float name="sampling_weight" value="1"/>
    <float name="ior" value="1.33"/>
    <boolean name="sample_emitters" value="true"/>
    <boolean name="has_spectral_extinction" value="true"/>
    <phase type="isotropic"/>
</medium>)",
               R"(<medium type="heterogeneous">
    <float name="sigma_a" value="0.1"/>
    <float name="sigma_s" value="1"/>
</medium>)"}});

}  // namespace
}  // namespace aureole
