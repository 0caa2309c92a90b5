// SPDX-License-Identifier: Apache-2.0
// A ring-shaped aperture.
#include "aureole/aperture/aperture.h"
#include "aureole/optics/aperture/round_aperture.h"

namespace aureole {
namespace {

class Annulus final : public Aperture {
public:
  explicit Annulus(const Properties& p) : Aperture(p) {
    const double radius = get_aperture_length_m(p, "radius"),
                 inner = get_aperture_length_m(p, "inner_radius");
    // Upper bound of the ratio of the radii, above which the ring's area would be lost in the rounding of the
    // two circles.
    if (!(inner <= 0.999999 * radius))
      throw p.error("inner_radius", "must be smaller than \"radius\", by a millionth of it at least");
    set_shape(std::make_shared<optics::AnnulusAperture>(radius, inner));
  }
};

AUREOLE_PLUGIN(Annulus, "aperture", "annulus",
               PluginDoc{"The ring between two concentric circles.",
                         "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 8.6.2",
                         {{"radius", "length", "", "required", "outer radius"},
                          {"inner_radius", "length", "", "required", "inner radius, smaller than radius"}},
                         {R"(<aperture type="annulus">
    <string name="radius" value="5um"/> <string name="inner_radius" value="4um"/>
</aperture>)",
                          R"(<aperture type="annulus">
    <string name="radius" value="4um"/> <string name="inner_radius" value="1um"/>
    <float name="rotation" value="0"/> <boolean name="random_rotation" value="true"/>
    <float name="fraction" value="0.5"/> <string name="size_histogram" value="sizes.csv"/>
</aperture>)"}});

}  // namespace
}  // namespace aureole
