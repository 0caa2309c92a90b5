// SPDX-License-Identifier: Apache-2.0
// Coated spheres: a core of one material with a coat of another, by the theory of Aden and Kerker.
#include <stdexcept>

#include "aureole/ingredient/amount/amount_parameters.h"
#include "aureole/ingredient/ingredient.h"
#include "aureole/parameter/complex_index.h"
#include "aureole/plugin/radius_parameters.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

std::shared_ptr<const optics::ParticleKind> read_kind(const Properties& p) {
  for (const char* name : {"int_ior", "coat_ior"})
    if (!p.has(name))
      throw p.error(name,
                    "the parameter \"" + std::string(name) + "\" is required, a number or a material's name");
  const auto core =
      read_complex_index(p, "int_ior", "water", get_optional_spectrum(p, "k", SpectrumRole::unbounded));
  const auto coat = read_complex_index(p, "coat_ior", "water",
                                       get_optional_spectrum(p, "coat_k", SpectrumRole::unbounded), "coat_k");
  if (p.has("core_fraction") == p.has("coat_thickness"))
    throw p.error("core_fraction", "give either \"core_fraction\" or \"coat_thickness\"");
  if (p.has("coat_thickness"))
    return optics::thin_coated_sphere_kind(core, coat, p.get_length_m("coat_thickness", 0));
  try {
    return optics::coated_sphere_kind(core, coat, p.get_float("core_fraction", 0.5));
  } catch (const std::domain_error& e) {
    throw p.error("core_fraction", e.what());
  }
}

class CoatedSpheres final : public Ingredient {
public:
  explicit CoatedSpheres(const Properties& p)
      : Ingredient(p),
        particles_{.name = name(),
                   .particles = read_kind(p),
                   .radii = read_radii(p),
                   .amount = read_amount(p),
                   .density = read_density(p)} {}

  void add_to(IngredientList& list) const override { list.particles.push_back(particles_); }

private:
  optics::Ingredient particles_;
};

std::vector<ParameterDoc> coated_spheres_rows() {
  std::vector<ParameterDoc> all = radius_docs();
  all.insert(
      all.end(),
      {{"core_fraction", "float", "", "one of the two",
        "radius of the core over the radius of the sphere, in (0, 1)"},
       {"coat_thickness", "length", "", "one of the two",
        "thickness of the coat for all radii; spheres with a smaller radius consist of the coat's material"},
       {"int_ior", "float or string", "", "required",
        "index of refraction of the core: a number, a dielectric or a metal"},
       {"k", "spectrum", "", "0", "extinction coefficient: imaginary part of the index of a dielectric core"},
       {"coat_ior", "float or string", "", "required",
        "index of refraction of the coat: a number, a dielectric or a metal"},
       {"coat_k", "spectrum", "", "0",
        "extinction coefficient: imaginary part of the index of a dielectric coat"},
       {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"}});
  const std::vector<ParameterDoc> amount = amount_docs();
  all.insert(all.end(), amount.begin(), amount.end());
  return all;
}

AUREOLE_PLUGIN(
    CoatedSpheres, "ingredient", "coated_spheres",
    PluginDoc{
        "Spheres with a concentric coat, suspended in a medium: hollow pigments, wet soot, globules with a "
        "membrane, gold shells. `radius` is the outer radius. One of the three amounts, of core and coat "
        "together, is required.",
        "A. L. Aden and M. Kerker, Scattering of electromagnetic waves from two concentric spheres, J. Appl. "
        "Phys. 22 (1951) 1242; Bohren & Huffman, Absorption and Scattering of Light by Small Particles, 1983, "
        "chapter 8",
        coated_spheres_rows(),
        {R"(<ingredient type="coated_spheres">
    <string name="radius" value="250nm"/> <float name="core_fraction" value="0.8"/>
    <float name="int_ior" value="1"/> <spectrum name="k" value="0"/>
    <float name="coat_ior" value="1.59"/> <spectrum name="coat_k" value="400:1e-5, 700:1e-6"/>
    <float name="mass_fraction" value="0.02"/> <float name="density" value="600"/>
</ingredient>)",
         R"(<ingredient type="coated_spheres">
    <string name="radius" value="150nm"/> <float name="size_spread" value="0.3"/>
    <string name="weighting" value="volume"/> <string name="coat_thickness" value="20nm"/>
    <float name="int_ior" value="1.46"/> <string name="coat_ior" value="Au"/>
    <float name="volume_fraction" value="1e-5"/>
</ingredient>)",
         R"(<ingredient type="coated_spheres">
    <string name="radius" value="1um"/> <string name="distribution" value="modified_gamma"/>
    <float name="alpha" value="6"/> <float name="gamma" value="1"/> <float name="core_fraction" value="0.3"/>
    <float name="int_ior" value="1.75"/> <string name="coat_ior" value="water"/>
    <boolean name="dispersion" value="false"/> <float name="number_density" value="1e10"/>
</ingredient>)",
         R"(<ingredient type="coated_spheres">
    <string name="radius" value="1um"/> <string name="distribution" value="gamma"/>
    <float name="effective_variance" value="0.1"/> <float name="core_fraction" value="0.5"/>
    <float name="int_ior" value="1.4"/> <float name="coat_ior" value="1.5"/>
    <float name="volume_fraction" value="0.001"/>
</ingredient>)",
         R"(<ingredient type="coated_spheres">
    <string name="distribution" value="histogram"/>
    <string name="sizes" value="0.4, 0.8, 1.6, 3.2"/> <string name="weights" value="20, 50, 30"/>
    <string name="classes" value="edges"/> <string name="weighting" value="volume"/>
    <string name="size_unit" value="um"/> <string name="size_quantity" value="diameter"/>
    <float name="core_fraction" value="0.5"/>
    <float name="int_ior" value="1.4"/> <float name="coat_ior" value="1.5"/>
    <float name="volume_fraction" value="0.001"/>
</ingredient>)",
         R"(<ingredient type="coated_spheres">
    <string name="distribution" value="histogram"/>
    <string name="size_histogram" value="sizes.csv"/> <string name="weighting" value="number"/>
    <string name="size_unit" value="um"/> <string name="size_quantity" value="radius"/>
    <float name="core_fraction" value="0.5"/>
    <float name="int_ior" value="1.4"/> <float name="coat_ior" value="1.5"/>
    <float name="volume_fraction" value="0.001"/>
</ingredient>)"}});

}  // namespace
}  // namespace aureole
