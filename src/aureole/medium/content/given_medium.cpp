// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/content/given_medium.h"

#include <fmt/format.h>

#include "aureole/medium/content/extinction_limit.h"
#include "aureole/medium/content/volume_majorants.h"
#include "aureole/spectrum/planck.h"

namespace aureole {

GivenMedium::GivenMedium(const Properties& p) : Medium(p) {
  const bool by_parts = p.has("sigma_a") || p.has("sigma_s");
  if (by_parts) {
    for (const char* name : {"sigma_t", "albedo"})
      if (p.has(name))
        throw p.error(name, "give either \"sigma_t\" and \"albedo\" or \"sigma_a\" and \"sigma_s\"");
    absorption_ = get_volume(p, "sigma_a", 0, SpectrumRole::unbounded);
    scattering_ = get_volume(p, "sigma_s", 0, SpectrumRole::unbounded);
    for (const auto& [name, part] : {std::pair{"sigma_a", absorption_}, {"sigma_s", scattering_}})
      if (!part->is_constant())
        throw p.error(name, "varies in space; give \"sigma_t\" and \"albedo\" instead");
  } else {
    extinction_ = get_volume(p, "sigma_t", 1, SpectrumRole::unbounded);
    albedo_ = get_volume(p, "albedo", 0.75, SpectrumRole::reflectance);
  }
  scale_ = float(p.get_float("scale", 1, Range::non_negative()));
  const double most = extinction_ ? double(extinction_->maximum())
                                  : double(absorption_->maximum()) + double(scattering_->maximum());
  const char* stated = p.has("scale") ? "scale" : by_parts ? "sigma_s" : "sigma_t";
  require_computable_extinction(p, stated, most * double(scale_));
  emission_ = get_optional_volume(p, "emission", SpectrumRole::emission);
  temperature_ = get_optional_volume(p, "temperature", SpectrumRole::unbounded);
  for (const char* name : {"sample_emitters", "has_spectral_extinction"}) {
    if (p.has(name))
      p.note(name, "lights are always sampled, and every wavelength has its own extinction: no effect");
    p.get_bool(name, true);
  }
  const double n = p.get_float("ior", 1, {1, 100});
  index2_ = float(n * n);
  if (temperature_) {
    const double hottest = double(temperature_->maximum()),
                 light =
                     most * double(scale_) * n * n * black_body_radiance(p.context().grid.min_nm, hottest);
    constexpr double kBrightest = 1e18;  // upper bound of the emission per length; far beyond it, sums along
                                         // paths overflow
    if (!(light <= kBrightest))
      throw p.error("temperature",
                    fmt::format("at {:.3g} K the medium would shine too brightly to be computed "
                                "with",
                                hottest));
  }
  sampling_weight_ = float(p.get_float("sampling_weight", 1, Range::non_negative()));
  phase_ = only_phase(p);
  if (extinction_ && !extinction_->is_constant() && scale_ > 0) {
    // Emission is collected at null collisions, so the majorant must be positive wherever there may be
    // emission, even if the extinction is zero there.
    const double factor = double(scale_) * double(phase_->largest_projected_area());
    const Vec3 diagonal = extinction_->to_box().value_or(Transform()).inverse().vector({1, 1, 1});
    grid_ = majorants_of(*extinction_, emission_ ? float(1 / (double(length(diagonal)) * factor)) : 0.f);
    require_computable_extinction(p, stated, *grid_, extinction_->minimum(), factor);
  }
}

void GivenMedium::eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const {
  if (grid_ && grid_->at(p) == 0) {
    // The medium is empty outside of its volumes' box, although volumes may have values there.
    out = {};
    return;
  }
  const float factor = scale_ * phase_->projected_area(d, p);
  if (extinction_) {
    out.sigma_t = extinction_->eval(p, w) * factor;
    out.sigma_s = out.sigma_t * min(albedo_->eval(p, w), 1.f);
  } else {
    out.sigma_s = scattering_->eval(p, w) * factor;
    out.sigma_t = out.sigma_s + absorption_->eval(p, w) * factor;
  }
  out.emission = emission_ ? emission_->eval(p, w) : Spectrum(0.f);
  if (temperature_)
    out.emission +=
        (out.sigma_t - out.sigma_s) * (black_body_radiance(w.nm, temperature_->eval_scalar(p)) * index2_);
}

Spectrum GivenMedium::majorant(const Vec3&, const Wavelengths& w) const {
  const float factor = scale_ * phase_->largest_projected_area();
  return (extinction_ ? extinction_->envelope(w) : absorption_->envelope(w) + scattering_->envelope(w)) *
         factor;
}

bool GivenMedium::scatters() const {
  return scale_ > 0 &&
         (extinction_ ? extinction_->maximum() > 0 && albedo_->maximum() > 0 : scattering_->maximum() > 0);
}

bool GivenMedium::is_uniform() const {
  return has_uniform_emission() && !grid_ && (!albedo_ || albedo_->is_constant());
}

bool GivenMedium::has_uniform_emission() const {
  return (!emission_ || emission_->is_constant()) &&
         (!temperature_ || (temperature_->is_constant() && !grid_ && (!albedo_ || albedo_->is_constant())));
}

std::vector<ParameterDoc> GivenMedium::rows() {
  return {
      {"sigma_t", "volume", "1/length", "1", "extinction coefficient"},
      {"albedo", "volume", "", "0.75", "single-scattering albedo: ratio of scattering to extinction"},
      {"sigma_a", "spectrum", "1/length", "0",
       "absorption coefficient; give sigma_a and sigma_s instead of sigma_t and albedo"},
      {"sigma_s", "spectrum", "1/length", "0", "scattering coefficient; see sigma_a"},
      {"scale", "float", "", "1", "factor of sigma_t, or of sigma_a and sigma_s"},
      {"emission", "volume", "W/(m^2 sr nm) per length", "none", "emitted radiance per length"},
      {"temperature", "volume", "K", "none",
       "temperature of thermal emission: absorption coefficient times Planck radiance (Kirchhoff's law)"},
      {"sampling_weight", "float", "", "1",
       "factor of the probability that light sampling chooses this medium's emission; 0: never"},
      {"ior", "float", "", "1",
       "index of refraction n of the medium, which multiplies its thermal emission by n^2; refraction at the "
       "boundary is set by the boundary's BSDF"},
      {"sample_emitters", "boolean", "", "true", "accepted without effect"},
      {"has_spectral_extinction", "boolean", "", "true", "accepted without effect"},
      {"phase", "phase", "", "isotropic", "phase function: angular distribution of the scattered light"}};
}

}  // namespace aureole
