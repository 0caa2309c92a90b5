// SPDX-License-Identifier: Apache-2.0
// Sampling of a diffracted wave u = q a for `correlated_scatterers`: the strategies of its parameter
// `sampling`, as densities over the plane of u. A density D is reported times 2 pi, as intensities are: the
// integral of D over |u| < u_max is 2 pi.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "aureole/bsdf/layer/scatterer_model.h"
#include "aureole/math/piecewise.h"

namespace aureole {

class ScattererSampler {
public:
  struct Wave {
    double x, y;
  };
  virtual ~ScattererSampler() = default;
  /// Samples a wave with |u| <= u_max (of the hero). On return `xi` is uniform in [0, 1) again.
  virtual Wave sample(const ScattererModel::State& state, float& xi, Vec2 u2, double u_max) const = 0;
  virtual Spectrum density(const ScattererModel::State& state, const DiffractedWave& u,
                           const Spectrum& u_max) const = 0;
  virtual std::size_t bytes() const = 0;
};

/// Sampling distributions for a varying area fraction: a sample chooses one of the two neighbouring nodes.
class FractionNodes {
public:
  explicit FractionNodes(const ScattererModel& model);
  struct Place {
    int node;
    float next;  ///< weight of node + 1
  };
  Place at(const ScattererModel::State& state) const;
  int count() const { return int(states_.size()); }
  const ScattererModel::State& state(int node) const { return states_[std::size_t(node)]; }

private:
  std::vector<ScattererModel::State> states_;
  float least_, rate_;
};

/// Samples in proportion to the intensity: |u| by its ring means, then the azimuth by U or C, whose weights
/// in a ring are Ū and C̄ S'. Without azimuths it is exact up to the cells of the tables.
class ProductSampler final : public ScattererSampler {
public:
  /// With `correlated` false it samples the density of the shapes alone, S' = 1.
  ProductSampler(std::shared_ptr<const ScattererModel> model, bool correlated = true);
  Wave sample(const ScattererModel::State&, float& xi, Vec2, double u_max) const override;
  Spectrum density(const ScattererModel::State&, const DiffractedWave&, const Spectrum& u_max) const override;
  std::size_t bytes() const override;
  /// Returns the distribution of |u| at the only area fraction of a uniform layer.
  const optics::RadialDistribution& radial() const { return radial_.front(); }

private:
  float structure(int node, float u) const {
    return correlated_ ? model_->structure(nodes_.state(node), u) : 1;
  }
  Spectrum azimuth(int node, const DiffractedWave& u) const;

  std::shared_ptr<const ScattererModel> model_;
  bool correlated_;
  FractionNodes nodes_;
  std::vector<optics::RadialDistribution> radial_;  // distributions of |u|, one for each node
};

/// Samples by the shapes or by the structure factor, with equal probability (Yang, Kim, Pediredla & Jarosz,
/// "A wave-optics BSDF for correlated scatterers", 2025, section 7.2).
class FactorSampler final : public ScattererSampler {
public:
  explicit FactorSampler(std::shared_ptr<const ScattererModel> model);
  Wave sample(const ScattererModel::State&, float& xi, Vec2, double u_max) const override;
  Spectrum density(const ScattererModel::State&, const DiffractedWave&, const Spectrum& u_max) const override;
  std::size_t bytes() const override;

private:
  /// u S'(u) at a node, piecewise linear up to kEnd; S' = 1 beyond.
  struct Structure {
    std::vector<float> nodes;
    std::vector<double> power;
    double power_to(double u) const;
    double sample(double xi, double u_max) const;
    float eval(float u) const;
  };
  static constexpr int kRate = 64, kEnd = 64, kCells = kRate * kEnd;

  ProductSampler shapes_;
  FractionNodes nodes_;
  std::vector<Structure> structures_;
};

/// Samples by a table of the intensity over the square of waves that the shortest wavelength may have, for
/// one area fraction and radius. This is the simplest strategy, but its table must be computed for every set
/// of parameters.
class TableSampler final : public ScattererSampler {
public:
  TableSampler(std::shared_ptr<const ScattererModel> model, double extent);
  Wave sample(const ScattererModel::State&, float& xi, Vec2, double u_max) const override;
  Spectrum density(const ScattererModel::State&, const DiffractedWave&, const Spectrum& u_max) const override;
  std::size_t bytes() const override { return std::size_t(kSize) * kSize * 4; }

private:
  static constexpr int kSize = 1024;
  float extent_;
  Piecewise2D table_;
};

}  // namespace aureole
