// SPDX-License-Identifier: Apache-2.0
// A regular star.
#include <cmath>
#include <numbers>

#include "aureole/aperture/aperture.h"
#include "aureole/optics/aperture/polygon_aperture.h"

namespace aureole {
namespace {

class Star final : public Aperture {
public:
  explicit Star(const Properties& p) : Aperture(p) {
    const auto points = p.get_int("points", 5, Range{3, 1000});
    const double radius = get_aperture_length_m(p, "radius"),
                 inner = radius * p.get_float("inner_ratio", 0.5, Range{0.001, 1});
    optics::Ring ring;
    for (int i = 0; i < 2 * points; ++i) {
      const double phi = std::numbers::pi * (0.5 + i / double(points)), r = i % 2 == 0 ? radius : inner;
      ring.push_back({r * std::cos(phi), r * std::sin(phi)});
    }
    set_shape(std::make_shared<optics::PolygonAperture>(optics::PolygonRegion::even_odd({ring})));
  }
};

AUREOLE_PLUGIN(
    Star, "aperture", "star",
    PluginDoc{
        "A regular star with a point on the y axis; a model of stellar dendrites, or of the spikes of a "
        "stopped-down lens.",
        "S.-W. Lee, R. Mittra, Fourier transform of a polygonal shape function and its application in "
        "electromagnetics, IEEE Trans. Antennas Propag. 31, 1983",
        {{"points", "integer", "", "5", "number of points, 3 to 1000"},
         {"radius", "length", "", "required", "distance of the points from the centre"},
         {"inner_ratio", "float", "", "0.5",
          "distance of the inner corners, relative to radius, in [0.001, 1]"}},
        {R"(<aperture type="star">
    <integer name="points" value="6"/> <string name="radius" value="5um"/>
    <float name="inner_ratio" value="0.4"/> <boolean name="random_rotation" value="true"/>
</aperture>)",
         R"(<aperture type="star">
    <string name="radius" value="3um"/>
    <float name="rotation" value="36"/> <float name="fraction" value="0.5"/>
    <string name="size_histogram" value="sizes.csv"/>
</aperture>)"}});

}  // namespace
}  // namespace aureole
