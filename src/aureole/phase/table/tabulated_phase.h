// SPDX-License-Identifier: Apache-2.0
// Phase functions tabulated over the scattering angle and the wavelength, linear in cos(theta) and in the
// wavelength between nodes. The sampling pdf equals the value: between two wavelength nodes a direction is
// sampled from one of them, chosen with the weights of the interpolation.
#pragma once

#include <cstddef>
#include <span>

#include "aureole/core/table_fields.h"
#include "aureole/math/vec.h"
#include "aureole/phase/table/hemisphere_table.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class TabulatedPhase {
public:
  /// An empty table, to be read.
  TabulatedPhase() = default;
  /// `mu`: increasing cosines of the scattering angle from -1 (backward) to 1 (forward). `nm`: increasing
  /// wavelengths. `values`: one row per mu, with one value >= 0 per wavelength, in any unit, since each
  /// wavelength is normalised. The first and last wavelength are used beyond the range. Throws
  /// std::logic_error for arrays of wrong size, std::domain_error if all values of a wavelength are zero or a
  /// value is negative or not finite.
  TabulatedPhase(std::span<const double> mu, std::span<const double> nm, std::span<const double> values,
                 const SpectralGrid& grid);

  /// Returns the value [1/sr], which is also the pdf of `sample`. `w` belongs to the grid.
  Spectrum eval(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const;

  struct Sample {
    Vec3 wo;
    Spectrum value;  ///< value of the phase function, which equals the pdf
  };
  /// Samples a direction for the hero wavelength. u1 chooses between two wavelength nodes; it is unused if
  /// there is only one.
  Sample sample(const Vec3& wi, float u1, Vec2 u2, const Wavelengths& w) const;

  /// Returns the mean cosine of the scattering angle at a wavelength node.
  double asymmetry(int node) const;
  int wavelength_nodes() const { return wavelengths_; }
  std::size_t bytes() const { return forward_.bytes() + backward_.bytes(); }

  static constexpr TableKind kTable{"phase function", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.wavelengths_, self.position_, self.forward_, self.backward_);
  }

private:
  using Place = HemisphereTable::Place;
  Spectrum eval_at(const HemisphereTable& half, const Place& place, const Wavelengths& w) const;

  int wavelengths_ = 1;
  SampledSpectrum position_;  ///< position of a wavelength among the nodes
  HemisphereTable forward_, backward_;
};

}  // namespace aureole
