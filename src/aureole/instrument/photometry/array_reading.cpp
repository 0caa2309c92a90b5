// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/photometry/array_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/letter_case.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/pigment/text_table.h"
#include "aureole/spectrum/tables.h"

namespace aureole {
namespace {

/// Lines of mercury and argon, as calibration lamps have them, in air [nm] (NIST Atomic Spectra Database).
const std::vector<double> kMercuryArgon{404.656, 435.833, 546.074, 696.543, 738.398, 763.511, 811.531};

/// The mean spectral radiance of a part of a spectral picture.
LampPower picture_spectrum(const ArrayReadingSettings& o) {
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
  const auto whole = [](double v) { return v >= 0 && v <= 1e8 ? int(v) : -1; };
  int x0 = 0, y0 = 0, x1 = image.width, y1 = image.height;
  if (!o.pixel.empty()) {
    x0 = whole(o.pixel[0]), y0 = whole(o.pixel[1]), x1 = x0 + 1, y1 = y0 + 1;
  } else if (!o.region.empty()) {
    x0 = whole(o.region[0]), y0 = whole(o.region[1]), x1 = x0 + whole(o.region[2]),
    y1 = y0 + whole(o.region[3]);
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

}  // namespace

ArrayReading read_by_array(const ArrayReadingSettings& o) {
  const optics::ArraySpectrograph& a = o.array;
  try {
    check(a);
  } catch (const std::domain_error& e) {
    throw Error(e.what());
  }
  ArrayReading r;
  const bool is_picture = lower_extension(o.target) == ".exr";
  if (!is_picture && (!o.pixel.empty() || !o.region.empty()))
    r.notes.push_back("--pixel and --region have no effect on a lamp");
  const LampPower spectrum = is_picture ? picture_spectrum(o) : lamp_power(o.target);
  const TabulatedSpectrum table{spectrum.nm, spectrum.power};
  if (spectrum.nm.front() > a.first_nm || spectrum.nm.back() < a.last_nm)
    r.notes.push_back(
        fmt::format("{}: is known from {:g} to {:g} nm; beyond these wavelengths it counts as dark", o.target,
                    spectrum.nm.front(), spectrum.nm.back()));
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
      r.notes.push_back(
          fmt::format("lines of {:g} and {:g} nm are nearer than {:g} nm and may be taken for each other",
                      lines[i - 1], lines[i], search));
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
  std::vector<double>&nm = r.nm, &values = r.values, &truth = r.truth;
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
  r.xy = chromaticity_of(nm, values), r.true_xy = chromaticity_of(spectrum.nm, spectrum.power);
  r.scale_residual_nm = scale.residual_nm, r.lines = lines.size();
  r.mean_deviation = all > 0 ? weighted / all : 0;
  return r;
}

}  // namespace aureole
