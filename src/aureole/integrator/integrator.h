// SPDX-License-Identifier: Apache-2.0
// The integrator family: an estimate of the radiance along a camera ray. An integrator owns no scene state
// and no threads.
#pragma once

#include <functional>
#include <string>

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
  /// Dimensions of the sample stream that the camera uses before the integrator's: film position and
  /// wavelength.
  static constexpr int kCameraDimensions = 3;
  using Object::Object;

  virtual RadianceEstimate radiance(const Scene& scene, const Ray& ray, const Wavelengths& wavelengths,
                                    SampleStream& samples, const PathLog& log) const = 0;
};

}  // namespace aureole
