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
  require(layer.albedo > 0 && layer.albedo <= 1, layer.albedo, "the albedo", "must be above 0 and at most 1");
  require(layer.thickness > 0 && std::isfinite(layer.thickness), layer.thickness, "the thickness",
          "must be above 0 and finite");
  require(layer.g > -1 && layer.g < 1, layer.g, "the mean cosine", "must be between -1 and 1");
  require(layer.index >= 1 && std::isfinite(layer.index), layer.index, "the index", "must be at least 1");
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
