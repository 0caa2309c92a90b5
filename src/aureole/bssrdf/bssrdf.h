// SPDX-License-Identifier: Apache-2.0
// The BSSRDF family: subsurface scattering as a function of the surface alone. Light enters a boundary at one
// point and exits at another; its path inside is not simulated (Nicodemus et al. 1977, Geometrical
// Considerations and Nomenclature for Reflectance):
//     S(x_i, w_i; x_o, w_o) = T(w_i) P(x_i, |x_o - x_i|) T(w_o)/(c pi).
// T is the directional transmittance of the boundary, c its cosine-weighted mean over the hemisphere, so that
// exiting light is not attenuated twice. P [1/length^2] is the fraction of the entering light that exits per
// unit area. `boundary` samples whether light is reflected or enters, `exit` has the last factor, and
// plug-ins supply P. Paths from the sensor go from x_o to x_i: P depends on the point where the path enters.
#pragma once

#include <memory>

#include "aureole/bsdf/bsdf.h"

namespace aureole {

/// The point where a path enters the body, and its wavelengths.
struct BssrdfContext {
  const Wavelengths& wavelengths;  ///< wavelengths of the path; index 0 is the hero
  const SurfacePoint& point;
};

/// The profile P and the pdf of `sample_distance` per unit area of a plane, both per wavelength [1/length^2].
struct BssrdfEval {
  Spectrum value{0.f}, pdf{0.f};
};

class Bssrdf : public Object {
public:
  static constexpr const char* kFamily = "a BSSRDF";
  /// Reads the boundary's parameters.
  explicit Bssrdf(const Properties& properties);

  /// Returns the BSDF for light from outside: reflection, and the lobe `enter`.
  const BsdfPtr& boundary() const { return boundary_; }
  /// Returns the BSDF for exiting light: T(w_o)/(c pi) times the cosine, for any `wi` outside.
  const Bsdf& exit() const { return *exit_; }

  /// Returns P at a distance, and the pdf of that distance with `sample_distance`.
  virtual BssrdfEval eval_pdf(float distance, const BssrdfContext& ctx) const = 0;
  /// Samples a distance for the hero wavelength from u in [0, 1). Its density is 2 pi distance times the pdf
  /// per area.
  virtual float sample_distance(float u, const BssrdfContext& ctx) const = 0;
  /// Returns a distance beyond which hardly any light exits, at all wavelengths of the path. The distance
  /// bounds the search for exits about the plane at the entry point.
  virtual float reach(const BssrdfContext& ctx) const = 0;

protected:
  /// Index of refraction inside over outside, at each node of the scene's grid.
  const SampledSpectrum& relative_index() const { return relative_index_; }

private:
  SampledSpectrum relative_index_;
  BsdfPtr boundary_, exit_;
};
using BssrdfPtr = std::shared_ptr<const Bssrdf>;

}  // namespace aureole
