// SPDX-License-Identifier: Apache-2.0
// aureole spectroradiometer: a lamp, or pixels of a spectral picture, as an array spectroradiometer reads it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/optics/photometry/spectroradiometer.h"
#include "aureole/pigment/colour_spaces.h"
#include "aureole/pigment/text_table.h"
#include "aureole/spectrum/tables.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

struct SpectroradiometerOptions {
  std::string target, output, json, plot;
  std::vector<double> pixel, region, range{350, 850}, lines;
  optics::ArraySpectrograph array;
  int deconvolution = 0;
  std::uint64_t seed = 0;
  bool keep_stray = false, is_quiet = false;
};

/// Lines of mercury and argon, as calibration lamps have them, in air [nm] (NIST Atomic Spectra Database).
const std::vector<double> kMercuryArgon{404.656, 435.833, 546.074, 696.543, 738.398, 763.511, 811.531};

/// The mean spectral radiance of a part of a spectral picture.
LampPower picture_spectrum(const SpectroradiometerOptions& o) {
  const Image image = read_image(o.target);
  std::vector<std::pair<double, std::size_t>> bins;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    std::string name = image.channels[c];
    if (!name.starts_with("S0.") || !name.ends_with("nm")) continue;
    name = name.substr(3, name.size() - 5);
    std::replace(name.begin(), name.end(), ',', '.');
    if (const auto nm = pigment::finite_number(name)) bins.emplace_back(*nm, c);
  }
  if (bins.size() < 2)
    throw Error(
        {o.target, 0, 0},
        "is no spectral picture: channels such as S0.550,00nm are expected (film specfilm with bins)");
  std::sort(bins.begin(), bins.end());
  int x0 = 0, y0 = 0, x1 = image.width, y1 = image.height;
  if (!o.pixel.empty()) {
    x0 = int(o.pixel[0]), y0 = int(o.pixel[1]), x1 = x0 + 1, y1 = y0 + 1;
  } else if (!o.region.empty()) {
    x0 = int(o.region[0]), y0 = int(o.region[1]), x1 = x0 + int(o.region[2]), y1 = y0 + int(o.region[3]);
  }
  if (!(x0 >= 0 && y0 >= 0 && x1 > x0 && y1 > y0 && x1 <= image.width && y1 <= image.height))
    throw Error({o.target, 0, 0},
                fmt::format("the picture has {} x {} pixels; {},{} to {},{} is not within it", image.width,
                            image.height, x0, y0, x1 - 1, y1 - 1));
  LampPower s;
  for (const auto& [nm, c] : bins) {
    double sum = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) sum += double(image.at(x, y, c));
    s.nm.push_back(nm), s.power.push_back(std::max(0.0, sum / (double(x1 - x0) * double(y1 - y0))));
  }
  return s;
}

