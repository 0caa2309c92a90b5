// SPDX-License-Identifier: Apache-2.0
// Scattering of a plane wave by a body with spherical symmetry, as a series of partial waves (for a sphere:
// Bohren & Huffman, Absorption and Scattering of Light by Small Particles, 1983, chapter 4). Time dependence
// exp(-i omega t); mu is the cosine of the scattering angle. Only the coefficients a_n and b_n depend on the
// body's materials (`Mie`, `CoatedMie`).
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace aureole::optics {

/// Amplitudes for light polarised perpendicular (s1) and parallel (s2) to the scattering plane. Unpolarised
/// light has the differential cross section (|s1|^2 + |s2|^2)/(2 k^2).
struct MieAmplitudes {
  std::complex<double> s1, s2;
  double intensity() const { return 0.5 * (std::norm(s1) + std::norm(s2)); }
};

class PartialWaves {
public:
  /// Returns the size parameter 2 pi radius n_medium/lambda.
  double size() const { return x_; }
  /// Efficiencies: cross sections over pi radius^2. The efficiency of backscattering is 4 pi times the
  /// differential one (radar convention).
  double extinction() const { return extinction_; }
  double scattering() const { return scattering_; }
  double backscattering() const { return backscattering_; }
  /// Returns the mean cosine of the scattering angle; 0 if nothing is scattered.
  double asymmetry() const { return asymmetry_; }
  /// Returns the absorption efficiency, averaged over the size parameters from x - half_width to x + half_width.
  /// A weak absorber absorbs in resonances of single partial waves, which may be narrower than 1e-6 in x and
  /// which `extinction() - scattering()` hits or misses. `below` and `above` are the body with size parameters
  /// that differ from x by the same small step, such as 1e-5 x: the resonances near x follow from them.
  double mean_absorption(const PartialWaves& below, const PartialWaves& above, double half_width) const;

  /// Returns scattering over extinction; 1 if the extinction is 0.
  double albedo() const { return extinction_ > 0 ? scattering_ / extinction_ : 1; }

  /// Returns the forward amplitude S(0) = s1 = s2 at mu = 1; extinction() = 4/x^2 Re S(0).
  std::complex<double> forward() const { return forward_; }
  /// Returns the amplitudes at the cosine mu in [-1, 1] of the scattering angle.
  MieAmplitudes amplitudes(double mu) const;
  /// Computes the amplitudes at each mu and, unless `mirrored` is empty, at -mu too, for little extra cost.
  /// All spans have one size. The cost is some 3 clock cycles per term (x + 4 x^(1/3)) and pair of angles.
  void amplitudes(std::span<const double> mu, std::span<MieAmplitudes> at,
                  std::span<MieAmplitudes> mirrored = {}) const;
  /// Computes only `MieAmplitudes::intensity()`, in half the time of `amplitudes`.
  void intensities(std::span<const double> mu, std::span<double> at, std::span<double> mirrored = {}) const;

  const std::vector<std::complex<double>>& a() const { return a_; }  ///< coefficients: a()[n - 1] is a_n
  const std::vector<std::complex<double>>& b() const { return b_; }

protected:
  explicit PartialWaves(double x) : x_(x) {}

  /// Computes a_n and b_n for n = 1 ... from the logarithmic derivatives of the field inside the surface, at
  /// index n (index 0 is not used). They are divided by the relative index (`electric`) or multiplied by it
  /// (`magnetic`): Bohren & Huffman, equation 4.88.
  void match(std::span<const std::complex<double>> electric, std::span<const std::complex<double>> magnetic);

private:
  void find_efficiencies();

  double x_, extinction_ = 0, scattering_ = 0, backscattering_ = 0, asymmetry_ = 0;
  std::complex<double> forward_;
  std::vector<std::complex<double>> a_, b_;
  /// For each n: real and imaginary parts of a_n and b_n times (2n + 1)/(n (n + 1)).
  struct Term {
    double ar, ai, br, bi;
  };
  std::vector<Term> terms_;
};

}  // namespace aureole::optics
