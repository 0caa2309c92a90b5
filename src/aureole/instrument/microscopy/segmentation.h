// SPDX-License-Identifier: Apache-2.0
// From grey values to particles: evens out the light, tells particles from ground, divides those that touch.
#pragma once

#include <vector>

#include "aureole/instrument/microscopy/micrograph.h"

namespace aureole {

enum class Polarity { automatic, dark, bright };
enum class Background { automatic, morphology, none };
enum class Denoise { automatic, none, gaussian, median };

struct SegmentationOptions {
  Polarity polarity = Polarity::automatic;
  /// How uneven light is found. automatic: smooth surfaces through the levels of particles and of ground,
  /// away from edges; morphology: opening and closing by a square of the scale; none: one level each.
  Background background = Background::automatic;
  double background_scale = 0;  ///< pixels, larger than particles; 0: eight times their radius
  Denoise denoise = Denoise::automatic;
  /// Standard deviation of the Gaussian before outlines are found, pixels; 0: by the noise.
  double smooth = 0;
  bool fill_holes = false;  ///< particles with a middle like the ground (lenses, rings) are whole
  double min_radius = 2;    ///< pixels; smaller ones are dirt
};

struct Segmentation {
  int width = 0, height = 0;
  std::vector<float> coverage;  ///< part of a pixel that is particle: 0 ground, 1 particle, with noise beyond
  std::vector<float> smooth;    ///< the same, smoothed: its level 1/2 is the outline
  std::vector<int> labels;      ///< 0, or particle 1 ... count; reaches `band` pixels beyond the outline
  std::vector<float> depth;     ///< distance inside from the outline, 0 outside, pixels
  int count = 0;
  bool bright = false;
  double polarity_score = 1;  ///< excess of convex outline, in [-1, 1]; near 0 it could be either way
  double noise = 0, contrast = 0, blur = 0;  ///< noise in coverage; grey levels; pixels
  int band = 2;
  int too_small = 0;  ///< regions below min_radius that no frame cuts
};

/// Throws Error with the field's name where there is no contrast, or polarity cannot be told.
Segmentation segment(const Micrograph& field, const SegmentationOptions& options);

/// Regions of `inside` (1 where particle), divided at the valleys of `depth`. A basin that is less than 3/4
/// pixel or a quarter of its depth above the pass to its neighbour belongs to that. Returns labels from 1
/// and their number.
std::vector<int> divide(const std::vector<float>& depth, int width, int height, int& count);

}  // namespace aureole
