// SPDX-License-Identifier: Apache-2.0
// Fits the Kubelka-Munk coefficients K and S of paints to measured samples.
#pragma once

#include <string>
#include <vector>

#include "aureole/pigment/paints.h"
#include "aureole/pigment/samples.h"

namespace aureole::pigment {

struct FitSettings {
  Surface surface = {};         ///< interface between the samples and air, as the instrument measures it
  std::string white = "white";  ///< name of the paint used for tints
};

/// The method by which a paint's coefficients were determined.
enum class FitMethod {
  film,                 ///< R and T of a free film of known thickness
  drawdowns,            ///< drawdowns of known thickness over two substrates
  opaque_and_drawdown,  ///< an opaque layer, and one drawdown of known thickness
  masstone,             ///< only for the white: an opaque layer, with S = 1 by definition
  tints                 ///< an opaque masstone, and tints with white
};
std::string_view name_of(FitMethod method);

/// Diagnostics of a fitted paint, to judge its quality before use.
struct FitReport {
  FitMethod method = FitMethod::masstone;
  int samples = 0;                     ///< number of different samples, without repeats
  int measurements = 0;                ///< number of all measurements used
  int negative_k = 0, negative_s = 0;  ///< number of wavelengths at which the data contradict the theory
  /// number of wavelengths at which masstone and tint have equal K/S, so that S was set to the white's
  int undefined = 0;
  double negative_from_nm = 0, negative_to_nm = 0;  ///< wavelength range of the negative values
  double residual = 0;  ///< rms difference of reflectance between several tints and the fit
};

struct Fit {
  /// Unclamped result, possibly with negative values (see `clamp_negative`); with standard errors if there
  /// are repeats.
  Palette palette;
  std::vector<FitReport> reports;  ///< reports, one per pigment
};

/// Fits every paint of the table. Repeats are averaged. Standard errors are jackknife estimates over repeats;
/// they are omitted for a paint with a sample without repeats. Methods are preferred in the order of
/// `FitMethod`. Results are per metre if all paints or the white were measured with a thickness; otherwise
/// they are relative to the white's S at each wavelength. With the masstone and one tint only, the fit has as
/// many unknowns as data, so that reproducing the tint proves nothing. Throws SampleError for an impossible
/// reflectance, and std::domain_error if a measurement of a paint is missing.
Fit fit(const SampleTable& table, const FitSettings& settings = {});

/// A measurement excluded from the fit, and its prediction.
struct LeftOut {
  std::size_t sample = 0;  ///< index of the sample in the table
  std::vector<double> predicted;
  double rms = 0;  ///< rms of predicted minus measured reflectance
};

/// Leave-one-out cross-validation: excludes each measurement that has repeats, fits the rest and predicts it.
std::vector<LeftOut> leave_one_repeat_out(const SampleTable& table, const FitSettings& settings = {});

}  // namespace aureole::pigment
