// SPDX-License-Identifier: Apache-2.0
// Minimises a function of few variables without derivatives (Nelder & Mead, "A simplex method for function
// minimization", 1965), with the usual coefficients 1, 2, 1/2, 1/2.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace aureole {

template <int N, class F>
std::array<double, N> simplex_minimum(const F& f, std::array<double, N> start,
                                      const std::array<double, N>& step, int evaluations) {
  using Point = std::array<double, N>;
  struct Vertex {
    Point x;
    double f;
  };
  std::array<Vertex, N + 1> v;
  for (int i = 0; i <= N; ++i) {
    v[i].x = start;
    if (i > 0) v[i].x[i - 1] += step[i - 1];
    v[i].f = f(v[i].x);
  }
  for (int used = N + 1; used < evaluations;) {
    std::sort(v.begin(), v.end(), [](const Vertex& a, const Vertex& b) { return a.f < b.f; });
    Point middle{};
    for (int i = 0; i < N; ++i)
      for (int k = 0; k < N; ++k) middle[k] += v[i].x[k] / N;
    const auto along = [&](double t) {
      Vertex w;
      for (int k = 0; k < N; ++k) w.x[k] = middle[k] + t * (v[N].x[k] - middle[k]);
      w.f = f(w.x);
      ++used;
      return w;
    };
    const Vertex reflected = along(-1);
    if (reflected.f < v[0].f) {
      const Vertex farther = along(-2);
      v[N] = farther.f < reflected.f ? farther : reflected;
    } else if (reflected.f < v[N - 1].f) {
      v[N] = reflected;
    } else {
      const Vertex nearer = along(reflected.f < v[N].f ? -0.5 : 0.5);
      if (nearer.f < std::min(reflected.f, v[N].f)) {
        v[N] = nearer;
      } else {
        for (int i = 1; i <= N; ++i) {
          for (int k = 0; k < N; ++k) v[i].x[k] = 0.5 * (v[i].x[k] + v[0].x[k]);
          v[i].f = f(v[i].x), ++used;
        }
      }
    }
  }
  return std::min_element(v.begin(), v.end(), [](const Vertex& a, const Vertex& b) { return a.f < b.f; })->x;
}

}  // namespace aureole
