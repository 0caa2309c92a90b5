// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/sky/solar_position.h"

#include <algorithm>
#include <cmath>

#include "aureole/optics/constants.h"

namespace aureole::optics {

SolarPosition solar_position(double days, double hour, double latitude_degrees, double longitude_degrees) {
  // Ecliptic coordinates (M. Blanco-Muriel et al. 2001, table 1).
  const double node = 2.1429 - 0.0010394594 * days;
  const double mean_longitude = 4.8950630 + 0.017202791698 * days;
  const double anomaly = 6.2400600 + 0.0172019699 * days;
  const double longitude = mean_longitude + 0.03341607 * std::sin(anomaly) +
                           0.00034894 * std::sin(2 * anomaly) - 0.0001134 - 0.0000203 * std::sin(node);
  const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * std::cos(node);

  // Celestial coordinates, then local horizontal ones.
  const double right_ascension = std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));
  const double sidereal_hours = 6.6974243242 + 0.0657098283 * days + hour;
  const double hour_angle = (sidereal_hours * 15 + longitude_degrees) * kDegree - right_ascension;
  const double latitude = latitude_degrees * kDegree;
  const double cosine = std::cos(latitude) * std::cos(hour_angle) * std::cos(declination) +
                        std::sin(declination) * std::sin(latitude);
  SolarPosition p;
  p.zenith_angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  p.azimuth = std::atan2(-std::sin(hour_angle), std::tan(declination) * std::cos(latitude) -
                                                    std::sin(latitude) * std::cos(hour_angle));
  if (p.azimuth < 0) p.azimuth += 2 * M_PI;
  // Parallax: the earth's radius over the earth-sun distance.
  p.zenith_angle += 6371.01 / 149597890 * std::sin(p.zenith_angle);
  return p;
}

}  // namespace aureole::optics
