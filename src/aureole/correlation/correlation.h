// SPDX-License-Identifier: Apache-2.0
// The correlation family: how the positions of a layer's scatterers depend on one another, as a structure
// factor S'(q) without its delta. Lengths are relative to the correlation radius a: u = q a.
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

  /// `at`, stretched where the parameters say so.
  std::shared_ptr<const optics::StructureFactor> structure_factor(double area_fraction) const;

  /// S' where discs of the correlation radius cover `area_fraction` of the plane. Throws std::domain_error
  /// that says which fractions it knows.
  virtual std::shared_ptr<const optics::StructureFactor> at(double area_fraction) const = 0;

  /// Fractions in [least, most], both included, between which S', or 1/S', is interpolated by polynomials of
  /// `degree()` in Fa/(1 - Fa), where the fraction varies over a surface. Their number is 1 more than a
  /// multiple of the degree.
  virtual std::vector<double> nodes(double least, double most) const;
  virtual int degree() const { return 1; }
  /// 1/S' is smoother than S', as in fluids. S' must be positive.
  virtual bool interpolates_inverse() const { return false; }

  /// S_ml of discs of several sizes, radii relative to the largest. Throws std::domain_error where the
  /// plug-in has no such model.
  virtual std::shared_ptr<const optics::PartialStructureFactors> at(
      const optics::HardDiscMixture& mixture) const;

  /// Shapes may overlap (random positions): the covered part is 1 - exp(-Fr).
  virtual bool may_overlap() const { return false; }

private:
  double stretch_, direction_;
};

/// The correlation that is nested, described by the row "correlation", or else hard discs (percus_yevick).
std::shared_ptr<const Correlation> get_correlation(const Properties& properties);

}  // namespace aureole
