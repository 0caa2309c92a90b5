// SPDX-License-Identifier: Apache-2.0
// Spheres of one material and many sizes, by Mie's theory.
#include <array>

#include "aureole/bsdf/fresnel/complex_index.h"
#include "aureole/ingredient/ingredient.h"
#include "aureole/plugin/radius_parameters.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

using optics::Amount;

Amount read_amount(const Properties& p) {
  struct Way {
    const char* name;
    Amount::Kind kind;
    Range range;
  };
  const std::array<Way, 3> ways = {{{"number_density", Amount::Kind::number, Range::non_negative()},
                                    {"volume_fraction", Amount::Kind::volume, Range::unit()},
                                    {"mass_fraction", Amount::Kind::mass, Range::unit()}}};
  const Way* given = nullptr;
  for (const Way& way : ways)
    if (p.has(way.name)) {
      if (given)
        throw p.error(way.name, "give either \"" + std::string(given->name) + "\" or \"" + way.name + "\"");
      given = &way;
    }
  if (!given)
    throw Error(p.where(),
                "\"spheres\" needs one of \"number_density\", \"volume_fraction\" and \"mass_fraction\"");
  return {given->kind, p.get_float(given->name, given->range)};
}

class Spheres final : public Ingredient {
public:
  explicit Spheres(const Properties& p)
      : Ingredient(p),
        particles_{.name = name(),
                   .particles = nullptr,
                   .radii = read_radii(p),
                   .amount = read_amount(p),
                   .density = p.get_float("density", 0, Range::positive())} {
    if (!p.has("int_ior"))
      throw p.error("int_ior", "the parameter \"int_ior\" is required, a number or a material's name");
    particles_.particles = optics::sphere_kind(read_complex_index(p, "int_ior", "water"));
  }

  void add_to(IngredientList& list) const override { list.particles.push_back(particles_); }

private:
  optics::Ingredient particles_;
};

std::vector<ParameterDoc> rows() {
  std::vector<ParameterDoc> all = radius_docs();
  all.insert(
      all.end(),
      {{"int_ior", "float or string", "", "required",
        "index of the spheres: a number, a dielectric or a metal"},
       {"k", "spectrum", "", "0", "imaginary part of the index of dielectric spheres: absorption"},
       {"dispersion", "boolean", "", "true", "named materials use their dispersion data where there are any"},
       {"number_density", "float", "1/m^3", "none", "spheres in a cubic metre"},
       {"volume_fraction", "float", "", "none", "part of the volume that they fill"},
       {"mass_fraction", "float", "", "none",
        "part of the mass; needs their density and that of the liquid or gas around them"},
       {"density", "float", "kg/m^3", "none", "of the material of the spheres"}});
  return all;
}

AUREOLE_PLUGIN(
    Spheres, "ingredient", "spheres",
    PluginDoc{
        "Spheres that float in a medium: droplets, globules, pigments, powder. One of the three amounts "
        "is required.",
        "G. Mie, Beitraege zur Optik trueber Medien, Ann. Phys. 330 (1908) 377; Bohren & Huffman, "
        "Absorption and Scattering of Light by Small Particles, 1983, chapter 4",
        rows(),
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
</ingredient>)"}});

}  // namespace
}  // namespace aureole
