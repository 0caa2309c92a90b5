// SPDX-License-Identifier: Apache-2.0
// The integrator family: the radiance along a camera ray, or the light that paths from the emitters leave on
// the film. An integrator owns no scene state and no threads.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/sampler/sampler.h"
#include "aureole/scene/scene.h"
#include "aureole/spectrum/path_density.h"

namespace aureole {

/// Receives one line per event of a path, for replaying a pixel. Empty in normal rendering.
using PathLog = std::function<void(const std::string&)>;

struct RadianceEstimate {
  Spectrum estimate{0.f};  ///< L_i / (N p_lambda(lambda_i)), as Film::measure takes it
  float alpha = 0;
};

class Integrator : public Object {
public:
  static constexpr const char* kFamily = "an integrator";
  using Object::Object;
};

/// One of several paths followed together.
struct CameraPath {
  Ray ray;
  Wavelengths wavelengths;
  SampleStream samples;
  float* aovs = nullptr;
  RadianceEstimate result;
};

/// Follows paths from the sensor.
class RadianceIntegrator : public Integrator {
public:
  using Integrator::Integrator;

  /// Paths that `radiance_of` takes at once; usually samples of one pixel.
  static constexpr int kTogether = RayPacket::kSize;
  /// The same as `radiance` of each path, bit for bit, where an integrator can do it faster together.
  virtual void radiance_of(const Scene& scene, std::span<CameraPath> paths) const {
    static const PathLog no_log;
    for (CameraPath& p : paths) p.result = radiance(scene, p.ray, p.wavelengths, p.samples, no_log, p.aovs);
  }

  /// An estimate of the radiance along `ray`. The stream's dimensions count from 0. `aovs` receives one
  /// number per name of `aov_names`.
  virtual RadianceEstimate radiance(const Scene& scene, const Ray& ray, const Wavelengths& wavelengths,
                                    SampleStream& samples, const PathLog& log, float* aovs) const = 0;
  /// Further numbers measured beside the film's ("albedo.R", "depth"): names of their channels.
  virtual std::vector<std::string> aov_names() const { return {}; }
};

/// What a light path leaves on the film.
struct Splat {
  Vec2 film;  ///< pixels from the film's top left corner
  Spectrum estimate;
};

/// Follows paths from the emitters.
class SplatIntegrator : public Integrator {
public:
  using Integrator::Integrator;

  /// Appends what one light path leaves on the film: `estimate` is spectral power per film area [pixels^2]
  /// over the density of the path, as Film::measure takes it.
  virtual void trace(const Scene& scene, const Wavelengths& wavelengths, SampleStream& samples,
                     std::vector<Splat>& splats, const PathLog& log) const = 0;
  /// The rest of the radiance along a ray of the sensor: what light paths do not bring to the film, such as
  /// the background. As RadianceIntegrator::radiance estimates it.
  virtual Spectrum seen_directly(const Scene&, const Ray&, const Wavelengths&, const PathLog&) const {
    return 0.f;
  }
};

}  // namespace aureole
