// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/two_flux_error.h"

#include <cmath>

#include "aureole/optics/stack/plane_stack.h"
#include "aureole/pigment/colour_difference.h"
#include "aureole/pigment/domain.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {
namespace {

double lightness_of(double y) { return lab_of_xyz({y, y, y}, {1, 1, 1}).l; }

}  // namespace

TwoFluxError two_flux_error(const ScatteringLayer& layer, Convention convention) {
  require(layer.albedo >= 1e-6 && layer.albedo <= 1, layer.albedo, "the albedo", "must be in [1e-6, 1]");
  require(layer.thickness >= 1e-6 && layer.thickness <= 1e6, layer.thickness, "the thickness",
          "must be in [1e-6, 1e6]");
  require(std::abs(layer.g) <= 0.99, layer.g, "the mean cosine", "must be in [-0.99, 0.99]");
  require(layer.index >= 1 && layer.index <= 10, layer.index, "the index", "must be in [1, 10]");
  require_fraction(layer.substrate, "the substrate's reflectance");

  const double scattering = 1 / (1 - layer.g), absorption = scattering * (1 - layer.albedo) / layer.albedo;
  optics::StackDescription stack;
  stack.layers = {{absorption, scattering, layer.thickness, optics::LegendrePhase::henyey_greenstein(layer.g),
                   layer.index}};
  stack.substrate = layer.substrate;
  TwoFluxError result;
  result.reflectance = optics::PlaneStack(stack, {32}).fluxes(optics::StackLight::diffuse()).reflectance;
  result.lightness = lightness_of(result.reflectance);

  const Coefficients c = coefficients_of_transport(absorption, scattering, layer.g, convention);
  if (c.s < 0) return result;
  const Surface surface = smooth_surface(layer.index, Geometry::diffuse_diffuse, Specular::included);
  const double two =
      outer_reflectance(surface, reflectance_over(pigment::layer(c, layer.thickness), layer.substrate));
  result.error = two - result.reflectance;
  result.lightness_error = lightness_of(two) - result.lightness;
  return result;
}

}  // namespace aureole::pigment
