// SPDX-License-Identifier: Apache-2.0
// The film family: the quantity measured at a pixel, and its storage in a file.
#pragma once

#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/filter/filter.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The geometry of the quantity that a sensor measures: radiance along rays, irradiance at points (also of
/// receivers with another response to directions), or intensity in directions.
enum class MeasuredKind { radiance, irradiance, intensity };

class Film : public Object {
public:
  static constexpr const char* kFamily = "a film";
  using Object::Object;

  /// Tells the film what its sensor measures; `name` is a word before the name of the quantity, such as "cylindrical".
  /// Throws Error where the film states a quantity of another kind.
  void set_measured(MeasuredKind kind, std::string name = "");
  MeasuredKind measured_kind() const { return measured_kind_; }

  /// Tells the film how long a point of it is exposed [s], for quantities over time. Throws Error if it measures one and
  /// the duration is 0.
  virtual void set_exposure(double /*seconds*/) {}
  /// Whether it measures power or energy, in W, lm, J or lm s, instead of its density per area. A sensor of the irradiance
  /// then multiplies by the area of a pixel [m^2], or refuses (`Film::refuse_flux`).
  virtual bool measures_flux() const { return false; }
  /// Throws Error if the film measures power or energy, of which `reason` says why the sensor cannot.
  void refuse_flux(const std::string& reason) const;
  /// Whether it measures a quantity over time, such as J/m^2 or lx s.
  virtual bool integrates_over_time() const { return false; }

  int width() const { return width_; }  ///< of the whole film, pixels
  int height() const { return height_; }
  int crop_x() const { return crop_x_; }  ///< position and size of the rendered region [pixels]
  int crop_y() const { return crop_y_; }
  int crop_width() const { return crop_width_; }
  int crop_height() const { return crop_height_; }
  bool sample_border() const { return sample_border_; }
  const Filter& filter() const { return *filter_; }

  /// Number of values measured per sample; alpha is stored besides.
  virtual int measured_channels() const = 0;
  /// Measures one sample: sums the responses to its estimated spectral radiance. `estimate` per wavelength is
  /// L_i / (N p_lambda(lambda_i)), as PathDensity::contribution returns it. Writes measured_channels()
  /// values.
  virtual void measure(const Spectrum& estimate, const Wavelengths& wavelengths, float* out) const = 0;
  /// Sum over channels of the magnitude of the response, on the scene's grid; p_lambda is chosen by it.
  virtual SampledSpectrum response() const = 0;

  /// Names of the channels of the developed picture, with alpha last if requested.
  virtual std::vector<std::string> channel_names() const = 0;
  /// For each of `channel_names` the quantity in words, with its unit, for the headers of pictures.
  virtual std::vector<std::string> channel_meanings() const = 0;
  /// Computes one pixel of the picture from mean measured values and alpha. It is linear, so that variances
  /// of replicates are meaningful.
  virtual void develop(const double* measured, double alpha, float* out) const = 0;
  /// Computes linear sRGB for a preview.
  virtual void develop_rgb(const double* measured, float rgb[3]) const = 0;
  virtual ExrPixel pixel_type() const = 0;
  /// Returns the file extension that is used if the user names no file.
  virtual std::string file_extension() const { return ".exr"; }

  /// Multiplies the responses of all channels by `factor`, the spectral response (parameter `srf`) of a
  /// sensor.
  virtual void multiply_response(const SampledSpectrum& factor) = 0;
  /// Replaces the filter by a box, for a sensor whose pixels are measurements. `reason` is the note if the
  /// scene states another filter.
  void use_box_filter(
      const std::string& reason =
          "it would weight what a sensor of one value sees by the place in its pixel: a box is used");

protected:
  /// Throws Error if the film cannot hold a quantity of this kind.
  virtual void check_kind(MeasuredKind) const {}
  /// Returns the name of `set_measured` followed by a blank, or nothing.
  const std::string& measured_name() const { return measured_name_; }
  /// Reads size, crop, border, filter and `compensate`.
  void read_common(const Properties& properties);
  /// Reads the parameter `component_format`.
  static ExrPixel read_component_format(const Properties& properties);

private:
  int width_ = 768, height_ = 576;
  int crop_x_ = 0, crop_y_ = 0, crop_width_ = 768, crop_height_ = 576;
  bool sample_border_ = false;
  std::shared_ptr<Filter> filter_;
  bool filter_is_default_ = false;
  MeasuredKind measured_kind_ = MeasuredKind::radiance;
  std::string measured_name_;
};

/// Returns the radiometric name of a kind, such as "irradiance", and its unit, such as "W/m^2".
const char* radiometric_name(MeasuredKind kind);
const char* radiometric_unit(MeasuredKind kind);

/// The response of every channel of the developed picture except alpha, on the scene's grid.
std::vector<SampledSpectrum> channel_responses(const Film& film, const SpectralGrid& grid);

}  // namespace aureole
