// SPDX-License-Identifier: Apache-2.0
// Figures of diffraction by edges, each with its error against an independent computation. They are
// counterparts of the figures in the supplemental of Steinberg et al. 2024, "A Free-Space Diffraction BSDF".
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace aureole {

/// A picture of values in [0, 1] over a square, x to the right and y up, both from -1 to 1.
struct EdgeMap {
  std::function<double(double, double)> value;
  std::string caption;
};
struct EdgeCurves {
  std::string svg, caption;
};

/// Draws the magnitude |u| of the field diffracted by one edge of length 1 along x, whose amplitude varies
/// linearly from `a` to `b`, over canonical coordinates up to `extent`. If `inset` is positive, a corner
/// shows |u| up to `inset` with the 0th-order lobe removed.
EdgeMap edge_wave_map(double a, double b, double extent, double inset);
/// One edge in a beam. The amplitude is linear from `a` to `b` times a Gaussian; `ratio` is the length of the
/// edge over the Gaussian's standard deviation. The curves are the exact field, and the fields of a linear
/// amplitude between equal end values and of the mean amplitude.
EdgeCurves edge_amplitude(double a, double b, double ratio);
/// A square of `width` sigma in a Gaussian beam: its exact field, the sum of edge fields with linear
/// amplitudes in `pieces` per side, and the sum with one constant amplitude per side.
EdgeCurves edge_profile(double width, int pieces);
/// The intensity around a metallic wedge with exterior angle n pi, over `wavelengths` wavelengths, by the
/// uniform theory of diffraction (UTD). The error of a half-plane is against Sommerfeld's solution by Fresnel
/// integrals, the error of another wedge against the exact series.
EdgeMap wedge_map(double n, double phi_i, double wavelengths);
/// The intensity behind an aperture ("square", "ring" of 32 edges, "slits") at the Fresnel number `fresnel`:
/// edge fields, UTD, and the Fraunhofer and Rayleigh-Sommerfeld integrals.
EdgeCurves opening_profile(const std::string& shape, double wavelengths, double fresnel);

/// A comparison of diffraction by slits with a solver. Lengths are in metres. `solver`: intensities [m^2/sr]
/// in the plane perpendicular to the slits, from undeviated in steps of `step_degrees`, for an irradiance of
/// 1.
struct SlitsAndSolver {
  double wavelength, width, height, apart, step_degrees;
  std::vector<double> solver;
};
EdgeCurves slits_profile(const SlitsAndSolver& slits);

}  // namespace aureole
