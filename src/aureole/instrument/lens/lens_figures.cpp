// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/lens/lens_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"

namespace aureole {
namespace {

/// The position of the last surface with different indices on its sides, behind which rays are straight [mm].
double last_refracting_vertex(const optics::LensSystem& system, const std::vector<double>& indices) {
  std::size_t last = 0;
  for (std::size_t i = 0; i < indices.size(); ++i)
    if (indices[i] != (i == 0 ? 1 : indices[i - 1])) last = i;
  return system.vertex(last);
}

LensFigures figures_of_lens(const LensPrescription& lens, const LensSettings& settings) {
  optics::LensSystem system(lens.surfaces);
  const std::vector<double> at_d = lens.indices(kHeliumLine);
  const optics::ParaxialLens open = system.paraxial(at_d);
  if (settings.f_number) {
    // The f-number of a divergent lens has the sign of its focal length.
    const double n = *settings.f_number, wide = std::abs(open.f_number());
    if (!(n >= wide * (1 - 1e-3)))
      throw Error(fmt::format("--f-number {:g}: wide open the lens has f/{:.4g}", n, wide));
    system.set_stop_semi_diameter(lens.surfaces[system.stop()].semi_diameter * std::min(1.0, wide / n));
  }
  if (!(settings.object > 0))
    throw Error(fmt::format("--distance {:g}: must be positive, in metres", settings.object / 1000));
  if (settings.rays < 2 || settings.rays > 2000)
    throw Error(fmt::format("--rays {}: must be from 2 to 2000", settings.rays));
  for (const double nm : settings.nm)
    if (!(nm > 0 && nm < 1e6)) throw Error(fmt::format("--wavelengths {:g}: must be positive, in nm", nm));
  for (const LensGlass& glass : lens.glasses)
    for (const double nm : settings.nm)
      if (nm < glass.min_nm() || nm > glass.max_nm())
        throw Error(fmt::format("--wavelengths {:g}: the index of \"{}\" is known from {:g} to {:g} nm", nm,
                                glass.name(), glass.min_nm(), glass.max_nm()));
  for (const double field : settings.fields)
    if (!(std::abs(field) < 90))
      throw Error(fmt::format("--fields {:g}: must be below 90 degrees from the axis", field));
  const double last = system.vertex(lens.surfaces.size() - 1);
  const optics::ParaxialLens p = system.paraxial(at_d);
  LensFigures f;
  f.name = lens.name, f.surfaces = lens.surfaces.size(), f.stop = system.stop() + 1;
  f.focal_length = p.focal_length, f.f_number = p.f_number(), f.back_focus = p.back_focus - last;
  f.entrance_pupil = p.entrance_pupil, f.entrance_width = 2 * p.entrance_semi;
  f.exit_pupil = system.film() - p.exit_pupil, f.exit_width = 2 * p.exit_semi;
  for (const double nm : settings.nm) {
    const std::vector<double> n = lens.indices(nm);
    f.foci.push_back({nm, system.paraxial(n).focal_length, system.paraxial_image(n, settings.object) - last,
                      optics::best_focus(system, n, kHeliumLine, settings.object) - last});
  }
  const double focus = optics::best_focus(system, at_d, kHeliumLine, settings.object);
  system.set_film(focus);
  f.film = focus - last;
  if (focus < last_refracting_vertex(system, at_d))
    f.notes.push_back(fmt::format(
        "the image of this object is virtual, {:.4g} mm before the last vertex, where no film can lie: spots are those "
        "of the rays behind the lens, extended backwards",
        -f.film));
  else if (f.film < 0)
    f.notes.push_back(fmt::format(
        "the image of this object is real, but lies {:.4g} mm before the last vertex, a surface that refracts no light: "
        "spots are those of the rays behind it, extended backwards",
        -f.film));
  const double axial =
      double(optics::object_spot(system, at_d, kHeliumLine, 0, settings.object, settings.rays).points.size());
  for (const double field : settings.fields)
    for (const double nm : settings.nm) {
      if (settings.between) settings.between();
      const optics::Spot s = optics::object_spot(system, lens.indices(nm), nm, field * M_PI / 180,
                                                 settings.object, settings.rays);
      LensSpot& spot = f.spots.emplace_back();
      spot.field = field, spot.nm = nm;
      if (s.points.empty()) continue;
      spot.height = s.centroid[1], spot.rms = 1000 * s.rms_radius;
      spot.open = double(s.points.size()) / axial, spot.transmittance = s.transmittance;
      for (const auto& point : s.points)
        spot.points.push_back({1000 * (point[0] - s.centroid[0]), 1000 * (point[1] - s.centroid[1])});
    }
  f.cutoff = 1 / (kHeliumLine * 1e-6 * std::abs(p.f_number()));
  f.airy_radius = 1.21966989 * kHeliumLine * 1e-3 * std::abs(p.f_number());
  return f;
}

}  // namespace

LensFigures measure_lens(const LensPrescription& lens, const LensSettings& settings) {
  try {
    return figures_of_lens(lens, settings);
  } catch (const std::domain_error& e) {
    throw Error({lens.file.string(), 0, 0}, e.what());
  }
}

}  // namespace aureole
