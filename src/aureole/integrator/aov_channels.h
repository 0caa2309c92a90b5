// SPDX-License-Identifier: Apache-2.0
// Shared by integrators with AOVs: nested integrators, the base class of those that only nest others, and colours of estimates.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "aureole/integrator/integrator.h"
#include "aureole/spectrum/observer.h"

namespace aureole {

struct NestedIntegrator {
  /// name as Mitsuba forms it: the name of the integrator, or "_arg_0", "_arg_1", ... where it has none
  std::string name;
  std::shared_ptr<const Integrator> integrator;
  std::vector<std::string> channels;  ///< AOVs of the nested integrator
  /// descriptions of `channels`, as `Integrator::aov_meanings` gives them
  std::vector<std::string> meanings;
};

/// All nested integrators, in order; `documented_name` is their row of the parameter table. Throws a located
/// Error where the paths of one leave light on other pixels than their own.
std::vector<NestedIntegrator> nested_integrators(const Properties& properties,
                                                 std::string_view documented_name);

/// Appends the names and the descriptions of channels: the colours in linear sRGB and alpha of the first `colors` nested integrators, then
/// the AOVs of all.
void append_channels(const std::vector<NestedIntegrator>& nested, std::size_t colors,
                     std::vector<std::string>& names, std::vector<std::string>& meanings);

/// Returns the parts of a scene that nested integrators need. Throws a located Error where one diffracts light in another
/// manner than the others, since all follow light in one scene.
SceneNeeds nested_needs(const std::vector<NestedIntegrator>& nested);

/// Throws a located Error where two of the channels have one name.
void require_distinct(const Properties& properties, std::string_view parameter,
                      const std::vector<std::string>& channels);

/// Turns estimates into colours, whatever the film measures: the CIE 1931 observer, or the mean of the
/// sensor's range where that lies outside the visible.
class ColourMeter {
public:
  explicit ColourMeter(const SpectralGrid& grid);

  void xyz(const Spectrum& estimate, const Wavelengths& w, double out[3]) const;
  /// Linear sRGB of radiance; for reflectances, whose colour is the one under D65, see `reflectance_rgb`.
  void rgb(const Spectrum& estimate, const Wavelengths& w, float out[3]) const;
  /// Linear sRGB of a surface under D65 from its reflectance; it restores an <rgb> of the scene as written.
  /// `somewhere` is the reflectance at `fixed_wavelengths`: its mean is a control variate, so that a grey
  /// surface has no noise.
  void reflectance_rgb(const Spectrum& reflectance, const Wavelengths& w, const Spectrum& somewhere,
                       float out[3]) const;
  const Wavelengths& fixed_wavelengths() const { return fixed_; }

private:
  float range_nm_;
  bool visible_;
  std::array<SampledSpectrum, 3> observer_;
  SampledSpectrum d65_;
  Wavelengths fixed_;
};

/// An integrator whose picture and channels are made of those of the integrators that are nested in it: it needs all that they need, and says
/// all that they say about a scene.
class NestingIntegrator : public Integrator {
public:
  explicit NestingIntegrator(const Properties& properties);

  SceneNeeds needs() const override { return nested_needs(nested_); }
  void require_scene(const Scene& scene) const override;
  std::vector<std::string> scene_notes(const Scene& scene) const override;
  std::vector<ApproximationError> approximation_errors(const Scene& scene, double samples,
                                                       int threads) const override;
  std::vector<std::string> aov_names() const override { return names_; }
  std::vector<std::string> aov_meanings() const override { return meanings_; }

protected:
  std::vector<NestedIntegrator> nested_;
  ColourMeter meter_;
  std::vector<std::string> names_, meanings_;  ///< of the channels, which the derived class fills
};

}  // namespace aureole
