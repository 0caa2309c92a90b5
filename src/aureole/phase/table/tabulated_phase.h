// SPDX-License-Identifier: Apache-2.0
// Phase functions tabulated over the scattering angle and the wavelength, linear in cos(theta) and in the
// wavelength between nodes. Density and value are one and the same: between two nodes of wavelength a
// direction is drawn from either, with probabilities that are the weights of the interpolation.
#pragma once

#include <cstddef>
#include <span>

#include "aureole/math/vec.h"
#include "aureole/phase/table/hemisphere_table.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class TabulatedPhase {
public:
  /// `mu`, cosines of the scattering angle, increase from -1 (straight back) to 1 (straight on); `nm`
  /// increases; `values` has a row per mu, of one value >= 0 per wavelength, in any unit: each wavelength is
  /// normalised. Beyond the first and last wavelength their functions hold. Throws std::logic_error for
  /// arrays that do not fit, std::domain_error where a wavelength has no light at all or a value is negative
  /// or no finite number.
  TabulatedPhase(std::span<const double> mu, std::span<const double> nm, std::span<const double> values,
                 const SpectralGrid& grid);

  /// Value and density [1/sr]. `w` belongs to the grid.
  Spectrum eval(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const;

  struct Sample {
    Vec3 wo;
    Spectrum value;  ///< and density
  };
  /// Drawn for the hero. u1 chooses between two wavelengths; it is not looked at where there is only one.
  Sample sample(const Vec3& wi, float u1, Vec2 u2, const Wavelengths& w) const;

  /// Mean cosine of the scattering angle at a node of wavelength.
  double asymmetry(int node) const;
  int wavelength_nodes() const { return wavelengths_; }
  std::size_t bytes() const { return forward_.bytes() + backward_.bytes(); }

private:
  using Place = HemisphereTable::Place;
  Spectrum eval_at(const HemisphereTable& half, const Place& place, const Wavelengths& w) const;

  int wavelengths_ = 1;
  SampledSpectrum position_;  ///< of a wavelength among the nodes
  HemisphereTable forward_, backward_;
};

}  // namespace aureole
