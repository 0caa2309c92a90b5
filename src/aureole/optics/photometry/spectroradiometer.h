// SPDX-License-Identifier: Apache-2.0
// An array spectroradiometer: slit function, dispersion, responsivity, stray light and noise of the detector, and the corrections
// that its user applies: wavelengths by lamp lines, the stray-light matrix, deconvolution.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace aureole::optics {

/// Pixels of an array behind a grating.
struct ArraySpectrograph {
  int pixels = 512;
  double first_nm = 350, last_nm = 850;  ///< wavelengths of the first and the last pixel
  double curvature_nm = 4;               ///< how far the middle pixel's wavelength is off a linear scale [nm]
  double slit_nm = 4;                    ///< full width at half maximum of the triangular slit function [nm]
  double scattered =
      3e-3;  ///< fraction of each wavelength's light that the grating scatters evenly over the array
  double halo = 3e-3;                    ///< fraction in a halo about its pixel
  double halo_nm = 40;                   ///< standard deviation of the halo [nm]
  double peak_nm = 600, width_nm = 180;  ///< of the responsivity, a Gaussian that is 1 at its peak
  double electrons = 1e6;                ///< signal of the brightest pixel; 0: no noise
  double read_noise = 10;                ///< standard deviation of a pixel's reading [electrons]

  double nm_at(double pixel) const;
  double responsivity(double nm) const;
};
/// Throws std::domain_error for numbers that describe no spectrograph.
void check(const ArraySpectrograph& s);

/// The signal of each pixel for a spectral power density per nm, without noise, in units of that density: what is within the slit
/// function, times the responsivity, and stray light.
std::vector<double> array_signal(const ArraySpectrograph& s, const std::function<double(double)>& density);
/// The signal of light of one wavelength and unit power [1/nm].
std::vector<double> line_signal(const ArraySpectrograph& s, double nm);
/// Adds the noise of counted electrons and of reading, by a seed.
std::vector<double> with_array_noise(const ArraySpectrograph& s, std::vector<double> signal,
                                     std::uint64_t seed);

/// A scale of wavelengths: nm = c0 + c1 i + c2 i^2 of the pixel i.
struct WavelengthScale {
  double c0 = 0, c1 = 1, c2 = 0;
  double residual_nm = 0;  ///< root of the mean square of the lines' deviations
  double nm_at(double pixel) const { return c0 + c1 * pixel + c2 * pixel * pixel; }
};
/// Calibrates by lamp lines of known wavelengths [nm], of which each is looked for within `search_nm` of where the linear scale from
/// `first_nm` to `last_nm` has it, and placed by the centroid of its peak. Throws std::domain_error for fewer than three lines in the
/// range.
WavelengthScale calibrate_wavelengths(std::span<const double> signal, std::span<const double> lines_nm,
                                      double first_nm, double last_nm, double search_nm);

/// The stray-light matrix D of an array: column j is the signal of a line at pixel j relative to what its slit function receives,
/// zero within the slit function (Y. Zong, S. W. Brown, B. C. Johnson, K. R. Lykke, Y. Ohno, "Simple spectral stray light correction
/// method for array spectroradiometers", Applied Optics 45(6), 2006, equations 1 to 8).
class StrayLightMatrix {
public:
  explicit StrayLightMatrix(const ArraySpectrograph& s);
  /// The signal without stray light: (I + D)^-1 applied to it.
  std::vector<double> corrected(std::span<const double> signal) const;

private:
  int n_;
  std::vector<double> inverse_;
};

/// Deconvolution by the method of Richardson and Lucy (W. H. Richardson 1972; L. B. Lucy 1974) with the slit function. Negative
/// values count as zero; more iterations sharpen, and raise noise.
std::vector<double> without_slit(const ArraySpectrograph& s, std::span<const double> values, int iterations);

}  // namespace aureole::optics
