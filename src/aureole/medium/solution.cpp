// SPDX-License-Identifier: Apache-2.0
// A clear liquid with dissolved dyes.
#include "aureole/medium/content/mixture.h"

namespace aureole {
namespace {

optics::Suspension read_solution(const Properties& p) {
  const optics::Suspension solvent(read_clear_medium(p, "solvent"), {});
  const std::vector<IngredientPtr> ingredients = read_ingredients(p);
  for (const IngredientPtr& i : ingredients) {
    IngredientList list;
    i->add_to(list);
    if (!list.particles.empty())
      throw Error(i->properties().where(),
                  "a solution holds dyes; particles float in the medium \"suspension\"");
  }
  return mix(p, solvent, ingredients, false);
}

class SolutionMedium final : public Mixture {
public:
  explicit SolutionMedium(const Properties& p) : Mixture(p, read_solution(p)) {}
};

AUREOLE_PLUGIN(
    SolutionMedium, "medium", "solution",
    PluginDoc{
        "A clear liquid or gas, and dyes dissolved in it: wine, tea, coloured glass, deep water. Absorption "
        "coefficients add; only the molecules of the solvent scatter.",
        "Beer 1852; water: Pope & Fry 1997 (absorption), Morel 1974 (scattering); air: Bodhaine et al. 1999",
        {{"solvent", "float or string", "", "water",
          "solvent: water or air, with absorption and scattering of their molecules; vacuum, another "
          "dielectric or an index of refraction, without them"},
         {"dispersion", "boolean", "", "true",
          "a solvent named as a material uses its dispersion data if available"},
         {"ingredient", "ingredient", "", "none", "dissolved dyes"},
         Mixture::density_row()},
        {R"(<medium type="solution">
    <string name="solvent" value="ethanol"/> <boolean name="dispersion" value="false"/>
    <ingredient type="dye">
        <spectrum name="absorbance_1cm" value="360:3, 420:1.6, 520:2, 620:0.35, 700:0.1, 830:0.05"/>
    </ingredient>
    <float name="density" value="0.3"/>
</medium>)",
         R"(<medium type="solution"/>)"}});

}  // namespace
}  // namespace aureole
