// SPDX-License-Identifier: Apache-2.0
// Particles in a liquid or gas, given by material, size distribution and concentration. Coefficients and
// phase functions are computed when the scene is built.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "aureole/core/parallel.h"
#include "aureole/medium/content/mixture.h"
#include "aureole/optics/medium/recipes.h"
#include "aureole/optics/particle/hard_spheres.h"
#include "aureole/phase/mie_tables.h"

namespace aureole {
namespace {

constexpr const char* kMilk[] = {"milk", "low_fat_milk", "skim_milk"};

bool is_milk(const std::string& recipe) {
  return std::find(std::begin(kMilk), std::end(kMilk), recipe) != std::end(kMilk);
}

std::vector<std::string> recipe_names() {
  std::vector<std::string> all(std::begin(kMilk), std::end(kMilk));
  for (const char* name : {"water", "smoke"}) all.emplace_back(name);
  for (const optics::DropletRecipe& r : optics::droplet_recipes()) all.emplace_back(r.name);
  return all;
}

void refuse(const Properties& p, std::initializer_list<const char*> names, const std::string& reason) {
  for (const char* name : names)
    if (p.has(name)) throw p.error(name, reason);
}

optics::Suspension read_milk(const Properties& p, const std::string& recipe, bool dependent_scattering) {
  const double fat = recipe == "skim_milk" ? 0.1 : recipe == "low_fat_milk" ? 1.5 : 3;
  return optics::milk({.fat = p.get_float("fat", fat, {0, 40}),
                       .protein = p.get_float("protein", 3.4, {0, 20}),
                       .pressure = p.get_float("pressure", 0, {0, 200}),
                       .hard_spheres = dependent_scattering});
}

/// Returns the recipe's suspension, without the ingredients that the scene adds to it.
optics::Suspension read_recipe(const Properties& p, bool dependent_scattering) {
  const std::string recipe = p.get_choice("recipe", "", recipe_names());
  const std::string reason = "has no meaning for the recipe \"" + recipe + "\"";
  refuse(p, {"host", "host_density"}, reason);
  if (!is_milk(recipe)) refuse(p, {"fat", "protein", "pressure"}, reason);
  if (recipe != "smoke") refuse(p, {"mass_density"}, reason);
  if (is_milk(recipe) || recipe == "water" || recipe == "smoke") refuse(p, {"number_density"}, reason);
  try {
    if (is_milk(recipe)) return read_milk(p, recipe, dependent_scattering);
    if (recipe == "water") return optics::Suspension(optics::water(), {});
    if (recipe == "smoke") return optics::smoke(p.get_float("mass_density", 1e-3, Range::positive()));
    std::optional<double> number;
    if (p.has("number_density")) number = p.get_float("number_density", Range::positive());
    return optics::droplets(recipe, number);
  } catch (const std::domain_error& e) {
    throw p.error("recipe", e.what());
  }
}

optics::Suspension read_base(const Properties& p, bool dependent_scattering) {
  if (p.has("recipe")) return read_recipe(p, dependent_scattering);
  refuse(p, {"fat", "protein", "pressure", "number_density", "mass_density"},
         "belongs to a \"recipe\"; amounts of particles stand in their <ingredient>");
  optics::ClearMedium host = read_clear_medium(p, "host");
  if (p.has("host_density")) host.density = p.get_float("host_density", Range::positive());
  return optics::Suspension(std::move(host), {});
}

/// Notes each ingredient whose particles are so close together that interference changes their scattering.
void note_dependence(const Properties& p, const optics::Suspension& content, bool dependent_scattering) {
  constexpr double kWorthANote = 0.01;
  const SpectralGrid& grid = p.context().grid;
  const double nm = std::clamp(550.0, grid.min_nm, grid.max_nm);
  for (std::size_t i = 0; i < content.ingredients().size(); ++i) {
    const optics::Ingredient& ingredient = content.ingredients()[i];
    if (ingredient.hard_spheres || content.volume_fraction(i) == 0) continue;
    if (const auto change = content.dependence(
            i, nm, mie_accuracy(std::span(&ingredient.radii, 1), content.host().index(nm), nm), for_ranges)) {
      if (std::abs(change->scattering - 1) > kWorthANote)
        p.note("dependent_scattering",
               fmt::format(
                   "{} fill {:.2g} % of the volume: interference between neighbours would change "
                   "their scattering at {:g} nm by {:+.1f} %; {}",
                   ingredient.name, 100 * content.volume_fraction(i), nm, 100 * (change->scattering - 1),
                   dependent_scattering ? "the recipe does not count it, with \"dependent_scattering\" either"
                                        : "\"dependent_scattering\" counts it"));
    } else {
      p.note("dependent_scattering",
             fmt::format("{} fill {:.2g} % of the volume: they are too close to one another to scatter "
                         "independently, and beyond {:g} % there is no correction",
                         ingredient.name, 100 * content.volume_fraction(i),
                         100 * optics::kMaxHardSphereFraction));
    }
  }
}

optics::Suspension read_suspension(const Properties& p) {
  const bool dependent_scattering = p.get_bool("dependent_scattering", false);
  const optics::Suspension base = read_base(p, dependent_scattering);
  const std::vector<IngredientPtr> ingredients = read_ingredients(p);
  if (!p.has("recipe") && ingredients.empty())
    throw Error(p.where(), "\"suspension\" needs a \"recipe\" or an <ingredient>");
  optics::Suspension content = mix(p, base, ingredients, dependent_scattering);
  const SpectralGrid& grid = p.context().grid;
  for (const optics::Ingredient& i : content.ingredients()) {
    try {
      require_sizes_for_tables(grid, std::span(&i.radii, 1), content.host().index(grid.min_nm));
    } catch (const std::domain_error& e) {
      throw Error(p.where(), fmt::format("{}: {}", i.name, e.what()));
    }
  }
  note_dependence(p, content, dependent_scattering);
  return content;
}

class SuspensionMedium final : public Mixture {
public:
  explicit SuspensionMedium(const Properties& p) : Mixture(p, read_suspension(p)) {}
};

std::string known_recipes() {
  std::string all =
      "milk, low_fat_milk, skim_milk (3, 1.5, 0.1 % of fat; Frisvad, Christensen & Jensen "
      "2007), water, smoke (soot: Hess, Koepke & Schult 1998)";
  for (const optics::DropletRecipe& r : optics::droplet_recipes())
    all += fmt::format(", {} ({})", r.name, r.description);
  return all;
}

AUREOLE_PLUGIN(
    SuspensionMedium, "medium", "suspension",
    PluginDoc{
        "Particles in a liquid or gas, given by material, size and concentration: \"2 % fat in water\" "
        "instead of coefficients. Coefficients and phase function are computed when the scene is built, in "
        "seconds for particles of micrometres; the time grows with the square of the radius. Boundaries "
        "refract by their BSDF, whose index should be the host's. `aureole medium` prints the result.",
        "Frisvad, Christensen & Jensen, Computing the scattering properties of participating media using "
        "Lorenz-Mie theory, ACM Trans. Graph. 26 (2007) 60; Pedersen, J. Appl. Cryst. 27 (1994) 595 "
        "(dependent scattering)",
        {{"recipe", "string", "", "none", known_recipes()},
         {"host", "float or string", "", "water",
          "host of the particles, if there is no recipe: water or air, with absorption and scattering of "
          "their molecules; vacuum, another dielectric or an index of refraction, without them"},
         {"host_density", "float", "kg/m^3", "that of water or air",
          "density of the host; needed for mass fractions"},
         {"dispersion", "boolean", "", "true",
          "a host named as a material uses its dispersion data if available"},
         {"ingredient", "ingredient", "", "none",
          "one or more particles or dyes, added to those of a recipe"},
         {"dependent_scattering", "boolean", "", "false",
          "counts the interference between neighbours, which keep their distance as hard spheres do (of "
          "milk: the casein). Where it is off and would change scattering by more than 1 %, a note says so"},
         {"fat", "float", "% of the mass", "that of the recipe", "fat content of milk"},
         {"protein", "float", "% of the mass", "3.4", "protein content of milk"},
         {"pressure", "float", "MPa", "0", "homogenisation pressure of milk; 0: not homogenised"},
         {"number_density", "float", "1/m^3", "that of the recipe", "droplets per volume of a cloud or fog"},
         {"mass_density", "float", "kg/m^3", "0.001", "mass of soot per volume of smoke"},
         Mixture::density_row()},
        {R"(<medium type="suspension">
    <string name="recipe" value="milk"/>
    <float name="fat" value="1.5"/> <float name="protein" value="3.4"/> <float name="pressure" value="20"/>
    <boolean name="dependent_scattering" value="true"/>
</medium>)",
         R"(<medium type="suspension">
    <float name="host" value="1.47"/> <float name="host_density" value="1260"/>
    <boolean name="dispersion" value="false"/>
    <ingredient type="spheres">
        <string name="radius" value="200nm"/> <float name="int_ior" value="1.59"/>
        <float name="mass_fraction" value="0.001"/> <float name="density" value="1050"/>
    </ingredient>
    <ingredient type="dye">
        <spectrum name="absorbance_1cm" value="360:1, 500:0.3, 600:0.01, 830:0"/>
    </ingredient>
</medium>)",
         R"(<medium type="suspension">
    <string name="recipe" value="moderate_radiation_fog"/> <float name="number_density" value="1e8"/>
    <float name="density" value="0.5"/>
</medium>)",
         R"(<medium type="suspension">
    <string name="recipe" value="smoke"/> <float name="mass_density" value="0.0005"/>
</medium>)"}});

}  // namespace
}  // namespace aureole
