// SPDX-License-Identifier: Apache-2.0
// S(q) of points in a finite window. The taper keeps the transform of the window narrow. The contribution of
// the mean density is subtracted, so that only the fluctuations remain (Illian et al., Statistical Analysis
// and Modelling of Spatial Point Patterns, 2008, section 4.6.4).
#include <algorithm>
#include <cmath>
#include <complex>
#include <opencv2/core.hpp>

#include "aureole/core/parallel.h"
#include "aureole/instrument/microscopy/point_statistics.h"

namespace aureole {
namespace {

struct Mode {
  int kx, ky, ring;
};

/// Vectors of a half-plane (S is even), sorted by ring. At most `most` evenly selected ones per ring are
/// used; they are the fraction `part` of the ring.
std::vector<Mode> choose_modes(double qx, double qy, double step, int rings, size_t most, double least,
                               std::vector<double>& part) {
  std::vector<std::vector<Mode>> by_ring(static_cast<size_t>(rings));
  const double end = step * rings;
  for (int kx = 0; kx * qx < end; ++kx) {
    const int reach = int(std::sqrt(std::max(end * end - kx * kx * qx * qx, 0.0)) / qy);
    for (int ky = kx == 0 ? 1 : -reach; ky <= reach; ++ky) {
      const double q = std::hypot(kx * qx, ky * qy);
      const int ring = int(q / step);
      if (ring < rings && q >= least) by_ring[size_t(ring)].push_back({kx, ky, ring});
    }
  }
  std::vector<Mode> modes;
  part.clear();
  for (const auto& ring : by_ring) {
    const size_t n = std::min(most, ring.size());
    for (size_t i = 0; i < n; ++i) modes.push_back(ring[i * ring.size() / n]);
    part.push_back(n > 0 ? double(n) / double(ring.size()) : 0);
  }
  return modes;
}

/// Transform of the taper at the window's periods: element (kx, ky) of the returned matrix.
cv::Mat taper_transform(const PointField& f) {
  const cv::Mat taper(f.rows, f.columns, CV_32F, const_cast<float*>(f.taper.data()));
  cv::Mat out;
  cv::dft(taper, out, cv::DFT_COMPLEX_OUTPUT);
  return out * (f.cell_x * f.cell_y);
}

/// Sum over points of taper exp(-i q.r) for all modes. exp(-i k q x) is tabulated per point and k, so that
/// each mode costs one multiplication per point.
std::vector<std::complex<double>> amplitudes(const PointField& f, const std::vector<double>& taper,
                                             const std::vector<Mode>& modes, double qx, double qy) {
  constexpr size_t kChunk = 2048, kLanes = 8;
  int most_x = 0, most_y = 0;
  for (const Mode& m : modes) most_x = std::max(most_x, m.kx), most_y = std::max(most_y, std::abs(m.ky));
  std::vector<float> x(size_t(most_x + 1) * 2 * kChunk), y(size_t(most_y + 1) * 2 * kChunk);
  std::vector<std::complex<double>> sum(modes.size());
  for (size_t first = 0; first < f.x.size(); first += kChunk) {
    const size_t count = std::min(kChunk, f.x.size() - first);
    const auto fill = [&](std::vector<float>& table, int most, const std::vector<double>& at, double q,
                          bool with_taper) {
      for_ranges(size_t(most) + 1, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k)
          for (size_t i = 0; i < kChunk; ++i) {
            const double phase = i < count ? -double(k) * q * at[first + i] : 0;
            const double t = i >= count ? 0 : with_taper ? taper[first + i] : 1;
            table[2 * kChunk * k + i] = float(t * std::cos(phase));
            table[2 * kChunk * k + kChunk + i] = float(t * std::sin(phase));
          }
      });
    };
    fill(x, most_x, f.x, qx, true), fill(y, most_y, f.y, qy, false);
    for_ranges(modes.size(), [&](size_t begin, size_t end) {
      for (size_t m = begin; m < end; ++m) {
        const float* a = &x[2 * kChunk * size_t(modes[m].kx)];
        const float* b = &y[2 * kChunk * size_t(std::abs(modes[m].ky))];
        const float sign = modes[m].ky < 0 ? -1 : 1;
        float re[kLanes] = {}, im[kLanes] = {};
        for (size_t i = 0; i < kChunk; i += kLanes)
          for (size_t l = 0; l < kLanes; ++l) {
            const float c = a[i + l], s = a[kChunk + i + l], d = b[i + l], t = sign * b[kChunk + i + l];
            re[l] += c * d - s * t, im[l] += c * t + s * d;
          }
        for (size_t l = 0; l < kLanes; ++l) sum[m] += std::complex<double>(re[l], im[l]);
      }
    });
  }
  return sum;
}

}  // namespace

