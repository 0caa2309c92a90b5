// SPDX-License-Identifier: Apache-2.0
// Writes a BSDF as a `.bsdf` file of RGL's format, with an estimate of the distribution of its microfacet normals.
#pragma once

#include <string>

#include "aureole/bsdf/measured/rgl_file.h"
#include "aureole/instrument/measured/scattering_probe.h"

namespace aureole {

struct RglWriterSettings {
  int angles = 16;      ///< number of angles of incidence
  int azimuths = 1;     ///< number of azimuths of incidence over the circle; 1: the surface is isotropic
  int normals = 128;    ///< nodes of the distributions of normals over the polar angle
  int resolution = 32;  ///< rows and columns of spectra for each direction of incidence
  std::string description;
};

/// Reflection from +z to +z. The distribution of normals D follows from retro-reflection: D(m) is proportional to
/// f(m, m) cos(m) sigma(m), where sigma(w) is the integral of D(m) max(w.m, 0), which is solved by power iteration (J.
/// Dupuy, E. Heitz, J.-C. Iehl, P. Poulin and V. Ostromoukhov, "Extracting microfacet-based BRDF parameters from arbitrary
/// materials with power iterations", CGF 34(4), 2015). Throws Error without a location if nothing is reflected.
RglFile make_rgl_file(const ScatteringProbe& probe, const RglWriterSettings& settings);

}  // namespace aureole
