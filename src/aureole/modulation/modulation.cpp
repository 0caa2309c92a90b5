// SPDX-License-Identifier: Apache-2.0
#include "aureole/modulation/modulation.h"

#include "aureole/plugin/registry.h"

namespace aureole {

Modulation::Modulation(const Properties& p)
    : Object(p), by_peak_(p.get_choice("reference", "mean", {"mean", "peak"}) == "peak") {}

void Modulation::refer_to(double mean, double peak) { scale_ = 1 / (by_peak_ ? peak : mean); }

AUREOLE_FAMILY(FamilyInfo{
    .name = "modulation",
    .parameters = {
        {"reference", "string", "", "mean",
         "what the emission that the emitter states is: mean, over a period or over the table; peak, the "
         "largest value"}}});

}  // namespace aureole
