// SPDX-License-Identifier: Apache-2.0
// Writes a BSDF as text: Klems matrices in XML, a table of directions (CSV), and Zemax' tabular BSDF.
#pragma once

#include <string>
#include <vector>

#include "aureole/bsdf/measured/window_file.h"
#include "aureole/instrument/measured/scattering_probe.h"

namespace aureole {

struct KlemsWriterSettings {
  std::string basis = "LBNL/Klems Full";
  /// samples of the BSDF for each incident patch and side; a quarter as many uniform directions for each pair
  /// of patches
  int samples = 1024;
  bool is_reciprocal =
      false;  ///< whether the BSDF is known to be: both estimates of a pair of patches are averaged
  std::string name, manufacturer;
};
/// Means over pairs of patches, by samples of the BSDF, with delta lobes; the visible range under CIE D65 for the observer
/// of CIE 1931. +z is the file's back, as in Radiance.
std::string klems_file_content(const ScatteringProbe& probe, const KlemsWriterSettings& settings);

struct DirectionTableSettings {
  /// angles from the normal and relative azimuths [degrees]
  std::vector<double> incident, outgoing, azimuths;
  /// azimuths of incidence [degrees]; a single one: the surface is isotropic
  std::vector<double> incident_azimuths = {0};
  bool transmits = false;  ///< whether directions below the surface are written as well
};
/// Rows of theta_i, phi_i, theta_o, phi_o [degrees] and f [1/sr] by wavelength, as the BSDF `tabulated` reads them.
std::string direction_table_content(const ScatteringProbe& probe, const DirectionTableSettings& settings);

struct ZemaxSettings {
  /// angles of incidence, azimuths about the mirror direction, and angles from it [degrees]
  std::vector<double> incident, azimuths, radial;
  bool transmission = false;
};
/// Isotropic scattering about the mirror direction (or the undeviated one), monochrome: the mean over the wavelengths.
std::string zemax_file_content(const ScatteringProbe& probe, const ZemaxSettings& settings);

}  // namespace aureole
