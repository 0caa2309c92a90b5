// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/complex_index.h"

#include "aureole/parameter/data_range.h"
#include "aureole/parameter/ior.h"
#include "aureole/parameter/radio_index.h"
#include "aureole/pigment/grain_index.h"
#include "aureole/spectrum/refractive_index.h"

namespace aureole {
namespace {

/// Reads the index of a default material with its dispersion. `Ior` would use the constant index of other
/// renderers, and the rainbow of a default droplet would then have no colours.
SampledSpectrum real_index(const Properties& p, std::string_view name, const std::string& fallback) {
  const SpectralGrid& grid = p.context().grid;
  if (!p.find(name) && p.get_bool("dispersion", true))
    if (const auto material = find_refractive_index(fallback); material && material->is_dispersive()) {
      check_index_range(p, name, fallback, *material);
      return SampledSpectrum::from_function(grid, [&](double nm) { return material->at(nm).real(); });
    }
  const Ior ior = Ior::from(p, name, fallback);
  return SampledSpectrum::from_function(
      grid, [&](double nm) { return double(ior.eval(Wavelengths::at(grid, float(nm)))[0]); });
}

/// Returns the index of a pigment or filler whose name the parameter has; empty for other names, and for names that
/// `find_refractive_index` knows.
std::optional<std::function<std::complex<double>(double)>> grain_index(const Properties& p,
                                                                       std::string_view name, bool has_k) {
  const Properties::Entry* e = p.find(name);
  const auto* text = e ? std::get_if<std::string>(&e->value) : nullptr;
  if (!text || find_refractive_index(*text, false)) return {};
  const auto grain = pigment::find_grain_index(*text);
  if (!grain) {
    const std::string hint = did_you_mean(*text, pigment::grain_index_names());
    if (!hint.empty() && did_you_mean(*text, refractive_index_names()).empty())
      throw p.error(name, "unknown material \"" + *text + "\"" + hint);
    return {};
  }
  if (grain->absorbs && has_k)
    throw p.error("k", "\"" + *text + "\" has its own absorption: leave \"k\" out");
  note_data_range(p, name, "the index of \"" + *text + "\"", {grain->min_nm, grain->max_nm});
  if (p.get_bool("dispersion", true)) return grain->index;
  return [value = grain->index(589.3)](double) { return value; };
}

}  // namespace

std::function<std::complex<double>(double)> read_complex_index(const Properties& p, std::string_view name,
                                                               const std::string& fallback,
                                                               const std::optional<SampledSpectrum>& k,
                                                               std::string_view k_name) {
  if (const Properties::Entry* e = p.find(name))
    if (const auto* metal_name = std::get_if<std::string>(&e->value)) {
      if (auto radio = radio_index(p, name, *metal_name)) {
        if (k)
          throw p.error(k_name, "\"" + *metal_name + "\" has its own absorption: leave \"" +
                                    std::string(k_name) + "\" out");
        return *radio;
      }
      if (const auto metal = find_refractive_index(*metal_name, false); metal && metal->is_dispersive()) {
        if (k)
          throw p.error(k_name, "\"" + *metal_name + "\" has its own absorption: leave \"" +
                                    std::string(k_name) + "\" out");
        check_index_range(p, name, *metal_name, *metal);
        return [metal](double nm) { return metal->at(nm); };
      }
    }
  if (auto grain = grain_index(p, name, k.has_value())) {
    if (!k) return *grain;
    return [grain = *grain, absorption = *k, grid = p.context().grid](double nm) {
      return std::complex<double>(grain(nm).real(), absorption.eval(Wavelengths::at(grid, float(nm)))[0]);
    };
  }
  const SpectralGrid grid = p.context().grid;
  const SampledSpectrum real = real_index(p, name, fallback);
  const SampledSpectrum absorption = k ? *k : SampledSpectrum::constant(grid, 0);
  return [=](double nm) {
    const Wavelengths w = Wavelengths::at(grid, float(nm));
    return std::complex<double>(real.eval(w)[0], absorption.eval(w)[0]);
  };
}

}  // namespace aureole
