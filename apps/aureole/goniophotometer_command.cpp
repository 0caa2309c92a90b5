// SPDX-License-Identifier: Apache-2.0
// aureole goniophotometer: the luminous intensities of a modelled luminaire, or of a file, as IES and EULUMDAT files.
#include <fmt/format.h>

#include "aureole/core/output_file.h"
#include "aureole/instrument/report/svg_plot.h"
#include "command.h"
#include "luminaire_target.h"

namespace aureole {
namespace {

struct GonioArguments : LuminaireTarget {
  std::string plot;
};

void print_luminaire(const GonioArguments& a, const Luminaire& l) {
  const LuminaireFigures f = luminaire_figures(l);
  const optics::IntensityDistribution& d = l.distribution;
  fmt::print("{}: {}, type {}, {} x {} angles", a.target, l.standard,
             l.type == optics::PhotometricType::a   ? "A"
             : l.type == optics::PhotometricType::b ? "B"
                                                    : "C",
             l.horizontal_count, l.vertical_count);
  fmt::print("{}\n", l.symmetry.empty() ? "" : ", symmetry " + l.symmetry);
  fmt::print("  {}\n", flux_balance(l).text());
  if (l.type == optics::PhotometricType::c)
    fmt::print("  {:.1f} % of the flux goes down (gamma below 90 degrees)\n",
               f.flux > 0 ? 100 * f.downward_flux / f.flux : 0);
  fmt::print(
      "  largest intensity {:.6g} cd at azimuth {:g}, polar angle {:g} degrees; {:.6g} cd at both angles zero\n",
      f.peak, f.peak_c, f.peak_gamma, d.intensity({0, 0, 1}));
  if (l.type == optics::PhotometricType::c && f.beam[0] > 0 && f.beam[1] > 0)
    fmt::print("  full width at half of that: {:.1f} degrees in C 0-180, {:.1f} in C 90-270\n", f.beam[0],
               f.beam[1]);
  const auto& s = l.opening.size_m;
  if (l.opening.is_point())
    fmt::print("  luminous opening: a point\n");
  else
    fmt::print("  luminous opening: {:.4g} m along, {:.4g} m across, {:.4g} m high\n", s[0], s[1], s[2]);
}

std::string intensity_plot(const GonioArguments& a, const Luminaire& l) {
  Plot plot{a.target, "gamma, degrees", "cd", {}, false};
  const std::pair<double, const char*> planes[] = {
      {0, "#2050c0"}, {90, "#208030"}, {180, "#c03020"}, {270, "#806020"}};
  for (const auto& [c, colour] : planes) {
    PlotSeries series;
    for (int i = 0; i <= 360; ++i)
      series.x.push_back(0.5 * i), series.y.push_back(l.distribution.at(c, 0.5 * i));
    series.label = fmt::format("C {:g}", c), series.color = colour;
    plot.series.push_back(series);
    if (l.distribution.is_rotational()) break;
  }
  return svg_plot(plot);
}

int goniophotometer(const GonioArguments& a) {
  const Luminaire l = luminaire_of(a);
  if (!a.plot.empty()) write_file_atomically(a.plot, intensity_plot(a, l));
  if (!a.quiet) print_luminaire(a, l);
  return 0;
}

std::function<int()> declare_goniophotometer(CommandOptions& options) {
  auto a = std::make_shared<GonioArguments>();
  add_luminaire_target(options, *a);
  options.add("--plot", a->plot, "write the intensities over gamma to this SVG file").names_output();
  options.add("-q,--quiet", a->quiet, "print errors only");
  return [a] { return goniophotometer(*a); };
}

AUREOLE_COMMAND("goniophotometer",
                "Luminous intensities of a luminaire: measure a scene, read and write IES and EULUMDAT",
                declare_goniophotometer);

}  // namespace
}  // namespace aureole
