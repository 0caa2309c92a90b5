// SPDX-License-Identifier: Apache-2.0
// Uneven light: the levels of particles and of ground as smooth surfaces over the field. For segmentation
// alone; the only header here that shows OpenCV.
#pragma once

#include <opencv2/core.hpp>

namespace aureole {

struct Levels {
  cv::Mat dark, bright;  ///< CV_32F, of the field's size
};

/// First guess, before the particles are known: a threshold that is a smooth surface between the
/// extremes of large neighbourhoods.
cv::Mat first_threshold(const cv::Mat& smooth, const cv::Mat& seen);

/// Surfaces through the grey values of pixels of the two classes that are farther than `core` from the
/// class's edge; a polynomial of second degree, and its residual averaged over `scale` pixels.
Levels fit_levels(const cv::Mat& grey, const cv::Mat& bright_class, const cv::Mat& seen, double core,
                  double scale);

/// Levels by closing and opening with a square of `scale` pixels, then smoothing.
Levels morphological_levels(const cv::Mat& smooth, double scale);

}  // namespace aureole
