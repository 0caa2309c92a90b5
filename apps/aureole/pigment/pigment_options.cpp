// SPDX-License-Identifier: Apache-2.0
#include "pigment/pigment_options.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/instrument/paint/two_flux_doubt.h"
#include "messages.h"

namespace aureole {

void SurfaceOptions::declare(CommandOptions& options, const std::string& whose) {
  options
      .add("--geometry", geometry,
           "measurement geometry of the interface to air in " + whose +
               ": diffuse, d8 (sphere), 45_0, or none")
      .one_of({"none", "diffuse", "d8", "45_0"});
  options
      .add(
          "--specular", specular,
          "specular reflection of the interface: included or excluded (the default, unless a file states it)")
      .one_of({"included", "excluded"});
  options.add("--index", index, "index of refraction of the binder").between(1.0, 4.0).shows_default();
  options.add("--alpha", alpha, "roughness of the interface (GGX), with --geometry diffuse")
      .between(0.0, 1.0);
  options.add("--k1", k1, "Saunderson's reflectance from outside, with --k2 instead of --geometry")
      .between(0.0, 0.9999);
  options.add("--k2", k2, "Saunderson's reflectance from inside").between(0.0, 0.9999);
}

pigment::Surface SurfaceOptions::surface() const {
  using namespace pigment;
  try {
    if (k1 >= 0 || k2 >= 0) {
      if (!(k1 >= 0 && k2 >= 0)) throw Error("--k1 and --k2 are given together");
      if (!geometry.empty()) throw Error("--geometry: is not used where --k1 and --k2 are given");
      return saunderson_surface(k1, k2, light());
    }
    if (alpha > 0 && geometry != "diffuse")
      throw Error("--alpha: a rough interface needs --geometry diffuse");
    if (alpha > 0) return rough_surface(index, alpha, light());
    if (!geometry.empty() && geometry != "none")
      return smooth_surface(index, geometry_called(geometry), light());
  } catch (const std::domain_error& e) {
    throw Error(e.what());
  }
  return {};
}

void SurfaceOptions::set(pigment::Palette& palette, const std::string& file) const {
  palette.surface = surface();
  if (!palette.streams) return;
  if (k1 >= 0 || alpha > 0) {
    tell("note: {}: {}\n", file, pigment::theory_note(palette));
    palette.streams.reset();
    return;
  }
  palette.streams->index = geometry == "none" ? 1 : index;
  if (geometry != "none")
    palette.streams->geometry = pigment::geometry_called(geometry), palette.streams->specular = light();
}

void SurfaceOptions::take(const pigment::Instrument& instrument, const std::string& file, bool is_taken_off) {
  if (instrument.geometry.empty()) return;
  const bool says_specular = !instrument.specular.empty() && instrument.geometry != "45_0";
  if (given()) {
    // Whether the specular component is taken from the file, because options state the geometry alone.
    const bool completes = specular.empty() && says_specular && geometry == instrument.geometry;
    if (completes) {
      specular = instrument.specular;
      tell("note: {}: states that specular light is {}; --specular says otherwise\n", file, specular);
      return;
    }
    const bool differs = (!geometry.empty() && geometry != instrument.geometry) ||
                         (says_specular && geometry != "none" && specular_text() != instrument.specular);
    if (differs)
      tell("note: {}: states the geometry {}; the options, which differ, are taken\n", file,
           stated(instrument));
    return;
  }
  geometry = instrument.geometry;
  if (!specular.empty() && says_specular && specular != instrument.specular) {
    tell(
        "note: {}: was measured at the geometry {}; --specular {}, which differs, is taken: the interface of index {:g} "
        "is taken off{}\n",
        file, stated(instrument), specular, index, is_taken_off ? "" : " for K/S and conversions");
    return;
  }
  if (specular.empty()) specular = instrument.specular;
  if (!is_taken_off) {
    tell(
        "note: {}: was measured at the geometry {}{}; K/S and conversions are those of the interface of index {:g}\n",
        file, stated(instrument),
        instrument.specular.empty() ? ", and does not say whether specular light is included" : "", index);
    return;
  }
  tell(
      "note: {}: was measured at the geometry {}{}: the interface of index {:g} is taken off; --geometry none takes "
      "none off\n",
      file, stated(instrument),
      instrument.specular.empty() ? ", and does not say whether specular light is included" : "", index);
}

std::string SurfaceOptions::stated(const pigment::Instrument& instrument) {
  return instrument.geometry + (instrument.specular.empty() ? "" : ", specular " + instrument.specular);
}

std::string SurfaceOptions::specular_text() const { return specular.empty() ? "excluded" : specular; }

void SurfaceOptions::note_unused(bool fits_streams) const {
  if (index != SurfaceOptions().index && ((k1 >= 0 && !fits_streams) || !given() || geometry == "none"))
    tell("note: --index: has no effect {}\n",
         k1 >= 0 ? "with --k1 and --k2" : "without an interface (--geometry)");
  if (k1 >= 0 && alpha > 0) tell("note: --alpha: has no effect with --k1 and --k2\n");
  if (specular == "included" && (!given() || geometry == "none"))
    tell("note: --specular: has no effect without an interface (--geometry, or --k1 and --k2)\n");
}

void note_two_flux_doubt(const pigment::Palette& palette, const pigment::Paint& paint, double thickness,
                         double substrate, double index, const pigment::Observation& lamp,
                         const std::string& whose) {
  constexpr double kDoubtful = 1;
  if (std::isinf(thickness)) return;
  // The interface of the binder; a palette without an interface was measured without one being removed.
  const double doubt =
      two_flux_doubt(paint, palette.nm, thickness, substrate, palette.surface.k2 > 0 ? index : 1, lamp);
  if (doubt > kDoubtful)
    tell(
        "note: two fluxes may be off by a Delta E of {:.1f} for {} (CIEDE2000 from transport with g from 0 to 0.8), as for "
        "thin, dark or forward-scattering ones; K and S of layers of like thickness are off by less\n",
        doubt, whose);
}

void note_substrate(double substrate, const std::string& thickness) {
  if (substrate != 1 && thickness.empty())
    tell("note: --substrate: has no effect without --thickness: the layer is opaque\n");
}

std::string SurfaceOptions::text() const {
  const std::string with = ", specular " + specular_text();
  if (k1 >= 0) return fmt::format("Saunderson, k1 {:g}, k2 {:g}{}", k1, k2, with);
  if (!given() || geometry == "none") return "none";
  return fmt::format("{} {}, index {:g}{}", alpha > 0 ? fmt::format("rough (alpha {:g}),", alpha) : "smooth,",
                     geometry, index, geometry == "45_0" ? "" : with);
}

void LightOptions::declare(CommandOptions& options, const std::string& what) {
  options
      .add("--illuminant", illuminant,
           what + ": a name of the CIE, or a file of a measured lamp (wavelength, power)")
      .names_input()
      .shows_default();
  options
      .add("--observer", observer, "field of the CIE observer in degrees: 2 (1931, the default) or 10 (1964)")
      .one_of({"2", "10"});
}

std::string LightOptions::viewing() const {
  const std::string name = viewed_at(illuminant, field());
  if (!observer.empty() && (viewing_of(name).field == pigment::Field::ten) != (observer == "10"))
    throw Error("--illuminant " + illuminant + ": states another observer than --observer " + observer +
                "; give one of them, as in --illuminant " + viewing_of(illuminant).illuminant +
                " --observer " + observer);
  return name;
}

std::string LightOptions::field() const {
  if (!observer.empty()) return observer;
  return viewing_of(illuminant).field == pigment::Field::ten ? "10" : "2";
}

std::vector<std::string> LightOptions::others(const std::vector<std::string>& names) const {
  std::vector<std::string> all;
  const Viewing own = viewing_of(viewing());
  for (const std::string& name : names) {
    const std::string other = viewed_at(name, field());
    const Viewing of = viewing_of(other);
    if (of.illuminant != own.illuminant || of.field != own.field) {
      all.push_back(other);
    } else if (names != kUsualOthers) {
      tell("note: --others {}: is the illuminant of the colours itself and left out\n", name);
    }
  }
  return all;
}

void DifferenceOptions::declare(CommandOptions& options) {
  options
      .add("--others", others,
           "illuminants, or observers as in D65/10, of the metamerism indices (default A,F11)")
      .separated_by(',');
  options.add("--cmc", cmc, "l:c of the CMC difference (default 2:1)").separated_by(':');
}

void DifferenceOptions::complete() {
  if (others.empty()) others = kUsualOthers;
  if (cmc.empty()) cmc = {2, 1};
  if (cmc.size() != 2 || !(cmc[0] > 0 && cmc[1] > 0))
    throw Error("--cmc: expected two positive numbers l:c, as in 2:1");
}

void LayerOfPaint::declare(CommandOptions& options) {
  options.add("palette", palette, "palette.csv as `aureole pigment fit` writes it, or kimera").required();
  options.add("recipe", recipe, "paints and parts by mass, \"red: 1 + white: 3\", or per cent").required();
  options.add("--volume", by_volume, "the parts are by volume; the palette needs densities");
  options.add(
      "--thickness", thickness,
      "thickness of the layer, \"20um\"; for palettes without a unit of length a number, in 1/S of the white or in films");
  light.declare(options, "illuminant of the colours");
  options.add("--json", json, "also write the results to this file").names_output();
}

pigment::Palette usable_palette(const std::string& file, const SurfaceOptions& surface) {
  pigment::Palette palette = read_palette_file(file);
  if (const int count = pigment::clamp_negative(palette))
    tell("note: {}: {} negative values of K and S count as zero\n", file, count);
  if (surface.given()) surface.set(palette, file);
  return palette;
}

double thickness_for(const pigment::Palette& palette, const std::string& text) {
  if (text.empty()) return std::numeric_limits<double>::infinity();
  double value = 0;
  try {
    value = palette.relative ? parse_number(text) : parse_length_m(text);
  } catch (const Error& e) {
    throw Error("--thickness: " + e.message() +
                (palette.per_film ? " (K and S of this palette are per film: thickness counts in films)"
                 : palette.relative
                     ? " (K and S of this palette are relative: thickness counts in 1/S of the white)"
                     : ""));
  }
  if (!(value > 0)) throw Error("--thickness: must be positive, got " + text);
  return value;
}

double shown(double value) { return value < 0 && value > -0.005 ? 0.0 : value; }

std::string colour_text(const pigment::Observation& lamp, const std::vector<double>& reflectance) {
  const pigment::Lab lab = lamp.lab(reflectance);
  return fmt::format("L* {:6.2f}  a* {:7.2f}  b* {:7.2f}  {}", lab.l, shown(lab.a), shown(lab.b),
                     screen_colour(lamp.xyz(reflectance), lamp.white()));
}

PlotSeries spectrum_line(const std::vector<double>& nm, const std::vector<double>& values,
                         const std::string& label, const std::string& colour) {
  PlotSeries series;
  series.x = nm, series.y = values, series.label = label, series.color = colour;
  return series;
}

}  // namespace aureole
