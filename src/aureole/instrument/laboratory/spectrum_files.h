// SPDX-License-Identifier: Apache-2.0
// Measured spectra as files that the commands of pigments read: CSV, CxF 3 and CGATS.17.
#pragma once

#include <string>

#include "aureole/pigment/samples.h"

namespace aureole {

/// The content of a file by its ending: .csv, .cxf (CxF 3, ISO 17972-1) or .txt, .cgats (CGATS.17, ISO 28178). `geometry` is the
/// name of CIE 15, such as "45a:0". Throws Error for other endings, and for CxF and wavelengths
/// at unequal steps.
std::string spectrum_file_content(const std::string& file, const pigment::SampleTable& table,
                                  const std::string& geometry);
/// Throws Error for a name whose ending says no format.
void require_spectrum_file(const std::string& file);

}  // namespace aureole
