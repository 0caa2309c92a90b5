// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/scattering_function.h"

#include "aureole/core/error.h"
#include "aureole/instrument/check/deviation.h"

namespace aureole {

SpectralGrid ScatteringFunction::grid_of(const Object& object, const CheckOptions& options) {
  if (const auto context = object.properties().shared_context()) return context->grid;
  // The range of the options, or a default: the object was not made from a scene and has no grid.
  const bool given = options.min_nm > 0 && options.max_nm > options.min_nm;
  return given ? SpectralGrid::over(options.min_nm, options.max_nm) : SpectralGrid{};
}

ScatteringFunction::ScatteringFunction(const SpectralGrid& grid, const CheckOptions& options,
                                       const char* kind) {
  double min_nm = options.min_nm, max_nm = options.max_nm;
  if (min_nm == 0 && max_nm == 0) min_nm = grid.min_nm, max_nm = grid.max_nm;
  if (!(min_nm >= grid.min_nm && max_nm <= grid.max_nm && min_nm <= max_nm))
    throw Error(check::sentence("wavelengths: expected a range within ", grid.min_nm, " to ", grid.max_nm,
                                " nm, for which the ", kind, " was made, got ", min_nm, " to ", max_nm));
  const double width = max_nm - min_nm;
  for (int hero = 0; hero < kWavelengths; ++hero)
    rotated_.push_back(Wavelengths::at(grid, make_spectrum([&](int i) {
                                         const double place = ((i + hero) % kWavelengths) + 0.37;
                                         return float(min_nm + width * place / kWavelengths);
                                       })));
}

}  // namespace aureole