RingMeans structure_factor_of(const std::vector<PointField>& fields, double step, int rings) {
  RingMeans out;
  out.step = step;
  std::vector<double> sum(size_t(rings), 0.0), independent = sum, weight = sum, where = sum;
  for (const PointField& f : fields) {
    double w1 = 0, w2 = 0, w4 = 0;
    for (const float w : f.taper) {
      const double v = double(w) * w;
      w1 += w, w2 += v, w4 += v * v;
    }
    if (!(w2 > 0) || f.x.size() < 3) continue;
    const double width = f.columns * f.cell_x, height = f.rows * f.cell_y;
    const double qx = 2 * M_PI / width, qy = 2 * M_PI / height;
    // Neighbouring vectors within the taper's width are correlated: `shared` of them count as one.
    const double shared = w4 * double(f.taper.size()) / (w2 * w2);

    std::vector<double> taper(f.x.size());
    double sum1 = 0, sum2 = 0;
    for (size_t i = 0; i < f.x.size(); ++i) {
      const double x = f.x[i] / f.cell_x - 0.5, y = f.y[i] / f.cell_y - 0.5;
      const int x0 = std::clamp(int(std::floor(x)), 0, std::max(f.columns - 2, 0));
      const int y0 = std::clamp(int(std::floor(y)), 0, std::max(f.rows - 2, 0));
      const double tx = std::clamp(x - x0, 0.0, 1.0), ty = std::clamp(y - y0, 0.0, 1.0);
      const auto at = [&](int i2, int j2) {
        return double(
            f.taper[size_t(std::min(j2, f.rows - 1)) * f.columns + size_t(std::min(i2, f.columns - 1))]);
      };
      taper[i] = (1 - ty) * ((1 - tx) * at(x0, y0) + tx * at(x0 + 1, y0)) +
                 ty * ((1 - tx) * at(x0, y0 + 1) + tx * at(x0 + 1, y0 + 1));
      sum1 += taper[i], sum2 += taper[i] * taper[i];
    }
    if (!(sum2 > 0)) continue;
    const double density = sum1 / (w1 * f.cell_x * f.cell_y);
    const cv::Mat transform = taper_transform(f);

    std::vector<double> part;
    const auto modes = choose_modes(qx, qy, step, rings, 1200, 3 * std::max(qx, qy), part);
    const std::vector<std::complex<double>> amplitude = amplitudes(f, taper, modes, qx, qy);
    std::vector<double> power(modes.size());
    for (size_t m = 0; m < modes.size(); ++m) {
      std::complex<double> rest = amplitude[m];
      const auto [kx, ky, ring] = modes[m];
      if (2 * kx < f.columns && 2 * std::abs(ky) < f.rows) {
        // The transform is evaluated at the centres of the cells.
        const auto t = transform.at<cv::Vec2f>(ky < 0 ? ky + f.rows : ky, kx);
        const auto shift = std::polar(density, -0.5 * (kx * qx * f.cell_x + ky * qy * f.cell_y));
        rest -= shift * std::complex<double>(t[0], t[1]);
      }
      power[m] = std::norm(rest) / sum2;
    }
    // Fields are weighted by their number of points, because the relative error per vector is equal.
    for (size_t m = 0; m < modes.size(); ++m) {
      const size_t ring = size_t(modes[m].ring);
      sum[ring] += power[m], weight[ring] += 1, independent[ring] += 1 / std::max(shared * part[ring], 1.0);
      where[ring] += std::hypot(modes[m].kx * qx, modes[m].ky * qy);
    }
  }
  for (int i = 0; i < rings; ++i) {
    const size_t k = size_t(i);
    if (weight[k] < 4) continue;
    out.q.push_back(where[k] / weight[k]);
    out.value.push_back(sum[k] / weight[k]);
    // Standard error: |amplitude|^2 of a mode is exponentially distributed, so that its standard deviation
    // equals its mean.
    out.error.push_back(sum[k] / weight[k] / std::sqrt(std::max(independent[k], 1.0)));
  }
  return out;
}

}  // namespace aureole
