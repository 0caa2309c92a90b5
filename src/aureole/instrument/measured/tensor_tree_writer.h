// SPDX-License-Identifier: Apache-2.0
// Writes a BSDF as Radiance's tensor tree in XML: cells are small where the scattering changes.
#pragma once

#include <string>

#include "aureole/instrument/measured/scattering_probe.h"

namespace aureole {

struct TensorTreeSettings {
  bool is_isotropic = true;  ///< rank 3, else rank 4
  int levels = 6;            ///< the smallest cells are 2^-levels of each axis
  /// Sibling cells are merged where their values differ by less than this part of their mean, or of the least mean that matters
  double tolerance = 0.05;
  int samples = 4096;  ///< of the BSDF for each incident cell and side
  /// Whether the BSDF is known to be reciprocal: both estimates of a pair of cells of rank 4 are averaged, and cells are merged alike.
  bool is_reciprocal = false;
  std::string name, manufacturer;
};
/// Trees of reflection and transmission, front and back (G. Ward, M. Kurt and N. Bonneel, LBNL report 5954E, 2012): the visible range
/// under CIE D65 for the observer of CIE 1931. +z is the file's back, as in Radiance. Throws Error for trees of more than
/// 2^24 cells.
std::string tensor_tree_file_content(const ScatteringProbe& probe, const TensorTreeSettings& settings);

}  // namespace aureole
