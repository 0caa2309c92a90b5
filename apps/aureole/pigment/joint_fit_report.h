// SPDX-License-Identifier: Apache-2.0
// `aureole pigment fit --joint`: one fit of all measurements of a table, by two theories, and its report.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "aureole/pigment/joint_fit.h"
#include "pigment/pigment_options.h"

namespace aureole {

struct JointOptions {
  bool joint = false;
  std::string theory = "best", black = "black";
  std::vector<std::string> hold_out;
  double g = pigment::StreamsSettings().g;
  pigment::JointSettings settings;

  void declare(CommandOptions& options);
};

/// A fitted palette, and the standard deviations of ln(K/S) by paint and wavelength.
struct JointPalette {
  pigment::Palette palette;
  std::vector<std::vector<double>> ratio_error;
};

/// Fits, prints the report and adds it to `out`. Returns the palette of the theory that is chosen.
JointPalette fit_jointly(const std::string& file, const pigment::SampleTable& table,
                         const JointOptions& options, const SurfaceOptions& surface, const std::string& white,
                         const std::string& illuminant, nlohmann::json& out);

}  // namespace aureole
