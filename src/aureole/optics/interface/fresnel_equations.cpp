// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/interface/fresnel_equations.h"

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

double checked_cosine(double cosine) {
  if (!(cosine >= -1e-6 && cosine <= 1 + 1e-6))
    throw std::domain_error("cosine of incidence must be in [0, 1], got " + std::to_string(cosine));
  return std::clamp(cosine, 0.0, 1.0);
}

void check_real_index(double n) {
  if (!(n > 0 && std::isfinite(n)))
    throw std::domain_error("refractive index must be positive and finite, got " + std::to_string(n));
}

void check_complex_index(Complex n) {
  // The index may have a tiny or zero real part, as for some metals, or a zero imaginary part, but not both.
  if (!(n.real() >= 0 && n.imag() >= 0 && std::isfinite(n.real()) && std::isfinite(n.imag()) &&
        std::abs(n) > 0))
    throw std::domain_error("complex refractive index eta + i k needs finite eta, k >= 0, not both 0, got " +
                            std::to_string(n.real()) + " + i " + std::to_string(n.imag()));
}

}  // namespace

FresnelAmplitudes fresnel_amplitudes(double cos_i, double n_i, Complex n_t) {
  cos_i = checked_cosine(cos_i);
  check_real_index(n_i);
  check_complex_index(n_t);
  // At exactly grazing incidence equal indices would give 0/0, although there is no interface.
  if (n_t == Complex(n_i)) return {0.0, 0.0, 1.0, 1.0, cos_i};

  // Normal component of the transmitted wave vector, n_t cos_t. For exp(-i omega t), its root with Im >= 0
  // decays away from the interface.
  const double sin2 = (1 - cos_i) * (1 + cos_i);
  const double real = n_t.real() * n_t.real() - n_t.imag() * n_t.imag() - n_i * n_i * sin2;
  const double imag = 2 * n_t.real() * n_t.imag();
  Complex normal_t = std::sqrt(Complex(real, imag));
  if (normal_t.imag() < 0) normal_t = -normal_t;
  const Complex cos_t = normal_t / n_t;

  const double normal_i = n_i * cos_i;
  const Complex sum_s = normal_i + normal_t;
  const Complex sum_p = n_t * cos_i + n_i * cos_t;
  return {(normal_i - normal_t) / sum_s, (n_t * cos_i - n_i * cos_t) / sum_p, 2 * normal_i / sum_s,
          2 * normal_i / sum_p, cos_t};
}

double fresnel_reflectance(double cos_i, double n_i, double n_t) {
  cos_i = checked_cosine(cos_i);
  check_real_index(n_i);
  check_real_index(n_t);
  if (n_i == n_t) return 0;
  const double eta = n_t / n_i;
  const double normal_t2 = eta * eta - (1 - cos_i) * (1 + cos_i);
  if (normal_t2 <= 0) return 1;
  const double normal_t = std::sqrt(normal_t2);  // cosine term eta cos_t
  const double r_s = (cos_i - normal_t) / (cos_i + normal_t);
  const double r_p = (eta * eta * cos_i - normal_t) / (eta * eta * cos_i + normal_t);
  return 0.5 * (r_s * r_s + r_p * r_p);
}

double fresnel_reflectance_conductor(double cos_i, double n_i, Complex n_t) {
  const FresnelAmplitudes a = fresnel_amplitudes(cos_i, n_i, n_t);
  return 0.5 * (std::norm(a.r_s) + std::norm(a.r_p));
}

double thin_slab_reflectance(double cos_i, double n_ext, double n_int) {
  const double r = fresnel_reflectance(cos_i, n_ext, n_int);
  return 2 * r / (1 + r);
}

SlabAmplitudes slab_amplitudes(double cos_i, double n_ext, Complex n_slab, double thickness) {
  if (!(thickness > 0 && std::isfinite(thickness)))
    throw std::domain_error("thickness of a slab must be positive and finite, got " +
                            std::to_string(thickness));
  const FresnelAmplitudes face = fresnel_amplitudes(cos_i, n_ext, n_slab);
  // Change of the amplitude along one pass through the slab.
  const Complex way = std::exp(Complex(0, 2 * kPi * thickness) * (n_slab * face.cos_t));
  const Complex sum_s = 1.0 - face.r_s * face.r_s * way * way, sum_p = 1.0 - face.r_p * face.r_p * way * way;
  // At the critical angle the amplitudes are 0/0, so that the amplitudes of a nearby angle are used.
  if (sum_s == 0.0 || sum_p == 0.0)
    return slab_amplitudes(cos_i < 0.5 ? cos_i + 1e-7 : cos_i - 1e-7, n_ext, n_slab, thickness);
  return {face.r_s * (1.0 - way * way) / sum_s, face.r_p * (1.0 - way * way) / sum_p,
          (1.0 - face.r_s * face.r_s) * way / sum_s, (1.0 - face.r_p * face.r_p) * way / sum_p};
}

SlabPowers slab_powers(double cos_i, double n_ext, Complex n_slab, double thickness) {
  return slab_powers(slab_amplitudes(cos_i, n_ext, n_slab, thickness));
}

SlabPowers slab_powers(const SlabAmplitudes& a) {
  return {0.5 * (std::norm(a.r_s) + std::norm(a.r_p)), 0.5 * (std::norm(a.t_s) + std::norm(a.t_p))};
}

double fresnel_diffuse_reflectance(double eta) {
  check_real_index(eta);
  if (eta == 1) return 0;
  // For eta below 1 the integrand has a kink at the critical angle. R is equal from both sides, so the
  // substitution mu_i dmu_i = eta^2 mu_t dmu_t leaves the smooth external integral.
  if (eta < 1) return (1 - eta * eta) + eta * eta * fresnel_diffuse_reflectance(1 / eta);
  const auto integrand = [eta](double mu) { return 2 * mu * fresnel_reflectance(mu, 1, eta); };
  return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(integrand, 0.0, 1.0, 15, 1e-11);
}

}  // namespace aureole::optics
