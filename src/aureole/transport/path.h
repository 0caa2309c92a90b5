// SPDX-License-Identifier: Apache-2.0
// `Path`: a sample of the film whose radiance is estimated, with its result; and `Splat`: light that a path
// contributes to another position on the film.
#pragma once

#include <limits>

#include "aureole/sampler/sampler.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

struct Receiver;

struct RadianceEstimate {
  Spectrum estimate{0.f};  ///< L_i / (N p_lambda(lambda_i)), as Film::measure takes it
  float alpha = 0;
  /// Marks the sample as invalid: it is left out of the picture and counted.
  void invalidate() { estimate = std::numeric_limits<float>::quiet_NaN(); }
};

/// One of the paths of a batch, which belongs to a sample of a pixel.
struct Path {
  Ray ray;    ///< the ray that leaves the sensor
  Vec2 film;  ///< position at which the film was sampled [pixels from the film's top left corner]
  Wavelengths wavelengths;
  /// random numbers of the sample; its dimensions count from the first one after those of the sensor
  SampleStream samples;
  /// The receiver that `ray` leaves, where `Integrator::estimate` samples the lights at it: emission that the ray
  /// finds is weighted against that. Null: nothing samples lights at the ray's origin.
  const Receiver* receiver = nullptr;
  float* aovs = nullptr;    ///< receives one number per name of `Integrator::aov_names`
  RadianceEstimate result;  ///< estimate of the radiance along `ray`, set by `Integrator::trace`
};

/// Light that a path contributes to any position on the film.
struct Splat {
  int path;   ///< index of the path in the batch
  Vec2 film;  ///< position on the film [pixels from the film's top left corner]
  /// Spectral power per film area [pixels^2] over the pdf of the path, as Film::measure takes it.
  Spectrum estimate;
};

}  // namespace aureole
