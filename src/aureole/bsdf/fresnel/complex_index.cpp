// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/fresnel/complex_index.h"

#include "aureole/bsdf/bsdf.h"
#include "aureole/spectrum/refractive_index.h"
#include "aureole/texture/texture.h"

namespace aureole {

std::function<std::complex<double>(double)> read_complex_index(const Properties& p, std::string_view name,
                                                               const std::string& fallback) {
  const TexturePtr k = get_optional_texture(p, "k", SpectrumRole::unbounded);
  if (k && !k->is_constant()) throw p.error("k", "must not vary over the surface");
  if (const Properties::Entry* e = p.find(name))
    if (const auto* metal_name = std::get_if<std::string>(&e->value))
      if (const auto metal = find_refractive_index(*metal_name, false); metal && metal->is_dispersive()) {
        if (k) throw p.error("k", "\"" + *metal_name + "\" has its own absorption: leave \"k\" out");
        check_index_range(p, name, *metal_name, *metal);
        return [metal](double nm) { return metal->at(nm); };
      }
  const SpectralGrid grid = p.context().grid;
  const Ior real = Ior::from(p, name, fallback);
  const SampledSpectrum absorption = k ? k->average() : SampledSpectrum::constant(grid, 0);
  return [=](double nm) {
    const Wavelengths w = Wavelengths::at(grid, float(nm));
    return std::complex<double>(real.eval(w)[0], absorption.eval(w)[0]);
  };
}

}  // namespace aureole
