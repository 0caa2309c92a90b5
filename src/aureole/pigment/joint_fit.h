// SPDX-License-Identifier: Apache-2.0
// Fits all measurements of a table at once: one weighted least-squares problem for K and S of every paint at
// every wavelength, the thickness of every specimen, the amounts in every mixture, and cards without a
// measurement.
//
// Unknowns are logarithms, so that K and S are positive. A specimen is all that was measured of one layer of
// paint: over black and over white, repeats. A series is what was made in one session from the same batches of
// paint; paints may differ between series.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/pigment/film_theory.h"
#include "aureole/pigment/paints.h"
#include "aureole/pigment/samples.h"

namespace aureole::pigment {

/// Standard deviations that state what is known before the measurements. All but `noise` and `noise_relative`
/// are of logarithms; 0 fixes the quantity.
struct JointSettings {
  /// Error of a measured reflectance R, the theory's own error included: noise and noise_relative R, added in
  /// squares. Repeats of a specimen over one card add their own standard deviation, in squares as well.
  double noise = 0.01, noise_relative = 0.05;
  double thickness = 0.15;         ///< of a specimen without a stated thickness, about the common one
  double stated_thickness = 0.03;  ///< of a stated thickness
  double dose = 0.1;               ///< of each paint's amount in a mixture
  double specific_volume = 0.5;    ///< of a paint's volume per mass, relative to the others
  double g = 0;                    ///< of a paint's 1 - g about the theory's, if the theory has one
  /// A paint in one series about its mean over series: its strength, which K and S have in common, and K and S beside it.
  double series_strength = 0.25, series_k = 0.1, series_s = 0.05;
  double step_k = 0.7, step_s = 0.17;  ///< of the change of K and S over 10 nm
  double level_k = 3, level_s = 1.5;   ///< of K and S about the levels 0.4 and 7 per film
  /// A specimen whose squared residuals are, on average, this many times the expected ones counts half. 0:
  /// all count alike.
  double outlier_scale = 9;
  int iterations = 60;

  /// Two-constant theory with nothing else unknown: equal thickness, amounts by mass as stated, equal errors,
  /// no smoothness.
  static JointSettings plain();
};

/// How a specimen agrees with the fit.
struct SpecimenReport {
  std::string name;
  std::vector<std::size_t> samples;  ///< indices of the samples in the table
  double rms = 0;                    ///< rms of fitted minus measured reflectance
  double worst = 0;                  ///< the largest difference of reflectance, with its sign
  std::size_t worst_sample = 0;      ///< index of the sample with the largest difference
  double worst_nm = 0;
  double weight = 1;  ///< weight in the fit; below 1: down-weighted
  /// fitted over stated (or over the common) thickness, and its standard error
  double thickness = 1, thickness_error = 0;
  /// Fitted over stated amount of each paint of a mixture, relative to the other paints, and its standard error.
  struct Dose {
    std::string paint;
    double factor = 1, error = 0;
  };
  std::vector<Dose> doses;
};

/// The mean cosine of scattering in a paint, and its standard error.
struct MeanCosine {
  double g = 0, error = 0;
};

/// A paint whose K and S the table does not determine.
struct UnknownPaint {
  std::string name;
  bool ratio_is_known = false;  ///< whether K/S is known, from an opaque layer
};

/// The residuals in comparison with the stated noise.
struct ResidualReport {
  /// Root of the weighted sum of squares over the degrees of freedom, in units of the stated noise; 0 without `freedom`.
  double relative = 0;
  /// Measured values, counted by their specimens' weights, less the trace of the matrix that maps them to fitted values
  /// (estimated by random signs, M. F. Hutchinson, Commun. Stat. Simul. Comput. 19, 1990).
  double freedom = 0;
  double values = 0;  ///< number of measured values, by weights
};

/// Half the width of a 90 % interval of a normal distribution, in standard deviations.
inline constexpr double kNormal90 = 1.6449;

/// Standard errors of ln K, ln S and ln(K/S) of a paint, by wavelength.
struct PaintErrors {
  std::vector<double> k, s, ratio;
};

/// A predicted specimen.
struct JointPrediction {
  std::vector<double> values;  ///< reflectances at the table's wavelengths
  /// standard deviation of a new measurement about `values`; empty unless it was requested
  std::vector<double> error;
};

class JointSystem;

class JointFit {
public:
  /// Prepares a fit. Throws SampleError for measurements that no fit can use, with the reason, and
  /// std::domain_error if data are missing. `theory` must outlive the fit. Samples whose index is in
  /// `left_out` are not used, but their bare substrates are.
  JointFit(const SampleTable& table, const FilmTheory& theory, const JointSettings& settings = {},
           const std::vector<std::size_t>& left_out = {}, const JointFit* start = nullptr);
  ~JointFit();
  JointFit(JointFit&&) noexcept;

