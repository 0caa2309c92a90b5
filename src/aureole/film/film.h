// SPDX-License-Identifier: Apache-2.0
// The film family: the quantity that is measured at a pixel, and its form in a file.
#pragma once

#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/filter/filter.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class Film : public Object {
public:
  static constexpr const char* kFamily = "a film";
  using Object::Object;

  int width() const { return width_; }  ///< of the whole film, pixels
  int height() const { return height_; }
  int crop_x() const { return crop_x_; }  ///< the part that is rendered
  int crop_y() const { return crop_y_; }
  int crop_width() const { return crop_width_; }
  int crop_height() const { return crop_height_; }
  bool sample_border() const { return sample_border_; }
  const Filter& filter() const { return *filter_; }

  /// Numbers a sample is turned into; alpha is kept beside them.
  virtual int measured_channels() const = 0;
  /// Adds up the responses to the estimated spectral radiance of one sample: `estimate` per wavelength is
  /// L_i / (N p_lambda(lambda_i)) as PathDensity::contribution gives it. Writes measured_channels() numbers.
  virtual void measure(const Spectrum& estimate, const Wavelengths& wavelengths, float* out) const = 0;
  /// Sum over channels of the magnitude of the response, on the scene's grid: p_lambda follows it.
  virtual SampledSpectrum response() const = 0;

  /// Names of the channels of the developed picture, alpha last where asked for.
  virtual std::vector<std::string> channel_names() const = 0;
  /// One pixel of the picture from mean measured values and alpha. Linear, so that variances of replicates
  /// make sense.
  virtual void develop(const double* measured, double alpha, float* out) const = 0;
  /// Linear sRGB for a preview.
  virtual void develop_rgb(const double* measured, float rgb[3]) const = 0;
  virtual ExrPixel pixel_type() const = 0;
  /// The ending of the file where the user names none.
  virtual std::string file_extension() const { return ".exr"; }

  /// Multiplies the responses of all channels, for the srf of a sensor.
  virtual void multiply_response(const SampledSpectrum& factor) = 0;
  /// For a sensor whose pixels are measurements; `reason` is for a note where the scene states another filter.
  void use_box_filter(
      const std::string& reason =
          "it would weight what a sensor of one value sees by the place in its pixel: a box is used");

protected:
  /// Reads size, crop, border, filter and `compensate`.
  void read_common(const Properties& properties);
  /// Reads `component_format`.
  static ExrPixel read_component_format(const Properties& properties);

private:
  int width_ = 768, height_ = 576;
  int crop_x_ = 0, crop_y_ = 0, crop_width_ = 768, crop_height_ = 576;
  bool sample_border_ = false;
  std::shared_ptr<Filter> filter_;
  bool filter_is_default_ = false;
};

/// The response of every channel of the developed picture but alpha, on the scene's grid.
std::vector<SampledSpectrum> channel_responses(const Film& film, const SpectralGrid& grid);

}  // namespace aureole
