// SPDX-License-Identifier: Apache-2.0
// How fields are pooled. Sizes: particles that are seen whole, each divided by the area in which it would be
// (Miles-Lantuejoul), so that large ones, which the frame cuts more often, count as much as they should.
// Positions: centres at least the largest reach away from the frame, where no centre is missed or displaced.
// Covered part: all particles, cut ones included. Intervals: bootstrap of square blocks of the fields.
#include "aureole/instrument/microstructure.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <random>

#include "aureole/core/error.h"

namespace aureole {
namespace {

constexpr double kPi = M_PI;
constexpr int kPairBins = 100, kOnsetBins = 160;
constexpr double kPairStep = 0.1, kLargestU = 15;

/// One block of a field: what the bootstrap draws.
struct Block {
  double window = 0, covered = 0;  ///< m^2
  double area = 0;                 ///< of the eroded window, m^2
  double centres = 0;
  std::vector<int> particles;  ///< whole ones with their centre here
};

struct Pool {
  std::vector<ObservationWindow> windows;
  std::vector<double> margin;  ///< pixels
  std::vector<Block> blocks;
  std::vector<int> side, first;  ///< blocks of a field: side^2 from first
};

/// Blocks along a side: as many as leave several particles in each, but some even where they do not.
int blocks_along(size_t particles, size_t fields) {
  return std::clamp(int(std::sqrt(double(particles) / 6)), fields >= 4 ? 1 : 2,
                    fields >= 30  ? 1
                    : fields >= 8 ? 2
                                  : 4);
}

int block_of(const Pool& p, size_t f, double x, double y) {
  const int side = p.side[f];
  const auto at = [&](double v, int n) { return std::clamp(int(v / n * side), 0, side - 1); };
  return p.first[f] + at(y, p.windows[f].height()) * side + at(x, p.windows[f].width());
}

struct Sizes {
  double mean = 0, deviation = 0, log_deviation = 0, quantiles[std::size(kQuantiles)] = {};
};

Sizes sizes_of(std::vector<std::pair<double, double>> radius_weight) {
  Sizes s;
  double sum = 0, log_mean = 0;
  for (const auto& [r, w] : radius_weight) sum += w, s.mean += w * r, log_mean += w * std::log(r);
  if (!(sum > 0)) return s;
  s.mean /= sum, log_mean /= sum;
  for (const auto& [r, w] : radius_weight) {
    s.deviation += w * (r - s.mean) * (r - s.mean);
    s.log_deviation += w * (std::log(r) - log_mean) * (std::log(r) - log_mean);
  }
  const double unbiased =
      radius_weight.size() > 1 ? double(radius_weight.size()) / double(radius_weight.size() - 1) : 1;
  s.deviation = std::sqrt(s.deviation / sum * unbiased);
  s.log_deviation = std::sqrt(s.log_deviation / sum * unbiased);
  std::sort(radius_weight.begin(), radius_weight.end());
  for (size_t q = 0; q < std::size(kQuantiles); ++q) {
    // Linear between the middles of the steps.
    double before = 0, last_at = 0, last_r = radius_weight.front().first;
    s.quantiles[q] = radius_weight.back().first;
    for (const auto& [r, w] : radius_weight) {
      const double at = (before + 0.5 * w) / sum;
      if (at >= kQuantiles[q]) {
        s.quantiles[q] =
            at > last_at ? last_r + (kQuantiles[q] - last_at) / (at - last_at) * (r - last_r) : r;
        break;
      }
      before += w, last_at = at, last_r = r;
    }
  }
  return s;
}

/// Pixels per metre differ between fields: everything in metres from here on.
PointField point_field(const Pool& pool, const Microstructure& m, size_t f) {
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
      out.taper[i] = 0.5f - 0.5f * float(std::cos(kPi * std::min(1.0, raster.free[i] / (0.25 * most))));
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

/// Everything that the bootstrap repeats, as one list of numbers.
struct Sample {
  double covered, density, onset;
  Sizes sizes;
  std::vector<double> g;
};

class Estimator {
public:
  Estimator(const Microstructure& m, const std::vector<Block>& blocks, const std::vector<PointField>& points,
            double radius_deviation)
      : m_(m), blocks_(blocks), points_(points) {
    std::vector<double> nearest;
    for (const PointField& f : points)
      for (const double d : nearest_distances(f)) nearest.push_back(d);
    std::sort(nearest.begin(), nearest.end());
    if (nearest.empty()) return;
    smallest_ = nearest.front();
    // A few false neighbours (particles divided by mistake) must not set the scale.
    guess_ = nearest[nearest.size() / 20];
    expected_width_ = std::clamp(std::sqrt(2.0) * radius_deviation, 0.004 * guess_, 0.25 * guess_);
    onset_pairs_ = count_pairs(points, 1.6 * guess_ / kOnsetBins, kOnsetBins);
    double near = 0;
    for (int i = 0; i < kOnsetBins; ++i) {
      distance_.push_back((i + 0.5) * onset_pairs_.width);
      if (distance_.back() > 0.8 * guess_ && distance_.back() < 1.25 * guess_)
        near += onset_pairs_.count[size_t(i)];
    }
    fits_ = near >= 40;
  }
  bool has_pairs() const { return guess_ > 0; }
  bool fits_onset() const { return fits_; }

  /// g(r) in bins of `width`; from here on samples contain it.
  void set_pairs(double width) { pairs_ = count_pairs(points_, width, kPairBins); }

  Onset onset(const std::vector<int>& draw) const {
    if (!fits_) return {smallest_, 0, 0};
    const std::vector<double> g = pair_correlation(onset_pairs_, draw);
    std::vector<double> r, v, n;
    for (size_t i = 0; i < g.size(); ++i)
      if (distance_[i] > 0.5 * guess_)
        r.push_back(distance_[i]), v.push_back(g[i]), n.push_back(onset_pairs_.count[i]);
    return fit_onset(r, v, n, guess_, expected_width_);
  }
  Sample sample(const std::vector<int>& draw) const {
    Sample s;
    double window = 0, covered = 0;
    std::vector<std::pair<double, double>> sizes;
    for (const int b : draw) {
      const Block& block = blocks_[size_t(b)];
      window += block.window, covered += block.covered;
      for (const int i : block.particles) {
        const Particle& p = m_.particles[size_t(i)];
        sizes.emplace_back(p.radius * m_.fields[size_t(p.field)].pixel_m, m_.weights[size_t(i)]);
      }
    }
    s.covered = window > 0 ? covered / window : 0;
    s.density = density(draw);
    s.onset = has_pairs() ? onset(draw).distance : 0;
    s.sizes = sizes_of(std::move(sizes));
    if (!pairs_.weighted.empty()) s.g = pair_correlation(pairs_, draw);
    return s;
  }

private:
  double density(const std::vector<int>& draw) const {
    double n = 0, area = 0;
    for (const int b : draw) n += blocks_[size_t(b)].centres, area += blocks_[size_t(b)].area;
    return area > 0 ? n / area : 0;
  }
  std::vector<double> pair_correlation(const PairCounts& pairs, const std::vector<int>& draw) const {
    const double rho = density(draw);
    std::vector<double> g(pairs.count.size());
    for (const int b : draw)
      for (size_t i = 0; i < g.size(); ++i) g[i] += pairs.weighted[size_t(b)][i];
    for (size_t i = 0; i < g.size(); ++i) {
      const double ring = kPi * pairs.width * pairs.width * (2 * double(i) + 1);
      g[i] = rho > 0 ? g[i] / (rho * rho * ring) : 0;
    }
    return g;
  }
  const Microstructure& m_;
  const std::vector<Block>& blocks_;
  const std::vector<PointField>& points_;
  double guess_ = 0, smallest_ = 0, expected_width_ = 0;
  bool fits_ = false;
  PairCounts onset_pairs_, pairs_;
  std::vector<double> distance_;
};

/// Standard deviation over resamples, without outliers of the fit: half the 16 to 84 % range.
double spread(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const auto at = [&](double q) { return v[std::min(size_t(q * double(v.size())), v.size() - 1)]; };
  return 0.5 * (at(0.8413) - at(0.1587));
}

void pool_fields(size_t count, const std::function<Micrograph(size_t)>& read, const MicrostructureOptions& o,
                 const FieldVisitor& visit, Microstructure& m, Pool& pool) {
  std::vector<std::vector<float>> covered;
  for (size_t f = 0; f < count; ++f) {
    const Micrograph field = read(f);
    const Segmentation s = segment(field, o.segmentation);
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

}  // namespace

Microstructure analyse_microstructure(size_t count, const std::function<Micrograph(size_t)>& read,
                                      const MicrostructureOptions& o, const FieldVisitor& visit) {
  Microstructure m;
  Pool pool;
  pool_fields(count, read, o, visit, m, pool);
  size_t whole = 0;
  std::string names;
  for (const FieldReport& f : m.fields) {
    whole += size_t(f.whole), names += (names.empty() ? "" : ", ") + f.name;
    if (f.bright != m.fields[0].bright)
      m.notes.push_back(f.name + ": particles are " + (f.bright ? "bright" : "dark") + ", in " +
                        m.fields[0].name + " they are not; --polarity decides for all");
  }
  if (m.particles.empty()) throw Error({names, 0, 0}, "no particles found");
  if (whole < 3)
    throw Error({names, 0, 0}, std::to_string(whole) + (whole == 1 ? " particle is" : " particles are") +
                                   " seen whole: at least 3 are needed for statistics");
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

  // Sizes and density.
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

  // Centres are complete where every particle would be seen whole.
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
  Estimator estimator(m, pool.blocks, points, sizes_of(radii).deviation);
  if (!estimator.has_pairs() && o.correlation_radius_m == 0)
    throw Error({names, 0, 0}, "no two particles lie away from the frame: give --correlation-radius");
  std::vector<int> all;
  for (int b = 0; b < int(pool.blocks.size()); ++b) all.push_back(b);
  m.blocks = int(all.size());
  const Onset onset = estimator.has_pairs() ? estimator.onset(all) : Onset{};
  m.correlation_radius_given = o.correlation_radius_m > 0;
  const double a = m.correlation_radius_given ? o.correlation_radius_m : 0.5 * onset.distance;
  m.onset_width = onset.distance > 0 ? onset.width / onset.distance : 0;
  if (!m.correlation_radius_given && !estimator.fits_onset())
    m.notes.push_back(
        "too few close pairs: the correlation radius is half the smallest distance, too large by an unknown "
        "part");
  estimator.set_pairs(kPairStep * a);
  const Sample whole_sample = estimator.sample(all);

  // The bootstrap.
  std::mt19937_64 random(o.seed);
  std::vector<Sample> samples;
  for (int i = 0; i < o.resamples; ++i) {
    std::vector<int> draw;
    for (size_t k = 0; k < all.size(); ++k) draw.push_back(int(random() % all.size()));
    Sample s = estimator.sample(draw);
    if (s.density > 0 && s.sizes.mean > 0) samples.push_back(std::move(s));
  }
  const double blocks = double(all.size());
  const double t = blocks > 1 ? boost::math::quantile(boost::math::students_t(blocks - 1), 0.975) : 0;
  const auto error = [&](const auto& get) {
    if (blocks < 2 || samples.size() < 20) return 0.0;
    std::vector<double> v;
    for (const Sample& s : samples) v.push_back(get(s));
    return spread(std::move(v)) * std::sqrt(blocks / (blocks - 1));
  };
  const auto estimate = [&](double value, const auto& get, double most = INFINITY) {
    const double half = t * error(get);
    return Estimate{value, std::max(value - half, 0.0), std::min(value + half, most)};
  };
  if (blocks < 2) m.notes.push_back("too few particles for intervals: they are left empty");
  m.shape_fraction = estimate(
      whole_sample.covered, [](const Sample& s) { return s.covered; }, 1);
  // The bootstrap knows the relative error of the density away from the frame; it is taken for that of all.
  const double relative = density / whole_sample.density;
  m.density = estimate(density, [&](const Sample& s) { return s.density * relative; });
  const auto radius_of = [&](const Sample& s) { return m.correlation_radius_given ? a : 0.5 * s.onset; };
  m.correlation_radius = m.correlation_radius_given ? Estimate{a, a, a} : estimate(a, radius_of);
  m.area_fraction = estimate(density * kPi * a * a, [&](const Sample& s) {
    return s.density * relative * kPi * radius_of(s) * radius_of(s);
  });
  m.mean_radius = estimate(whole_sample.sizes.mean, [](const Sample& s) { return s.sizes.mean; });
  m.deviation = estimate(whole_sample.sizes.deviation, [](const Sample& s) { return s.sizes.deviation; });
  m.log_deviation =
      estimate(whole_sample.sizes.log_deviation, [](const Sample& s) { return s.sizes.log_deviation; });
  for (size_t q = 0; q < std::size(kQuantiles); ++q)
    m.quantiles.push_back(
        estimate(whole_sample.sizes.quantiles[q], [q](const Sample& s) { return s.sizes.quantiles[q]; }));
  for (size_t i = 0; i < whole_sample.g.size(); ++i) {
    m.pair_correlation.x.push_back((double(i) + 0.5) * kPairStep);
    m.pair_correlation.value.push_back(whole_sample.g[i]);
    m.pair_correlation.error.push_back(error([i](const Sample& s) { return s.g[i]; }));
  }
  double side = INFINITY;
  for (const PointField& f : points) side = std::min({side, f.columns * f.cell_x, f.rows * f.cell_y});
  const double step = std::max(0.1, 2 * kPi * a / side);
  if (step < 1) {
    const RingMeans rings = structure_factor_of(points, step / a, int(kLargestU / step));
    for (const double q : rings.q) m.structure_factor.x.push_back(q * a);
    m.structure_factor.value = rings.value, m.structure_factor.error = rings.error;
  } else {
    m.notes.push_back("the fields are too small, relative to the particles, for a structure factor");
  }
  classify_shapes(m);
  return m;
}

}  // namespace aureole