  /// Mean K and S of each paint over its series, and its relative density, the inverse of its volume, with standard errors if `with_errors` was called before.
  const Palette& palette() const { return palette_; }
  /// Standard error of ln(K/S), by paint and wavelength; empty before `with_errors`.
  const std::vector<std::vector<double>>& ratio_error() const { return ratio_error_; }
  void with_errors();
  /// Errors of each paint, in the palette's order, for a noise of measurements that is `noise_scale` times the stated one. With
  /// `ResidualReport::relative` they are those that the residuals tell, which leave out the error of the theory.
  std::vector<PaintErrors> errors(double noise_scale = 1);

  std::vector<SpecimenReport> specimens(bool with_errors = false) const;
  /// Volume per mass of each paint, relative to their mean, in the palette's order.
  std::vector<double> specific_volumes() const;
  /// Mean cosine of each paint, in the palette's order, in fits of streams in which paints have their own; else empty.
  std::vector<MeanCosine> mean_cosines() const;
  /// Predicts any sample of the table, at the thickness stated or the common one and the stated amounts. Throws
  /// std::domain_error for a paint that the fit has not seen.
  JointPrediction predict(const Sample& sample, bool with_error = false) const;
  /// Names of the cards that were not measured, whose reflectance is an unknown of the fit.
  const std::vector<std::string>& unknown_cards() const;
  /// Names of the specimens over two or more cards that reflect nearly the same, so that they do not
  /// determine the transmission.
  std::vector<std::string> over_equal_cards() const;
  /// Paints whose K and S cannot be determined separately. No mixture and no free film of them was measured,
  /// and at most one of: an opaque layer, films over cards that differ, films of stated thicknesses that
  /// differ.
  std::vector<UnknownPaint> unknown_paints() const;
  /// Films that are darker over the brighter of two measured cards, by more than the stated noise at most wavelengths,
  /// in words.
  std::vector<std::string> swapped_cards() const;
  ResidualReport residuals() const;
  double cost() const;
  int iterations() const;
  /// Whether the last step made the sum of squares smaller by less than one part in 10^5. Otherwise the number of
  /// iterations ended the fit.
  bool converged() const;

private:
  std::unique_ptr<JointSystem> system_;
  Palette palette_;
  std::vector<std::vector<double>> ratio_error_;
};

/// Seconds that a fit of this table takes on one core, within a factor of some three: a step solves the normal equations
/// of all wavelengths, and a fit has some 20 steps.
double joint_fit_seconds(const SampleTable& table, const JointSettings& settings = {});

/// Notes about the data of a fit: cards that were not measured, specimens over cards that are alike, paints
/// for which the data determine only K/S, with the measurement that is missing, cards that seem swapped, a
/// fit that did not converge.
std::vector<std::string> joint_notes(const JointFit& fit);

/// Throws SampleError for a reflectance or transmittance above 1.05, and notes values that no paint has under
/// the interface: a few of them, caused by noise, are used like all other measurements.
std::vector<std::string> range_notes(const SampleTable& table, const Surface& surface);

/// The key of a sample's specimen: its column "specimen", or else recipe, thickness and series.
std::string specimen_key(const Sample& sample);

}  // namespace aureole::pigment
