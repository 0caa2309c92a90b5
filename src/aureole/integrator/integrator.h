// SPDX-License-Identifier: Apache-2.0
// The integrator family: estimates of the light that reaches the film, from the sensor's rays or by paths
// from the emitters. An integrator owns no scene state and no threads.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/scene/scene.h"
#include "aureole/transport/batch.h"
#include "aureole/transport/path.h"
#include "aureole/transport/path_log.h"

namespace aureole {

/// The parts of a scene that an integrator needs beside surfaces, lights and media.
struct SceneNeeds {
  std::optional<DiffractionSettings> diffraction;  ///< how edges diffract light; empty: they do not
  bool may_diffract = false;  ///< whether the integrator follows light that edges of the scene diffract
  bool adds_media =
      false;  ///< whether coefficients of media that overlap add up, so that none has to be chosen
};

/// An approximation that an integrator makes on a scene, and its error as measured on some rays of the sensor.
struct ApproximationError {
  std::string text;              ///< the approximation and its error in words, with numbers
  double mean = 0, largest = 0;  ///< differences of the light of a ray, as parts of that of the brightest ray
};

class Integrator : public Object {
public:
  static constexpr const char* kFamily = "an integrator";
  using Object::Object;

  /// Follows the paths of a batch, which are usually samples of one pixel: at most kBatch in `dvr`,
  /// `radiance_field` and `splat`, any number in the others. Sets the result and the AOVs of each, and appends their splats. Results do not depend on the other paths of the batch,
  /// nor on `log`.
  virtual void trace(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
                     const BatchLog& log) const = 0;

  /// Follows the paths and, where `shows_emitters`, adds light that a receiver (sensor/sensor.h) receives
  /// directly, by light sampling: of emitters that no ray can hit, such as a point light, and of all others
  /// by multiple importance sampling where `receiver_rays` says how.
  void estimate(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
                const BatchLog& log) const;
  /// Whether the result includes light that arrives from emitters unscattered.
  virtual bool shows_emitters() const { return false; }
  /// How `trace` weights emission that the ray of a path finds at once, where `Path::receiver` is set.
  enum class ReceiverRays {
    unweighted,  ///< not at all: light sampling at receivers leaves lights out that rays hit
    scattered,   ///< against light sampling; media scatter the ray, or let it pass with some probability
    straight     ///< against light sampling; the ray passes media by their transmittance
  };
  virtual ReceiverRays receiver_rays() const { return ReceiverRays::unweighted; }
  /// Whether the sensor's rays go on behind obstacles near edges that diffract light (`probability_behind`).
  virtual bool rays_go_behind() const { return false; }

  /// Whether the result is the light of emitters: 0, with alpha 0, in scenes without emitters whose surfaces all are null.
  virtual bool shows_light() const { return false; }

  /// Pixels to which paths contribute: `pixel`, the result to their own pixel only; `film`, splats, of which
  /// the result is one more, so that a path belongs to no pixel; `both`, the result on their own pixel and
  /// splats.
  enum class Leaves { pixel, film, both };
  virtual Leaves leaves() const { return Leaves::pixel; }
  /// Parts of a scene that the integrator needs, which are known before the scene is made.
  virtual SceneNeeds needs() const { return {}; }
  /// Throws an Error, at its place in the file, where the scene has something that the integrator cannot
  /// follow.
  virtual void require_scene(const Scene&) const {}
  /// Notes on objects and parameters that the integrator does not show or use, each with its place in the file. Throws nothing
  /// for scenes that `require_scene` refuses.
  virtual std::vector<std::string> scene_notes(const Scene&) const { return {}; }
  /// Approximations beside the noise of samples, each with its error. The measurement takes some per cent of the work of a picture
  /// with `samples` samples in all, on `threads` threads, and does not depend on their number.
  virtual std::vector<ApproximationError> approximation_errors(const Scene&, [[maybe_unused]] double samples,
                                                               [[maybe_unused]] int threads) const {
    return {};
  }
  /// Names of the channels of further numbers measured beside the film's ("albedo.R", "depth"). None where
  /// paths belong to no pixel.
  virtual std::vector<std::string> aov_names() const { return {}; }
  /// For each of `aov_names` the meaning of the quantity with its unit, for the headers of pictures.
  virtual std::vector<std::string> aov_meanings() const { return {}; }
};

}  // namespace aureole
