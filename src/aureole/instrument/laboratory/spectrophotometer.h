// SPDX-License-Identifier: Apache-2.0
// Spectrophotometers: reflectance factors and transmittances as CIE 15 and ASTM E1164 name their geometries, haze and gloss. An
// instrument is a scene of lamps, an integrating sphere, ports and detectors around the specimen, which is traced.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/instrument/laboratory/bench.h"
#include "aureole/instrument/laboratory/specimen.h"
#include "aureole/instrument/laboratory/sphere_theory.h"

namespace aureole {

/// Where light comes from and where it is measured.
struct MeasuringGeometry {
  std::string name;  ///< "45a:0"
  bool transmits = false;
  /// One end: a direction, a ring of directions, or a sphere with or without the specular component.
  enum class End { normal, eight, forty_five, ring, sphere, sphere_without_specular } light, view;
  bool has_sphere() const { return light >= End::sphere || view >= End::sphere; }
};
/// All geometries of reflection, or of transmission.
std::vector<MeasuringGeometry> measuring_geometries(bool transmission);
/// The geometry of a name such as "d:8"; in transmission "0:0". Throws Error with all names.
MeasuringGeometry measuring_geometry(const std::string& name, bool transmission);

struct SpectrophotometerSettings {
  MeasuringGeometry geometry;
  /// How a reading becomes a reflectance: the standard takes the sample's place; both are in the sphere at once; or the
  /// incident irradiance is measured instead (absolute).
  enum class Method { substitution, comparison, absolute } method = Method::comparison;
  bool by_theory = false;  ///< the sphere in closed form instead of traced
  /// The traced sphere is compared with the theory, whose noise is low, and their quotient is fitted by a line over the reflectance:
  /// the walls are grey, so that wavelengths differ by the sample alone.
  bool is_pooled = false;
  double standard = 0.99;     ///< reflectance of the Lambertian standard
  double azimuth = 0;         ///< of the lamp or the detector of 45x, or of the lamp of 8 degrees [degrees]
  double viewed_m = 8e-3;     ///< diameter of the area that the detector views [m]
  double lit_m = 12e-3;       ///< diameter of the area that the lamp lights, without a sphere [m]
  double sample_m = 60e-3;    ///< extent of the specimen [m]
  double lamp_angle = 3.5;    ///< half of the angle under which the sample sees the lamp [degrees]
  double detector_angle = 2;  ///< half of the angle under which the sample sees the detector [degrees]
  double distance_m = 0.3;    ///< of lamp and detector from the sample, without a sphere [m]
  double sphere_m = 0.15;     ///< diameter of the sphere [m]
  double port_m = 25e-3;      ///< diameter of the sample's port [m]
  double wall = 0.97;         ///< reflectance of the sphere's wall
  double specular_angle =
      0;  ///< half-angle of the specular port [degrees]; 0: as wide as the mirrored beam needs
  bool correct_bandwidth = false;  ///< the correction of Stearns and Stearns (1988) for triangular slits
  double noise = 0;       ///< standard deviation of the detector for the standard's signal, relative to it
  double dark_noise = 0;  ///< standard deviation without light, relative to the standard's signal
  double standard_error = 0;       ///< relative standard uncertainty of the standard's reflectance
  double wavelength_error_nm = 0;  ///< standard uncertainty of the scale of wavelengths [nm]
};

/// A measured spectrum with its standard uncertainties by cause.
struct MeasuredSpectrum {
  std::vector<double> nm, values;
  struct Cause {
    std::string name;
    std::vector<double> errors;
  };
  std::vector<Cause> causes;  ///< "tracing", "detector", "standard", "wavelength"
  /// The part of the light that a wide port would read which is lost beside the lit area, by band, as diffusion predicts it
  /// (`optics::port_part`); empty unless a slab of a homogeneous medium is measured in reflection.
  std::vector<double> edge_loss;
  /// By replicate and band, the deviation of a value, of which the root of the mean square over the root of the replicates less
  /// one is the error by tracing. Bands share paths, so that sums over bands need them, such as the correction of the bandwidth.
  std::vector<std::vector<double>> deviations;
  /// The sum of all causes' squares under a root.
  double error(std::size_t band) const;
  /// The standard error of the sum of weights[i] times the value of band i.
  double error_of_sum(const std::vector<double>& weights) const;
  std::vector<std::string> notes;
};

/// Measures the specimen. Throws Error for sizes that do not fit each other: a sample smaller than the lit area, a port wider
/// than the sphere, a method that the geometry does not allow.
MeasuredSpectrum measure_spectrum(const Bench& bench, const Specimen& specimen,
                                  const SpectrophotometerSettings& settings);

/// Weights of bands by luminance under CIE illuminant C for the observer of CIE 1931, whose sum is 1. A single wavelength has
/// the weight 1. Throws Error where several wavelengths do not cover the visible range.
std::vector<double> luminance_weights(const std::vector<double>& nm);

/// Gives the settings the beam that ASTM D1003 asks for, nearly parallel and narrow: a half-angle of 0.1 degrees that lights 2 mm
/// from 1 m away. The usual beam is as wide as the port.
void use_beam_of_haze(SpectrophotometerSettings& settings);

/// A beam and a viewed area as a user states them: what is not stated is empty.
struct StatedBeam {
  std::optional<double> lamp_angle{};  ///< half of the angle under which the sample sees the lamp [degrees]
  std::optional<double> viewed_m{}, lit_m{};  ///< diameters of the viewed and of the lit area [m]
};

/// Replaces the beam and the viewed area by stated ones. An area that is not stated beside another one is the usual one: the
/// viewed area the default of the settings, the lit area 4 mm wider than the viewed one.
void set_beam(SpectrophotometerSettings& settings, const StatedBeam& stated);

/// Haze: transmitted light that leaves its direction by more than `angle` [degrees], over all transmitted light (ASTM D1003,
/// ISO 14782), by luminance, for the beam of the settings.
struct Haze {
  double total = 0, haze = 0, total_error = 0, haze_error = 0;
};
Haze measure_haze(const Bench& bench, const Specimen& specimen, SpectrophotometerSettings settings,
                  double angle, const std::vector<double>& luminance_weights);

/// Gloss units at 20, 60 or 85 degrees through the apertures of ISO 2813: 100 for black glass of index 1.567. Throws Error for
/// other angles.
Ratio measure_gloss(const Bench& bench, const Specimen& specimen, double angle,
                    const SpectrophotometerSettings& settings, const std::vector<double>& luminance_weights);

}  // namespace aureole
