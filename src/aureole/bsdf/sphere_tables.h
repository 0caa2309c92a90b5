// SPDX-License-Identifier: Apache-2.0
// Tables of the BSDF `correlated_spheres`: light scattered by a layer of spheres,
//     f(w_i, w_o) = P(v) S'(u) h(|cos i|) h(|cos o|),   v = |w_i + w_o|, u = k a |(w_i + w_o)_xy|,
// P the phase function of a sphere (Mie, normalised), S' the structure factor of the positions and h what
// makes the diffuse albedo that of the layer without breaking reciprocity. Everything is tabulated at nodes
// that are uniform in 1/lambda. Between two of them f, the albedos and the shares of the lobes are the same
// mean of two layers, each of which conserves energy, and so do all wavelengths.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "aureole/math/vec.h"
#include "aureole/optics/size_distribution.h"
#include "aureole/optics/structure_factor.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// A layer of spheres as a scene describes it.
struct SphereLayer {
  double radius_nm = 0;      ///< the median, where sizes differ
  double area_fraction = 0;  ///< of the mean cross section
  optics::SizeDistribution sizes;
  double spread = 0;                                              ///< standard deviation of ln(size)
  std::shared_ptr<const optics::StructureFactor> structure;       ///< at area_fraction
  std::function<double(double nm)> medium;                        ///< index around the spheres
  std::function<std::complex<double>(double nm)> relative_index;  ///< of the spheres over the medium's
};

class SphereTables {
public:
  /// Of 2 pi n radius/lambda.
  static constexpr double kLeastSize = 0.01, kMostSize = 5000;

  SphereTables(const SphereLayer& layer, const SpectralGrid& grid);

  /// Per wavelength, what goes straight on, is reflected as by a mirror, and leaves them. They sum to one.
  struct Shares {
    Spectrum transmitted, reflected, lost;
  };
  Shares shares(float cos_i, const Spectrum& nm) const;

  struct Eval {
    Spectrum value;  ///< f |cos o|
    Spectrum pdf;    ///< density of `sample` times the share `lost` [1/sr]
  };
  Eval eval(const Vec3& wi, const Vec3& wo, const Spectrum& nm) const;
  /// Direction of diffuse light at one wavelength.
  Vec3 sample(const Vec3& wi, Vec2 u, float nm) const;

  std::size_t bytes() const;
  int wavelength_nodes() const { return wavelengths_; }

private:
  struct Worker;
  /// Angles: nodes are uniform in r = |w_i - w_o| (backward, which comes first: small shares of a sum keep
  /// their digits at its begin) or |w_i + w_o| (forward), in each half of the sphere finer in its centre;
  /// r dr dphi is the solid angle.
  struct AngleGrid {
    float fine = 0, coarse = 0, offset = 0, split = 0;
    int half = 0;  ///< cells per half
    double radius(double position) const;
    float position(float r) const { return std::min(fine * r, coarse * r + offset); }
  };

  static constexpr int kCosines = 96;  // cells of h and of the shares, uniform in sqrt(cos)
  static constexpr int kTilts = 16;    // angles of incidence that samples are prepared for
  static constexpr int kStride = 4;    // nodes of wavelength per node of the samples

  void plan(const SphereLayer& layer, const SpectralGrid& grid);
  void scatter(int node, const SphereLayer& layer, Worker& w);
  void balance(int node, Worker& w);
  void prepare_samples(int node, const Worker& w);
  float structure(float u) const {
    const float x = std::min(u * kStructureRate, kStructureEnd);
    const int i = int(x);
    return structure_[i] + (x - float(i)) * (structure_[i + 1] - structure_[i]);
  }
  int cells() const { return 2 * angles_.half; }
  /// The cell's place in its half, from the centre.
  int ring(int cell) const { return cell < angles_.half ? cell : cells() - 1 - cell; }
  static int tilt(float cos_i) { return int(std::min(cos_i, 1.f) * (kTilts - 1) + 0.5f); }
  static double tilt_cosine(int tilt) { return tilt == 0 ? 0.02 : double(tilt) / (kTilts - 1); }
  int sample_nodes() const { return (wavelengths_ - 1) / kStride + 1; }
  static int sample_node(float position) { return int(position * (1.f / kStride) + 0.5f); }

  /// Where each wavelength is between the nodes.
  struct Nodes {
    Spectrum position, fraction;
    int at[kWavelengths];
  };
  Nodes nodes(const Spectrum& nm) const;
  /// Where a direction is in the tables over cosines.
  struct Cosine {
    std::size_t row;
    float fraction;
  };
  Cosine cosine(float z) const;
  Spectrum mean(const std::vector<float>& table, const Cosine& c, const Nodes& n) const;
  Spectrum structure(const Spectrum& u) const;

  static constexpr int kStructureRate = 64, kStructureCells = 96 * kStructureRate;
  static constexpr float kStructureEnd = float(kStructureCells) - 0.5f;

  AngleGrid angles_;
  int wavelengths_ = 0;
  double first_ = 0, scale_ = 0;  // node = (1/nm - first) scale
  std::vector<double> samples_;   // of mu >= 0, in order of the nodes of half a sphere
  std::vector<int> sample_ends_;  // per node of the half
  std::vector<double> areas_;     // solid angle of each cell
  std::vector<float> sizes_;      // k a of the correlation discs, per wavelength
  std::vector<float> structure_;
  std::vector<float> phase_;                           // [angle][wavelength]
  std::vector<float> h_;                               // [cosine][wavelength]
  std::vector<float> transmitted_, reflected_, lost_;  // the same
  std::vector<float> density_;                         // [tilt][angle cell][sample node]: 1/sr
  std::vector<float> cdf_;                             // [tilt][sample node][angle]
};

}  // namespace aureole
