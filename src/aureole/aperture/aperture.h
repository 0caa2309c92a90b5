// SPDX-License-Identifier: Apache-2.0
// The aperture family: shapes of openings, or of opaque discs, in a layer of scatterers. A plug-in makes its
// shape in metres; what all have in common, their part in a mixture, rotation and spread of sizes, is here.
#pragma once

#include <memory>
#include <vector>

#include "aureole/optics/aperture_shape.h"
#include "aureole/optics/size_distribution.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"

namespace aureole {

class Aperture : public Object {
public:
  static constexpr const char* kFamily = "an aperture";
  explicit Aperture(const Properties& properties);

  /// The shape as written, in metres, unturned. Never null, never without area.
  const std::shared_ptr<const optics::ApertureShape>& shape() const { return shape_; }
  /// Its part of the number of scatterers of the layer.
  double fraction() const { return fraction_; }
  /// Angle that every scatterer is turned by, counter-clockwise, rad.
  double rotation() const { return rotation_; }
  /// Every scatterer is turned by its own random angle.
  bool is_randomly_rotated() const { return random_rotation_; }
  /// Sizes relative to `shape()`.
  const optics::SizeDistribution& sizes() const { return sizes_; }

protected:
  /// For constructors of plug-ins.
  void set_shape(std::shared_ptr<const optics::ApertureShape> shape) { shape_ = std::move(shape); }

private:
  std::shared_ptr<const optics::ApertureShape> shape_;
  double fraction_, rotation_;
  bool random_rotation_;
  optics::SizeDistribution sizes_;
};

/// Rows of the parameter table that all apertures share, after those of the plug-in.
std::vector<ParameterDoc> aperture_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole
