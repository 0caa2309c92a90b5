// SPDX-License-Identifier: Apache-2.0
// Evaluation of a BSDF for the writers of measured formats: f for pairs of directions and a list of
// wavelengths, and how far it is reciprocal and conserves energy.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/core/error.h"

namespace aureole {

/// Evaluates a BSDF at one point of its surface. Delta lobes are left out.
class ScatteringProbe {
public:
  /// `nm` is not empty. `make_reciprocal`: values are the means of both directions of the light.
  ScatteringProbe(std::shared_ptr<const Bsdf> bsdf, const SpectralGrid& grid, std::vector<double> nm,
                  bool make_reciprocal);

  const std::vector<double>& nm() const { return nm_; }
  std::size_t channels() const { return nm_.size(); }
  const Bsdf& bsdf() const { return *bsdf_; }
  const SpectralGrid& grid() const { return grid_; }
  bool makes_reciprocal() const { return make_reciprocal_; }

  /// Sets out[c] to f [1/sr], without the cosine, at wavelength c in radiance mode. A table of these values,
  /// with wi as its direction of incidence, gives the pictures that the BSDF gives. Directions may lie on any
  /// side.
  void f(const Vec3& wi, const Vec3& wo, std::vector<double>& out) const;
  /// The mean of f over the wavelengths.
  double mean(const Vec3& wi, const Vec3& wo) const;
  /// Lets a long work end: `f` and the writers throw Error once `stop` is set.
  void stop_by(const std::atomic<bool>* stop) { stop_ = stop; }
  void check_stop() const {
    if (stop_ && *stop_) throw Error("interrupted: nothing is written");
  }

private:
  std::shared_ptr<const Bsdf> bsdf_;
  SpectralGrid grid_;
  std::vector<double> nm_;
  /// sets of kWavelengths wavelengths each; the last one repeats its last wavelength
  std::vector<Wavelengths> sets_;
  SurfacePoint point_;
  bool make_reciprocal_;
  const std::atomic<bool>* stop_ = nullptr;
};

/// Faults of a BSDF as a table: they are reported, never repaired unless the user asks for it.
struct ScatteringReport {
  /// Scattered fraction of light, the largest over the wavelengths, for an angle of incidence [degrees] from +z.
  struct Energy {
    double angle, reflected, transmitted;
  };
  std::vector<Energy> energies;
  /// |f(i, o) - f(o, i)| / (f(i, o) + f(o, i)) over pairs of directions: the mean weighted by f and the cosines, and the
  /// largest among pairs with at least 1 % of the largest f.
  double mean_asymmetry = 0, largest_asymmetry = 0;
  /// f does not change by more than 0.1 % when both directions turn about the normal
  bool is_isotropic = true;
  bool has_values = false;  ///< beside delta lobes, which have no part in the asymmetry
  bool has_delta = false, transmits = false, reflects_below = false;
  bool refracts = false;  ///< there are different indices of refraction on the two sides

  double largest_energy() const;
};
ScatteringReport examine(const ScatteringProbe& probe);

/// Returns a few sentences about the report.
std::string report_text(const ScatteringReport& report);

}  // namespace aureole
