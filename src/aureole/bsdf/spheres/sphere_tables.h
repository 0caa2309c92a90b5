// SPDX-License-Identifier: Apache-2.0
// Tables of the BSDF `correlated_spheres`: light scattered by a layer of spheres,
//     f(w_i, w_o) = P(v) S'(u) h(|cos i|) h(|cos o|),   v = |w_i + w_o|, u = k a |(w_i + w_o)_xy|,
// with P the phase function of a sphere (Mie, normalised), S' the structure factor of the positions and h a
// factor that gives the diffuse albedo of the layer without breaking reciprocity. Everything is tabulated at
// nodes that are uniform in 1/lambda. Between two nodes f, the albedos and the lobe fractions are means of
// two layers with equal weights. Each layer conserves energy, and so does the mean at all wavelengths; where
// there are more than 129 nodes, h is computed at some of them and interpolated, which is right to 1e-3.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "aureole/bsdf/spheres/sphere_angles.h"
#include "aureole/bsdf/spheres/sphere_samples.h"
#include "aureole/core/table_fields.h"
#include "aureole/math/vec.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/particle/size_distribution.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// A layer of spheres as a scene describes it.
struct SphereLayer {
  double radius_nm = 0;      ///< radius of the spheres; the median radius, if sizes differ
  double area_fraction = 0;  ///< area fraction of the mean cross section
  optics::SizeDistribution sizes;
  double spread = 0;                                         ///< standard deviation of ln(size)
  std::shared_ptr<const optics::StructureFactor> structure;  ///< structure factor at area_fraction
  std::function<double(double nm)> medium;                   ///< index of refraction around the spheres
  /// index of refraction of the spheres over the medium's
  std::function<std::complex<double>(double nm)> relative_index;
};

class SphereTables {
public:
  /// Bounds of the size parameter 2 pi n radius/lambda.
  static constexpr double kMinSize = 0.01, kMaxSize = 5000;

  /// Empty tables, to be read.
  SphereTables() = default;
  SphereTables(const SphereLayer& layer, const SpectralGrid& grid);

  /// The fractions of the light, per wavelength, that pass undeflected, are reflected specularly, and are
  /// scattered or absorbed. They sum to one.
  struct Shares {
    Spectrum transmitted, reflected, lost;
  };
  Shares shares(float cos_i, const Spectrum& nm) const;

  struct Eval {
    Spectrum value;  ///< value f |cos o|
    Spectrum pdf;    ///< pdf of `sample` times the fraction `lost` [1/sr]
  };
  Eval eval(const Vec3& wi, const Vec3& wo, const Spectrum& nm) const;
  /// Samples a direction of diffuse light at one wavelength.
  Vec3 sample(const Vec3& wi, Vec2 u, float nm) const;

  std::size_t bytes() const;
  int wavelength_nodes() const { return wavelengths_; }

  static constexpr TableKind kTable{"layer of spheres", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.angles_, self.sampling_, self.wavelengths_, self.stride_, self.per_stride_, self.balance_stride_,
        self.has_peaks_, self.first_, self.scale_, self.sizes_, self.structure_, self.phase_, self.h_,
        self.transmitted_, self.reflected_, self.lost_);
  }

private:
  struct Worker;
  static constexpr int kCosines = 96;  // number of cells of h and of the fractions, uniform in sqrt(cos)

  void plan(const SphereLayer& layer, const SpectralGrid& grid);
  void scatter(int node, const SphereLayer& layer, Worker& w);
  void place_points(Worker& w) const;
  void sum_row(int node, int i, Worker& w) const;
  void balance(int node, Worker& w);
  void interpolate_balance(int node, Worker& w);
  void prepare_samples(int node, const Worker& w);
  float structure(float u) const {
    const float x = std::min(u * kStructureRate, kStructureEnd);
    const int i = int(x);
    return structure_[i] + (x - float(i)) * (structure_[i + 1] - structure_[i]);
  }
  int cells() const { return angles_.cells(); }
  int sample_node(float position) const { return int(position * per_stride_ + 0.5f); }

  /// The position of each wavelength between the nodes.
  struct Nodes {
    Spectrum position, fraction;
    int at[kWavelengths];
  };
  Nodes nodes(const Spectrum& nm) const;
  /// The position of a direction in the tables over cosines.
  struct Cosine {
    std::size_t row;
    float fraction;
  };
  Cosine cosine(float z) const;
  Spectrum mean(const std::vector<float>& table, const Cosine& c, const Nodes& n) const;
  Spectrum structure(const Spectrum& u) const;

  static constexpr int kStructureRate = 64, kStructureCells = 96 * kStructureRate;
  static constexpr float kStructureEnd = float(kStructureCells) - 0.5f;

  SphereAngles angles_;
  SphereSamples sampling_;
  int wavelengths_ = 0;
  int stride_ = 4;  // wavelength nodes per node of the samples
  float per_stride_ = 0.25f;
  int balance_stride_ = 1;        // wavelength nodes per node at which h is computed
  bool has_peaks_ = false;        // whether the structure factor has peaks
  double first_ = 0, scale_ = 0;  // the node of a wavelength is (1/nm - first) scale
  std::vector<double> samples_;   // cosines mu >= 0, in the order of the nodes of one hemisphere
  std::vector<int> sample_ends_;  // end of the samples for each node of the hemisphere
  std::vector<double> albedos_;   // single-scattering albedo of a sphere at each node, while tables are made
  std::vector<float> sizes_;      // k a of the correlation discs, per wavelength
  std::vector<float> structure_;
  std::vector<float> phase_;                           // phase function by [angle][wavelength]
  std::vector<float> h_;                               // factor h by [cosine][wavelength]
  std::vector<float> transmitted_, reflected_, lost_;  // fractions by [cosine][wavelength]
};

}  // namespace aureole
