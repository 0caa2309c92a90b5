// SPDX-License-Identifier: Apache-2.0
// A digital camera as a measuring instrument: from a spectral picture to the digital numbers of its sensor.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/core/raw_image.h"
#include "aureole/optics/detector/photodetector.h"

namespace aureole {

/// A picture by wavelength: what each pixel has in contiguous intervals, as a spectral film stores it.
struct SpectralPicture {
  int width = 0, height = 0;
  bool is_irradiance = false;              ///< on the film, W/(m^2 nm); else radiance, W/(m^2 sr nm)
  std::vector<double> lower_nm, upper_nm;  ///< of the intervals
  std::vector<float> values;               ///< height x width x intervals

  float at(int x, int y, std::size_t bin) const {
    return values[(std::size_t(y) * std::size_t(width) + std::size_t(x)) * lower_nm.size() + bin];
  }
};
/// Takes the spectral channels of a picture, by the meanings that its header states (`aureole:channels`). Throws Error,
/// which `name` begins, where it has none.
SpectralPicture spectral_picture(const Image& picture, const std::string& channels_attribute,
                                 const std::string& name);

/// The quantum efficiency of a filter with the sensor behind it: electrons per photon by wavelength, linear between the
/// points and 0 beyond them.
struct EfficiencyCurve {
  std::vector<double> nm, values;
  double at(double wavelength_nm) const;
  static EfficiencyCurve constant(double value);
};

struct CameraModel {
  std::string name = "aureole";
  optics::DetectorModel detector;
  double pixel_pitch_um = 4;  ///< distance of neighbouring pixels
  double fill_factor = 1;     ///< fraction of the pixel's area that is sensitive
  double f_number = 2.8;      ///< for pictures of the radiance
  optics::ApertureLaw aperture = optics::ApertureLaw::sine;
  double transmission = 1;  ///< of lens and filters that all pixels share
  /// Transmittance by wavelength of lens and filters that all pixels share, besides `transmission`.
  EfficiencyCurve transmittance = EfficiencyCurve::constant(1);
  optics::ColorMosaic mosaic;
  std::vector<EfficiencyCurve> efficiency{
      EfficiencyCurve::constant(0.5)};  ///< one, or of red, green and blue
};

/// Reads a camera from a JSON file; keys that it lacks keep their values here, and unknown keys are errors. Curves are a
/// number, the name of a table beside the file, or lists of numbers ("nm" with "values", or with "red", "green" and "blue"); so
/// is the transmission, which all pixels share. Throws Error located in the file.
CameraModel read_camera(const std::filesystem::path& file);
/// Reads the text of a file of that name.
CameraModel parse_camera(const std::string& text, const std::filesystem::path& file);
/// Reads curves of a table: wavelengths in nm, and one column (efficiency) or three (red, green, blue). A first line of
/// headings is allowed. Throws Error located in the file.
std::vector<EfficiencyCurve> read_efficiency(const std::filesystem::path& file);
/// Throws Error if the camera cannot be.
void check_camera(const CameraModel& camera);

/// Mean number of electrons that the light of each pixel frees during the exposure [s], row by row.
std::vector<double> mean_electrons(const SpectralPicture& picture, const CameraModel& camera,
                                   double exposure);

/// The keys of the random numbers: `sensor` of the fixed pattern, `frame` of the noise of one picture.
struct NoiseSeeds {
  std::uint64_t sensor = 1, frame = 1;
};
/// The picture that the sensor reads.
RawImage read_sensor(std::span<const double> electrons, int width, int height, const CameraModel& camera,
                     double exposure, const NoiseSeeds& seeds);

/// How well a linear matrix takes the sensor's colours to the eye's.
struct ColorCalibration {
  std::array<double, 9>
      to_xyz{};  ///< rows, from the sensor's R, G, B, balanced so that white is 1, 1, 1, to XYZ
  std::array<double, 9>
      from_xyz{};  ///< rows, from XYZ (Y of white 1) to the sensor's R, G, B, not balanced; green 1 for white
  std::array<double, 3> white{};  ///< the sensor's R, G, B of a white surface under D65, the largest being 1
  std::vector<double> delta_e;    ///< CIEDE2000 of each patch
  double mean_delta_e = 0, largest_delta_e = 0;
};
/// Fits the matrix by least squares on the 24 patches of a virtual ColorChecker under D65: reflectances that have the
/// colours of the patches (sRGB values that X-Rite published), by smooth upsampling. White keeps its colour.
ColorCalibration calibrate_colors(std::span<const EfficiencyCurve> red_green_blue);
/// Calibrates a camera, with what its lens and its filters transmit by wavelength.
ColorCalibration calibrate_colors(const CameraModel& camera);

}  // namespace aureole
