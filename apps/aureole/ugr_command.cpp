// SPDX-License-Identifier: Apache-2.0
// aureole ugr: the table of the unified glare rating of a luminaire in the standard rooms of the CIE.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/photometry/ugr_table.h"
#include "aureole/instrument/report/svg_plot.h"
#include "command.h"
#include "interruption.h"
#include "luminaire_target.h"
#include "messages.h"

namespace aureole {
namespace {

struct UgrArguments : LuminaireTarget {
  std::string csv, plot, background = "uniform";
  double spacing = 0.25;
  bool is_uncorrected = false;
};

/// The table for the flux of the luminaire, or for 1000 lm.
UgrTable shown_table(UgrTable table, bool is_uncorrected) {
  if (!is_uncorrected) return table;
  const double correction = table.correction();
  for (auto& view : table.rating)
    for (auto& row : view)
      for (double& v : row) v -= correction;
  return table;
}

std::string csv_of_ratings(const UgrTable& t) {
  std::string s = "x_H,y_H";
  for (int view = 0; view < 2; ++view)
    for (std::size_t k = 0; k < kUgrReflectances.size(); ++k) s += "," + ugr_column(view, k);
  s += "\n";
  for (std::size_t r = 0; r < kUgrRooms.size(); ++r) {
    s += fmt::format("{:g},{:g}", kUgrRooms[r].x, kUgrRooms[r].y);
    for (const auto& view : t.rating)
      for (const double v : view[r]) s += fmt::format(",{:.3f}", v);
    s += "\n";
  }
  return s;
}

void print_ratings(const UgrArguments& a, const UgrTable& t) {
  const char* flux_is = t.is_of_lamps ? "of the lamps" : "of the luminaire";
  fmt::print("{}: UGR, luminaires every {:g} H, H = 2 m above the eye at 1.2 m; ", a.target, t.spacing);
  if (a.is_uncorrected)
    fmt::print("for 1000 lm {} ({:+.1f} for {:.6g} lm)\n", flux_is, t.correction(), t.flux);
  else
    fmt::print("for {:.6g} lm {} ({:+.1f} against 1000 lm)\n", t.flux, flux_is, t.correction());
  fmt::print("{:>10}  {:^29}  {:^29}\n", "X   Y", "viewed crosswise", "viewed endwise");
  const auto line = [](const char* name, double UgrReflectances::*value) {
    fmt::print("{:>10}  ", name);
    for (int view = 0; view < 2; ++view) {
      for (const UgrReflectances& r : kUgrReflectances) fmt::print("{:5.1f} ", r.*value);
      fmt::print(" ");
    }
    fmt::print("\n");
  };
  line("ceiling", &UgrReflectances::ceiling);
  line("walls", &UgrReflectances::walls);
  line("plane", &UgrReflectances::plane);
  for (std::size_t r = 0; r < kUgrRooms.size(); ++r) {
    fmt::print("{:>10}  ", fmt::format("{:g}H  {:3g}H", kUgrRooms[r].x, kUgrRooms[r].y));
    for (const auto& view : t.rating) {
      for (const double v : view[r]) fmt::print("{:>5} ", std::isfinite(v) ? fmt::format("{:.1f}", v) : "-");
      fmt::print(" ");
    }
    fmt::print("\n");
  }
  fmt::print("other positions among luminaires that are farther apart, in the room 4H 8H, 0.7/0.5/0.2:\n");
  for (const UgrVariation& v : t.variations) {
    fmt::print("{:>10}  ", fmt::format("S = {:g}H", v.spacing));
    for (const auto& [low, high] : v.difference)
      fmt::print("{:^29}  ", std::isfinite(low) && std::isfinite(high)
                                 ? fmt::format("{:+.1f} / {:+.1f}", high, low)
                                 : std::string("-"));
    fmt::print("\n");
  }
}

/// Ratings over the length of the room for each width, crosswise and endwise, by the first set of reflectances.
std::string plot_of_ratings(const UgrArguments& a, const UgrTable& t) {
  Plot plot{a.target + ", reflectances 0.7 / 0.5 / 0.2",
            "length of the room along the line of sight, H",
            "UGR",
            {},
            false};
  constexpr const char* kColours[] = {"#2050c0", "#208030", "#c03020", "#806020"};
  for (std::size_t view = 0; view < 2; ++view) {
    std::size_t colour = 0;
    for (std::size_t r = 0; r < kUgrRooms.size(); ++r) {
      if (r == 0 || kUgrRooms[r].x != kUgrRooms[r - 1].x) {
        PlotSeries series;
        series.kind = view == 0 ? PlotSeries::Kind::line : PlotSeries::Kind::points;
        series.label = fmt::format("{:g} H, {}", kUgrRooms[r].x, view == 0 ? "cross" : "end");
        series.color = kColours[colour++];
        plot.series.push_back(series);
      }
      if (!std::isfinite(t.rating[view][r][0])) continue;
      plot.series.back().x.push_back(kUgrRooms[r].y);
      plot.series.back().y.push_back(t.rating[view][r][0]);
    }
  }
  return svg_plot(plot);
}

/// Throws Error unless --opening states a luminous opening, which no scene has, with an area towards an observer below it.
void require_stated_opening(const UgrArguments& a) {
  if (a.opening.empty())
    throw Error(
        "--opening: is needed for a scene: the size of the luminous opening, by which the luminance is reckoned");
  require_luminous_area({a.opening[0], a.opening[1], a.opening[2]});
}

/// A name for the measured luminaire of a scene that no file has: NAME_measured.ies, or with a number behind it.
std::filesystem::path unused_name(const std::string& scene) {
  const std::string stem = std::filesystem::path(scene).stem().string() + "_measured";
  std::filesystem::path file = stem + ".ies";
  std::error_code ignored;
  for (int i = 2; std::filesystem::exists(std::filesystem::symlink_status(file, ignored)); ++i)
    file = fmt::format("{}_{}.ies", stem, i);
  return file;
}

/// Keeps the luminaire of a scene, whose measurement took long, when the table is interrupted. Returns where it is, for a message.
std::string where_the_luminaire_is(const UgrArguments& a, const Luminaire& luminaire) {
  if (a.is_file()) return "";
  constexpr const char* kIs = " is the measured luminaire, which aureole ugr reads";
  if (!a.outputs.empty()) return "; " + a.outputs[0] + kIs;
  try {
    const WrittenFile written = write_somewhere(
        unused_name(a.target), [&](const std::filesystem::path& file) { write_luminaire(file, luminaire); });
    return "; " + written.file.string() + kIs;
  } catch (const Error& e) {
    return std::string("; the measured luminaire cannot be kept: ") + e.what();
  }
}

int ugr(const UgrArguments& a) {
  UgrOptions options;
  options.spacing = a.spacing;
  if (a.background == "patches") options.background = UgrOptions::Background::patches;
  // Wrong options are reported before a scene is measured.
  require_ugr_spacing(options.spacing);
  if (!a.is_file()) require_stated_opening(a);
  const Luminaire luminaire = luminaire_of(a);
  const std::atomic<bool>& stop = stop_on_interrupt();
  options.between = [&] {
    if (stop) throw Error("interrupted: no table is written" + where_the_luminaire_is(a, luminaire));
  };
  UgrTable table;
  try {
    table = ugr_table(luminaire, options);
  } catch (const Error& e) {
    if (is_interrupted()) throw;
    const std::string message = e.what();
    throw Error(message.starts_with("--") ? message : a.target + ": " + message);
  }
  for (const std::string& note : table.notes) tell("note: {}: {}\n", a.target, note);
  const UgrTable shown = shown_table(table, a.is_uncorrected);
  if (!a.csv.empty()) write_file_atomically(a.csv, csv_of_ratings(shown));
  if (!a.plot.empty()) write_file_atomically(a.plot, plot_of_ratings(a, shown));
  if (!a.quiet) print_ratings(a, shown);
  return 0;
}

std::function<int()> declare_ugr(CommandOptions& options) {
  auto a = std::make_shared<UgrArguments>();
  add_luminaire_target(options, *a);
  options
      .add("--spacing", a->spacing,
           "distance of neighbouring luminaires in heights above the eye: 0.25 in data sheets, 1 in CIE 190")
      .shows_default();
  options.add("--uncorrected", a->is_uncorrected, "ratings for 1000 lm instead of the luminaire's own flux");
  options
      .add("--background", a->background,
           "interreflection: uniform surfaces, as CIE 190 assumes, or patches, the radiosity of the box")
      .one_of({"uniform", "patches"})
      .shows_default();
  options.add("--csv", a->csv, "write the table to this file").names_output();
  options.add("--plot", a->plot, "write the ratings over the length of the rooms to this SVG file")
      .names_output();
  options.add("-q,--quiet", a->quiet, "print notes and errors only");
  return [a] { return ugr(*a); };
}

AUREOLE_COMMAND("ugr", "Unified glare rating of a luminaire in the standard rooms of the CIE, as a table",
                declare_ugr);

}  // namespace
}  // namespace aureole
