// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/saunderson.h"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "aureole/optics/constants.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/pigment/domain.h"

namespace aureole::pigment {
namespace {

using optics::kDegree;

double counted(double reflected, Specular specular) { return specular == Specular::included ? reflected : 0; }

/// Outer value of one mode, R + T or R - T, of a layer between two equal interfaces.
double outer_mode(const Surface& s, double inner) { return s.through * inner / (1 - s.k2 * inner); }
double inner_mode(const Surface& s, double outer) { return outer / (s.through + s.k2 * outer); }

/// Smith's masking function of Trowbridge and Reitz's facets for one direction.
double masking(double mu, double alpha) {
  return 2 * mu / (mu + std::sqrt(mu * mu + alpha * alpha * (1 - mu) * (1 + mu)));
}

/// Directional albedo of facets with single reflection. The integration variable t in (0, 1), with tan^2
/// theta_m = alpha^2 t/(1 - t), makes the measure D cos(theta_m) of normals uniform.
double facet_albedo(double mu, double index, double alpha) {
  using Nodes = boost::math::quadrature::gauss<double, 40>;
  const double sine = std::sqrt((1 - mu) * (1 + mu)), shown = masking(mu, alpha);
  return Nodes::integrate(
      [&](double t) {
        const double tangent = alpha * std::sqrt(t / (1 - t)), cosine = 1 / std::sqrt(1 + tangent * tangent);
        return Nodes::integrate(
                   [&](double phi) {
                     const double facing = cosine * (mu + sine * tangent * std::cos(phi));
                     const double mu_out = 2 * facing * cosine - mu;
                     if (!(facing > 0 && mu_out > 0)) return 0.0;
                     return optics::fresnel_reflectance(std::min(facing, 1.0), 1, index) * facing /
                            (mu * cosine) * shown * masking(mu_out, alpha);
                   },
                   0.0, optics::kPi) /
               optics::kPi;
      },
      0.0, 1.0);
}

void check_index(double index) {
  require(index >= 1 && std::isfinite(index), index, "index of the binder", "must be at least 1");
}

}  // namespace

Surface saunderson_surface(double k1, double k2, Specular specular) {
  require(k1 >= 0 && k1 < 1, k1, "k1", "must be in [0, 1)");
  require(k2 >= 0 && k2 < 1, k2, "k2", "must be in [0, 1)");
  return {counted(k1, specular), (1 - k1) * (1 - k2), k2};
}

Geometry geometry_called(std::string_view name) {
  return name == "diffuse" ? Geometry::diffuse_diffuse
         : name == "45_0"  ? Geometry::angle_45_0
                           : Geometry::diffuse_8;
}

std::string_view name_of(Geometry geometry) {
  switch (geometry) {
    case Geometry::diffuse_diffuse:
      return "diffuse";
    case Geometry::diffuse_8:
      return "d8";
    case Geometry::angle_45_0:
      return "45_0";
  }
  throw std::logic_error("no such geometry");
}

std::string_view name_of(Specular specular) {
  return specular == Specular::included ? "included" : "excluded";
}

Surface smooth_surface(double index, Geometry geometry, Specular specular) {
  check_index(index);
  const double k2 = optics::fresnel_diffuse_reflectance(1 / index), inside = 1 / (index * index);
  const auto fresnel = [&](double degrees) {
    return optics::fresnel_reflectance(std::cos(degrees * kDegree), 1, index);
  };
  switch (geometry) {
    case Geometry::diffuse_diffuse:
      return saunderson_surface(optics::fresnel_diffuse_reflectance(index), k2, specular);
    case Geometry::diffuse_8:
      return saunderson_surface(fresnel(8), k2, specular);
    case Geometry::angle_45_0:
      return {0, (1 - fresnel(45)) * (1 - fresnel(0)) * inside, k2};
  }
  throw std::logic_error("no such geometry");
}

double rough_diffuse_reflectance(double index, double alpha) {
  check_index(index);
  require_fraction(alpha, "alpha");
  // facets are nearly parallel to the surface
  if (alpha < 1e-3) return optics::fresnel_diffuse_reflectance(index);
  // mu = m^2 concentrates nodes near grazing directions, where the albedo varies fast.
  return boost::math::quadrature::gauss<double, 40>::integrate(
      [&](double m) { return 4 * m * m * m * facet_albedo(m * m, index, alpha); }, 0.0, 1.0);
}

Surface rough_surface(double index, double alpha, Specular specular) {
  const double k1 = rough_diffuse_reflectance(index, alpha);
  return saunderson_surface(k1, 1 - (1 - k1) / (index * index), specular);
}

double outer_reflectance(const Surface& surface, double inner) {
  require_fraction(inner, "inner reflectance");
  return surface.seen + outer_mode(surface, inner);
}

double inner_reflectance(const Surface& surface, double outer) {
  if (!(outer >= surface.seen))
    throw std::domain_error("reflectance " + number_text(outer) +
                            " is below what the interface itself reflects, " + number_text(surface.seen));
  const double inner = inner_mode(surface, outer - surface.seen);
  if (!(inner <= 1 + 1e-12))
    throw std::domain_error("reflectance " + number_text(outer) +
                            " is above that of a perfect white under this interface, " +
                            number_text(outer_reflectance(surface, 1)));
  return std::min(inner, 1.0);
}

double converted_reflectance(const Surface& from, const Surface& to, double outer) {
  return outer_reflectance(to, inner_reflectance(from, outer));
}

LayerTransfer outer_transfer(const Surface& surface, LayerTransfer inner) {
  // For the sum and the difference of equal beams from both sides, the layer acts as if it had a mirror (R +
  // T and R - T), which is Saunderson's one-sided problem.
  const double even = outer_mode(surface, inner.reflectance + inner.transmittance);
  const double odd = outer_mode(surface, inner.reflectance - inner.transmittance);
  return {surface.seen + 0.5 * (even + odd), 0.5 * (even - odd)};
}

LayerTransfer inner_transfer(const Surface& surface, LayerTransfer outer) {
  const double reflected = outer.reflectance - surface.seen;
  const double even = inner_mode(surface, reflected + outer.transmittance);
  const double odd = inner_mode(surface, reflected - outer.transmittance);
  const LayerTransfer inner{0.5 * (even + odd), 0.5 * (even - odd)};
  if (!(inner.reflectance >= -1e-12 && inner.transmittance >= 0 && even <= 1 + 1e-12))
    throw std::domain_error("no layer under this interface has reflectance " +
                            number_text(outer.reflectance) + " and transmittance " +
                            number_text(outer.transmittance));
  return {std::max(inner.reflectance, 0.0), inner.transmittance};
}

}  // namespace aureole::pigment
