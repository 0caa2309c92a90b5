// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/fresnel/conductor_index.h"

#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/parameter/radio_index.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/spectrum/refractive_index.h"

namespace aureole {

namespace {

std::vector<std::string> conductor_names() {
  std::vector<std::string> names{"none"};
  for (const std::string& name : refractive_index_names())
    if (find_refractive_index(name, false)->is_dispersive()) names.push_back(name);
  const auto radio = radio_material_names();
  names.insert(names.end(), radio.begin(), radio.end());
  return names;
}

/// Returns the integral of 2 F(mu) mu over mu in [0, 1] by five-point Gauss-Legendre quadrature, error below
/// 2e-4; the weights contain 2 mu.
Spectrum fresnel_conductor_diffuse(const Spectrum& eta, const Spectrum& k) {
  constexpr float kNodes[] = {0.04691008f, 0.23076534f, 0.5f, 0.76923466f, 0.95308992f};
  constexpr float kWeights[] = {0.01111426f, 0.11045091f, 0.28444444f, 0.36817776f, 0.22581263f};
  Spectrum sum;
  for (int i = 0; i < 5; ++i) sum += fresnel_conductor(kNodes[i], eta, k) * kWeights[i];
  return min(sum, 1.f);
}

}  // namespace

ConductorIndex ConductorIndex::from(const Properties& properties) {
  return properties.tolerate(ConductorIndex(), [&] {
    ConductorIndex c;
    const SpectralGrid& grid = properties.context().grid;
    const std::string material = properties.get_string("material", "none");
    const TexturePtr eta = get_optional_texture(properties, "eta", SpectrumRole::unbounded);
    const TexturePtr k = get_optional_texture(properties, "k", SpectrumRole::unbounded);
    if (material != "none") {
      if (eta || k)
        throw properties.error(eta ? "eta" : "k", "give either a material or eta and k, not both");
      const auto take = [&](const auto& index_at) {
        c.eta_ = SampledSpectrum::from_function(grid, [&](double nm) { return index_at(nm).real(); });
        c.k_ = SampledSpectrum::from_function(grid, [&](double nm) { return index_at(nm).imag(); });
        c.tabulate_diffuse();
        return c;
      };
      if (const auto radio = radio_index(properties, "material", material)) return take(*radio);
      const auto index = find_refractive_index(material, false);
      // Dielectrics have constant indices without dispersion; they belong to other BSDFs.
      if (!index || !index->is_dispersive())
        throw properties.error("material", "\"" + material + "\" is not a known conductor" +
                                               did_you_mean_or_all(material, conductor_names()));
      check_index_range(properties, "material", material, *index);
      return take([&](double nm) { return index->at(nm); });
    }
    if (!eta && !k) return c;
    if ((!eta || eta->is_constant()) && (!k || k->is_constant())) {
      c.eta_ = eta ? eta->average() : SampledSpectrum::constant(grid, 0);
      c.k_ = k ? k->average() : SampledSpectrum::constant(grid, 1);
      c.tabulate_diffuse();
      return c;
    }
    c.eta_texture_ = get_texture(properties, "eta", 0, SpectrumRole::unbounded);
    c.k_texture_ = get_texture(properties, "k", 1, SpectrumRole::unbounded);
    return c;
  });
}

Spectrum ConductorIndex::reflectance(float cos_i, const BsdfContext& ctx) const {
  if (tabulated_) return fresnel_conductor(cos_i, eta_.eval(ctx.wavelengths), k_.eval(ctx.wavelengths));
  if (!eta_texture_) return 1.f;
  return fresnel_conductor(cos_i, eta_texture_->eval(ctx.point, ctx.wavelengths),
                           k_texture_->eval(ctx.point, ctx.wavelengths));
}

MirrorReflection::Amplitudes ConductorIndex::amplitudes(float cos_i, const BsdfContext& ctx) const {
  MirrorReflection::Amplitudes a;
  a.s.fill(-1), a.p.fill(1);
  if (!tabulated_ && !eta_texture_) return a;
  const Spectrum eta =
      tabulated_ ? eta_.eval(ctx.wavelengths) : eta_texture_->eval(ctx.point, ctx.wavelengths);
  const Spectrum k = tabulated_ ? k_.eval(ctx.wavelengths) : k_texture_->eval(ctx.point, ctx.wavelengths);
  for (int i = 0; i < kWavelengths; ++i) {
    if (eta[i] == 0 && k[i] == 0) continue;  // the limit of Fresnel's formulae is a perfect mirror
    const auto at = optics::fresnel_amplitudes(double(cos_i), 1, {double(eta[i]), double(k[i])});
    a.s[std::size_t(i)] = at.r_s, a.p[std::size_t(i)] = at.r_p;
  }
  return a;
}

Spectrum ConductorIndex::diffuse_reflectance(const BsdfContext& ctx) const {
  if (tabulated_) return diffuse_.eval(ctx.wavelengths);
  if (!eta_texture_) return 1.f;
  return fresnel_conductor_diffuse(eta_texture_->eval(ctx.point, ctx.wavelengths),
                                   k_texture_->eval(ctx.point, ctx.wavelengths));
}

void ConductorIndex::tabulate_diffuse() {
  tabulated_ = true;
  std::vector<float> nodes(eta_.nodes().size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    nodes[i] = fresnel_conductor_diffuse(eta_.nodes()[i], k_.nodes()[i])[0];
  diffuse_ = SampledSpectrum(eta_.grid(), std::move(nodes));
}

std::vector<ParameterDoc> conductor_parameters(std::vector<ParameterDoc> own) {
  std::vector<ParameterDoc> all = {
      {"material", "string", "", "none",
       "name of a conductor with tabulated index, such as Au or Cu_palik, or of a building material at radio "
       "frequencies, such as itu_concrete (ITU-R P.2040-3); none is a perfect mirror"},
      {"eta", "texture", "", "0", "real part of the index of refraction, instead of a material"},
      {"k", "texture", "", "1",
       "imaginary part of the index (extinction coefficient), instead of a material"},
      {"specular_reflectance", "texture", "", "1",
       "factor of the reflected light; leave at 1 for a real metal"}};
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

}  // namespace aureole
