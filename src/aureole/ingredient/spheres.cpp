// SPDX-License-Identifier: Apache-2.0
// Homogeneous spheres with a distribution of sizes, by Mie's theory.
#include "aureole/ingredient/amount/amount_parameters.h"
#include "aureole/ingredient/ingredient.h"
#include "aureole/parameter/complex_index.h"
#include "aureole/plugin/radius_parameters.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class Spheres final : public Ingredient {
public:
  explicit Spheres(const Properties& p)
      : Ingredient(p),
        particles_{.name = name(),
                   .particles = nullptr,
                   .radii = read_radii(p),
                   .amount = read_amount(p),
                   .density = read_density(p)} {
    if (!p.has("int_ior"))
      throw p.error("int_ior", "the parameter \"int_ior\" is required, a number or a material's name");
    const auto k = get_optional_spectrum(p, "k", SpectrumRole::unbounded);
    particles_.particles = optics::sphere_kind(read_complex_index(p, "int_ior", "water", k));
  }

  void add_to(IngredientList& list) const override { list.particles.push_back(particles_); }

private:
  optics::Ingredient particles_;
};

std::vector<ParameterDoc> spheres_rows() {
  std::vector<ParameterDoc> all = radius_docs();
  all.insert(all.end(), {{"int_ior", "float or string", "", "required",
                          "index of refraction of the spheres: a number, a dielectric or a metal"},
                         {"k", "spectrum", "", "0",
                          "extinction coefficient: imaginary part of the index of dielectric spheres"},
                         {"dispersion", "boolean", "", "true",
                          "named materials use their dispersion data if available"}});
  const std::vector<ParameterDoc> amount = amount_docs();
  all.insert(all.end(), amount.begin(), amount.end());
  return all;
}

AUREOLE_PLUGIN(
    Spheres, "ingredient", "spheres",
    PluginDoc{
        "Spheres suspended in a medium: droplets, globules, pigments, powder. One of the three amounts is "
        "required.",
        "G. Mie, Beitraege zur Optik trueber Medien, Ann. Phys. 330 (1908) 377; Bohren & Huffman, "
        "Absorption and Scattering of Light by Small Particles, 1983, chapter 4",
        spheres_rows(),
        {R"(<ingredient type="spheres">
    <string name="radius" value="150nm"/>
    <float name="size_spread" value="0.4"/> <string name="weighting" value="volume"/>
    <float name="int_ior" value="1.46"/> <spectrum name="k" value="400:1e-5, 700:1e-6"/>
    <float name="mass_fraction" value="0.02"/> <float name="density" value="915"/>
</ingredient>)",
         R"(<ingredient type="spheres">
    <string name="radius" value="4um"/> <string name="distribution" value="modified_gamma"/>
    <float name="alpha" value="6"/> <float name="gamma" value="1"/>
    <string name="int_ior" value="water"/> <boolean name="dispersion" value="false"/>
    <float name="number_density" value="1e8"/>
</ingredient>)",
         R"(<ingredient type="spheres">
    <string name="radius" value="1um"/> <string name="distribution" value="gamma"/>
    <float name="effective_variance" value="0.1"/>
    <float name="int_ior" value="1.59"/> <float name="volume_fraction" value="0.001"/>
</ingredient>)",
         R"(<ingredient type="spheres">
    <string name="distribution" value="histogram"/>
    <string name="sizes" value="0.4, 0.8, 1.6, 3.2"/> <string name="weights" value="20, 50, 30"/>
    <string name="classes" value="edges"/> <string name="weighting" value="volume"/>
    <string name="size_unit" value="um"/> <string name="size_quantity" value="diameter"/>
    <float name="int_ior" value="1.52"/> <float name="volume_fraction" value="0.001"/>
</ingredient>)",
         R"(<ingredient type="spheres">
    <string name="distribution" value="histogram"/>
    <string name="size_histogram" value="sizes.csv"/> <string name="weighting" value="number"/>
    <string name="size_unit" value="um"/> <string name="size_quantity" value="radius"/>
    <float name="int_ior" value="1.52"/> <float name="volume_fraction" value="0.001"/>
</ingredient>)"}});

}  // namespace
}  // namespace aureole
