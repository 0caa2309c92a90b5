// SPDX-License-Identifier: Apache-2.0
// A circular aperture, whose diffraction is the Airy pattern.
#include "aureole/aperture/aperture.h"
#include "aureole/optics/aperture/round_aperture.h"

namespace aureole {
namespace {

class Circle final : public Aperture {
public:
  explicit Circle(const Properties& p) : Aperture(p) {
    const double radius = get_aperture_length_m(p, "radius");
    set_shape(std::make_shared<optics::EllipseAperture>(radius, radius));
  }
};

AUREOLE_PLUGIN(Circle, "aperture", "circle",
               PluginDoc{"A circle. Its Fourier transform is 2 J1(u)/u, the Airy pattern.",
                         "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 8.5.2",
                         {{"radius", "length", "", "required", "radius, such as 5um"}},
                         {R"(<aperture type="circle">
    <string name="radius" value="5um"/>
</aperture>)",
                          R"(<aperture type="circle">
    <string name="radius" value="4um"/>
    <float name="fraction" value="0.7"/> <float name="size_spread" value="0.1"/>
    <float name="rotation" value="0"/> <boolean name="random_rotation" value="false"/>
</aperture>)",
                          R"(<aperture type="circle">
    <string name="radius" value="4um"/>
    <string name="size_histogram" value="sizes.csv"/>
</aperture>)"}});

}  // namespace
}  // namespace aureole
