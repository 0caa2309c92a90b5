// SPDX-License-Identifier: Apache-2.0
// Settings of a BSDF for diffraction at the edges of its shape.
#pragma once

#include <optional>

namespace aureole {

/// A part of a BSDF beside `Bsdf`, found by dynamic_cast. In scenes where some BSDF has it, only shapes with one diffract.
class EdgeDiffraction {
public:
  virtual ~EdgeDiffraction() = default;

  bool is_enabled() const { return enabled_; }
  /// Standard deviation of the beams of light [wavelengths], where it is stated.
  std::optional<double> sigma() const { return sigma_; }
  /// Factor of the diffracted light.
  float scale() const { return scale_; }

protected:
  bool enabled_ = true;
  std::optional<double> sigma_;
  float scale_ = 1;
};

}  // namespace aureole
