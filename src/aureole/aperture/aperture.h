// SPDX-License-Identifier: Apache-2.0
// The aperture family: shapes of openings, or of opaque discs, in a layer of scatterers. A plug-in makes its
// shape in metres; this class has the common parameters: fraction in a mixture, rotation and spread of sizes.
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

  /// Returns the shape as given, in metres, without rotation. It is never null and has a positive area.
  const std::shared_ptr<const optics::ApertureShape>& shape() const { return shape_; }
  /// Returns the fraction of the layer's scatterers that have this shape.
  double fraction() const { return fraction_; }
  /// Returns the counter-clockwise rotation of every scatterer, in rad.
  double rotation() const { return rotation_; }
  /// Whether every scatterer is rotated by its own random angle.
  bool is_randomly_rotated() const { return random_rotation_; }
  /// Returns the sizes relative to `shape()`.
  const optics::SizeDistribution& sizes() const { return sizes_; }

protected:
  /// Sets the shape. Constructors of plug-ins must call it.
  void set_shape(std::shared_ptr<const optics::ApertureShape> shape) { shape_ = std::move(shape); }

private:
  std::shared_ptr<const optics::ApertureShape> shape_;
  double fraction_, rotation_;
  bool random_rotation_;
  optics::SizeDistribution sizes_;
};

/// Returns the required length `name` in metres. Apertures are between 1 nm and 1 m: their areas are normal
/// numbers in single precision, and other lengths indicate wrong units.
double get_aperture_length_m(const Properties& p, const std::string& name);

}  // namespace aureole
