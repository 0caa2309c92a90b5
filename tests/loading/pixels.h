// SPDX-License-Identifier: Apache-2.0
// A picture of a scene, to be compared bit for bit.
#pragma once

#include <atomic>
#include <cmath>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/render/job.h"

namespace aureole::test {

inline std::vector<float> pixels_of(const LoadedScene& scene) {
  RenderOptions options;
  options.end = 2;
  options.threads = 1;
  RenderJob job(scene, options);
  const std::atomic<bool> stop{false};
  job.run(stop);
  std::vector<float> pixels = job.state().picture().pixels;
  for (float& p : pixels)
    if (std::isnan(p)) p = -1;  // equal to itself
  return pixels;
}

}  // namespace aureole::test
