// SPDX-License-Identifier: Apache-2.0
// The position of the sun against another formula: the low-accuracy one of J. Meeus, "Astronomical
// Algorithms", 1998, chapter 25, with apparent sidereal time from chapter 12, good to .01 degrees.
#include "aureole/optics/sky/solar_position.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace aureole::optics {
namespace {

constexpr double kDegree = M_PI / 180;

double days_from_2000(int year, unsigned month, unsigned day, double hour) {
  using namespace std::chrono;
  const sys_days date =
      year_month_day{std::chrono::year(year), std::chrono::month(month), std::chrono::day(day)};
  return double((date - sys_days(January / 1 / 2000)).count()) - 0.5 + hour / 24;
}

struct Vector {
  double north, east, up;
};

Vector meeus(double days, double latitude, double longitude) {
  const double t = days / 36525;
  const double mean = 280.46646 + 36000.76983 * t + 0.0003032 * t * t;
  const double m = (357.52911 + 35999.05029 * t - 0.0001537 * t * t) * kDegree;
  const double center =
      (1.914602 - 0.004817 * t) * std::sin(m) + 0.019993 * std::sin(2 * m) + 0.000289 * std::sin(3 * m);
  const double node = (125.04 - 1934.136 * t) * kDegree;
  const double longitude_of_sun = (mean + center - 0.00569 - 0.00478 * std::sin(node)) * kDegree;
  const double obliquity = (23.439291 - 0.0130042 * t + 0.00256 * std::cos(node)) * kDegree;
  const double ascension =
      std::atan2(std::cos(obliquity) * std::sin(longitude_of_sun), std::cos(longitude_of_sun));
  const double declination = std::asin(std::sin(obliquity) * std::sin(longitude_of_sun));
  const double sidereal = 280.46061837 + 360.98564736629 * days + longitude;
  const double h = sidereal * kDegree - ascension, b = latitude * kDegree;
  return {std::sin(declination) * std::cos(b) - std::cos(declination) * std::sin(b) * std::cos(h),
          -std::cos(declination) * std::sin(h),
          std::sin(b) * std::sin(declination) + std::cos(b) * std::cos(declination) * std::cos(h)};
}

TEST(SolarPosition, AgreesWithMeeus) {
  double worst = 0;
  for (const int year : {1950, 1990, 2005, 2010, 2024, 2060})
    for (unsigned month = 1; month <= 12; ++month)
      for (const double hour : {0.0, 3.7, 9.2, 15.0, 21.3})
        for (const double latitude : {-89.0, -33.9, 0.0, 35.7, 70.0})
          for (const double longitude : {-120.0, 0.0, 139.7}) {
            const double days = days_from_2000(year, month, 11, hour);
            const SolarPosition p = solar_position(days, hour, latitude, longitude);
            const Vector v = meeus(days, latitude, longitude);
            // Meeus gives the view from the middle of the earth: parallax lowers the sun.
            const double zenith = p.zenith_angle - 6371.01 / 149597890 * std::sin(p.zenith_angle);
            const double dn = std::sin(zenith) * std::cos(p.azimuth) - v.north,
                         de = std::sin(zenith) * std::sin(p.azimuth) - v.east, du = std::cos(zenith) - v.up;
            worst = std::max(worst, std::sqrt(dn * dn + de * de + du * du) / kDegree);
            EXPECT_GE(p.azimuth, 0);
            EXPECT_LT(p.azimuth, 2 * M_PI + 1e-12);
          }
  EXPECT_LT(worst, 0.03);
  RecordProperty("worst_millidegrees", int(1000 * worst));
}

TEST(SolarPosition, AnEquinox) {
  // 20 March 2024, 3:06 UT: the sun crosses the equator, and stands over it at the longitude where it is
  // noon.
  const double hour = 3 + 6 / 60.0, days = days_from_2000(2024, 3, 20, hour);
  const double equation_of_time = -7.43 / 60;  // hours, of that day
  const double noon_longitude = (12 - hour - equation_of_time) * 15;
  EXPECT_NEAR(solar_position(days, hour, 0, noon_longitude).zenith_angle / kDegree, 0, 0.05);
  // At the poles it is on the horizon.
  for (const double latitude : {-90.0, 90.0})
    EXPECT_NEAR(solar_position(days, hour, latitude, 0).zenith_angle / kDegree, 90, 0.03);
  // West of there it is morning: it stands in the east.
  EXPECT_NEAR(solar_position(days, hour, 0, noon_longitude - 60).azimuth / kDegree, 90, 0.1);
}

}  // namespace
}  // namespace aureole::optics
