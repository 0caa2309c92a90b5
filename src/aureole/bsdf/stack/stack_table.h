// SPDX-License-Identifier: Apache-2.0
// The scattering of a stack of layers as a table over wavelength, both cosines and the azimuth between them,
// and samples drawn from exactly what is read from it.
//
// K = f/n_o^2 is linear in each cosine, in the azimuth and in the wavelength between nodes, and so are, with the
// same nodes, the shares of light that is scattered, mirrored and passed on. The flux of what is linear between
// nodes, K cos theta domega, is a sum over nodes in closed form: the integral of f cos theta is the share that is
// scattered, to rounding errors, for every direction of incidence, not only for the nodes. Light is nearly linear
// in the cosine close to the horizon. K is symmetric, so light that goes backward needs no table of its own.
//
// A Lambertian substrate may reflect differently from place to place. What comes down on it is the same from all
// directions, so it adds to K a product: of the share t that reaches it from one direction and that of the other,
//     K = K_black + t_i t_o rho/(1 - rho r)/(pi n^2),
// r the share of diffuse light that the layers return to it and n the index of the last of them.
#pragma once

#include <span>
#include <vector>

#include "aureole/math/vec.h"
#include "aureole/optics/stack/stack_kernels.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class StackTable {
public:
  static constexpr double kLargestMegabytes = 512;
  /// While a table of so many kernels with so many values each is made: kernels in double precision, the table in single.
  static double megabytes(double values, std::size_t kernels) {
    return 1e-6 * values *
           (double(kernels) * sizeof(double) + double(std::max<std::size_t>(kernels, 2)) * sizeof(float));
  }
  /// `kernels`: of wavelengths evenly over the grid's range, or one for all. `azimuths`: theirs, from 0 to pi.
  /// Directions below are those of a stack without a substrate. Each kernel is changed so that no energy is lost
  /// or gained: first where it is largest, since sums over nodes miss most at peaks, then by factors of both
  /// directions (Sinkhorn & Knopp 1967). Where the energy is not linear between two cosines there is a node
  /// more, unless the table became too large by them. `inner_indices`: of the last layer by kernel, for a Lambertian substrate.
  StackTable(std::vector<optics::StackKernels> kernels, std::span<const double> azimuths,
             const SpectralGrid& grid, float index_above, float index_below,
             std::span<const double> inner_indices = {});

  /// Of light from a direction.
  struct Shares {
    Spectrum scattered, mirrored, passed;
    Spectrum total() const { return scattered + mirrored + passed; }
  };
  /// `below`: the reflectance of a Lambertian substrate; null where it is part of the table.
  Shares shares(const Vec3& wi, const Wavelengths& w, const Spectrum* below = nullptr) const;
  struct Value {
    Spectrum k;
    Spectrum total{0.f};  ///< `Shares::total` of wi, if asked for
  };
  /// K for directions off the horizon; 0 where nothing passes.
  template <bool kWithTotal>
  Value eval(const Vec3& wi, const Vec3& wo, const Wavelengths& w, const Spectrum* below = nullptr) const;
  /// A direction in proportion to K n_o^2 cos theta_o at the wavelength nm of index 0. `choice` and u are
  /// uniform in [0, 1).
  Vec3 sample(const Vec3& wi, float choice, Vec2 u, const Wavelengths& w,
              const Spectrum* below = nullptr) const;

  bool is_open() const { return !sides_[1].cosines.empty(); }
  float index(bool below) const { return index_[below]; }
  std::size_t bytes() const;
  /// How far sums over the table's nodes were from the energy before it was made exact: the largest share of
  /// it, for directions less than 80 degrees from the normal.
  double correction() const { return correction_; }

private:
  struct Side {
    std::vector<float> cosines;                             ///< from 0 to 1
    std::vector<int> cells;                                 ///< in which evenly spaced cosines lie
    std::vector<float> scattered, mirrored, passed, total;  ///< [cosine][wavelength]
    /// For directions of incidence on this side: sums over azimuth of K n_o^2 by node above, then below, and
    /// the probability of the cells up to each, [wavelength][cosine][node].
    std::vector<float> ring, cdf;
    std::vector<float> reached;  ///< [cosine][wavelength], of a substrate
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
  /// Of light that leaves a Lambertian substrate upward.
  struct Upward {
    Spectrum scale;  ///< t_i times this and t_o is what it adds to K
    Spectrum all;    ///< and this what it adds to the share that is scattered
  };
  Upward upward(const Nodes& n, const Spectrum& below) const;
  /// Its means for this direction and its wavelengths.
  Spectrum at(const std::vector<float>& table, const Place& place, const Nodes& n) const;
  Vec3 sample_upward(Vec2 u, const Nodes& n) const;

  /// The row of K for these nodes: by azimuth, then wavelength.
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

  float index_[2];
  int wavelengths_, azimuths_;
  float first_nm_, per_nm_;
  Side sides_[2];
  std::vector<float> phi_;
  std::vector<int> phi_cells_;                     ///< those in which azimuths pi (i/n)^2 lie
  std::vector<float> reflected_[2], transmitted_;  ///< [cosine][cosine][azimuth][wavelength]
  double correction_ = 0;
  /// Of a substrate, by wavelength: what of its light does not return to it, the sum of t over flux, and 1/(pi n^2) within.
  std::vector<float> lost_, reached_sum_, per_inner_;
};

}  // namespace aureole
