// SPDX-License-Identifier: Apache-2.0
// The correlation family: how the positions of a layer's scatterers depend on one another, as a structure
// factor S'(q) without its delta. Lengths are relative to the correlation radius a: u = q a.
#pragma once

#include <memory>
#include <vector>

#include "aureole/optics/structure_factor.h"
#include "aureole/plugin/properties.h"

namespace aureole {

class Correlation : public Object {
public:
  static constexpr const char* kFamily = "a correlation";
  using Object::Object;

  /// S' where discs of the correlation radius cover `area_fraction` of the plane. Throws std::domain_error
  /// that says which fractions it knows.
  virtual std::shared_ptr<const optics::StructureFactor> at(double area_fraction) const = 0;

  /// Fractions in [least, most], both included, between which 1/S' is interpolated, piecewise linear in
  /// Fa/(1 - Fa), where the fraction varies over a surface.
  virtual std::vector<double> nodes(double least, double most) const;

  /// Shapes may overlap (random positions): the covered part is 1 - exp(-Fr).
  virtual bool may_overlap() const { return false; }
};

}  // namespace aureole
