// SPDX-License-Identifier: Apache-2.0
// Writes the table of spectral upsampling that src/aureole/spectrum/upsampling.cpp reads (its layout is
// described there):
//
//     make_upsampling_table OUTPUT [resolution]
//
// W. Jakob and J. Hanika, "A Low-Dimensional Function Space for Efficient Spectral Upsampling", 2019,
// section 5.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "aureole/spectrum/upsampling_fit.h"

namespace {

using namespace aureole;

constexpr int kDefaultResolution = 48;

/// White is the limit of ever larger x; this is a finite stand-in near the x of its neighbours. Light colours are
/// looked up by what they lack from white, so that no lookup reaches this node.
constexpr double kWhite = 0.99985;

/// Represents black, where the coefficients are infinite but their products with the square root are not.
constexpr double kDarkest = 1e-5;

/// The nodes of every axis are dense near 0 and 1, where the coefficients change fastest.
double warped(double u) { return u * u / (u * u + (1.0 - u) * (1.0 - u)); }

std::vector<float> make_table(int n, double& worst) {
  std::vector<float> table(static_cast<std::size_t>(n) * n * n * 9);
  worst = 0;
  for (int l = 0; l < 3; ++l) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double x = warped(static_cast<double>(i) / (n - 1)),
                     y = warped(static_cast<double>(j) / (n - 1));
        const auto fit_node = [&](int k, FitCoefficients& fit) {
          const double z = std::max(kDarkest, warped(static_cast<double>(k) / (n - 1)));
          Rgb rgb;
          rgb[l] = z;
          rgb[(l + 1) % 3] = x * z;
          rgb[(l + 2) % 3] = y * z;
          if (k == n - 1 && i == n - 1 && j == n - 1)
            fit.c = {(kWhite - 0.5) / std::sqrt(kWhite * (1.0 - kWhite)), 0, 0};
          else
            worst = std::max(worst, refine_fit(rgb, fit));
          const SigmoidPolynomial p = fit.polynomial();
          float* out = &table[(((static_cast<std::size_t>(l) * n + k) * n + j) * n + i) * 3];
          const auto scale = static_cast<float>(std::sqrt(z));
          out[0] = scale * p.c0, out[1] = scale * p.c1, out[2] = scale * p.c2;
        };
        // Colours of medium brightness have smooth spectra and are easily found; each leads to the next.
        const int middle = n / 2;
        FitCoefficients start;
        fit_node(middle, start);
        FitCoefficients fit = start;
        for (int k = middle + 1; k < n; ++k) fit_node(k, fit);
        fit = start;
        for (int k = middle - 1; k >= 0; --k) fit_node(k, fit);
      }
    }
  }
  return table;
}

}  // namespace

int main(int argc, char** argv) try {
  const int n = argc > 2 ? std::atoi(argv[2]) : kDefaultResolution;
  if (argc < 2 || n < 8 || n > 128) {
    std::fprintf(stderr, "usage: make_upsampling_table OUTPUT [resolution, 8-128]\n");
    return 2;
  }
  double worst = 0;
  const std::vector<float> table = make_table(n, worst);
  constexpr double kAcceptable = 0.01;
  if (!(worst < kAcceptable)) {
    std::fprintf(stderr, "make_upsampling_table: a fit failed, Delta E %g\n", worst);
    return 1;
  }
  std::FILE* file = std::fopen(argv[1], "wb");
  const auto size = static_cast<std::uint32_t>(n);
  bool written = file != nullptr && std::fwrite("AURU", 4, 1, file) == 1 &&
                 std::fwrite(&size, 4, 1, file) == 1 &&
                 std::fwrite(table.data(), sizeof(float), table.size(), file) == table.size();
  if (file != nullptr) written = std::fclose(file) == 0 && written;
  if (!written) {
    std::fprintf(stderr, "make_upsampling_table: cannot write %s\n", argv[1]);
    return 1;
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "make_upsampling_table: %s\n", error.what());
  return 1;
}
