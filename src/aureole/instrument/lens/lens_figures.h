// SPDX-License-Identifier: Apache-2.0
// The figures of a lens by its elements: focal length, pupils, focus by wavelength, spots and vignetting.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "aureole/parameter/lens/lens_file.h"

namespace aureole {

/// Wavelength of the helium line d [nm], to which focal length, pupils and the position of the film refer.
inline constexpr double kHeliumLine = 587.5618;

struct LensSettings {
  std::optional<double> f_number;                           ///< stop down to it; nothing: wide open
  double object = std::numeric_limits<double>::infinity();  ///< distance of the object in focus [mm]
  std::vector<double> fields{0, 10, 20};                    ///< angles from the axis [degrees]
  std::vector<double> nm{486.1327, 587.5618, 656.2725};     ///< wavelengths of foci and spots
  int rays = 200;                                           ///< across the entrance pupil
  std::function<void()> between{};                          ///< called between spots; it may throw
};

/// The focus of one wavelength. Positions are behind the last vertex [mm].
struct LensFocus {
  double nm = 0, focal_length = 0;
  double paraxial = 0;  ///< paraxial image of the object
  double best = 0;      ///< smallest root mean square spot of the axial point
};

/// The spot of a point at the distance of the object in the plane of the film.
struct LensSpot {
  double field = 0, nm = 0;  ///< angle from the axis, seen from the entrance pupil [degrees], wavelength
  double height = 0;         ///< of the centroid above the axis [mm]
  double rms = 0;            ///< root mean square distance from the centroid [um]
  double open = 0;           ///< rays that arrive over those of the axial point at the line d
  double transmittance = 0;  ///< mean over the rays that arrive
  std::vector<std::array<double, 2>> points;  ///< of the rays, from the centroid [um]; empty if none arrives
};

struct LensFigures {
  std::string name;
  std::size_t surfaces = 0, stop = 0;             ///< number of surfaces; the stop among them, from 1
  double focal_length = 0, f_number = 0;          ///< [mm]
  double back_focus = 0;                          ///< rear focal point behind the last vertex [mm]
  double entrance_pupil = 0, entrance_width = 0;  ///< position behind the first vertex, diameter [mm]
  double exit_pupil = 0, exit_width = 0;          ///< distance before the film, diameter [mm]
  double film = 0;                                ///< position of the film behind the last vertex [mm]
  std::vector<LensFocus> foci;                    ///< one for each wavelength
  std::vector<LensSpot> spots;                    ///< for each field, one for each wavelength
  double cutoff = 0;                              ///< of diffraction at the line d [cycles/mm]
  double airy_radius = 0;                         ///< [um]
  std::vector<std::string> notes{};               ///< for the user
};

/// Traces a lens. Throws Error where the settings, which it names as options, do not suit it.
LensFigures measure_lens(const LensPrescription& lens, const LensSettings& settings);

}  // namespace aureole
