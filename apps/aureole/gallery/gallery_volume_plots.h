// SPDX-License-Identifier: Apache-2.0
// Figures of direct volume rendering: what the length of its steps costs.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace aureole {

struct VolumeCurves {
  std::string svg, caption;
};

/// The error of a scene's `dvr` picture in each discrete form by the length of its steps, in voxels: the mean absolute difference
/// from steps of 1/32 voxel, in per cent of the mean. Throws Error where the scene has no volume. Empty if interrupted.
VolumeCurves steps_against_error(const std::filesystem::path& scene, const std::vector<double>& steps,
                                 int width, int height, const std::atomic<bool>& stop);

}  // namespace aureole
