// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/ior.h"

#include <fmt/format.h>

#include <cmath>

#include "aureole/parameter/data_range.h"
#include "aureole/parameter/radio_index.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/refractive_index.h"

namespace aureole {

namespace {

constexpr double kSodiumD = 589.3;

}  // namespace

void check_index_range(const Properties& properties, std::string_view name, const std::string& material,
                       const RefractiveIndex& index) {
  // The visible range, in which a scene always loads: the default sensor covers 360-830 nm, and the eye is
  // insensitive at its ends.
  constexpr SpectralGrid kVisible;
  const SpectralGrid& grid = properties.context().grid;
  const bool below = grid.min_nm<index.min_nm(), above = grid.max_nm> index.max_nm();
  const std::string subject = "the index of \"" + material + "\"";
  if ((below && grid.min_nm < kVisible.min_nm) || (above && grid.max_nm > kVisible.max_nm))
    throw properties.error(name, subject + " is known from " + range_text(index.min_nm(), index.max_nm()) +
                                     ", but the sensor sees " + range_text(grid.min_nm, grid.max_nm) +
                                     "; narrow wavelength_min and wavelength_max, or give a number");
  note_data_range(properties, name, subject, {index.min_nm(), index.max_nm()});
}

Ior Ior::from(const Properties& properties, std::string_view name, const std::string& fallback) {
  return properties.tolerate(Ior(), [&] {
    // Where a plug-in documents `dispersion`, a scene can select the constant indices of other renderers.
    const bool may_disperse = !properties.plugin() || !properties.plugin()->documents("dispersion") ||
                              properties.get_bool("dispersion", true);
    Ior ior;
    std::string material = fallback;
    bool named = false;
    if (const Properties::Entry* e = properties.find(name)) {
      if (std::holds_alternative<double>(e->value) || std::holds_alternative<std::int64_t>(e->value)) {
        ior.constant_ = float(properties.get_float(name, Range::positive()));
        return ior;
      }
      if (!std::holds_alternative<std::string>(e->value))
        throw properties.error(name, "expected a number or the name of a material");
      material = std::get<std::string>(e->value);
      named = true;
    }
    if (const auto radio = radio_index(properties, name, material)) {
      const SpectralGrid& grid = properties.context().grid;
      const std::complex<double> n = (*radio)(grid.node(grid.cells / 2));
      if (n.imag() > 0.1 * n.real())
        throw properties.error(name, "\"" + material + "\" absorbs too strongly to be a dielectric");
      if (n.imag() > 0)
        properties.note(name,
                        fmt::format("only the real part of the index of \"{}\", {:.4g} + {:.3g} i, refracts; "
                                    "what is absorbed inside is a medium's",
                                    material, n.real(), n.imag()));
      ior.table_ = SampledSpectrum::from_function(grid, [&](double nm) { return (*radio)(nm).real(); });
      ior.constant_ = float(n.real()), ior.dispersive_ = true;
      return ior;
    }
    const auto constant = find_refractive_index(material, false);
    if (!constant)
      throw properties.error(name, "unknown material \"" + material + "\"" +
                                       did_you_mean_or_all(material, refractive_index_names()));
    // A material that is tabulated even without dispersion is a conductor, which is an error here.
    if (constant->is_dispersive())
      throw properties.error(name, "\"" + material + "\" absorbs too strongly to be a dielectric");
    // A default material has the constant index of other renderers, for equal pictures. A material named in
    // the scene has its dispersion.
    const auto index = find_refractive_index(material, named && may_disperse);
    ior.constant_ = float(index->at(kSodiumD).real());
    if (!index->is_dispersive()) return ior;
    const SpectralGrid& grid = properties.context().grid;
    check_index_range(properties, name, material, *index);
    ior.dispersive_ = true;
    ior.table_ = SampledSpectrum::from_function(grid, [&](double nm) { return index->at(nm).real(); });
    return ior;
  });
}

}  // namespace aureole
