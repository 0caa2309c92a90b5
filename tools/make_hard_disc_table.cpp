// SPDX-License-Identifier: Apache-2.0
// Writes the table of optics/arrangement/equilibrium_structure_factor.cpp: by how much 1/S' of simulated hard discs
// differs from that of theory. It takes ten minutes of one core.
//
//     make_hard_disc_table > src/aureole/optics/arrangement/data/hard_disc_corrections.inc
#include <cstdio>

#include "aureole/optics/arrangement/simulated_structure_factor.h"

int main() {
  using namespace aureole::optics;
  std::printf(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Area fraction, and 1/S' of simulated hard discs minus that of theory at u = 0, 0.125, 0.25, ... 40. Written by\n"
      "// tools/make_hard_disc_table.cpp.\n");
  for (const double fraction :
       {0.1, 0.2, 0.3, 0.35, 0.4, 0.44, 0.48, 0.52, 0.56, 0.6, 0.62, 0.64, 0.66, 0.68}) {
    HardDiscEnsemble ensemble;
    ensemble.discs = 2000, ensemble.snapshots = 9600, ensemble.seed = 7;
    const SimulatedStructureFactor simulated(fraction, ensemble);
    std::printf("    {%g,\n     {", fraction);
    for (int i = 0; i <= 320; ++i) {
      const double u = 0.125 * i,
                   correction = 1 / simulated.eval(u) - 1 / hard_disc_structure_factor(u, fraction);
      std::printf("%.4g%s", correction, i == 320 ? "}},\n" : i % 16 == 15 ? ",\n      " : ", ");
    }
    std::fflush(stdout);
  }
}
