// SPDX-License-Identifier: Apache-2.0
// `ClassifiedMedium`: the medium that a transfer function makes of a scalar volume. `dvr` composites it step
// by step; the other integrators follow light in it as in any medium.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "aureole/medium/classified/classification.h"
#include "aureole/medium/medium.h"
#include "aureole/plugin/registry.h"

namespace aureole {

class ClassifiedMedium final : public Medium {
public:
  explicit ClassifiedMedium(const Properties& properties);
  static std::vector<ParameterDoc> rows();

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const override;
  const PhaseFunction& phase() const override { return *phase_; }
  Majorants majorants() const override { return Majorants(*grid_); }
  Spectrum majorant(const Vec3&, const Wavelengths&) const override { return 1.f; }
  bool is_uniform() const override { return false; }
  bool has_uniform_emission() const override { return false; }
  bool emits() const override { return color_emits_; }
  bool scatters() const override { return !color_emits_; }
  float sampling_weight() const override { return sampling_weight_; }

  const ScalarField& field() const { return field_; }
  const Classification& classification() const { return classification_; }
  /// Whether a point is neither clipped nor outside the box of the volume.
  bool contains(const Vec3& p) const;
  /// Shortens the interval [begin, end] of distances along a ray to its part within the box and all clip planes. The
  /// interval is empty, end <= begin, where there is none.
  void clip(const Ray& ray, float& begin, float& end) const;
  /// Extinction and colour at a point inside, where the volume has the value `value`.
  TransferFunction::Sample classify(const Vec3& p, float value) const { return classification_.at(p, value); }
  /// Extinction and colour of a short segment with the midpoint `p` and these values at its ends.
  TransferFunction::Sample classify(const Vec3& p, float from, float to) const {
    return classification_.mean(p, from, to);
  }

  bool is_clipped() const { return !planes_.empty(); }
  /// Whether the colour is that of emitted light; else it is the single-scattering albedo.
  bool color_emits() const { return color_emits_; }
  /// Opacity of a layer of the thickness `unit()` and this extinction.
  float layer_opacity(float extinction) const { return -std::expm1(-extinction * unit_); }
  /// Length of the layer whose opacity the transfer function gives.
  float unit() const { return unit_; }
  float emission_scale() const { return emission_scale_; }
  /// Coefficients of gradient shading (Levoy 1988, "Display of surfaces from volume data", equation 3).
  struct Shading {
    float ambient, diffuse, specular, shininess;
  };
  const Shading& shading() const { return shading_; }

private:
  struct Plane {
    Vec3 n;
    float d;  ///< offset of the clip plane: points p with dot(n, p) >= d are kept
  };
  ScalarField field_;
  Classification classification_;
  float unit_ = 1;  ///< thickness of the layer whose opacity is given
  std::vector<Plane> planes_;
  bool color_emits_;
  float emission_scale_ = 1, sampling_weight_ = 1;
  SampledSpectrum d65_;
  Shading shading_;
  PhaseFunctionPtr phase_;
  std::optional<MajorantGrid> grid_;
};

}  // namespace aureole
