// SPDX-License-Identifier: Apache-2.0
// Point and line spread of translucent slabs: light of a small spot that leaves beside it, traced, and as diffusion predicts it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/instrument/laboratory/bench.h"
#include "aureole/instrument/laboratory/specimen.h"
#include "aureole/optics/medium/diffusion_multipole.h"

namespace aureole {

struct SpreadSettings {
  bool is_line = false;        ///< a line of light, else a point
  std::vector<double> at_m;    ///< distances of the receivers from the spot [m]
  double lit_m = 0.5e-3;       ///< diameter of the spot, or width of the line [m]
  double receiver_m = 0.5e-3;  ///< diameter of a receiver, or its width [m]
  double lamp_angle = 1;       ///< half of the angle under which the sample sees the lamp [degrees]
  double distance_m = 0.3;     ///< of the lamp, which stands above the spot [m]
  double sample_m = 60e-3;     ///< extent of the slab [m]
};

/// Light that leaves upwards at a distance, for one unit of light that arrives: per area [1/m^2], or per length across a line [1/m].
struct SpreadReading {
  double at_m = 0;
  std::vector<Ratio> values;      ///< by band
  std::vector<double> predicted;  ///< by diffusion, by band; empty where the slab is no homogeneous medium
};
struct SpreadTable {
  std::vector<double> nm;
  bool is_line = false;
  std::vector<SpreadReading> readings;
  std::vector<std::string> notes;
};
/// Each receiver is a cosine receiver just above the slab; the beam passes it. Throws Error for a specimen that is no slab, for
/// distances that do not increase or lie outside of it, and for sizes that do not fit each other.
SpreadTable measure_spread(const Bench& bench, const Specimen& specimen, const SpreadSettings& settings);
std::string spread_table_content(const SpreadTable& table);

/// The diffusion of light in a slab with a homogeneous medium at a wavelength, by its optical properties; nothing where the specimen is
/// none, or its medium has no extinction. The index of refraction is that of its surface.
std::optional<optics::Multipole> diffusion_of(const Specimen& specimen, const SpectralGrid& grid,
                                              double length_unit_m, double nm);

}  // namespace aureole
