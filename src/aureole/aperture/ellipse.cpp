// SPDX-License-Identifier: Apache-2.0
// An elliptic aperture, whose diffraction is a stretched Airy pattern.
#include "aureole/aperture/aperture.h"
#include "aureole/optics/aperture/round_aperture.h"

namespace aureole {
namespace {

class Ellipse final : public Aperture {
public:
  explicit Ellipse(const Properties& p) : Aperture(p) {
    const double x = get_aperture_length_m(p, "radius_x"), y = get_aperture_length_m(p, "radius_y");
    set_shape(std::make_shared<optics::EllipseAperture>(x, y));
  }
};

AUREOLE_PLUGIN(Ellipse, "aperture", "ellipse",
               PluginDoc{"An ellipse, such as a circle seen at an angle.",
                         "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 8.5.2, stretched",
                         {{"radius_x", "length", "", "required", "semi-axis along x"},
                          {"radius_y", "length", "", "required", "semi-axis along y"}},
                         {R"(<aperture type="ellipse">
    <string name="radius_x" value="5um"/> <string name="radius_y" value="2um"/>
    <float name="rotation" value="30"/>
</aperture>)",
                          R"(<aperture type="ellipse">
    <string name="radius_x" value="3um"/> <string name="radius_y" value="2um"/>
    <float name="fraction" value="0.5"/> <boolean name="random_rotation" value="true"/>
    <string name="size_histogram" value="sizes.csv"/>
</aperture>)"}});

}  // namespace
}  // namespace aureole
