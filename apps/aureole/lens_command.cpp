// SPDX-License-Identifier: Apache-2.0
// aureole lens: the properties of a lens by its elements.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "aureole/instrument/lens/lens_figures.h"
#include "aureole/optics/detector/photodetector.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

struct LensArguments {
  std::string file;
  std::optional<double> f_number, distance;
  std::vector<double> fields{0, 10, 20}, nm{486.1327, 587.5618, 656.2725};
  int rays = 200;
};

int report_lens(const LensArguments& a) {
  const LensPrescription lens = read_lens(a.file);
  for (const std::string& note : lens.notes) tell("note: {}\n", note);
  LensSettings settings;
  settings.f_number = a.f_number;
  if (a.distance) settings.object = 1000 * *a.distance;
  settings.fields = a.fields, settings.nm = a.nm, settings.rays = a.rays;
  const LensFigures f = measure_lens(lens, settings);
  for (const std::string& note : f.notes) tell("note: {}\n", note);
  fmt::print("{}{} surfaces, stop at surface {}\n", f.name.empty() ? "" : f.name + ": ", f.surfaces, f.stop);
  fmt::print("at the line d: focal length {:.4f} mm, f/{:.3f}, back focus {:.4f} mm behind the last vertex\n",
             f.focal_length, f.f_number, f.back_focus);
  fmt::print(
      "entrance pupil {:.3f} mm behind the first vertex, diameter {:.3f} mm; exit pupil {:.3f} mm before the film, "
      "diameter {:.3f} mm\n",
      f.entrance_pupil, f.entrance_width, f.exit_pupil, f.exit_width);
  fmt::print("\n{:>10} {:>14} {:>14} {:>14}\n", "nm", "focal length", "paraxial", "best focus");
  for (const LensFocus& focus : f.foci)
    fmt::print("{:10.2f} {:14.4f} {:14.4f} {:14.4f}\n", focus.nm, focus.focal_length, focus.paraxial,
               focus.best);
  const std::string points = std::isinf(settings.object)
                                 ? "distant points"
                                 : fmt::format("points at {:g} m", settings.object / 1000);
  fmt::print("\nfilm {:.4f} mm behind the last vertex; {}:\n", f.film, points);
  fmt::print("{:>8} {:>10} {:>12} {:>12} {:>12} {:>12}\n", "degrees", "nm", "height mm", "rms um", "open",
             "transmits");
  for (const LensSpot& s : f.spots)
    if (s.points.empty())
      fmt::print("{:8.2f} {:10.2f} no light arrives\n", s.field, s.nm);
    else
      fmt::print("{:8.2f} {:10.2f} {:12.4f} {:12.2f} {:12.4f} {:12.4f}\n", s.field, s.nm, s.height, s.rms,
                 s.open, s.transmittance);
  fmt::print(
      "\ndiffraction at the line d: cut-off {:.1f} cycles/mm, modulation {:.4f} at half of it; Airy radius {:.2f} um\n",
      f.cutoff, optics::diffraction_mtf(0.5, 1), f.airy_radius);
  return 0;
}

std::function<int()> declare_lens(CommandOptions& options) {
  auto a = std::make_shared<LensArguments>();
  options.add("file", a->file, "prescription: a table (radius, thickness, glass, diameter) or .zmx")
      .required();
  options.add("--f-number", a->f_number, "stop down to this f-number (default: wide open)");
  options.add("--distance", a->distance,
              "distance of the object in focus, before the first vertex, in m (default: infinity)");
  options.add("--fields", a->fields, "angles from the axis in degrees, separated by commas")
      .separated_by(',')
      .shows_default();
  options.add("--wavelengths", a->nm, "wavelengths in nm, separated by commas")
      .separated_by(',')
      .shows_default();
  options.add("--rays", a->rays, "rays across the entrance pupil").between(2, 2000).shows_default();
  return [a] { return report_lens(*a); };
}

AUREOLE_COMMAND("lens",
                "Focal length, pupils, chromatic focus, spots and vignetting of a lens by its elements",
                declare_lens);

}  // namespace
}  // namespace aureole
