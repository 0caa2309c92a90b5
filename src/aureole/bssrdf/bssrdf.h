// SPDX-License-Identifier: Apache-2.0
// The BSSRDF family: translucent bodies by their surface alone. Light that a boundary lets in at one point
// leaves at others; only where it leaves is modelled, not its way (Nicodemus et al. 1977, Geometrical
// Considerations and Nomenclature for Reflectance):
//     S(x_i, w_i; x_o, w_o) = T(w_i) P(x_i, |x_o - x_i|) T(w_o)/(c pi),
// where T is the part of light that the boundary transmits in a direction, c its mean over a uniform sky (so that
// what leaves is not reduced once more), and P [1/length^2] the part of the light that has entered which leaves
// per area. `boundary` draws whether light is reflected or enters, `exit` has the last factor, and the plug-ins
// have P. Paths from the sensor go from x_o to x_i: P depends on the point where the path enters.
#pragma once

#include <memory>

#include "aureole/bsdf/bsdf.h"

namespace aureole {

/// The entry of a path.
struct BssrdfContext {
  const Wavelengths& wavelengths;  ///< index 0 is the hero
  const SurfacePoint& point;
};

/// P and the density of `sample_distance` per area of a plane, both per wavelength [1/length^2].
struct BssrdfEval {
  Spectrum value{0.f}, pdf{0.f};
};

class Bssrdf : public Object {
public:
  static constexpr const char* kFamily = "a BSSRDF";
  /// Reads the boundary.
  explicit Bssrdf(const Properties& properties);

  /// The BSDF of the surface as light meets it from outside: what it reflects, and the lobe `enter`.
  const BsdfPtr& boundary() const { return boundary_; }
  /// That of the surface as light leaves it. Its value is T(w_o)/(c pi) times the cosine for any `wi` outside.
  const Bsdf& exit() const { return *exit_; }

  /// P at a distance, and the density with which `sample_distance` finds it.
  virtual BssrdfEval eval_pdf(float distance, const BssrdfContext& ctx) const = 0;
  /// A distance drawn for the hero by u in [0, 1): its density is 2 pi distance times that per area.
  virtual float sample_distance(float u, const BssrdfContext& ctx) const = 0;
  /// A distance beyond which hardly any light leaves, at all wavelengths of the path: it bounds how far from the
  /// plane of the entry exits are looked for.
  virtual float reach(const BssrdfContext& ctx) const = 0;

protected:
  /// Index inside over that outside, at each node of the scene's grid.
  const SampledSpectrum& relative_index() const { return relative_index_; }

private:
  SampledSpectrum relative_index_;
  BsdfPtr boundary_, exit_;
};
using BssrdfPtr = std::shared_ptr<const Bssrdf>;

}  // namespace aureole
