// SPDX-License-Identifier: Apache-2.0
// Analytic BRDFs fitted to a goniometer's readings, with confidence intervals and Akaike's criterion.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "aureole/instrument/laboratory/goniometer.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

struct FitSettings {
  std::vector<std::string> models;  ///< names of `brdf_models`; empty: all
  /// Half-angles of the cones of lamp and detector, over which models are averaged as the instrument does [degrees].
  double lamp_angle = 0, detector_angle = 0;
  /// Diameter of the viewed area and distance of the detectors [m]: over the area, too, directions differ. 0: a point.
  double viewed_m = 0, distance_m = 0.5;
  double floor =
      0.005;  ///< uncertainty of the model itself, relative to a reading, which joins the measured one
  std::size_t most_readings = 4000;  ///< of which as many are taken at even steps
  const std::atomic<bool>* stop = nullptr;
};

struct FittedParameter {
  std::string name;
  double value = 0;
  double low = 0, high = 0;  ///< confidence interval of 95 %; equal to the value for a parameter at its bound
};

struct BrdfFit {
  std::string model;
  std::vector<FittedParameter> parameters;
  double chi_squared = 0;  ///< sum of squares of residuals over uncertainties
  std::size_t readings = 0;
  double rms = 0;      ///< root of the mean square of the residuals [1/sr]
  double largest = 0;  ///< the largest residual [1/sr]
  double aic = 0;      ///< Akaike's criterion, chi^2 + 2 k: the best model has the least
  std::string
      bsdf;  ///< the model as a <bsdf> element; reflectances as spectra where the model is linear in them
};

std::vector<std::string> brdf_models();

/// Fits models to the readings of reflection, means over the bands, and returns them in the order of their AIC. Throws Error
/// for unknown models, and for tables with fewer readings than a model has parameters.
std::vector<BrdfFit> fit_brdfs(const GonioTable& table, const FitSettings& settings);

/// A table of the fits for people.
std::string fit_text(const std::vector<BrdfFit>& fits);

}  // namespace aureole
