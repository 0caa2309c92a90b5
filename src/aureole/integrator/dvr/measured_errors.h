// SPDX-License-Identifier: Apache-2.0
// Errors of the approximations of `dvr`, measured on some rays of the sensor.
#pragma once

#include <span>
#include <vector>

#include "aureole/integrator/dvr/settings.h"
#include "aureole/integrator/integrator.h"
#include "aureole/medium/classified/classified_medium.h"

namespace aureole {

/// Compares the light of rays by `settings` with their light by shorter steps, without early termination, and by the exact one of
/// two conventions. Each entry is one approximation. The rays spread over the film and hit a medium; the work is about a
/// hundredth of that of a picture with `samples` samples in all, but for pictures of very few samples.
std::vector<ApproximationError> measured_errors(const Scene& scene,
                                                std::span<const ClassifiedMedium* const> media,
                                                const DvrSettings& settings, const SampledSpectrum& d65,
                                                double samples, int threads);

}  // namespace aureole
