// SPDX-License-Identifier: Apache-2.0
// The clear sky of Hosek & Wilkie ("An analytic model for full spectral sky-dome radiance", 2012) and the sun
// seen through it ("Adding a solar-radiance function to the Hosek-Wilkie skylight model", 2013). Spectral
// radiance is in W/(m^2 sr nm) at 11 wavelengths, with linear interpolation between them.
#pragma once

#include <array>
#include <cstddef>

namespace aureole::optics {

class SkyModel {
public:
  static constexpr std::size_t kChannels = 11;
  static constexpr double wavelength_nm(std::size_t channel) { return 320 + 40 * double(channel); }
  /// The sun's mean angular diameter [rad], for which the model gives the solar radiance.
  static constexpr double kSunDiameter = 0.5358 * 0.017453292519943295;

  /// Makes a sky. Turbidity is in [1, 10], ground albedo at each wavelength in [0, 1], elevation of the sun's
  /// centre in [0, pi/2]. Values outside these ranges are clamped.
  SkyModel(double turbidity, const std::array<double, kChannels>& albedo, double solar_elevation);

  /// Returns the sky radiance, equation 8 of 2012 times the mean radiance, as a product that can be
  /// tabulated:
  /// radiance = horizon(cos_zenith) (glow(gamma) + zenith_gain sqrt(cos_zenith)),
  /// with gamma the angle to the sun. The fit may be slightly negative at the horizon under a low sun.
  double sky(std::size_t channel, double cos_zenith, double gamma) const;
  double horizon(std::size_t channel, double cos_zenith) const;
  double glow(std::size_t channel, double gamma) const;
  double zenith_gain(std::size_t channel) const { return sky_[channel][7]; }

  /// Returns the radiance of the centre of the sun's disc at this elevation [rad]; 0 below the horizon.
  double sun(std::size_t channel, double elevation) const;
  /// Returns the radiance of the disc over that of its centre (Neckel & Labs, "Solar limb darkening
  /// 1986-1990", 1994). `cosine` is the cosine between the direction and the normal of the sun's surface.
  static double limb_darkening(std::size_t channel, double cosine);

private:
  /// coefficients A ... I, and mean radiance, of each channel
  std::array<std::array<double, 10>, kChannels> sky_;
  double turbidity_;
};

}  // namespace aureole::optics
