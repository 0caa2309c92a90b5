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
    PluginDoc{"Independent positions, as of sparse dust: the corona is that of one scatterer, with its "
              "bright centre. Scatterers may overlap; with the area fraction Fr they cover 1 - exp(-Fr).",
              "S. Torquato, Random Heterogeneous Materials, 2002, section 5.1",
              {},
              {R"(<correlation type="poisson">
    <float name="stretch" value="1"/> <float name="stretch_direction" value="0"/>
</correlation>)"}});

}  // namespace
}  // namespace aureole
