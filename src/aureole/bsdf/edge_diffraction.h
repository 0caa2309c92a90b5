// SPDX-License-Identifier: Apache-2.0
// Parameters of a BSDF that control diffraction at the edges of its shape.
#pragma once

#include <optional>

namespace aureole {

/// An interface that a BSDF implements besides `Bsdf`, found by dynamic_cast. If some BSDF of a scene has it,
/// only shapes with such BSDFs diffract.
class EdgeDiffraction {
public:
  virtual ~EdgeDiffraction() = default;

  bool is_enabled() const { return enabled_; }
  /// Standard deviation of the beams' width [wavelengths], if given.
  std::optional<double> sigma() const { return sigma_; }
  /// Factor of the diffracted radiance.
  float scale() const { return scale_; }

protected:
  bool enabled_ = true;
  std::optional<double> sigma_;
  float scale_ = 1;
};

}  // namespace aureole
