// SPDX-License-Identifier: Apache-2.0
#include "aureole/ingredient/amount/amount_parameters.h"

#include <array>
#include <string>

#include "aureole/core/error.h"

namespace aureole {

optics::Amount read_amount(const Properties& p) {
  using optics::Amount;
  struct Way {
    const char* name;
    Amount::Kind kind;
    Range range;
  };
  const std::array<Way, 3> ways = {{{"number_density", Amount::Kind::number, Range::non_negative()},
                                    {"volume_fraction", Amount::Kind::volume, Range::unit()},
                                    {"mass_fraction", Amount::Kind::mass, Range::unit()}}};
  const Way* given = nullptr;
  for (const Way& way : ways)
    if (p.has(way.name)) {
      if (given)
        throw p.error(way.name, "give either \"" + std::string(given->name) + "\" or \"" + way.name + "\"");
      given = &way;
    }
  if (!given)
    throw Error(p.where(), "\"" + p.type() +
                               "\" needs one of \"number_density\", \"volume_fraction\" and "
                               "\"mass_fraction\"");
  return {given->kind, p.get_float(given->name, given->range)};
}

double read_density(const Properties& p) { return p.get_float("density", 0, Range::positive()); }

std::vector<ParameterDoc> amount_docs() {
  return {{"number_density", "float", "1/m^3", "none", "number of spheres per cubic metre"},
          {"volume_fraction", "float", "", "none", "fraction of the volume that the spheres fill"},
          {"mass_fraction", "float", "", "none",
           "fraction of the mass; needs the spheres' density and the density of the host medium"},
          {"density", "float", "kg/m^3", "none", "density of the spheres' material"}};
}

}  // namespace aureole
