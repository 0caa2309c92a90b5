// SPDX-License-Identifier: Apache-2.0
// `MaskAperture`: an aperture given by an image: a sum of square pixels, each with a transmittance in [0, 1].
// Up to the Nyquist frequency, |q_x|, |q_y| < pi/pitch, its transform approximates that of the shape in the
// image. Beyond, it is the periodic spectrum of the samples times the sinc of a pixel, which does not
// represent the shape.
#pragma once

#include <cstddef>
#include <vector>

#include "aureole/optics/aperture/aperture_shape.h"

namespace aureole::optics {

/// Transmittances of the pixels, row by row from the top (largest y).
struct Mask {
  int width = 0, height = 0;
  std::vector<float> open;  ///< transmittances in [0, 1]

  float& at(int x, int y) { return open[std::size_t(y) * width + x]; }
  float at(int x, int y) const { return open[std::size_t(y) * width + x]; }
};

class MaskAperture final : public ApertureShape {
public:
  static constexpr int kMaxSide = 1024;

  /// `pitch` is the side of a pixel. The origin is the centroid (`centroid`) or the centre of the image. The
  /// image's empty border is removed. A mask that is then still wider or higher than kMaxSide is averaged
  /// over squares of pixels. Throws std::domain_error for values outside [0, 1] and for a mask that is opaque
  /// everywhere.
  MaskAperture(const Mask& mask, double pitch, bool centroid);

  double area() const override { return area_; }
  double squared_area() const override { return squared_area_; }
  double bounding_radius() const override { return bounding_radius_; }
  /// Returns F(q) with an error below 1e-4 of the area. It is interpolated in a Fourier transform of at most
  /// 10 MB, which the constructor computes.
  std::complex<double> transform(double qx, double qy) const override;

private:
  void make_spectrum(const Mask& mask);

  double pitch_, area_ = 0, squared_area_ = 0, bounding_radius_ = 0;
  double x_ = 0, y_ = 0;        ///< pixel coordinates of the origin of `spectrum_`
  int columns_ = 0, rows_ = 0;  ///< size of the FFT
  int stride_ = 0;
  /// transform at the frequencies -kPad to columns/2 + kPad of x, and all frequencies of y
  std::vector<std::complex<float>> spectrum_;
};

}  // namespace aureole::optics
