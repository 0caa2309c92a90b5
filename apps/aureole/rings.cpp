// SPDX-License-Identifier: Apache-2.0
// aureole rings: measures the rings of a corona in a picture and compares them with a prediction
// (instrument/corona/ring_report.h).
#include <fmt/format.h>

#include <memory>
#include <string>

#include "aureole/instrument/corona/ring_report.h"
#include "command.h"
#include "picture_file.h"

namespace aureole {
namespace {

int rings(const std::string& picture, const RingSettings& settings) {
  const RingReport found = measure_rings(read_picture(picture), picture, settings);
  fmt::print("lamp at pixel ({:.1f}, {:.1f}); angles from it in degrees\n", found.at[0], found.at[1]);
  fmt::print("{:8} {:>28} {:>28}\n", "", "first maximum", "next minimum");
  fmt::print("{:8} {:>9} {:>9} {:>8} {:>9} {:>9} {:>8}\n", "channel", "measured", "predicted", "differ",
             "measured", "predicted", "differ");
  const auto percent = [](double m, double p) {
    return m > 0 && p > 0 ? fmt::format("{:+.1f} %", 100 * (m / p - 1)) : std::string("-");
  };
  const auto degrees = [](double d) { return d > 0 ? fmt::format("{:.3f}", d) : std::string("none"); };
  for (std::size_t c = 0; c < 3; ++c) {
    const RingAngles &m = found.measured_rings[c], &p = found.predicted_rings[c];
    fmt::print("{:8} {:>9} {:>9} {:>8} {:>9} {:>9} {:>8}\n", "RGB"[c], degrees(m.first_maximum),
               degrees(p.first_maximum), percent(m.first_maximum, p.first_maximum), degrees(m.next_minimum),
               degrees(p.next_minimum), percent(m.next_minimum, p.next_minimum));
  }
  return found.is_complete() ? 0 : 1;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<RingSettings>();
  auto picture = std::make_shared<std::string>();
  options.add("picture", *picture, "EXR with the channels R, G, B; the source must not be clipped")
      .required();
  options.add("--at", o->at, "pixel of the source, x y (default: the brightest white one)").takes(2);
  options
      .add(
          "--azimuths", o->azimuths,
          "use only the azimuths around the source from one to another, degrees, 0 right, 90 up; 300 60 is through 0")
      .takes(2);
  options.add("--mask", o->masks, "exclude a disc of the picture, x y radius in pixels; may be repeated")
      .takes_each_time(3);
  options.add("--fov", o->fov, "horizontal field of view, degrees").shows_default();
  options.add("--illuminant", o->illuminant, "CIE name of the source's spectrum").shows_default();
  options.add("--radius", o->radius, "radius of the circular scatterers").shows_default();
  options.add("--correlation-radius", o->correlation_radius, "radius of the hard discs (default: radius)");
  options.add("--area-fraction", o->area_fraction, "fraction of the plane covered by the hard discs")
      .shows_default();
  options.add("--pane-distance", o->pane_distance, "distance of the pane along the camera axis")
      .shows_default();
  options.add("--lamp-distance", o->lamp_distance, "distance of the source along the camera axis")
      .shows_default();
  options.add("--lamp-diameter", o->lamp_diameter, "diameter of a circular source").shows_default();
  options.add("--smooth", o->smooth, "half-width of the window of fits to extrema, degrees").shows_default();
  return [=] { return rings(*picture, *o); };
}

AUREOLE_COMMAND("rings", "Measure the rings of a corona in a picture and compare them with theory", declare);

}  // namespace
}  // namespace aureole
