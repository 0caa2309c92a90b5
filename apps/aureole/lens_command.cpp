// SPDX-License-Identifier: Apache-2.0
// aureole lens: the properties of a lens by its elements.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/optics/detector/photodetector.h"
#include "aureole/parameter/lens/lens_file.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

struct LensArguments {
  std::string file;
  std::vector<double> f_number, distance, fields{0, 10, 20}, nm{486.1327, 587.5618, 656.2725};
  int rays = 200;
};

int report_lens(const LensArguments& a) {
  const LensPrescription lens = read_lens(a.file);
  for (const std::string& note : lens.notes) tell("note: {}\n", note);
  optics::LensSystem system(lens.surfaces);
  constexpr double kD = 587.5618;
  const optics::ParaxialLens open = system.paraxial(lens.indices(kD));
  if (!a.f_number.empty()) {
    if (!(a.f_number[0] >= open.f_number() * (1 - 1e-3)))
      throw Error(
          fmt::format("--f-number {:g}: wide open the lens has f/{:.4g}", a.f_number[0], open.f_number()));
    system.set_stop_semi_diameter(lens.surfaces[system.stop()].semi_diameter *
                                  std::min(1.0, open.f_number() / a.f_number[0]));
  }
  const double object = a.distance.empty() ? std::numeric_limits<double>::infinity() : 1000 * a.distance[0];
  if (!(object > 0)) throw Error(fmt::format("--distance {:g}: must be positive, in metres", a.distance[0]));
  const double last = system.vertex(lens.surfaces.size() - 1);
  const optics::ParaxialLens p = system.paraxial(lens.indices(kD));
  fmt::print("{}{} surfaces, stop at surface {}\n", lens.name.empty() ? "" : lens.name + ": ",
             lens.surfaces.size(), system.stop() + 1);
  fmt::print("at the line d: focal length {:.4f} mm, f/{:.3f}, back focus {:.4f} mm behind the last vertex\n",
             p.focal_length, p.f_number(), p.back_focus - last);
  fmt::print(
      "entrance pupil {:.3f} mm behind the first vertex, diameter {:.3f} mm; exit pupil {:.3f} mm before the film, "
      "diameter {:.3f} mm\n",
      p.entrance_pupil, 2 * p.entrance_semi, system.film() - p.exit_pupil, 2 * p.exit_semi);
  fmt::print("\n{:>10} {:>14} {:>14} {:>14}\n", "nm", "focal length", "paraxial", "best focus");
  for (const double nm : a.nm) {
    const std::vector<double> n = lens.indices(nm);
    fmt::print("{:10.2f} {:14.4f} {:14.4f} {:14.4f}\n", nm, system.paraxial(n).focal_length,
               system.paraxial_image(n, object) - last, optics::best_focus(system, n, kD, object) - last);
  }
  const double focus = optics::best_focus(system, lens.indices(kD), kD, object);
  system.set_film(focus);
  const double axial = double(optics::distant_spot(system, lens.indices(kD), kD, 0, a.rays).points.size());
  fmt::print("\nfilm {:.4f} mm behind the last vertex; distant points:\n", focus - last);
  fmt::print("{:>8} {:>10} {:>12} {:>12} {:>12} {:>12}\n", "degrees", "nm", "height mm", "rms um", "open",
             "transmits");
  for (const double field : a.fields)
    for (const double nm : a.nm) {
      const optics::Spot s = optics::distant_spot(system, lens.indices(nm), nm, field * M_PI / 180, a.rays);
      if (s.points.empty()) {
        fmt::print("{:8.2f} {:10.2f} no light arrives\n", field, nm);
        continue;
      }
      fmt::print("{:8.2f} {:10.2f} {:12.4f} {:12.2f} {:12.4f} {:12.4f}\n", field, nm, s.centroid[1],
                 1000 * s.rms_radius, double(s.points.size()) / axial, s.transmittance);
    }
  const double cutoff = 1 / (kD * 1e-6 * p.f_number());
  fmt::print(
      "\ndiffraction at the line d: cut-off {:.1f} cycles/mm, modulation {:.4f} at half of it; Airy radius {:.2f} um\n",
      cutoff, optics::diffraction_mtf(0.5, 1), 1.21966989 * kD * 1e-3 * p.f_number());
  return 0;
}

std::function<int()> declare_lens(CommandOptions& options) {
  auto a = std::make_shared<LensArguments>();
  options.add("file", a->file, "prescription: a table (radius, thickness, glass, diameter) or .zmx")
      .required();
  options.add("--f-number", a->f_number, "stop down to this f-number (default: wide open)").takes(1);
  options.add("--distance", a->distance, "distance of the object in focus in m (default: infinity)").takes(1);
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
