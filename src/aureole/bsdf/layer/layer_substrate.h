// SPDX-License-Identifier: Apache-2.0
// The plane on which the scatterers of `correlated_scatterers` lie. Its functions are inline, since
// `reflectance` is part of every evaluation.
#pragma once

#include <cmath>
#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/spectrum/fresnel.h"

namespace aureole {

class LayerSubstrate {
public:
  enum class Kind {
    none,       ///< no interface: a sheet in one medium, without reflection
    interface,  ///< the interface of two media
    pane,       ///< both faces of a pane as one surface, with one medium on both sides
  };

  /// Reads "substrate", "ext_ior" and "int_ior". Throws located Errors.
  static LayerSubstrate from(const Properties& p);

  Kind kind() const { return kind_; }
  bool is_none() const { return kind_ == Kind::none; }
  /// Whether indices depend on the wavelength.
  bool is_dispersive() const { return dispersive_; }
  const Ior& exterior() const { return exterior_; }
  const Ior& interior() const { return interior_; }

  /// The indices of refraction for light from one side.
  struct Indices {
    Spectrum here, beyond;
    /// index behind the first interface; for a pane the index of its glass, while `beyond` is the exterior
    /// again
    Spectrum inside;
  };
  /// Returns the indices for the side where a direction has the sign of `z`.
  Indices indices(float z, const Wavelengths& w) const {
    const Spectrum n_ext = index(exterior_, w), n_int = index(interior_, w);
    if (kind_ != Kind::interface) return {n_ext, n_ext, n_int};
    return z > 0 ? Indices{n_ext, n_int, n_int} : Indices{n_int, n_ext, n_ext};
  }

  /// Returns the reflectance for a direction on its own side; 1 beyond the critical angle. Not for `none`.
  Spectrum reflectance(float cosine, const Indices& n) const {
    Spectrum r;
    if (dispersive_)
      r = fresnel_dielectric(cosine, n.inside / n.here);
    else
      r = fresnel_dielectric(cosine, n.inside[0] / n.here[0]).reflectance;
    return kind_ == Kind::pane ? thin_slab(r) : r;
  }

  /// Samples reflection or transmission of undiffracted light at the plane, chosen by the reflectance, which
  /// is the hero's at an interface and the mean over the wavelengths at a pane. `weight` scales the values,
  /// `mass` the probabilities.
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, float weight, float mass,
                                   const BsdfContext& ctx) const;
  /// Whether transmitted undiffracted light is not deflected.
  bool is_passable() const { return kind_ != Kind::interface; }
  /// Fraction of the light from wi that is transmitted without deflection; 0 at an interface, which refracts
  /// it.
  Spectrum straight(const Vec3& wi, const BsdfContext& ctx) const;

private:
  Spectrum index(const Ior& ior, const Wavelengths& w) const {
    return dispersive_ ? ior.eval(w) : Spectrum(ior.at_sodium_d());
  }

  Kind kind_ = Kind::none;
  Ior exterior_, interior_;
  bool dispersive_ = false;
};

}  // namespace aureole
