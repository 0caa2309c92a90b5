// SPDX-License-Identifier: Apache-2.0
// Position of the sun in the sky.
#pragma once

namespace aureole::optics {

struct SolarPosition {
  double zenith_angle = 0;  ///< zenith angle of the sun's centre [rad], without refraction
  double azimuth = 0;       ///< azimuth [rad], from north towards east
};

/// Returns the sun's position. `days`: days and fractions since 1 January 2000, 12:00 UT (Julian date -
/// 2451545); `hour`: hour of the day, UT; latitude and longitude in degrees, north and east positive (M.
/// Blanco-Muriel, D. C. Alarcon-Padilla, T. Lopez-Moratalla & M. Lara-Coira, "Computing the solar vector",
/// Solar Energy 70(5), 2001). The error is at most 0.01 degrees from 1999 to 2015 and a few hundredths for
/// decades around.
SolarPosition solar_position(double days, double hour, double latitude_degrees, double longitude_degrees);

}  // namespace aureole::optics
