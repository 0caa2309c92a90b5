// SPDX-License-Identifier: Apache-2.0
// Spheres of one material, by Mie's theory, averaged over their sizes: halos of
// fog and mist, rainbows and glories. The phase functions of all wavelengths
// are tabulated when the scene is built (optics/particle/ensemble.h): on one
// grid of angles that suits them all, at nodes that are uniform in 1/lambda,
// between which they are mixed.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/fresnel/complex_index.h"
#include "aureole/core/parallel.h"
#include "aureole/optics/particle/ensemble.h"
#include "aureole/phase/table/tabulated_phase_function.h"
#include "aureole/plugin/radius_parameters.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

/// 2 pi n r/lambda of the effective radius.
double size_parameter(const optics::RadiusDistribution& radii, double host_index, double nm) {
  return 2 * M_PI * host_index * radii.effective_radius() * 1e9 / nm;
}

/// Wavelengths at which phase functions are tabulated, increasing. Their features move in proportion to the
/// size parameter; resonances of spheres of one size repeat over about one unit of it, a spread of sizes
/// blurs them. Rainbows do not blur: dispersion turns that of water by some 3 degrees per unit of ln(lambda),
/// and it is 120 degrees x^(-2/3) wide (Airy), of which nodes must be a fourth apart.
std::vector<double> wavelength_nodes(const SpectralGrid& grid, const optics::RadiusDistribution& radii,
                                     double host_index) {
  constexpr double kSizeStep = 0.25, kRainbow = 4 * 3 / 120.0;
  constexpr double kLeastPerUnitOfLog = 9.6, kMost = 64;
  const double width = std::log(grid.max_nm / grid.min_nm);
  const double range = 1 / grid.min_nm - 1 / grid.max_nm, x = size_parameter(radii, host_index, grid.min_nm);
  double cells = (x - size_parameter(radii, host_index, grid.max_nm)) / kSizeStep;
  if (const double variance = radii.effective_variance(); variance > 0)
    cells = std::min(cells, 4 * width / std::sqrt(variance));
  cells = std::clamp(std::max(cells, kRainbow * std::cbrt(x * x) * width), kLeastPerUnitOfLog * width, kMost);
  const int nodes = int(std::ceil(cells)) + 1;
  std::vector<double> nm;
  for (int i = 0; i < nodes; ++i) nm.push_back(1 / (1 / grid.min_nm - range * i / (nodes - 1)));
  return nm;
}

/// Coarser than the library's own: a part in a hundred of a phase function is not seen in a picture.
optics::EnsembleAccuracy accuracy_for(double size_parameter) {
  optics::EnsembleAccuracy a;
  a.averaging = 5e-3, a.phase_averaging = 3e-2;
  // The work grows as the square of the size, times the number of radii.
  a.most_radii = std::size_t(std::clamp(3e5 / size_parameter, 128.0, 1024.0));
  a.phase.relative = 1e-2, a.phase.floor = 1e-3;
  a.phase.most_nodes = 12000;
  return a;
}

TabulatedPhase make_table(const Properties& p) {
  const SpectralGrid grid = p.context().grid;
  const optics::RadiusDistribution radii = read_radii(p);
  const Ior medium = Ior::from(p, "ext_ior", "air");
  const auto host = [=](double nm) { return double(medium.eval(Wavelengths::at(grid, float(nm)))[0]); };
  const auto index = read_complex_index(p, "int_ior", "water");
  const std::vector<double> nm = wavelength_nodes(grid, radii, host(grid.min_nm));
  const optics::EnsembleAccuracy accuracy = accuracy_for(size_parameter(radii, host(nm.front()), nm.front()));
  try {
    const optics::Ensemble ensemble({{optics::sphere_kind(index), radii}}, nm, host, accuracy, for_ranges);
    return tabulate(ensemble.phases(for_ranges), nm, grid);
  } catch (const std::domain_error& e) {
    throw p.error("radius", e.what());
  }
}

class MiePhase final : public TabulatedPhaseFunction {
public:
  explicit MiePhase(const Properties& properties)
      : TabulatedPhaseFunction(properties, make_table(properties)) {}
};

std::vector<ParameterDoc> rows() {
  std::vector<ParameterDoc> all = radius_docs();
  all.insert(
      all.end(),
      {{"int_ior", "float or string", "", "water", "index of the spheres: a number, a dielectric or a metal"},
       {"k", "spectrum", "", "0", "imaginary part of the index of dielectric spheres: absorption"},
       {"ext_ior", "float or string", "", "air", "index of the medium around them"},
       {"dispersion", "boolean", "", "true",
        "named materials use their dispersion data where there are any"}});
  return all;
}

AUREOLE_PLUGIN(
    MiePhase, "phase", "mie",
    PluginDoc{
        "Scattering by spheres of one material, such as droplets, averaged over their sizes: the phase "
        "function of fog and clouds, with rainbow, glory and corona. The medium's coefficients are given "
        "beside it and do not follow from these spheres.\n\n"
        "Tables are made when the scene is built: in 2 seconds for fog of 10 um, a minute for drops of 100 "
        "um; the time grows with the square of the radius, and as the sizes differ less.",
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
</phase>)"}});

}  // namespace
}  // namespace aureole
