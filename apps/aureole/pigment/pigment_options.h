// SPDX-License-Identifier: Apache-2.0
// Options and tables shared by the commands `aureole pigment ...`.
#pragma once

#include <string>
#include <vector>

#include "aureole/instrument/report/svg_plot.h"
#include "aureole/pigment/match.h"
#include "aureole/pigment/paints.h"
#include "aureole/pigment/samples.h"
#include "command.h"

namespace aureole {

/// The interface between binder and air: an index and a measurement geometry, or Saunderson's k1 and k2.
struct SurfaceOptions {
  std::string geometry, specular;  ///< geometry and specular component; specular "" means excluded
  double index = 1.5, alpha = 0, k1 = -1, k2 = -1;

  /// Declares the options; `whose` completes the help text, for example "the measurements".
  void declare(CommandOptions& options, const std::string& whose);
  pigment::Specular light() const {
    return specular == "included" ? pigment::Specular::included : pigment::Specular::excluded;
  }
  bool given() const { return !geometry.empty() || k1 >= 0 || k2 >= 0; }
  /// Throws Error if only one of k1 and k2 is given, or if they are combined with the other options.
  pigment::Surface surface() const;
  /// The palette with the given interface. A palette by streams keeps its theory where this interface is smooth with an
  /// index; under another one its K and S are used by two fluxes, with a note.
  void set(pigment::Palette& palette, const std::string& file) const;
  /// Takes the geometry and the specular component that a file of measurements states, unless options give them; notes
  /// what is taken.
  /// `is_taken_off` says whether reflectances are used without the interface; otherwise only K/S is.
  void take(const pigment::Instrument& instrument, const std::string& file, bool is_taken_off = true);
  /// Notes options that have no effect beside the others. A theory by streams has the index beside k1 and k2.
  void note_unused(bool fits_streams = false) const;
  /// A geometry that a file states, in words: "d8, specular included".
  static std::string stated(const pigment::Instrument& instrument);
  /// Returns "included" or "excluded", with the default applied.
  std::string specular_text() const;
  /// Returns the interface in words, for reports: "Saunderson, k1 0.04, k2 0.6, specular excluded".
  std::string text() const;
};

/// Illuminants under which metamerism is judged unless options name others.
inline const std::vector<std::string> kUsualOthers{"A", "F11"};

/// The options of differences from a standard.
struct DifferenceOptions {
  std::vector<std::string> others;  ///< illuminants of the metamerism indices
  std::vector<double> cmc;          ///< l and c of the CMC difference

  void declare(CommandOptions& options);
  /// Sets the values of options that were not given. Throws Error unless l and c are two positive numbers.
  void complete();
};

/// The illuminant and the observer of colours.
struct LightOptions {
  std::string illuminant = "D65",
              observer;  ///< names; observer "": 2 degrees, unless the illuminant's name states the observer

  /// Declares the options; `what` is the help text of --illuminant.
  void declare(CommandOptions& options, const std::string& what);
  /// Returns the name for `observe`: "D65", or "D65/10" for the 10-degree observer. Throws Error if the name
  /// states another observer than --observer.
  std::string viewing() const;
  /// The observer's field in degrees: "2" or "10".
  std::string field() const;
  /// Returns the other illuminants, under this observer unless they state one themselves. `viewing()` is left
  /// out of them, with a note unless `names` are the usual ones.
  std::vector<std::string> others(const std::vector<std::string>& names) const;
};

/// A layer of paint: a recipe, a thickness and a substrate.
struct LayerOfPaint {
  std::string palette = "kimera", recipe, thickness, json;
  LightOptions light;
  bool by_volume = false;

  void declare(CommandOptions& options);
};

/// Reads the palette, reports the number of negative values that are set to zero, and replaces the interface
/// if one is given (`SurfaceOptions::set`). What options of the interface have no effect is for the caller to note.
pigment::Palette usable_palette(const std::string& file, const SurfaceOptions& surface);

/// Notes where two fluxes are expected to be off by a visible colour difference for a layer (`two_flux_doubt`). `whose`
/// names the layer: "this layer". `index` is the index of refraction of the binder, where the palette has an
/// interface.
void note_two_flux_doubt(const pigment::Palette& palette, const pigment::Paint& paint, double thickness,
                         double substrate, double index, const pigment::Observation& lamp,
                         const std::string& whose);

/// Notes a substrate that was given (not 1) below an opaque layer.
void note_substrate(double substrate, const std::string& thickness);

/// Parses "20um" to metres for a palette per metre, or a plain number in units of 1/S of the white for a
/// relative one; empty: infinite.
double thickness_for(const pigment::Palette& palette, const std::string& text);

/// Returns a value to print with two digits: zero instead of values that would be printed as -0.00.
double shown(double value);

/// Returns text such as "L* 53.24 a* 80.09 b* 67.20 #ff0000".
std::string colour_text(const pigment::Observation& lamp, const std::vector<double>& reflectance);

/// Returns a line over the wavelengths, with a given colour.
PlotSeries spectrum_line(const std::vector<double>& nm, const std::vector<double>& values,
                         const std::string& label, const std::string& colour);

}  // namespace aureole
