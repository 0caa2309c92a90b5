// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/measured/rgl_writer.h"

#include <algorithm>
#include <cmath>

#include "aureole/bsdf/measured/bilinear_warp.h"
#include "aureole/bsdf/measured/half_vector_square.h"
#include "aureole/core/error.h"
#include "aureole/core/parallel.h"

namespace aureole {
namespace {

/// Fraction of a uniform distribution of normals (D = 1/pi) in the estimate. It gives every direction a
/// positive density, so that the spectra hold the scattering that retro-reflection does not show.
constexpr double kEvenNormals = 0.01;
constexpr int kPowerIterations = 40;

Vec3 direction_at(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

/// Nodes of the square with the solid angles around them, for sums over normals.
struct NormalGrid {
  int width, height;
  std::vector<Vec3> normals;
  std::vector<double> areas;

  NormalGrid(int w, int h) : width(w), height(h) {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const double u = double(x) / (w - 1), v = double(y) / (h - 1), theta = 0.5 * kPiD * u * u;
        normals.push_back(direction_at(theta, kPiD * (2 * v - 1)));
        const double rim = (x == 0 || x == w - 1 ? 0.5 : 1) * (y == 0 || y == h - 1 ? 0.5 : 1);
        areas.push_back(2 * kPiD * kPiD * u * std::sin(theta) * rim / ((w - 1) * (h - 1)));
      }
  }
  std::size_t size() const { return normals.size(); }
};

/// sigma(w): the projected area of the normals towards w.
double projected_area(const NormalGrid& grid, const std::vector<double>& d, const Vec3& w) {
  double sum = 0;
  for (std::size_t k = 0; k < grid.size(); ++k)
    sum += d[k] * grid.areas[k] * std::max(double(dot(w, grid.normals[k])), 0.0);
  return sum;
}

void scale_to_unit_area(const NormalGrid& grid, std::vector<double>& d) {
  const double area = projected_area(grid, d, {0, 0, 1});
  for (double& x : d) x /= area;
}

}  // namespace

RglFile make_rgl_file(const ScatteringProbe& probe, const RglWriterSettings& s) {
  const bool is_isotropic = s.azimuths == 1;
  const NormalGrid grid(s.normals, s.normals / (is_isotropic ? 4 : 2) + 1);
  const std::size_t width = std::size_t(grid.width), height = std::size_t(grid.height);
  // Retro-reflection f(m, m) cos(theta_m) at each normal m.
  std::vector<double> retro(grid.size());
  for_ranges(
      grid.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          // The rows of an isotropic distribution are equal, so that the first row serves for all.
          const Vec3& m = grid.normals[is_isotropic ? k % width : k];
          const Vec3 w = m.z > 1e-3f ? m : normalize(Vec3{m.x, m.y, 1e-3f});
          retro[k] = std::max(probe.mean(w, w), 0.0) * double(w.z);
        }
      },
      64);
  std::vector<double> d(grid.size(), 1 / kPiD), sigma(grid.size());
  if (*std::max_element(retro.begin(), retro.end()) > 0) {
    // The projected area sigma changes slowly with the direction: a coarse grid suffices for the iteration.
    const int rows = is_isotropic ? 1 : 17, columns = 33;
    std::vector<double> coarse(std::size_t(rows * columns));
    for (int i = 0; i < kPowerIterations; ++i) {
      for_ranges(
          coarse.size(),
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
              const double u = double(int(k) % columns) / (columns - 1),
                           v = rows > 1 ? double(int(k) / columns) / (rows - 1) : 0.5;
              coarse[k] = projected_area(grid, d, direction_at(0.5 * kPiD * u * u, kPiD * (2 * v - 1)));
            }
          },
          8);
      for (std::size_t k = 0; k < grid.size(); ++k) {
        const double x = double(k % width) / double(width - 1) * (columns - 1),
                     y = double(k / width) / double(height - 1) * (rows - 1);
        const int i0 = std::min(int(x), columns - 2), j0 = std::min(int(y), std::max(rows - 2, 0));
        const double tx = x - i0, ty = rows > 1 ? y - j0 : 0;
        const auto at = [&](int a, int b) {
          return coarse[std::size_t(std::min(b, rows - 1) * columns + a)];
        };
        const double area = (1 - ty) * ((1 - tx) * at(i0, j0) + tx * at(i0 + 1, j0)) +
                            ty * ((1 - tx) * at(i0, j0 + 1) + tx * at(i0 + 1, j0 + 1));
        d[k] = retro[k] * area;
      }
      scale_to_unit_area(grid, d);
    }
  }
  for (double& x : d) x = (1 - kEvenNormals) * x + kEvenNormals / kPiD;
  scale_to_unit_area(grid, d);

  RglFile file;
  file.description = s.description;
  file.is_relative = true;
  for (int i = 0; i < s.azimuths; ++i)
    file.phi_i.push_back(is_isotropic ? 0.f : float(kPiD * (2.0 * i / (s.azimuths - 1) - 1)));
  // The nodes of the angle of incidence are denser near 90 degrees, where reflection changes most; no light
  // arrives at 90 degrees.
  for (int i = 0; i < s.angles; ++i)
    file.theta_i.push_back(float(89.0 * kDegree * std::sin(0.5 * kPiD * i / (s.angles - 1))));
  for (const double nm : probe.nm()) file.nm.push_back(float(nm));
  const std::size_t rows = is_isotropic ? 2 : height;
  file.ndf = {rows, width, {}};
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < width; ++x) file.ndf.values.push_back(float(d[y * width + x]));
  file.sigma = {rows, width, std::vector<float>(rows * width)};
  for_ranges(
      rows * width,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          file.sigma.values[k] = float(projected_area(grid, d, grid.normals[is_isotropic ? k % width : k]));
      },
      16);
  const BilinearTable ndf_table(int(width), int(rows), file.ndf.values),
      sigma_table(int(width), int(rows), file.sigma.values);

  const std::size_t n = std::size_t(s.resolution), area = n * n, channels = probe.channels(),
                    slices = file.phi_i.size() * file.theta_i.size();
  file.vndf = {height, width, std::vector<float>(slices * height * width)};
  file.luminance = {n, n, std::vector<float>(slices * area)};
  file.spectra.resize(slices * channels * area);
  double brightest = 0;
  for_ranges(
      slices,
      [&](std::size_t begin, std::size_t end) {
        std::vector<double> f;
        for (std::size_t slice = begin; slice < end; ++slice) {
          const double phi = double(file.phi_i[slice / file.theta_i.size()]),
                       theta = double(file.theta_i[slice % file.theta_i.size()]);
          const Vec3 wi = direction_at(theta, phi);
          const Vec2 at_wi = half_vector_to_square(wi);
          const float sigma_i = sigma_table.at(at_wi);
          float* vndf = file.vndf.values.data() + slice * height * width;
          for (std::size_t k = 0; k < grid.size(); ++k) {
            // Azimuths of isotropic tables are relative to the azimuth of wi, which is 0 here.
            const double u = double(k % width) / double(width - 1);
            const double jacobian = 2 * kPiD * kPiD * u * std::sin(0.5 * kPiD * u * u);
            vndf[k] =
                float(d[k] * std::max(double(dot(wi, grid.normals[k])), 0.0) * jacobian / double(sigma_i));
          }
          const BilinearWarp warp(int(width), int(height), 1, {vndf, height * width});
          const SliceBlend blend = SliceNodes{{0}, {0}}.at(0, 0);
          for (std::size_t y = 0; y < n; ++y)
            for (std::size_t x = 0; x < n; ++x) {
              const Vec2 square = warp.sample({float(x) / float(n - 1), float(y) / float(n - 1)}, blend).p;
              const Vec3 m = square_to_half_vector(square);
              Vec3 wo = 2 * dot(m, wi) * m - wi;
              const bool is_above = wo.z > 0;
              // Points whose directions lie below the surface take the values at the horizon, so that
              // interpolation between nodes does not darken them.
              wo = normalize(Vec3{wo.x, wo.y, std::max(wo.z, 2e-3f)});
              const Vec3 half = normalize(wi + wo);
              const float unit = ndf_table.at(half_vector_to_square(half)) / (4 * sigma_i);
              probe.f(wi, wo, f);
              double sum = 0;
              for (std::size_t c = 0; c < channels; ++c) {
                const double value = std::max(f[c], 0.0) * double(wo.z) / double(unit);
                file.spectra[(slice * channels + c) * area + y * n + x] = float(value);
                sum += value;
              }
              file.luminance.values[slice * area + y * n + x] =
                  is_above ? float(sum / double(channels)) : 0.f;
            }
        }
      },
      1);
  for (const float v : file.luminance.values) brightest = std::max(brightest, double(v));
  if (!(brightest > 0))
    throw Error(
        "the BSDF reflects nothing from the side of its normal to that side, or by delta lobes alone");
  return file;
}

}  // namespace aureole
