// SPDX-License-Identifier: Apache-2.0
// A regular polygon.
#include <cmath>
#include <numbers>

#include "aureole/aperture/aperture.h"
#include "aureole/optics/aperture/polygon_aperture.h"

namespace aureole {
namespace {

class Ngon final : public Aperture {
public:
  explicit Ngon(const Properties& p) : Aperture(p) {
    const auto sides = p.get_int("sides", 6, Range{3, 1000});
    const double radius = get_aperture_length_m(p, "radius");
    optics::Ring ring;
    for (int i = 0; i < sides; ++i) {
      const double phi = std::numbers::pi * (0.5 + 2.0 * i / double(sides));
      ring.push_back({radius * std::cos(phi), radius * std::sin(phi)});
    }
    set_shape(std::make_shared<optics::PolygonAperture>(optics::PolygonRegion::even_odd({ring})));
  }
};

AUREOLE_PLUGIN(
    Ngon, "aperture", "ngon",
    PluginDoc{
        "A regular polygon with a corner on the y axis, such as the iris of a lens. Its diffraction has "
        "streaks perpendicular to the sides: one per side if the number of sides is even, since opposite "
        "sides are parallel, and two per side if it is odd.",
        "S.-W. Lee, R. Mittra, Fourier transform of a polygonal shape function and its application in "
        "electromagnetics, IEEE Trans. Antennas Propag. 31, 1983",
        {{"sides", "integer", "", "6", "number of sides, 3 to 1000"},
         {"radius", "length", "", "required", "distance of the corners from the centre"}},
        {R"(<aperture type="ngon">
    <integer name="sides" value="6"/> <string name="radius" value="5um"/>
    <float name="rotation" value="30"/>
</aperture>)",
         R"(<aperture type="ngon">
    <integer name="sides" value="5"/> <string name="radius" value="3um"/>
    <float name="fraction" value="0.3"/> <boolean name="random_rotation" value="true"/>
    <string name="size_histogram" value="sizes.csv"/>
</aperture>)"}});

}  // namespace
}  // namespace aureole
