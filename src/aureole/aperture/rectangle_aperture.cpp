// SPDX-License-Identifier: Apache-2.0
// A rectangular aperture, or a slit if it is much longer than wide.
#include "aureole/aperture/aperture.h"
#include "aureole/optics/aperture/polygon_aperture.h"

namespace aureole {
namespace {

class RectangleAperture final : public Aperture {
public:
  explicit RectangleAperture(const Properties& p) : Aperture(p) {
    const double x = 0.5 * get_aperture_length_m(p, "width"), y = 0.5 * get_aperture_length_m(p, "height");
    if (!(x <= 1e6 * y && y <= 1e6 * x))
      throw p.error("height", "the sides of a rectangle may differ by a factor of a million at most");
    set_shape(std::make_shared<optics::PolygonAperture>(
        optics::PolygonRegion::even_odd({{{-x, -y}, {x, -y}, {x, y}, {-x, y}}})));
  }
};

AUREOLE_PLUGIN(RectangleAperture, "aperture", "rectangle",
               PluginDoc{"A rectangle with sides along x and y. Its Fourier transform is a product of two "
                         "sincs.",
                         "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 8.5.1",
                         {{"width", "length", "", "required", "side along x"},
                          {"height", "length", "", "required", "side along y"}},
                         {R"(<aperture type="rectangle">
    <string name="width" value="8um"/> <string name="height" value="4um"/>
</aperture>)",
                          R"(<aperture type="rectangle">
    <string name="width" value="1um"/> <string name="height" value="6um"/>
    <float name="rotation" value="10"/> <boolean name="random_rotation" value="false"/>
    <float name="fraction" value="0.5"/> <string name="size_histogram" value="sizes.csv"/>
</aperture>)"}});

}  // namespace
}  // namespace aureole
