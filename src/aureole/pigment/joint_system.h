// SPDX-License-Identifier: Apache-2.0
// The unknowns of a joint fit (joint_fit.h), its equations, and their solution. For joint_fit.cpp alone.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aureole/pigment/joint_fit.h"
#include "aureole/pigment/normal_chain.h"

namespace aureole::pigment {

using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ColumnMatrix = Eigen::MatrixXd;
using JointVector = Eigen::VectorXd;

/// Smallest standard deviation: quantities with a smaller one are constants.
constexpr double kFixed = 1e-6;

/// The unknowns of a JointFit and its equations.
///
/// The unknowns at one wavelength are ln K and ln S of every paint, their deviations in every series (of both together,
/// the strength, and of each), and the logit of the reflectance of cards that were not measured. The border has ln(thickness) of every specimen, the
/// logarithm of every amount in a mixture, the logarithm of every paint's specific volume, and the change of
/// ln(1 - g) of every paint from the theory's.
class JointSystem {
public:
  JointSystem(const SampleTable& table, const FilmTheory& theory, const JointSettings& settings,
              const std::vector<std::size_t>& left_out)
      : table_(table), theory_(theory), settings_(settings), wavelengths_(table.nm.size()) {
    check(table);
    collect(left_out);
    set_scatter();
    set_priors();
  }

  void start_from(const JointSystem& other);
  void start_from_closed_forms();
  void solve();

  /// A sample's place among the unknowns; indices are -1 where there is none.
  struct Row {
    std::size_t sample = 0;
    int specimen = -1, card = -1;  ///< indices of the specimen, and of the card if its reflectance is unknown
    std::vector<double> substrate;  ///< reflectance of a known card, by wavelength
    double scatter = 0;             ///< standard deviation of the sample's repeats of one specimen
    enum class Kind { over, opaque, free_reflectance, free_transmittance } kind = Kind::over;
  };
  struct Part {
    int paint = 0;
    double fraction = 1;
    int dose = -1, variant = -1;
  };
  struct Specimen {
    std::string key, name, series;
    std::vector<Part> parts;
    double ln_thickness = 0;  ///< logarithm of the stated or common thickness, relative to the unit film
    double weight = 1;
    std::vector<std::size_t> rows;
  };
  /// A film's reflectance at one wavelength, and how its K and S depend on those of its parts.
  struct Local {
    FilmValue film;
    std::vector<double> k, s;  ///< derivatives of ln K and ln S of the layer by ln K, ln S of each part
    std::vector<double>
        g;  ///< derivatives of the layer's `g_shift` by each part's `g_shift`; empty without `has_g`
  };

  Local evaluate(const Specimen& specimen, const Row& row, std::size_t l, const ColumnMatrix& chain,
                 const JointVector& border, bool with_thickness = true) const;
  Specimen specimen_of(const Sample& sample) const;
  Row row_of(std::size_t sample, const Sample& of);
  double total_cost(const ColumnMatrix& chain, const JointVector& border) const;
  void assemble(NormalChain& matrix, std::vector<ColumnMatrix>& gradient,
                ColumnMatrix& border_gradient) const;
  void derivatives(const Specimen& specimen, const Local& local, const Row& row, std::size_t l,
                   Eigen::Ref<Eigen::RowVectorXd> chain, Eigen::Ref<Eigen::RowVectorXd> border) const;
  /// Standard deviation of a measurement of this reflectance. `scatter`, the standard deviation of repeats,
  /// is added in squares.
  double sigma(double reflectance, double scatter = 0) const {
    return std::hypot(noise_scale_ * settings_.noise, noise_scale_ * settings_.noise_relative * reflectance,
                      scatter);
  }

  int paints() const { return int(names_.size()); }
  int paint_unknown(int paint, int which) const { return 2 * paint + which; }
  /// `which`: the deviation of K, of S, or (2) of both together.
  int variant_unknown(int variant, int which) const { return 2 * paints() + 3 * variant + which; }
  int card_unknown(int card) const { return variant_unknown(int(variants_.size()), 0) + card; }
  int thickness_unknown(int specimen) const { return specimen; }
  int dose_unknown(int dose) const { return int(specimens_.size()) + dose; }
  int volume_unknown(int paint) const { return int(specimens_.size()) + doses_ + paint; }
  int g_unknown(int paint) const { return volume_unknown(paints()) + paint; }
  /// Whether paints have mean cosines of their own.
  bool has_g() const { return theory_.mean_cosine() && settings_.g > kFixed; }
  /// Returns the mean cosine of scattering in a paint.
  double mean_cosine(int paint) const {
    return 1 - (1 - *theory_.mean_cosine()) * std::exp(border_[g_unknown(paint)]);
  }

  const SampleTable& table_;
  const FilmTheory& theory_;
  JointSettings settings_;
  double noise_scale_ = 1;  ///< factor of the stated noise
  std::size_t wavelengths_;
  std::vector<std::string> names_, cards_;
  /// pairs of series and paint, for paints in several series
  std::vector<std::pair<std::string, int>> variants_;
  std::vector<Specimen> specimens_;
  std::vector<Row> rows_;
  int doses_ = 0;
  double unit_ = 1;  ///< thickness of the unit film [m], or 1 if no thickness is stated
  bool metric_ = false;

  ColumnMatrix chain_;  ///< the unknowns at each wavelength, wavelengths by columns
  JointVector border_;
  JointVector chain_mean_, level_precision_, border_sd_;
  std::vector<JointVector> step_precision_;  ///< precisions for each pair of neighbouring wavelengths
  double cost_ = 0;
  int iterations_ = 0;
  bool converged_ = true;
  std::shared_ptr<NormalChain> matrix_;
  std::shared_ptr<NormalChainFactors> factors_;

private:
  void collect(const std::vector<std::size_t>& left_out);
  void set_scatter();
  void set_priors();
  int index_of(const std::string& paint) const {
    const auto at = std::find(names_.begin(), names_.end(), paint);
    return at == names_.end() ? -1 : int(at - names_.begin());
  }
  int variant_of(const std::string& series, int paint) const {
    const auto at = std::find(variants_.begin(), variants_.end(), std::pair(series, paint));
    return at == variants_.end() ? -1 : int(at - variants_.begin());
  }
};

}  // namespace aureole::pigment
