// SPDX-License-Identifier: Apache-2.0
// Independent positions: scatterers may overlap, and only the undiffracted light interferes.
#include "aureole/correlation/correlation.h"

namespace aureole {
namespace {

class Poisson final : public Correlation {
public:
  using Correlation::Correlation;

  using Correlation::at;
  std::shared_ptr<const optics::StructureFactor> at(double) const override {
    return std::make_shared<optics::PoissonStructureFactor>();
  }
  bool may_overlap() const override { return true; }
};

AUREOLE_PLUGIN(
    Poisson, "correlation", "poisson",
    PluginDoc{
        "Independent positions, as of dust: the corona has a bright centre and, where scatterers are "
        "sparse, is that of one scatterer. Scatterers may overlap, and what they transmit multiplies (the "
        "Boolean model): with the area fraction Fr they cover 1 - exp(-Fr), and as Fr grows the centre "
        "loses light and dark rings fill. `stretch` has no effect.",
        "S. Torquato, Random Heterogeneous Materials, 2002, section 5.1",
        {},
        {R"(<correlation type="poisson">
    <float name="stretch" value="1"/> <float name="stretch_direction" value="0"/>
</correlation>)"}});

}  // namespace
}  // namespace aureole
