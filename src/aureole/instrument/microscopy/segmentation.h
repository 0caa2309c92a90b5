// SPDX-License-Identifier: Apache-2.0
// Segmentation of grey values into particles: corrects uneven illumination, classifies particles and ground,
// divides touching particles.
#pragma once

#include <vector>

#include "aureole/instrument/microscopy/micrograph.h"

namespace aureole {

enum class Polarity { automatic, dark, bright };
enum class Background { automatic, morphology, none };
enum class Denoise { automatic, none, gaussian, median };

struct SegmentationOptions {
  Polarity polarity = Polarity::automatic;
  /// Model of uneven illumination. automatic: smooth surfaces fitted to the levels of particles and of
  /// ground, away from edges; morphology: opening and closing by a square of the scale; none: one level each.
  Background background = Background::automatic;
  /// scale of the background [pixels], larger than particles; 0: eight times their radius
  double background_scale = 0;
  Denoise denoise = Denoise::automatic;
  /// Standard deviation of the Gaussian applied before outlines are found [pixels]; 0: chosen by the noise.
  double smooth = 0;
  bool fill_holes = false;  ///< particles with a centre as bright as the ground (lenses, rings) are filled
  double min_radius = 2;    ///< smallest radius of a particle [pixels]; smaller regions are dirt
};

struct Segmentation {
  int width = 0, height = 0;
  std::vector<float> coverage;  ///< covered fraction of each pixel: 0 ground, 1 particle, plus noise
  std::vector<float> smooth;    ///< smoothed coverage, whose level 1/2 is the outline
  /// label of each pixel: 0 for ground, or particle 1 ... count; labels extend `band` pixels beyond the
  /// outline
  std::vector<int> labels;
  std::vector<float> depth;  ///< distance from the outline inside, 0 outside [pixels]
  int count = 0;
  bool bright = false;
  /// convex minus concave outline length over their sum, in [-1, 1]; near 0 the polarity is ambiguous
  double polarity_score = 1;
  double noise = 0, contrast = 0, blur = 0;  ///< noise in coverage; contrast in grey levels; blur in pixels
  int band = 2;
  int too_small = 0;  ///< number of regions below min_radius that the frame does not cut
};

/// Segments a field. Throws Error with the field's name if there is no contrast, or if polarity is ambiguous.
Segmentation segment(const Micrograph& field, const SegmentationOptions& options);

/// Divides the regions of `depth` > 0 along the valleys of `depth`. A basin is merged with its neighbour if
/// its height above the pass is below 3/4 pixel or a quarter of its depth. Returns labels from 1 and their
/// number.
std::vector<int> divide(const std::vector<float>& depth, int width, int height, int& count);

}  // namespace aureole
