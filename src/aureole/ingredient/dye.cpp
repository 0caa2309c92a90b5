// SPDX-License-Identifier: Apache-2.0
// A dissolved substance that absorbs and does not scatter.
#include "aureole/core/error.h"
#include "aureole/ingredient/ingredient.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

/// Returns a spectrum as a function of the wavelength in nm.
optics::SpectralFunction read_spectrum(const Properties& p, std::string_view name) {
  const TexturePtr given = get_optional_texture(p, name, SpectrumRole::unbounded);
  if (!given->is_constant()) throw p.error(name, "must not vary over the surface");
  return [values = given->average()](double nm) {
    return double(values.eval(Wavelengths::at(values.grid(), float(nm)))[0]);
  };
}

optics::Dye read_dye(const Properties& p, const std::string& name) {
  const char* given = nullptr;
  for (const char* way : {"substance", "molar_absorptivity", "absorbance_1cm"})
    if (p.has(way)) {
      if (given) throw p.error(way, "give either \"" + std::string(given) + "\" or \"" + way + "\"");
      given = way;
    }
  if (!given)
    throw Error(p.where(),
                "\"dye\" needs one of \"substance\", \"molar_absorptivity\" and \"absorbance_1cm\"");
  if (given == std::string_view("absorbance_1cm")) {
    if (p.has("concentration"))
      throw p.error("concentration", "\"absorbance_1cm\" is that of the whole and has no concentration");
    // The absorbance of 1 cm at 1 mol/L equals the molar absorptivity in L/(mol cm).
    return {name, read_spectrum(p, given), 1};
  }
  if (!p.has("concentration"))
    throw p.error("concentration", "the parameter \"concentration\" is required, in mol/L");
  const double concentration = p.get_float("concentration", Range::non_negative());
  if (given == std::string_view("molar_absorptivity")) return {name, read_spectrum(p, given), concentration};
  p.get_choice("substance", "", {"riboflavin"});
  return {name, optics::riboflavin_absorptivity(), concentration};
}

class DyeIngredient final : public Ingredient {
public:
  explicit DyeIngredient(const Properties& p) : Ingredient(p), dye_(read_dye(p, name())) {}

  void add_to(IngredientList& list) const override { list.dyes.push_back(dye_); }

private:
  optics::Dye dye_;
};

AUREOLE_PLUGIN(DyeIngredient, "ingredient", "dye",
               PluginDoc{"A dissolved substance that absorbs and does not scatter.",
                         "Beer 1852; IUPAC Compendium of Chemical Terminology, \"Beer-Lambert law\"",
                         {{"substance", "string", "", "none",
                           "riboflavin (vitamin B2 in water: PhotochemCAD, Du et al. 1998; Koziol 1966)"},
                          {"molar_absorptivity", "spectrum", "L/(mol cm)", "none",
                           "decadic molar absorptivity: the absorbance of 1 cm at 1 mol/L"},
                          {"concentration", "float", "mol/L", "required",
                           "concentration; used with substance or molar_absorptivity"},
                          {"absorbance_1cm", "spectrum", "", "none",
                           "decadic absorbance -lg T of 1 cm, as a spectrometer measures it; replaces the "
                           "other parameters"}},
                         {R"(<ingredient type="dye">
    <string name="substance" value="riboflavin"/> <float name="concentration" value="4e-5"/>
</ingredient>)",
                          R"(<ingredient type="dye">
    <spectrum name="molar_absorptivity" value="400:2000, 450:9000, 520:30000, 560:12000, 620:300"/>
    <float name="concentration" value="2e-5"/>
</ingredient>)",
                          R"(<ingredient type="dye">
    <spectrum name="absorbance_1cm" value="360:3, 420:1.6, 520:2, 620:0.35, 700:0.1, 830:0.05"/>
</ingredient>)"}});

}  // namespace
}  // namespace aureole
