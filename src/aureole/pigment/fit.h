// SPDX-License-Identifier: Apache-2.0
// K and S of paints from measured samples.
#pragma once

#include <string>
#include <vector>

#include "aureole/pigment/paints.h"
#include "aureole/pigment/samples.h"

namespace aureole::pigment {

struct FitSettings {
  Surface surface = {};         ///< between the samples and the instrument
  std::string white = "white";  ///< the paint that tints are made with
};

/// How a paint's coefficients were found.
enum class FitMethod {
  film,                 ///< R and T of a free film of known thickness
  drawdowns,            ///< over two substrates, of known thickness
  opaque_and_drawdown,  ///< an opaque layer, and one drawdown of known thickness
  masstone,             ///< the white's: an opaque layer, S = 1 by definition
  tints                 ///< an opaque masstone, and tints with white
};
std::string_view name_of(FitMethod method);

/// Diagnostics of a fitted paint, to judge it by before it is used.
struct FitReport {
  FitMethod method = FitMethod::masstone;
  int samples = 0;                     ///< different ones, without repeats
  int measurements = 0;                ///< all that were used
  int negative_k = 0, negative_s = 0;  ///< wavelengths at which the data contradict the theory
  int undefined =
      0;  ///< wavelengths at which masstone and tint have the same K/S: S was set to that of white
  double negative_from_nm = 0, negative_to_nm = 0;  ///< the range of those above
  double residual = 0;  ///< rms reflectance by which several tints contradict one another
};

struct Fit {
  /// As found, negative values too (see `clamp_negative`); with errors where there are repeats.
  Palette palette;
  std::vector<FitReport> reports;  ///< one for each pigment
};

/// Fits every paint that occurs. Repeats are averaged; standard errors are those of the jackknife over
/// repeats, and are left out for a paint of which one sample has no repeat. Methods are preferred in the
/// order of `FitMethod`. Per metre, where all paints or the white were measured with a thickness; else
/// relative to the white's S at each wavelength. With the masstone and one tint alone the fit has as many
/// numbers as the data: that it gives back the tint proves nothing. Throws SampleError for an impossible
/// reflectance, and std::domain_error that says which measurement of which paint is missing.
Fit fit(const SampleTable& table, const FitSettings& settings = {});

/// One measurement that the fit did not see, and what it says of it.
struct LeftOut {
  std::size_t sample = 0;  ///< its place in the table
  std::vector<double> predicted;
  double rms = 0;  ///< of predicted less measured reflectance
};

/// Leaves out each measurement that has repeats, fits the rest and predicts it.
std::vector<LeftOut> leave_one_repeat_out(const SampleTable& table, const FitSettings& settings = {});

}  // namespace aureole::pigment
