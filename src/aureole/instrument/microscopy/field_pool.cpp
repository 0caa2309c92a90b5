// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/field_pool.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace aureole {
namespace {

/// Number of blocks along a side: many, but with several particles in each, and at least 2 for fewer than 4
/// fields.
int blocks_along(size_t particles, size_t fields) {
  return std::clamp(int(std::sqrt(double(particles) / 6)), fields >= 4 ? 1 : 2,
                    fields >= 30  ? 1
                    : fields >= 8 ? 2
                                  : 4);
}

}  // namespace

int block_of(const FieldPool& p, size_t f, double x, double y) {
  const int side = p.side[f];
  const auto at = [&](double v, int n) { return std::clamp(int(v / n * side), 0, side - 1); };
  return p.first[f] + at(y, p.windows[f].height()) * side + at(x, p.windows[f].width());
}

void pool_fields(size_t count, const std::function<Micrograph(size_t)>& read,
                 const SegmentationOptions& options, const FieldVisitor& visit, Microstructure& m,
                 FieldPool& pool) {
  for (size_t f = 0; f < count; ++f) {
    const Micrograph field = read(f);
    for (const std::string& note : field.notes) m.notes.push_back(field.name + ": " + note);
    const Segmentation s = segment(field, options);
    pool.windows.emplace_back(field.width, field.height, field.seen);
    const ObservationWindow& window = pool.windows.back();
    std::vector<Particle> found = measure_particles(s, window, int(f));
    FieldReport r;
    r.name = field.name, r.width = field.width, r.height = field.height, r.pixel_m = field.pixel_m;
    r.seen_m2 = window.area() * field.pixel_m * field.pixel_m;
    for (const Particle& p : found) ++(p.cut ? r.cut : r.whole);
    r.too_small = s.too_small, r.bright = s.bright, r.polarity_score = s.polarity_score;
    r.noise = s.noise, r.blur = s.blur;
    m.fields.push_back(r);
    if (visit) visit(field, s, found);

    pool.side.push_back(blocks_along(found.size(), count));
    pool.first.push_back(int(pool.blocks.size()));
    pool.blocks.resize(pool.blocks.size() + size_t(pool.side.back()) * pool.side.back());
    const double pixel2 = field.pixel_m * field.pixel_m;
    for (int y = 0; y < field.height; ++y)
      for (int x = 0; x < field.width; ++x) {
        const size_t i = size_t(y) * field.width + x;
        if (!field.seen.empty() && !field.seen[i]) continue;
        Block& b = pool.blocks[size_t(block_of(pool, f, x + 0.5, y + 0.5))];
        b.window += pixel2;
        if (s.labels[i]) b.covered += pixel2 * (s.depth[i] > s.band + 1 ? 1.0 : double(s.coverage[i]));
      }
    for (Particle& p : found) m.particles.push_back(std::move(p));
  }
}

PointField point_field(const FieldPool& pool, const Microstructure& m, size_t f) {
  const ObservationWindow& window = pool.windows[f];
  const double p = m.fields[f].pixel_m, margin = pool.margin[f];
  PointField out;
  const auto raster = window.raster(margin, 512);
  out.columns = raster.width, out.rows = raster.height;
  out.cell_x = raster.cell_x * p, out.cell_y = raster.cell_y * p;
  bool masked = false;
  double inside = 0;
  out.blocks = pool.side[f] * pool.side[f];
  out.block_area.assign(size_t(out.blocks), 0);
  float most = 0;
  for (const float v : raster.free) most = std::max(most, v);
  out.taper.resize(raster.free.size());
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x) {
      const size_t i = size_t(y) * raster.width + x;
      out.taper[i] = 0.5f - 0.5f * float(std::cos(M_PI * std::min(1.0, raster.free[i] / (0.25 * most))));
      const double area = raster.inside[i] * out.cell_x * out.cell_y;
      inside += area;
      const int b = block_of(pool, f, (x + 0.5) * raster.cell_x, (y + 0.5) * raster.cell_y);
      out.block_area[size_t(b - pool.first[f])] += area;
    }
  masked = std::abs(window.area() - double(window.width()) * window.height()) > 0.5;
  out.area = masked ? inside : window.area(margin) * p * p;
  const auto covariance = std::make_shared<SetCovariance>(window, margin, masked);
  out.covariance = [covariance, p](double dx, double dy) { return (*covariance)(dx / p, dy / p) * p * p; };
  for (const Particle& a : m.particles)
    if (size_t(a.field) == f && window.free(a.x, a.y) >= margin) {
      out.x.push_back(a.x * p), out.y.push_back(a.y * p);
      out.block.push_back(block_of(pool, f, a.x, a.y) - pool.first[f]);
    }
  return out;
}

}  // namespace aureole
