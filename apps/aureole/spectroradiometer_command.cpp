// SPDX-License-Identifier: Apache-2.0
// aureole spectroradiometer: a lamp, or pixels of a spectral picture, as an array spectroradiometer reads it.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "aureole/core/output_file.h"
#include "aureole/instrument/photometry/array_reading.h"
#include "aureole/instrument/report/svg_plot.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

struct SpectroradiometerOptions : ArrayReadingSettings {
  std::string output, json, plot;
  std::vector<double> range{350, 850};
  bool is_quiet = false;
};

int spectroradiometer(SpectroradiometerOptions o) {
  o.array.first_nm = o.range[0], o.array.last_nm = o.range[1];
  const ArrayReading r = read_by_array(o);
  for (const std::string& note : r.notes) tell("note: {}\n", note);
  if (!o.is_quiet) {
    fmt::print("{}: {} pixels, {:.2f} to {:.2f} nm by {} lines, which are {:.3f} nm off (RMS)\n", o.target,
               o.array.pixels, r.nm.front(), r.nm.back(), r.lines, r.scale_residual_nm);
    fmt::print(
        "read x {:.5f}  y {:.5f}; the spectrum itself x {:.5f}  y {:.5f}; mean deviation {:.2f} % of the mean\n",
        r.xy.x, r.xy.y, r.true_xy.x, r.true_xy.y, 100 * r.mean_deviation);
  }
  if (!o.output.empty()) {
    std::string text =
        "# wavelength in nm, spectral power in the unit of the lamp or the picture\nwavelength,power\n";
    for (std::size_t i = 0; i < r.nm.size(); ++i)
      text += fmt::format("{:.3f},{:.6g}\n", r.nm[i], std::max(r.values[i], 0.0));
    write_file_atomically(o.output, text);
  }
  if (!o.json.empty())
    write_file_atomically(o.json, nlohmann::json{{"wavelengths_nm", r.nm},
                                                 {"values", r.values},
                                                 {"xy", {r.xy.x, r.xy.y}},
                                                 {"true_xy", {r.true_xy.x, r.true_xy.y}},
                                                 {"scale_residual_nm", r.scale_residual_nm}}
                                          .dump(1) +
                                      "\n");
  if (!o.plot.empty()) {
    Plot plot{o.target, "wavelength, nm", "spectral power", {}, false};
    PlotSeries measured, itself;
    measured.x = r.nm, measured.y = r.values, measured.label = "read", measured.color = "#2050c0";
    itself.x = r.nm, itself.y = r.truth, itself.label = "the spectrum itself", itself.color = "#c03020";
    plot.series = {itself, measured};
    write_file_atomically(o.plot, svg_plot(plot));
  }
  return 0;
}

std::function<int()> declare_spectroradiometer(CommandOptions& options) {
  auto o = std::make_shared<SpectroradiometerOptions>();
  optics::ArraySpectrograph& a = o->array;
  options
      .add("target", o->target,
           "an illuminant (A, FL11), a lamp's file of wavelengths and powers, or a spectral picture (.exr)")
      .required();
  options.add("--pixel", o->pixel, "x,y: one pixel of the picture").separated_by(',').takes(2);
  options.add("--region", o->region, "x,y,width,height: a part of the picture (default: all of it)")
      .separated_by(',')
      .takes(4);
  options
      .add("--range", o->range,
           "wavelengths of the first and the last pixel of the array in nm (default 350,850)")
      .separated_by(',')
      .takes(2);
  options.add("--pixels", a.pixels, "pixels of the array").between(8, 4096).shows_default();
  options.add("--slit", a.slit_nm, "full width of the slit function at half maximum in nm").shows_default();
  options.add("--curvature", a.curvature_nm, "how far the middle pixel is off a linear scale, in nm")
      .shows_default();
  options.add("--scattered", a.scattered, "fraction of the light that is scattered evenly over the array")
      .shows_default();
  options.add("--halo", a.halo, "fraction of the light in a halo of 40 nm").shows_default();
  options.add("--electrons", a.electrons, "signal of the brightest pixel; 0: no noise").shows_default();
  options.add("--read-noise", a.read_noise, "noise of reading a pixel, in electrons").shows_default();
  options.add("--lines", o->lines, "wavelengths of the calibration lamp in nm (default: mercury and argon)")
      .separated_by(',');
  options.add("--keep-stray", o->keep_stray, "do not correct stray light");
  options.add("--deconvolve", o->deconvolution, "iterations of Richardson and Lucy against the slit function")
      .between(0, 10000);
  options.add("--seed", o->seed, "seed of the noise").shows_default();
  options.add("-o,--output", o->output, "write wavelengths and powers to this .csv, which --illuminant reads")
      .names_output();
  options.add("--json", o->json, "write readings to this file").names_output();
  options.add("--plot", o->plot, "write the spectrum to this SVG file").names_output();
  options.add("-q,--quiet", o->is_quiet, "print errors only");
  return [o] { return spectroradiometer(*o); };
}

AUREOLE_COMMAND("spectroradiometer",
                "A lamp or pixels of a spectral picture as an array spectroradiometer reads them",
                declare_spectroradiometer);

}  // namespace
}  // namespace aureole
