// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/two_flux_doubt.h"

#include <algorithm>

#include "aureole/pigment/two_flux_error.h"
#include "aureole/spectrum/tables.h"

namespace aureole {

double two_flux_doubt(const pigment::Paint& paint, const std::vector<double>& nm, double thickness,
                      double substrate, double index, const pigment::Observation& lamp) {
  constexpr std::size_t kPoints = 16;  // wavelengths at which transport is solved
  double largest = 0;
  for (const double g : {0.0, 0.8}) {
    std::vector<double> at, two, transport;
    for (std::size_t p = 0; p < kPoints; ++p) {
      const std::size_t i = p * (nm.size() - 1) / (kPoints - 1);
      if (!at.empty() && nm[i] <= at.back()) continue;
      const double absorbed = std::max(paint[i].k / 2, 1e-30), reduced = std::max(paint[i].s / 0.75, 1e-30);
      const double scattered = reduced / (1 - g);
      const pigment::TwoFluxError e =
          pigment::two_flux_error({.albedo = std::clamp(scattered / (scattered + absorbed), 1e-6, 1.0),
                                   .thickness = std::clamp(reduced * thickness, 1e-6, 1e6),
                                   .g = g,
                                   .index = index,
                                   .substrate = substrate});
      at.push_back(nm[i]), transport.push_back(e.reflectance);
      two.push_back(e.reflectance + e.error.value_or(0));
    }
    const auto spread = [&](const std::vector<double>& values) {
      std::vector<double> all;
      for (const double l : nm) all.push_back(std::max(TabulatedSpectrum{at, values}.at(l), 0.0));
      return all;
    };
    largest = std::max(largest, pigment::ciede2000(lamp.lab(spread(two)), lamp.lab(spread(transport))));
  }
  return largest;
}

}  // namespace aureole
