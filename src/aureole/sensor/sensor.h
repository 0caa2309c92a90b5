// SPDX-License-Identifier: Apache-2.0
// The sensor family: which rays reach a point of the film.
#pragma once

#include "aureole/film/film.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/sampler/sampler.h"

namespace aureole {

class Sensor : public Object {
public:
  static constexpr const char* kFamily = "a sensor";
  using Object::Object;

  /// The ray seen at `film_position` (pixels from the film's top left corner, not the crop's); `lens` chooses
  /// a point of the aperture.
  virtual Ray sample_ray(Vec2 film_position, Vec2 lens) const = 0;

  const Film& film() const { return *film_; }
  const Sampler& sampler() const { return *sampler_; }

protected:
  /// Reads the children film (default: hdrfilm) and sampler (default: sobol).
  void read_common(const Properties& properties);

private:
  std::shared_ptr<Film> film_;
  std::shared_ptr<Sampler> sampler_;
};

}  // namespace aureole
