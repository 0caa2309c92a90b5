// SPDX-License-Identifier: Apache-2.0
// A regular arrangement with defects: gratings, woven cloth, colloidal crystals.
#include <stdexcept>

#include "aureole/correlation/correlation.h"

namespace aureole {
namespace {

using Kind = optics::LatticeStructureFactor::Kind;

class Lattice final : public Correlation {
public:
  explicit Lattice(const Properties& p)
      : Correlation(p),
        kind_(p.get_choice("lattice", "hexagonal", {"hexagonal", "square"}) == "square" ? Kind::square
                                                                                        : Kind::hexagonal),
        jitter_(p.get_float("jitter", 0.05, Range{0, 0.5})),
        domain_(p.get_float("domain", 4, Range{1, 10})),
        angle_(p.get_float("angle", 0) * M_PI / 180),
        random_(p.get_bool("random_orientation", false)) {}

  using Correlation::at;
  std::shared_ptr<const optics::StructureFactor> at(double area_fraction) const override {
    return std::make_shared<optics::LatticeStructureFactor>(kind_, area_fraction, jitter_, domain_, angle_,
                                                            random_);
  }

  std::vector<double> nodes(double, double) const override {
    throw std::domain_error(
        "the area fraction of a lattice must be the same everywhere: it sets the spacing");
  }

private:
  Kind kind_;
  double jitter_, domain_, angle_;
  bool random_;
};

AUREOLE_PLUGIN(
    Lattice, "correlation", "lattice",
    PluginDoc{
        "A hexagonal or square lattice with random displacements and order limited to domains: bright spots "
        "(diffraction orders) on a faint background, or rings if domains have all orientations. The spacing "
        "follows from area_fraction and correlation_radius.",
        "A. Guinier, X-ray Diffraction in Crystals, Imperfect Crystals, and Amorphous Bodies, 1963, chapter "
        "7",
        {{"lattice", "string", "", "hexagonal", "hexagonal (area fractions up to 0.9069) or square (0.7854)"},
         {"jitter", "float", "", "0.05",
          "standard deviation of the displacement along each axis, in spacings"},
         {"domain", "float", "", "4",
          "size of the ordered domains in spacings, in [1, 10]: pairs at a distance r are correlated by "
          "exp(-r^2/(2 domain^2)); the width of spots is 1/(2 pi domain) of their distance; at most 25 "
          "correlation radii"},
         {"angle", "float", "degrees", "0", "angle between a row of the lattice and the surface's u axis"},
         {"random_orientation", "boolean", "", "false", "domains of all orientations: rings, not spots"}},
        {R"(<correlation type="lattice">
    <string name="lattice" value="square"/> <float name="jitter" value="0.08"/> <float name="domain" value="5"/>
    <float name="angle" value="15"/> <boolean name="random_orientation" value="false"/>
    <float name="stretch" value="1.2"/> <float name="stretch_direction" value="15"/>
</correlation>)",
         R"(<correlation type="lattice">
    <float name="jitter" value="0.1"/> <boolean name="random_orientation" value="true"/>
</correlation>)"}});

}  // namespace
}  // namespace aureole
