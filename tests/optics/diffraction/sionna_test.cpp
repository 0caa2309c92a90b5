// SPDX-License-Identifier: Apache-2.0
// Single diffraction at edges of metal after sionna-rt 2.2.0: a wall, a block and two blocks at 3.5 and 28 GHz, oblique as well.
// references/make_sionna_references.py has made the numbers, and says which coefficient they hold.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "aureole/optics/diffraction/uniform_theory.h"

namespace aureole::optics {
namespace {

/// A path with one diffraction.
struct Row {
  double ghz;
  double n;  ///< exterior angle over pi
  /// Transmitter, point of the edge, receiver; across the edge, points of the o- and of the n-face [m].
  double from[3], edge[3], to[3], o_face[2], n_face[2];
  double gain_db;
};

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-braces"
const Row kRows[] = {
#include "optics/diffraction/references/sionna_references.inc"
};
#pragma GCC diagnostic pop

/// The angle about the edge from the o-face, clockwise as seen from above.
double angle(const Row& r, const double* to) {
  const double o = std::atan2(r.o_face[1] - r.edge[1], r.o_face[0] - r.edge[0]);
  return std::fmod(o - std::atan2(to[1] - r.edge[1], to[0] - r.edge[0]) + 4 * M_PI, 2 * M_PI);
}

double distance(const double* a, const double* b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Between isotropic antennas.
double gain_db(const Row& r) {
  const double lambda = 0.299792458 / r.ghz, s_i = distance(r.from, r.edge), s = distance(r.edge, r.to);
  const double sin_beta = std::hypot(r.from[0] - r.edge[0], r.from[1] - r.edge[1]) / s_i;
  const auto d = Wedge(r.n).coefficient(2 * M_PI / lambda, point_source_distance(s_i, s, sin_beta), sin_beta,
                                        angle(r, r.to), angle(r, r.from), kSoftMetal);
  return 20 * std::log10(lambda / (4 * M_PI) / s_i * std::abs(d) * point_source_spreading(s_i, s));
}

TEST(Sionna, SingleDiffractionByMetal) {
  double worst = 0, squares = 0;
  int count = 0;
  for (const Row& r : kRows) {
    const double off = gain_db(r) - r.gain_db;
    EXPECT_NEAR(off, 0, 0.06) << r.ghz << " GHz, n " << r.n << ", from " << angle(r, r.from) << " to "
                              << angle(r, r.to);
    worst = std::max(worst, std::abs(off)), squares += off * off, ++count;
  }
  EXPECT_GT(count, 300);
  std::printf("UTD against sionna-rt, %d paths: rms %.4f dB, largest %.3f dB\n", count,
              std::sqrt(squares / count), worst);
}

}  // namespace
}  // namespace aureole::optics
