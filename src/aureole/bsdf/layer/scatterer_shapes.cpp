// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/layer/scatterer_shapes.h"

#include <algorithm>
#include <memory>
#include <string>

#include "aureole/aperture/aperture.h"
#include "aureole/optics/aperture/round_aperture.h"

namespace aureole {

LayerShapes read_layer_shapes(const Properties& p) {
  LayerShapes layer;
  double largest = 0;
  const auto apertures = p.get_children<Aperture>("aperture");
  const double radius = p.get_length_m("radius", 0);
  if (apertures.empty()) {
    if (!p.has("radius"))
      throw p.error(
          "radius",
          "the parameter \"radius\" is required, a length such as \"5um\", or else nested apertures");
    layer.scatterers.push_back({std::make_shared<optics::EllipseAperture>(radius, radius), 1, 0, false, {}});
    largest = radius;
  } else if (p.has("radius")) {
    throw p.error("radius", "is for circles only; nested apertures have lengths of their own");
  }
  for (const auto& a : apertures) {
    layer.scatterers.push_back(
        {a->shape(), a->fraction(), a->rotation(), a->is_randomly_rotated(), a->sizes()});
    largest = std::max(largest, a->shape()->bounding_radius() * a->sizes().largest());
  }
  layer.largest = largest;
  layer.correlation_radius = p.get_length_m("correlation_radius", largest);
  if (layer.correlation_radius < largest * (1 - 1e-6))
    throw p.error("correlation_radius", apertures.empty()
                                            ? "must not be less than \"radius\""
                                            : "must not be less than the largest scatterer, whose "
                                              "circle has a radius of " +
                                                  std::to_string(largest * 1e6) + "um");
  if (layer.correlation_radius > largest * 64)
    throw p.error("correlation_radius",
                  "must not exceed 64 times " +
                      std::string(apertures.empty() ? "\"radius\"" : "the largest scatterer"));
  return layer;
}

}  // namespace aureole
