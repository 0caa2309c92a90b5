// SPDX-License-Identifier: Apache-2.0
// Pools the statistics of fields. Sizes: each uncut particle is weighted by the inverse area in which it
// would be uncut (Miles-Lantuejoul), because the frame cuts large particles more often. Positions: only
// centres at least the largest reach away from the frame are used, because none of these is missing or
// displaced. Covered area: all particles, including cut ones. Confidence intervals: bootstrap of square
// blocks of the fields.
#include "aureole/instrument/microscopy/microstructure.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "aureole/core/error.h"
#include "aureole/instrument/microscopy/field_pool.h"
#include "aureole/instrument/microscopy/material_choice.h"
#include "aureole/instrument/microscopy/resampling.h"

namespace aureole {
namespace {

constexpr double kPiDouble = std::numbers::pi;
constexpr int kPairBins = 100;
constexpr double kPairStep = 0.1, kLargestU = 15;

}  // namespace

Microstructure analyse_microstructure(size_t count, const std::function<Micrograph(size_t)>& read,
                                      const MicrostructureOptions& o, const FieldVisitor& visit) {
  check_material_options(o);
  Microstructure m;
  FieldPool pool;
  pool_fields(count, read, o.segmentation, visit, m, pool);
  size_t whole = 0;
  std::string names;
  for (const FieldReport& f : m.fields)
    whole += size_t(f.whole), names += (names.empty() ? "" : ", ") + f.name;
  if (m.particles.empty()) throw Error({names, 0, 0}, "no particles found");
  if (whole < 3)
    throw Error({names, 0, 0}, std::to_string(whole) + (whole == 1 ? " particle is" : " particles are") +
                                   " seen whole: at least 3 are needed for statistics");
  choose_scatterers(m, o);
  if (whole < 20)
    m.notes.push_back("only " + std::to_string(whole) +
                      " particles are seen whole: the intervals are wide and rough");

  std::vector<double> pixels;
  double blur = 0;
  for (const Particle& p : m.particles)
    if (!p.cut) pixels.push_back(p.radius);
  for (const FieldReport& f : m.fields) blur = std::max(blur, f.blur);
  std::nth_element(pixels.begin(), pixels.begin() + long(pixels.size() / 2), pixels.end());
  const double typical = pixels[pixels.size() / 2];
  if (typical < 4.5 || blur > 0.2 * typical)
    m.notes.push_back(
        "the picture is not sharp enough for its particles (radius " + fmt::format("{:.1f}", typical) +
        " pixels, blur " + fmt::format("{:.1f}", blur) +
        "): neighbours merge and all numbers are biased; at least 5 pixels and a fifth of that are needed");

  // Sizes and density of the particles.
  double density = 0;
  for (const Particle& p : m.particles) {
    double area = 0;
    for (size_t f = 0; f < count; ++f) {
      const double scale = m.fields[f].pixel_m;
      area += pool.windows[f].area(p.reach * m.fields[size_t(p.field)].pixel_m / scale) * scale * scale;
    }
    m.weights.push_back(p.cut || !(area > 0) ? 0 : 1 / area);
    density += m.weights.back();
  }
  for (double& w : m.weights) w /= density;

  // Centres are complete where every particle would be uncut.
  std::vector<double> reach;
  for (const Particle& p : m.particles)
    if (!p.cut) reach.push_back(p.reach * m.fields[size_t(p.field)].pixel_m);
  std::sort(reach.begin(), reach.end());
  const double margin = std::min(reach.back(), 3 * reach[reach.size() / 2]);
  std::vector<PointField> points;
  for (size_t f = 0; f < count; ++f) {
    pool.margin.push_back(margin / m.fields[f].pixel_m);
    points.push_back(point_field(pool, m, f));
    for (int b = 0; b < points[f].blocks; ++b)
      pool.blocks[size_t(pool.first[f] + b)].area = points[f].block_area[size_t(b)];
    for (const int b : points[f].block) pool.blocks[size_t(pool.first[f] + b)].centres += 1;
  }
  for (size_t i = 0; i < m.particles.size(); ++i) {
    const Particle& p = m.particles[i];
    if (!p.cut) pool.blocks[size_t(block_of(pool, size_t(p.field), p.x, p.y))].particles.push_back(int(i));
  }

  std::vector<std::pair<double, double>> radii;
  for (size_t i = 0; i < m.particles.size(); ++i)
    if (m.weights[i] > 0)
      radii.emplace_back(m.particles[i].radius * m.fields[size_t(m.particles[i].field)].pixel_m,
                         m.weights[i]);
  BlockEstimator estimator(m, pool.blocks, points, sizes_of(radii).deviation);
  if (!estimator.has_pairs() && o.correlation_radius_m == 0)
    throw Error({names, 0, 0}, "no two particles lie away from the frame: give --correlation-radius");
  std::vector<int> all;
  for (int b = 0; b < int(pool.blocks.size()); ++b) all.push_back(b);
  m.blocks = int(all.size());
  const Onset onset = estimator.has_pairs() ? estimator.onset(all) : Onset{};
  m.correlation_radius_given = o.correlation_radius_m > 0;
  const double a = m.correlation_radius_given ? o.correlation_radius_m : 0.5 * onset.distance;
  m.onset_width = onset.distance > 0 ? onset.width / onset.distance : 0;
  m.onset_height = onset.contact;
  if (!m.correlation_radius_given && !estimator.fits_onset())
    m.notes.push_back(
        "too few close pairs: the correlation radius is half the smallest distance, too large by an unknown "
        "part");
  estimator.set_pairs(kPairStep * a, kPairBins);
  const BlockSample whole_sample = estimator.sample(all);

  // Confidence intervals by the bootstrap.
  std::mt19937_64 random(o.seed);
  std::vector<BlockSample> samples;
  for (int i = 0; i < o.resamples; ++i) {
    std::vector<int> draw;
    for (size_t k = 0; k < all.size(); ++k) draw.push_back(int(random() % all.size()));
    BlockSample s = estimator.sample(draw);
    if (s.density > 0 && s.sizes.mean > 0) samples.push_back(std::move(s));
  }
  const double blocks = double(all.size());
  const double t = blocks > 1 ? boost::math::quantile(boost::math::students_t(blocks - 1), 0.975) : 0;
  const auto error = [&](const auto& get) {
    if (blocks < 2 || samples.size() < 20) return 0.0;
    std::vector<double> v;
    for (const BlockSample& s : samples) v.push_back(get(s));
    return spread(std::move(v)) * std::sqrt(blocks / (blocks - 1));
  };
  const auto estimate = [&](double value, const auto& get, double most = INFINITY) {
    const double half = t * error(get);
    return Estimate{value, std::max(value - half, 0.0), std::min(value + half, most)};
  };
  if (blocks < 2) m.notes.push_back("too few particles for intervals: they are left empty");
  m.shape_fraction = estimate(
      whole_sample.covered, [](const BlockSample& s) { return s.covered; }, 1);
  // The bootstrap gives the relative error of the density away from the frame; this relative error is used
  // for the density of all particles.
  const double relative = density / whole_sample.density;
  m.density = estimate(density, [&](const BlockSample& s) { return s.density * relative; });
  const auto radius_of = [&](const BlockSample& s) { return m.correlation_radius_given ? a : 0.5 * s.onset; };
  m.correlation_radius = m.correlation_radius_given ? Estimate{a, a, a} : estimate(a, radius_of);
  m.area_fraction = estimate(density * kPiDouble * a * a, [&](const BlockSample& s) {
    return s.density * relative * kPiDouble * radius_of(s) * radius_of(s);
  });
  m.mean_radius = estimate(whole_sample.sizes.mean, [](const BlockSample& s) { return s.sizes.mean; });
  m.deviation =
      estimate(whole_sample.sizes.deviation, [](const BlockSample& s) { return s.sizes.deviation; });
  m.log_deviation =
      estimate(whole_sample.sizes.log_deviation, [](const BlockSample& s) { return s.sizes.log_deviation; });
  for (size_t q = 0; q < std::size(kQuantiles); ++q)
    m.quantiles.push_back(estimate(whole_sample.sizes.quantiles[q],
                                   [q](const BlockSample& s) { return s.sizes.quantiles[q]; }));
  for (size_t i = 0; i < whole_sample.g.size(); ++i) {
    m.pair_correlation.x.push_back((double(i) + 0.5) * kPairStep);
    m.pair_correlation.value.push_back(whole_sample.g[i]);
    m.pair_correlation.error.push_back(error([i](const BlockSample& s) { return s.g[i]; }));
  }
  double side = INFINITY;
  for (const PointField& f : points) side = std::min({side, f.columns * f.cell_x, f.rows * f.cell_y});
  const double step = std::max(0.1, 2 * kPiDouble * a / side);
  if (step < 1) {
    const RingMeans rings = structure_factor_of(points, step / a, int(kLargestU / step));
    for (const double q : rings.q) m.structure_factor.x.push_back(q * a);
    m.structure_factor.value = rings.value, m.structure_factor.error = rings.error;
  } else {
    m.notes.push_back("the fields are too small, relative to the particles, for a structure factor");
  }
  classify_shapes(m);
  note_bad_fits(m);
  return m;
}

}  // namespace aureole
