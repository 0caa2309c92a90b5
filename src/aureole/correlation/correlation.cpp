// SPDX-License-Identifier: Apache-2.0
#include "aureole/correlation/correlation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace aureole {

Correlation::Correlation(const Properties& p)
    : Object(p),
      stretch_(p.get_float("stretch", 1, Range{0.25, 4})),
      direction_(p.get_float("stretch_direction", 0) * M_PI / 180) {}

std::shared_ptr<const optics::StructureFactor> Correlation::structure_factor(double area_fraction) const {
  auto factor = at(area_fraction);
  if (stretch_ == 1) return factor;
  return std::make_shared<optics::StretchedStructureFactor>(std::move(factor), stretch_, direction_);
}

std::shared_ptr<const optics::PartialStructureFactors> Correlation::at(const optics::HardDiscMixture&) const {
  throw std::domain_error("the correlation \"" + properties().type() +
                          "\" knows discs of one size only; percus_yevick and simulated know several");
}

std::vector<double> Correlation::nodes(double least, double most) const {
  constexpr double kStep = 1.0 / 32;
  const int cells = std::max(1, int(std::ceil((most - least) / kStep)));
  std::vector<double> nodes;
  for (int i = 0; i <= cells; ++i) nodes.push_back(least + (most - least) * i / cells);
  return nodes;
}

std::shared_ptr<const Correlation> get_correlation(const Properties& p) {
  const auto nested = p.get_children<Correlation>("correlation");
  if (nested.size() > 1)
    throw Error(nested[1]->properties().where(), "\"" + p.type() + "\" takes one correlation, not more");
  if (!nested.empty()) return nested.front();
  return make_default<const Correlation>(p, "correlation");
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "correlation",
    .fallback = "percus_yevick",
    .parameters =
        {{"stretch", "float", "", "1",
          "stretches positions by its square root in one direction and compresses them by as much "
          "perpendicular to it, as on a drawn film; in [1/4, 4]. Shapes are not changed. Where their discs "
          "are compressed they may overlap, which the model ignores: leave a margin by correlation_radius"},
         {"stretch_direction", "float", "degrees", "0",
          "direction of the stretch, counter-clockwise from the surface's u axis"}},
    .is_reusable = true});

}  // namespace aureole