int spectroradiometer(SpectroradiometerOptions o) {
  optics::ArraySpectrograph& a = o.array;
  a.first_nm = o.range[0], a.last_nm = o.range[1];
  try {
    check(a);
  } catch (const std::domain_error& e) {
    throw Error(e.what());
  }
  const bool is_picture = std::filesystem::path(o.target).extension() == ".exr";
  if (!is_picture && (!o.pixel.empty() || !o.region.empty()))
    tell("note: --pixel and --region have no effect on a lamp\n");
  const LampPower spectrum = is_picture ? picture_spectrum(o) : lamp_power(o.target);
  const TabulatedSpectrum table{spectrum.nm, spectrum.power};
  if (spectrum.nm.front() > a.first_nm || spectrum.nm.back() < a.last_nm)
    tell("note: {}: is known from {:g} to {:g} nm; beyond these wavelengths it counts as dark\n", o.target,
         spectrum.nm.front(), spectrum.nm.back());
  // The scale of wavelengths by a calibration lamp, the responsivity by a lamp of even power.
  const std::vector<double>& lines = o.lines.empty() ? kMercuryArgon : o.lines;
  std::vector<double> of_lines(std::size_t(a.pixels));
  for (const double nm : lines) {
    const std::vector<double> one = line_signal(a, nm);
    for (std::size_t i = 0; i < one.size(); ++i) of_lines[i] += one[i];
  }
  const double search = std::abs(a.curvature_nm) + 2 * a.slit_nm;
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (std::abs(lines[i] - lines[i - 1]) < search)
      tell("note: lines of {:g} and {:g} nm are nearer than {:g} nm and may be taken for each other\n",
           lines[i - 1], lines[i], search);
  optics::WavelengthScale scale;
  try {
    scale = optics::calibrate_wavelengths(with_array_noise(a, of_lines, o.seed + 1), lines, a.first_nm,
                                          a.last_nm, search);
  } catch (const std::domain_error& e) {
    throw Error(fmt::format("--lines: {}", e.what()));
  }
  std::vector<double> even = with_array_noise(a, array_signal(a, [](double) { return 1.0; }), o.seed + 2);
  std::vector<double> signal =
      with_array_noise(a, array_signal(a, [&](double nm) { return table.at(nm); }), o.seed + 3);
  if (*std::max_element(signal.begin(), signal.end()) <= 0)
    throw Error({o.target, 0, 0}, fmt::format("has no light from {:g} to {:g} nm", a.first_nm, a.last_nm));
  if (!o.keep_stray) {
    const optics::StrayLightMatrix matrix(a);
    even = matrix.corrected(even), signal = matrix.corrected(signal);
  }
  std::vector<double> nm, values, truth;
  double weighted = 0, all = 0;
  for (int i = 0; i < a.pixels; ++i) {
    nm.push_back(scale.nm_at(i));
    values.push_back(even[std::size_t(i)] > 0 ? signal[std::size_t(i)] / even[std::size_t(i)] : 0);
  }
  if (o.deconvolution > 0) values = optics::without_slit(a, values, o.deconvolution);
  for (std::size_t i = 0; i < nm.size(); ++i) {
    truth.push_back(table.at(nm[i]));
    weighted += std::abs(values[i] - truth[i]), all += truth[i];
  }
  const auto chromaticity_of = [](const std::vector<double>& at, const std::vector<double>& power) {
    const auto xyz = cie_tristimulus({at, power});
    return pigment::chromaticity({xyz[0], xyz[1], xyz[2]});
  };
  const pigment::Chromaticity read = chromaticity_of(nm, values),
                              real = chromaticity_of(spectrum.nm, spectrum.power);
  if (!o.is_quiet) {
    fmt::print("{}: {} pixels, {:.2f} to {:.2f} nm by {} lines, which are {:.3f} nm off (RMS)\n", o.target,
               a.pixels, nm.front(), nm.back(), lines.size(), scale.residual_nm);
    fmt::print(
        "read x {:.5f}  y {:.5f}; the spectrum itself x {:.5f}  y {:.5f}; mean deviation {:.2f} % of the mean\n",
        read.x, read.y, real.x, real.y, all > 0 ? 100 * weighted / all : 0);
  }
  if (!o.output.empty()) {
    std::string text =
        "# wavelength in nm, spectral power in the unit of the lamp or the picture\nwavelength,power\n";
    for (std::size_t i = 0; i < nm.size(); ++i)
      text += fmt::format("{:.3f},{:.6g}\n", nm[i], std::max(values[i], 0.0));
    write_file_atomically(o.output, text);
  }
  if (!o.json.empty())
    write_file_atomically(o.json, nlohmann::json{{"wavelengths_nm", nm},
                                                 {"values", values},
                                                 {"xy", {read.x, read.y}},
                                                 {"true_xy", {real.x, real.y}},
                                                 {"scale_residual_nm", scale.residual_nm}}
                                          .dump(1) +
                                      "\n");
  if (!o.plot.empty()) {
    Plot plot{o.target, "wavelength, nm", "spectral power", {}, false};
    PlotSeries measured, itself;
    measured.x = nm, measured.y = values, measured.label = "read", measured.color = "#2050c0";
    itself.x = nm, itself.y = truth, itself.label = "the spectrum itself", itself.color = "#c03020";
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
