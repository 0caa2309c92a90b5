// SPDX-License-Identifier: Apache-2.0
// The diffraction of a layer of scatterers, independent of its surface: the intensity as a function of u = q
// a (a the correlation radius), from the tables of its shapes and of its correlation. Part of the BSDF
// `correlated_scatterers`.
//
// All intensities are g(u) = (U + C S'(u))/integral, normalised so that the integral of g over the plane of u
// is 2 pi. The density over u of diffracted light, whose fraction is `diffracted`, is g/(2 pi).
//
// Where scatterers may overlap, U depends on the area fraction and C = 0 (optics/layer/overlapping_scatterers.h):
// there are tables at nodes of the fraction, and g is linear between them.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "aureole/core/table_fields.h"
#include "aureole/correlation/correlation.h"
#include "aureole/optics/layer/scatterer_table.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

/// (ux, uy) and their length, at the wavelengths of a path.
struct DiffractedWave {
  Spectrum x, y, length;
};

class ScattererModel {
public:
  /// The area fraction at a point, and the interpolation weights of the tables' nodes there.
  struct State {
    float area_fraction;
    float inverse_total;           ///< normalisation 1/integral of (U + C S') u du
    int first = 0, count = 1;      ///< nodes of the structure factor or, where scatterers overlap, tables
    std::array<float, 4> weights;  ///< weights of these nodes
  };

  /// A model without tables, to be read.
  ScattererModel() = default;
  /// `least`, `most`: range of the area fraction. `extent`: the largest |u|. Throws std::domain_error for
  /// errors of the correlation.
  ScattererModel(const optics::ScattererMixture& mixture, const Correlation& correlation, double least,
                 double most, double extent);

  State at(float area_fraction) const;
  /// Returns Fr, the fraction of the plane that the shapes cover.
  float covered(float area_fraction) const;

  /// Returns the fraction of light that is diffracted, the variance of the transmittance: Fr fill - Fr^2 or,
  /// where scatterers overlap, exp(-2 Fr) (exp(Fr fill) - 1). `fill` is the integral of A^2 over that of A: 1
  /// except for grey masks.
  float diffracted(float area_fraction) const;

  /// Returns g at the wavelengths of a path.
  Spectrum intensity(const State& state, const DiffractedWave& u) const;

  /// Returns S'(|u|) of an isotropic arrangement.
  float structure(const State& state, float u) const {
    if (may_overlap_) return 1;
    float sum = 0;
    for (int i = 0; i < state.count; ++i) sum += state.weights[i] * structures_[state.first + i].eval(u);
    // The table stores 1/S' - 1, or S' - 1.
    return inverse_ ? 1 / (1 + sum) : std::max(1 + sum, 0.f);
  }
  Spectrum structure(const State& state, const Spectrum& u) const {
    if (may_overlap_) return 1.f;
    Spectrum sum(0.f);
    for (int i = 0; i < state.count; ++i) {
      const optics::RadialFunction& f = structures_[std::size_t(state.first + i)];
      sum += make_spectrum([&](int j) { return f.eval(u[j]); }) * state.weights[std::size_t(i)];
    }
    return inverse_ ? Spectrum(1.f) / (Spectrum(1.f) + sum) : max(Spectrum(1.f) + sum, 0.f);
  }
  /// Whether all scatterers are equal, so that there is no uncorrelated term U.
  bool is_single() const { return single_; }
  /// Whether positions lack circular symmetry; their S' is then part of `table()`, for a single area
  /// fraction.
  bool is_anisotropic() const { return anisotropic_ != nullptr; }
  bool varies() const { return most_ > least_; }
  double least() const { return least_; }
  double most() const { return most_; }
  /// Returns the table of all states or, where scatterers overlap, the table of a node of the area fraction.
  /// Nodes are equally spaced from `least` to `most`.
  const optics::ScattererTable& table(int node = 0) const {
    return tables_.size() > 1 ? *tables_[std::size_t(node)] : *tables_.front();
  }
  /// Returns the number of nodes between which intensities are linear in the area fraction; 1 if only S'
  /// varies with it, or nothing.
  int tables() const { return int(tables_.size()); }
  /// Whether the density over the azimuth is 1 everywhere.
  bool is_isotropic() const { return !table().has_azimuths(); }
  std::size_t bytes() const;

  static constexpr TableKind kTable{"layer of scatterers", 1};
  /// Structure factors without circular symmetry are evaluated, not tabulated.
  bool is_keepable() const { return !is_anisotropic(); }
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.covered_per_fraction_, self.fill_, self.has_isotropic_shapes_, self.tables_, self.least_,
        self.most_, self.inverse_, self.may_overlap_, self.single_, self.degree_, self.ratios_,
        self.structures_, self.inverse_totals_);
  }

private:
  void tabulate_overlapping(const optics::ScattererMixture& mixture, double extent);
  /// Returns U and C of one table.
  Spectrum parts(const optics::ScattererTable& table, const DiffractedWave& u, Spectrum& coherent) const;

  double covered_per_fraction_ = 0,
         fill_ = 0;  ///< of the mixture: Fr/Fa, and the integral of A^2 over that of A
  bool has_isotropic_shapes_ = true;
  std::vector<std::shared_ptr<const optics::ScattererTable>> tables_;
  std::shared_ptr<const optics::StructureFactor> anisotropic_;
  double least_ = 0, most_ = 0;
  bool inverse_ = false, may_overlap_ = false, single_ = false;
  int degree_ = 1;
  std::vector<float> ratios_;  ///< ratio Fa/(1 - Fa) at the nodes
  std::vector<optics::RadialFunction> structures_;
  /// Values of `State::inverse_total` at equal steps of the area fraction; where scatterers overlap, one for
  /// each table.
  std::vector<float> inverse_totals_;
};

}  // namespace aureole
