// SPDX-License-Identifier: Apache-2.0
// Options and tables that the commands `aureole pigment ...` share.
#pragma once

#include <string>
#include <vector>

#include "aureole/instrument/report/svg_plot.h"
#include "aureole/pigment/match.h"
#include "aureole/pigment/paints.h"
#include "command.h"

namespace aureole {

/// The interface between binder and air: an index and how it is seen, or Saunderson's k1 and k2.
struct SurfaceOptions {
  std::string geometry, specular = "excluded";
  double index = 1.5, alpha = 0, k1 = -1, k2 = -1;

  /// `whose`: what they are said of in the help, "the measurements".
  void declare(CommandOptions& options, const std::string& whose);
  bool given() const { return !geometry.empty() || k1 >= 0 || k2 >= 0; }
  /// Throws Error where k1 and k2 are half given, or do not go with the rest.
  pigment::Surface surface() const;
};

/// A layer of paint: a recipe, a thickness and what it lies on.
struct LayerOfPaint {
  std::string palette = "kimera", recipe, thickness, illuminant = "D65", json;
  bool by_volume = false;

  void declare(CommandOptions& options);
};

/// Reads the palette, tells how many negative values count as zero, and puts another interface where one is
/// given.
pigment::Palette usable_palette(const std::string& file, const SurfaceOptions& surface);

/// "20um" in metres for a palette per metre; a plain number, in units of 1/S of the white, for a relative
/// one; empty: infinite.
double thickness_for(const pigment::Palette& palette, const std::string& text);

/// "L* 53.24  a* 80.09  b* 67.20  #ff0000".
std::string colour_text(const pigment::Observation& lamp, const std::vector<double>& reflectance);

/// A line over the wavelengths, of a colour.
PlotSeries spectrum_line(const std::vector<double>& nm, const std::vector<double>& values,
                         const std::string& label, const std::string& colour);

}  // namespace aureole
