// SPDX-License-Identifier: Apache-2.0
// The aperture of an instrument, and the light of translucent paints that a small one misses.
#pragma once

#include <optional>
#include <string>

#include "aureole/pigment/observation.h"
#include "aureole/pigment/paints.h"
#include "aureole/pigment/samples.h"

namespace aureole {

/// Diameter [m] of an aperture as files state it: a length such as "4 mm" or "8mm", or a number of millimetres. Names such as
/// "LAV", whose size differs from instrument to instrument, have none.
std::optional<double> aperture_diameter_m(const std::string& text);

/// The layer of a table that loses most light at the edge of the table's aperture, where the instrument lights no more than this.
struct ApertureLoss {
  double diameter_m = 0;
  double difference =
      0;               ///< CIEDE2000 between the measured layer and one that is lit far around the aperture
  std::string sample;  ///< name; empty if no layer has a thickness or is opaque
};
/// The loss by `pigment::disc_reflectance` with the K and S of a palette, which must be per metre; nothing where the table states no
/// aperture of a known size, or where K and S have no unit of length.
std::optional<ApertureLoss> aperture_loss(const pigment::SampleTable& table, const pigment::Palette& palette,
                                          const pigment::Observation& lamp);

/// The report of a fit on the stated aperture, in words; empty where the table states none.
std::string aperture_text(const pigment::SampleTable& table, const pigment::Palette& palette,
                          const pigment::Observation& lamp);

}  // namespace aureole
