// SPDX-License-Identifier: Apache-2.0
// Renders of small scenes with their statistical errors, from independently scrambled replicates.
#pragma once

#include <string>
#include <vector>

namespace aureole {
struct LoadedScene;
struct RenderOptions;
}  // namespace aureole

namespace aureole::testing {

inline constexpr int kReplicates = 16;

/// Means over replicates, per pixel and over the film, of one measured channel: Y, or the only one of a
/// uniform response.
struct Picture {
  int width = 0, height = 0;
  std::vector<double> mean, error;  ///< per pixel
  double all = 0, all_error = 0;    ///< over the film
};

/// Renders a scene to the end, its light paths' splats included. `options` has at least two replicates.
Picture render(const LoadedScene& scene, const RenderOptions& options);
/// Renders the content of a <scene> in two threads.
Picture render(const std::string& content);

/// The largest difference of two pixels at the same place, in standard errors: whether anything of what a test compares is there.
double largest_difference(const Picture& a, const Picture& b);

/// Within 4.5 standard errors, and these are small enough to mean something.
void expect_mean(const Picture& p, double expected, double largest_error = 0.01);
void expect_pixels(const Picture& p, double expected);

}  // namespace aureole::testing
