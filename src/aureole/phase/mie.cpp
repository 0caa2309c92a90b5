// SPDX-License-Identifier: Apache-2.0
// Mie scattering by spheres of one material, averaged over their sizes: coronas of fog and mist, rainbows and
// glories. Phase functions are tabulated when the scene is built (optics/particle/ensemble.h). All
// wavelengths share one grid of angles; their nodes are chosen by the error of linear interpolation.
#include <stdexcept>
#include <vector>

#include "aureole/core/parallel.h"
#include "aureole/optics/particle/ensemble.h"
#include "aureole/parameter/complex_index.h"
#include "aureole/parameter/ior.h"
#include "aureole/phase/mie_tables.h"
#include "aureole/phase/tabulated_phase_function.h"
#include "aureole/plugin/radius_parameters.h"
#include "aureole/plugin/registry.h"
#include "aureole/plugin/table_progress.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

std::shared_ptr<const TabulatedPhase> make_table(const Properties& p) {
  const SpectralGrid grid = p.context().grid;
  const optics::RadiusDistribution radii = read_radii(p);
  const Ior medium = Ior::from(p, "ext_ior", "air");
  const auto host = [=](double nm) { return double(medium.eval(Wavelengths::at(grid, float(nm)))[0]); };
  const auto index =
      read_complex_index(p, "int_ior", "water", get_optional_spectrum(p, "k", SpectrumRole::unbounded));
  return p.shared_model<TabulatedPhase>([&] {
    try {
      optics::EnsembleAccuracy accuracy = mie_accuracy({&radii, 1}, host(grid.min_nm), grid.min_nm);
      accuracy.most_coefficient_radii = 0;
      const auto ensemble = [&](const std::vector<double>& nm) {
        return optics::Ensemble({{optics::sphere_kind(index), radii}}, nm, host, accuracy, for_ranges);
      };
      const std::vector<double> nm =
          mie_spectrum(grid, {&radii, 1}, host(grid.min_nm), [&](const std::vector<double>& at) {
            return ensemble(at).coefficients();
          }).phase_nm;
      return std::make_shared<const TabulatedPhase>(
          tabulate(ensemble(nm).phases(for_ranges, progress_of(p)), nm, grid));
    } catch (const std::domain_error& e) {
      throw p.error("radius", e.what());
    }
  });
}

class MiePhase final : public TabulatedPhaseFunction {
public:
  explicit MiePhase(const Properties& properties)
      : TabulatedPhaseFunction(properties, make_table(properties)) {}
};

std::vector<ParameterDoc> rows() {
  std::vector<ParameterDoc> all = radius_docs();
  all.insert(all.end(), {{"int_ior", "float or string", "", "water",
                          "index of refraction of the spheres: a number, a dielectric or a metal"},
                         {"k", "spectrum", "", "0",
                          "extinction coefficient: imaginary part of the index of dielectric spheres"},
                         {"ext_ior", "float or string", "", "air", "index of refraction of the host medium"},
                         {"dispersion", "boolean", "", "true",
                          "named materials use their dispersion data if available"}});
  return all;
}

AUREOLE_PLUGIN(
    MiePhase, "phase", "mie",
    PluginDoc{
        "Mie scattering by spheres of one material, such as droplets, averaged over their sizes: the phase "
        "function of fog and clouds, with rainbow, glory and corona. The medium's coefficients are given "
        "separately and do not follow from these spheres.\n\nTables are computed when the scene is built, "
        "in 2 seconds for fog of 10 um and a minute for drops of 100 um. The time grows with the square of "
        "the radius, and for narrower size distributions.",
        "G. Mie, Beitraege zur Optik trueber Medien, Ann. Phys. 330 (1908) 377; Bohren & Huffman, Absorption "
        "and Scattering of Light by Small Particles, 1983, chapter 4",
        rows(),
        {R"(<phase type="mie">
    <string name="radius" value="2um"/> <string name="distribution" value="gamma"/>
    <float name="effective_variance" value="0.1"/>
    <string name="int_ior" value="water"/> <string name="ext_ior" value="air"/>
</phase>)",
         R"(<phase type="mie">
    <string name="radius" value="150nm"/>
    <float name="size_spread" value="0.4"/> <string name="weighting" value="volume"/>
    <float name="int_ior" value="1.46"/> <spectrum name="k" value="400:0.01, 700:0.001"/>
    <string name="ext_ior" value="water"/> <boolean name="dispersion" value="false"/>
</phase>)",
         R"(<phase type="mie">
    <string name="radius" value="1um"/> <string name="distribution" value="modified_gamma"/>
    <float name="alpha" value="5"/> <float name="gamma" value="1.5"/>
</phase>)",
         R"(<phase type="mie">
    <string name="distribution" value="histogram"/>
    <string name="sizes" value="0.4, 0.8, 1.6, 3.2"/> <string name="weights" value="20, 50, 30"/>
    <string name="classes" value="edges"/> <string name="weighting" value="volume"/>
    <string name="size_unit" value="um"/> <string name="size_quantity" value="diameter"/>
</phase>)",
         R"(<phase type="mie">
    <string name="distribution" value="histogram"/>
    <string name="size_histogram" value="sizes.csv"/> <string name="weighting" value="number"/>
    <string name="size_unit" value="um"/> <string name="size_quantity" value="radius"/>
</phase>)"}});

}  // namespace
}  // namespace aureole
