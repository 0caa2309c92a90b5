// SPDX-License-Identifier: Apache-2.0
// An image sensor as EMVA 1288 describes it: from the electrons that light frees to the digital numbers that are read.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace aureole::optics {

/// A linear image sensor (EMVA Standard 1288, release 4.0, section 2). All noise is of one pixel.
struct DetectorModel {
  double full_well = 20000;       ///< electrons that a pixel holds
  double read_noise = 3;          ///< standard deviation of reading a pixel [electrons]
  double dark_current = 0;        ///< electrons per second that heat frees
  double dark_nonuniformity = 0;  ///< DSNU: standard deviation of the offset over the pixels [electrons]
  double photo_nonuniformity =
      0;                    ///< PRNU: standard deviation of the response over the pixels, over the mean
  double gain = 0.2;        ///< K: digital numbers per electron
  double black_level = 64;  ///< digital number without light, added before conversion
  int bits = 12;            ///< of the converter

  /// Throws std::domain_error that names a value which no sensor has.
  void check() const;
  int white_level() const { return (1 << bits) - 1; }
  /// Electrons at which the converter or the pixel is full.
  double saturation() const;
  /// The variance of a pixel over frames [DN^2] by the mean number of electrons that light and heat free; with the
  /// variance 1/12 of rounding (section 2.4, equation 11).
  double temporal_variance(double electrons) const;
};

/// Random numbers of one pixel: a stream that its key determines.
class DetectorRandom {
public:
  explicit DetectorRandom(std::uint64_t key) : state_(key) {}
  double uniform();  ///< in (0, 1)
  double normal();   ///< of standard deviation 1
  /// A Poisson-distributed number: by multiplication up to 10, by transformed rejection above (Hoermann 1993, "The
  /// transformed rejection method for generating Poisson random variables", algorithm PTRS).
  double poisson(double mean);

private:
  std::uint64_t state_;
};

/// The digital number of a pixel, from the mean number of electrons that light frees during the exposure [s]. `pixel`
/// and `sensor` determine the offset and the response of the pixel, which all frames share; `frame` its noise.
std::uint16_t read_pixel(const DetectorModel& detector, double photoelectrons, double exposure,
                         std::uint64_t pixel, std::uint64_t sensor, std::uint64_t frame);
/// The digital number before rounding that the mean over frames and pixels approaches, without saturation.
double mean_signal(const DetectorModel& detector, double photoelectrons, double exposure);

/// A mosaic of colour filters before the pixels, which repeats over the sensor.
struct ColorMosaic {
  int width = 1, height = 1;
  std::vector<std::uint8_t> filters{
      0};  ///< of a cell, row by row: 0 red, 1 green, 2 blue; one of 0 has no filters

  bool is_mono() const { return filters.size() == 1; }
  int at(int x, int y) const {
    return filters[std::size_t(y % height) * std::size_t(width) + std::size_t(x % width)];
  }
  /// "mono"; "rggb", "bggr", "grbg", "gbrg" (Bayer 1976, US patent 3971065); "xtrans", 6 x 6. Throws std::domain_error
  /// that lists them.
  static ColorMosaic named(std::string_view name);
};

/// The light that a lens brings to the middle of the film: the projected solid angle [sr] of its aperture, which times the
/// radiance is the irradiance. `sine`: the f-number by Abbe's sine condition, pi/(4 N^2), that of a lens corrected for
/// distant objects. `thin`: a thin lens of focal length over diameter N, pi sin^2(atan(1/(2 N))).
enum class ApertureLaw { sine, thin };
double aperture_solid_angle(double f_number, ApertureLaw law);

/// The modulation transfer of a square pixel at a spatial frequency in cycles per its width, |sin(pi f)/(pi f)|.
double pixel_mtf(double cycles_per_pixel);
/// The modulation transfer of a lens of a round aperture without aberrations, in incoherent light of one wavelength
/// (Goodman 2005, "Introduction to Fourier optics", equation 6-32). Its cut-off is 1/(lambda N).
double diffraction_mtf(double frequency, double cutoff);

}  // namespace aureole::optics
