// SPDX-License-Identifier: Apache-2.0
// The correlation family: spatial correlation of the positions of a layer's scatterers, as a structure factor
// S'(q) without its delta function. Lengths are relative to the correlation radius a: u = q a.
#pragma once

#include <memory>
#include <vector>

#include "aureole/optics/arrangement/partial_structure_factors.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"

namespace aureole {

class Correlation : public Object {
public:
  static constexpr const char* kFamily = "a correlation";
  explicit Correlation(const Properties& properties);

  /// Returns `at`, stretched if the parameters say so.
  std::shared_ptr<const optics::StructureFactor> structure_factor(double area_fraction) const;

  /// Returns S' of discs of the correlation radius that cover `area_fraction` of the plane. Throws a
  /// std::domain_error that states the supported fractions.
  virtual std::shared_ptr<const optics::StructureFactor> at(double area_fraction) const = 0;

  /// Returns the nodes, in [least, most] with both included, at which S' or 1/S' is tabulated if the area
  /// fraction varies over a surface. Between nodes it is interpolated by polynomials of `degree()` in Fa/(1 -
  /// Fa). Their number is 1 more than a multiple of the degree.
  virtual std::vector<double> nodes(double least, double most) const;
  virtual int degree() const { return 1; }
  /// Whether 1/S' is interpolated, since it is smoother than S', as in fluids. S' must be positive.
  virtual bool interpolates_inverse() const { return false; }

  /// Returns S_ml of discs of several sizes, radii relative to the largest. Throws std::domain_error if the
  /// plug-in has no such model.
  virtual std::shared_ptr<const optics::PartialStructureFactors> at(
      const optics::HardDiscMixture& mixture) const;

  /// Whether shapes may overlap (random positions): the covered fraction is then 1 - exp(-Fr).
  virtual bool may_overlap() const { return false; }

private:
  double stretch_, direction_;
};

/// Returns the nested correlation, described by the row "correlation"; the default is hard discs
/// (percus_yevick).
std::shared_ptr<const Correlation> get_correlation(const Properties& properties);

}  // namespace aureole
