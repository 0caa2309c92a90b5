// SPDX-License-Identifier: Apache-2.0
// The scattering of a stack of layers as a table over wavelength, both cosines and the azimuth between them.
// Sampling follows exactly the interpolated table.
//
// K = f/n_o^2 is linear in each cosine, in the azimuth and in the wavelength between nodes. So are, with
// these nodes, the fractions of light that is scattered, specularly reflected and specularly transmitted. The
// flux of a function linear between nodes, K cos theta domega, is a sum over nodes in closed form. The
// integral of f cos theta therefore equals the scattered fraction, up to rounding, for every direction of
// incidence, not only for the nodes. Light is nearly linear in the cosine close to the horizon. K is
// symmetric, so the reverse direction needs no table.
//
// The reflectance of a Lambertian substrate may vary over the surface. It reflects equally into all
// directions, so it adds a product to K: the fraction t that reaches it from one direction times the fraction
// from the other,
//     K = K_black + t_i t_o rho/(1 - rho r)/(pi n^2),
// where r is the fraction of diffuse light that the layers return to it and n the index of the last layer.
#pragma once

#include <span>
#include <vector>

#include "aureole/core/table_fields.h"
#include "aureole/math/vec.h"
#include "aureole/optics/stack/stack_kernels.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class StackTable {
public:
  static constexpr double kLargestMegabytes = 512;
  /// Memory while a table is built from so many kernels with so many values each: kernels in double
  /// precision, the table in single.
  static double megabytes(double values, std::size_t kernels) {
    return 1e-6 * values *
           (double(kernels) * sizeof(double) + double(std::max<std::size_t>(kernels, 2)) * sizeof(float));
  }
  /// An empty table, to be read.
  StackTable() = default;
  /// `kernels`: at equidistant wavelengths over the grid's range, or one for all. `azimuths`: azimuths of the
  /// kernels, from 0 to pi. A stack without a substrate also has directions below. Each kernel is corrected
  /// so that it conserves energy: first where it is largest, since the error of sums over nodes is largest at
  /// peaks, then by factors of both directions (Sinkhorn & Knopp 1967). Where the energy is not linear
  /// between two cosines there is an additional node, unless the table would become too large.
  /// `inner_indices`: index of the last layer for each kernel, for a Lambertian substrate.
  StackTable(std::vector<optics::StackKernels> kernels, std::span<const double> azimuths,
             const SpectralGrid& grid, float index_above, float index_below,
             std::span<const double> inner_indices = {});

  /// Fractions of the light from a direction.
  struct Shares {
    Spectrum scattered, mirrored, passed;
    Spectrum total() const { return scattered + mirrored + passed; }
  };
  /// Returns the fractions for light from wi. `below` is the reflectance of a Lambertian substrate; null if
  /// the substrate is part of the table.
  Shares shares(const Vec3& wi, const Wavelengths& w, const Spectrum* below = nullptr) const;
  struct Value {
    Spectrum k;
    Spectrum total{0.f};  ///< `Shares::total` of wi, if requested
  };
  /// Returns K for directions off the horizon; 0 if nothing is transmitted.
  template <bool kWithTotal>
  Value eval(const Vec3& wi, const Vec3& wo, const Wavelengths& w, const Spectrum* below = nullptr) const;
  /// Samples a direction in proportion to K n_o^2 cos theta_o at the wavelength of index 0. `choice` and u
  /// are uniform in [0, 1).
  Vec3 sample(const Vec3& wi, float choice, Vec2 u, const Wavelengths& w,
              const Spectrum* below = nullptr) const;

  bool is_open() const { return !sides_[1].cosines.empty(); }
  float index(bool below) const { return index_[below]; }
  std::size_t bytes() const;
  /// Returns the largest relative error of the energy of sums over the table's nodes before the correction,
  /// for directions less than 80 degrees from the normal.
  double correction() const { return correction_; }

  static constexpr TableKind kTable{"stack of layers", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.index_, self.wavelengths_, self.azimuths_, self.first_nm_, self.per_nm_, self.sides_, self.phi_,
        self.phi_cells_, self.reflected_, self.transmitted_, self.correction_, self.lost_, self.reached_sum_,
        self.per_inner_);
  }

private:
  struct Side {
    std::vector<float> cosines;                             ///< cosines of the nodes, from 0 to 1
    std::vector<int> cells;                                 ///< cell of evenly spaced cosines, for the search
    std::vector<float> scattered, mirrored, passed, total;  ///< fractions by [cosine][wavelength]
    /// For directions of incidence on this side: sums over azimuth of K n_o^2 by node above, then below, and
    /// the cumulative probability of the cells, [wavelength][cosine][node].
    std::vector<float> ring, cdf;
    std::vector<float> reached;  ///< fraction that reaches the substrate, [cosine][wavelength]

    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.cosines, self.cells, self.scattered, self.mirrored, self.passed, self.total, self.ring,
          self.cdf, self.reached);
    }
  };
  struct Place {
    int cell;
    float fraction;
  };
  struct Nodes {
    int at[kWavelengths];
    Spectrum fraction;
  };
  Nodes nodes(const Wavelengths& w) const;
  static Place find(const Side& side, float cosine);
  Place find_azimuth(const Vec3& wi, const Vec3& wo) const;
  void balance(std::span<const optics::StackKernels> kernels);
  void prepare_samples();
  void prepare_substrate(std::span<const optics::StackKernels> kernels,
                         std::span<const double> inner_indices);
  /// Terms of light that leaves a Lambertian substrate upward.
  struct Upward {
    Spectrum scale;  ///< factor of t_i t_o in the term of K
    Spectrum all;    ///< factor of t_i in the term of the scattered fraction
  };
  Upward upward(const Nodes& n, const Spectrum& below) const;
  /// Interpolates a table at this direction and these wavelengths.
  Spectrum at(const std::vector<float>& table, const Place& place, const Nodes& n) const;
  Vec3 sample_upward(Vec2 u, const Nodes& n) const;

  /// Returns the row of K for these nodes: by azimuth, then wavelength.
  const float* row(bool in_below, bool out_below, int i, int o) const {
    const std::size_t above = sides_[0].cosines.size(), below = sides_[1].cosines.size();
    const std::size_t stride = std::size_t(azimuths_) * std::size_t(wavelengths_);
    if (in_below != out_below)
      return &transmitted_[((in_below ? std::size_t(o) : std::size_t(i)) * below +
                            (in_below ? std::size_t(i) : std::size_t(o))) *
                           stride];
    return in_below ? &reflected_[1][(std::size_t(i) * below + std::size_t(o)) * stride]
                    : &reflected_[0][(std::size_t(i) * above + std::size_t(o)) * stride];
  }

  float index_[2] = {};
  int wavelengths_ = 0, azimuths_ = 0;
  float first_nm_ = 0, per_nm_ = 0;
  Side sides_[2];
  std::vector<float> phi_;
  std::vector<int> phi_cells_;                     ///< cell of azimuths pi (i/n)^2, for the search
  std::vector<float> reflected_[2], transmitted_;  ///< values of K by [cosine][cosine][azimuth][wavelength]
  double correction_ = 0;
  /// For a substrate, by wavelength: the fraction of its light that does not return, the sum of t over flux,
  /// and 1/(pi n^2) of the last layer.
  std::vector<float> lost_, reached_sum_, per_inner_;
};

}  // namespace aureole
