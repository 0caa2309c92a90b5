// SPDX-License-Identifier: Apache-2.0
// Uneven illumination: the grey levels of particles and of ground as smooth surfaces over the field. Used by
// segmentation only; the only header of this folder that exposes OpenCV.
#pragma once

#include <opencv2/core.hpp>

namespace aureole {

struct Levels {
  /// levels of the darker and of the brighter class as CV_32F pictures of the field's size
  cv::Mat dark, bright;
};

/// Initial threshold, before the particles are known: a smooth surface between the extremes of large
/// neighbourhoods.
cv::Mat first_threshold(const cv::Mat& smooth, const cv::Mat& seen);

/// Fits surfaces to the grey values of pixels of both classes that are farther than `core` from the class's
/// edge: a polynomial of second degree plus its residual averaged over `scale` pixels.
Levels fit_levels(const cv::Mat& grey, const cv::Mat& bright_class, const cv::Mat& seen, double core,
                  double scale);

/// Levels by morphological closing and opening with a square of `scale` pixels, then smoothing.
Levels morphological_levels(const cv::Mat& smooth, double scale);

}  // namespace aureole
