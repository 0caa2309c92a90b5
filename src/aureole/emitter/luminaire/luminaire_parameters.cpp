// SPDX-License-Identifier: Apache-2.0
#include "aureole/emitter/luminaire/luminaire_parameters.h"

#include <fmt/format.h>

#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/spectrum/photometry.h"

namespace aureole {

namespace {

LuminaireOptions luminaire_options(const Properties& p) {
  LuminaireOptions options;
  options.lamp_set = std::size_t(p.get_int("lamp_set", 0, {0, 1000}));
  options.lamp_flux = p.get_float("lamp_flux", 0, Range::positive());
  const std::string zero = p.get_choice("c0", "format", {"format", "along", "across"});
  if (zero != "format")
    options.zero_plane =
        zero == "along" ? LuminaireOptions::ZeroPlane::along : LuminaireOptions::ZeroPlane::across;
  options.on_file = [&p](const std::filesystem::path& file) {
    if (p.context().scene) p.context().scene->add_file(file);
  };
  return options;
}

/// Returns the spectrum of the light; its scale is arbitrary.
TexturePtr relative_spectrum(const Properties& p) {
  if (!p.has("color_temperature")) {
    p.find("color_temperature");
    const TexturePtr t = get_texture(p, "spectrum", 1, SpectrumRole::emission);
    if (!t->is_constant()) throw p.error("spectrum", "expected a spectrum, not a texture");
    return t;
  }
  if (p.has("spectrum"))
    throw p.error("color_temperature", "give either \"color_temperature\" or \"spectrum\"");
  p.find("spectrum");
  const double kelvin = p.get_float("color_temperature", 6500, Range{100, 1e6});
  return std::dynamic_pointer_cast<const Texture>(
      make_object(p, "texture", "blackbody", {{"temperature", Properties::Value(kelvin)}}));
}

}  // namespace

LuminaireLight get_luminaire(const Properties& p) {
  const std::filesystem::path file = p.get_file("filename");
  const LuminaireOptions options = luminaire_options(p);
  LuminaireLight light{read_luminaire(file, options), relative_spectrum(p)};
  Luminaire& luminaire = light.luminaire;
  for (const std::string& note : luminaire.notes) p.note("filename", note);
  const bool is_c = luminaire.type == optics::PhotometricType::c;
  if (p.has("c0") && !is_c) p.note("c0", "has no effect: the file is not of type C");
  if (p.has("lamp_set") && luminaire.format != Luminaire::Format::eulumdat)
    p.note("lamp_set", "has no effect: files of LM-63 have one set of lamps");

  const FluxBalance balance = flux_balance(luminaire);
  if (!(balance.flux > 0)) throw p.error("filename", "the luminaire of the file emits no light");
  if (balance.lamp_flux > 0)
    p.note("filename",
           balance.text() + ". The intensities hold; the flux of the lamps has no further effect");
  if (luminaire.downward_fraction > 0) {
    const double downward = luminaire.distribution.flux(0, 90) / balance.flux;
    if (std::abs(downward - luminaire.downward_fraction) > 0.02)
      p.note("filename",
             fmt::format("{:.1f} % of the light goes down by the intensities, {:.1f} % by the file's own "
                         "statement, which has no effect",
                         100 * downward, 100 * luminaire.downward_fraction));
  }
  if (balance.output_ratio > 1.02)
    p.note("filename",
           "the luminaire emits more than its lamps do: the intensities or the flux of the lamps are wrong");

  double factor = p.get_float("scale", 1, Range::positive());
  const double flux = p.get_float("flux", balance.flux, Range::positive());
  if (p.has("flux")) factor *= flux / balance.flux;
  const double tilt = p.get_float("tilt_angle", 0, {-180, 180});
  if (!luminaire.tilt.angles.empty())
    factor *= luminaire.tilt.at(std::abs(tilt));
  else if (p.has("tilt_angle"))
    p.note("tilt_angle", "has no effect: the file states no factors of tilt");
  if (!(factor > 0)) throw p.error("tilt_angle", "the file's factor at this angle is 0: the lamp is dark");
  luminaire.distribution.scale(factor);
  light.flux = balance.flux * factor;

  if (!covers_photopic_vision(p.context().grid))
    throw p.error("filename",
                  "the film's wavelengths do not cover the visible, so that intensities in cd cannot be "
                  "converted to watts");
  const double lumens = product(light.per_candela->average(), photopic_efficacy(p.context().grid)).integral();
  if (!(lumens > 0)) throw p.error("spectrum", "has no light that the eye sees");
  light.per_candela = scaled_texture(light.per_candela, per_square_unit(p) / lumens);
  return light;
}

std::vector<ParameterDoc> luminaire_parameter_rows(std::vector<ParameterDoc> rows) {
  std::vector<ParameterDoc> all = {
      {"filename", "file", "", "required", "file in IES LM-63 (1986 to 2019; types A, B and C) or EULUMDAT"},
      {"spectrum", "spectrum", "", "1, CIE D65", "relative spectrum of the light; its scale has no effect"},
      {"color_temperature", "float", "K", "none", "instead of spectrum: a black body of this temperature"},
      {"flux", "float", "lm", "by the file",
       "luminous flux of the luminaire, to which the intensities are scaled"},
      {"lamp_flux", "float", "lm", "by the file",
       "luminous flux of all lamps together, to which intensities of relative photometry are scaled"},
      {"lamp_set", "integer", "", "0", "which of the alternative sets of lamps of an EULUMDAT file, from 0"},
      {"scale", "float", "", "1", "factor of the intensities, for dimming or maintenance"},
      {"tilt_angle", "float", "degrees", "0",
       "tilt of the lamp, where the file has factors for it (TILT=INCLUDE or TILT=file)"},
      {"c0", "string", "", "format",
       "where the half-plane C = 0 lies, for files of type C that deviate from their format: along or across "
       "the luminaire. By the format it runs along in LM-63, and across in EULUMDAT"}};
  all.insert(all.end(), rows.begin(), rows.end());
  return all;
}

}  // namespace aureole
