// SPDX-License-Identifier: Apache-2.0
// The aperture family: shapes of openings, or of opaque discs, in a layer of scatterers. A plug-in makes its
// shape in metres; the common parameters, the part in a mixture, rotation and spread of sizes, are here.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "aureole/optics/aperture/aperture_shape.h"
#include "aureole/optics/particle/size_distribution.h"
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

/// The required length `name` in metres. Apertures are between 1 nm and 1 m: their areas stay normal numbers in
/// single precision, and other lengths are mistaken units.
double get_aperture_length_m(const Properties& p, const std::string& name);

}  // namespace aureole
