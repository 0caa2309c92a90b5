// SPDX-License-Identifier: Apache-2.0
// Figures of diffraction by edges, each with its error against a computation that shares nothing with it. Counterparts of the figures in
// the supplemental of Steinberg et al. 2024, "A Free-Space Diffraction BSDF".
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

/// Roots of the intensity of the wave of one edge of length 1 along x, whose amplitude goes from `a` to `b`, over canonical coordinates up
/// to `extent`. Where `inset` is positive, a corner has them up to that with the 0th-order lobe removed.
EdgeMap edge_wave_map(double a, double b, double extent, double inset);
/// One edge in a beam: an amplitude linear from `a` to `b` times a Gaussian, `ratio` the length of the edge over the Gaussian's standard
/// deviation; its exact wave and those of the linear amplitude with the same ends and of its mean.
EdgeCurves edge_amplitude(double a, double b, double ratio);
/// A square of `width` sigma in a Gaussian beam: its exact field, that of edge waves with linear amplitudes in `pieces` to a side, and
/// with one amplitude to a side.
EdgeCurves edge_profile(double width, int pieces);
/// The intensity around a wedge of metal, n pi outside of it, `wavelengths` across, by UTD; a half plane's error is against Sommerfeld's solution
/// by Fresnel's integrals, that of another wedge against the exact series.
EdgeMap wedge_map(double n, double phi_i, double wavelengths);
/// Behind an opening ("square", "ring" of 32 pieces, "slits") at the Fresnel number `fresnel`: edge waves, UTD, and the integrals of Fraunhofer and
/// of Rayleigh and Sommerfeld.
EdgeCurves opening_profile(const std::string& shape, double wavelengths, double fresnel);

/// Lengths in metres. `solver`: intensities in the plane across the slits, from straight on in steps of `step_degrees` [m^2/sr], for an
/// irradiance of 1.
struct SlitsAndSolver {
  double wavelength, width, height, apart, step_degrees;
  std::vector<double> solver;
};
EdgeCurves slits_profile(const SlitsAndSolver& slits);

}  // namespace aureole
