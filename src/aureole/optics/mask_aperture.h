// SPDX-License-Identifier: Apache-2.0
// `MaskAperture`: an opening given by a picture, of square pixels that are each open in part. Up to the
// Nyquist frequency of the pixels, |q_x|, |q_y| < pi/pitch, that is the shape's transform; beyond, it is that
// of the squares, repeating under their sinc, and says nothing about the shape.
#pragma once

#include <cstddef>
#include <vector>

#include "aureole/optics/aperture_shape.h"

namespace aureole::optics {

/// Row by row from the top (largest y).
struct Mask {
  int width = 0, height = 0;
  std::vector<float> open;  ///< in [0, 1]

  float& at(int x, int y) { return open[std::size_t(y) * width + x]; }
  float at(int x, int y) const { return open[std::size_t(y) * width + x]; }
};

class MaskAperture final : public ApertureShape {
public:
  static constexpr int kMaxSide = 1024;

  /// `pitch` is the side of a pixel. The origin is the centroid, or else the centre of the picture. The empty
  /// border does not count; of masks still wider or higher than kMaxSide, squares of pixels are averaged.
  /// Throws std::domain_error for values outside of [0, 1] and where nothing is open.
  MaskAperture(const Mask& mask, double pitch, bool centroid);

  double area() const override { return area_; }
  double squared_area() const override { return squared_area_; }
  double bounding_radius() const override { return bounding_radius_; }
  /// To 1e-4 of the area. Interpolated in a Fourier transform made once, of at most 10 MB.
  std::complex<double> transform(double qx, double qy) const override;

private:
  void make_spectrum(const Mask& mask);

  double pitch_, area_ = 0, squared_area_ = 0, bounding_radius_ = 0;
  double x_ = 0, y_ = 0;        ///< of the pixel that the spectrum has as its origin
  int columns_ = 0, rows_ = 0;  ///< size of the FFT
  int stride_ = 0;
  std::vector<std::complex<float>> spectrum_;  ///< frequencies -kPad to columns/2 + kPad of x, all of y
};

}  // namespace aureole::optics
