// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/scattered_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <map>
#include <numeric>

#include "aureole/bsdf/measured/half_vector_square.h"
#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/parallel.h"
#include "aureole/pigment/samples.h"
#include "aureole/pigment/text_table.h"

namespace aureole {
namespace {

constexpr int kTableWidth = 72, kTableHeight = 49;
constexpr std::size_t kMaxScatteredChannels = 2048;

/// Linear interpolation among scattered points of the plane.
class Triangulation {
public:
  explicit Triangulation(std::vector<Vec2> points) : points_(std::move(points)) {
    // Boost's sweep works on integers; 2^24 steps of the unit are finer than single precision.
    std::vector<boost::polygon::point_data<std::int32_t>> sites;
    for (const Vec2& p : points_)
      sites.emplace_back(std::int32_t(std::lround(p.x * 0x1p24)), std::int32_t(std::lround(p.y * 0x1p24)));
    boost::polygon::voronoi_diagram<double> diagram;
    boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
    // A vertex of the Voronoi diagram is the centre of a triangle, or of a polygon of points on one circle.
    for (const auto& vertex : diagram.vertices()) {
      std::vector<std::uint32_t> around;
      const auto* edge = vertex.incident_edge();
      do {
        around.push_back(std::uint32_t(edge->cell()->source_index()));
        edge = edge->rot_next();
      } while (edge != vertex.incident_edge());
      for (std::size_t k = 1; k + 1 < around.size(); ++k) add_triangle(around[0], around[k], around[k + 1]);
    }
    fill_cells();
  }
  bool empty() const { return triangles_.empty(); }

  /// Three points and their weights; outside of the triangulation the nearest point.
  struct Weights {
    std::uint32_t point[3];
    float weight[3];
  };
  Weights at(Vec2 p) const {
    for (const std::uint32_t k : cells_[cell_of(p)]) {
      const Triangle& t = triangles_[k];
      const float b = (p.x - t.origin.x) * t.to_b.x + (p.y - t.origin.y) * t.to_b.y,
                  c = (p.x - t.origin.x) * t.to_c.x + (p.y - t.origin.y) * t.to_c.y;
      if (b >= -1e-4f && c >= -1e-4f && b + c <= 1.0001f) return {{t.a, t.b, t.c}, {1 - b - c, b, c}};
    }
    std::uint32_t nearest = 0;
    float distance = 1e30f;
    for (std::uint32_t k = 0; k < points_.size(); ++k) {
      const Vec2 d = points_[k] - p;
      if (dot(d, d) < distance) distance = dot(d, d), nearest = k;
    }
    return {{nearest, nearest, nearest}, {1, 0, 0}};
  }

private:
  struct Triangle {
    std::uint32_t a, b, c;
    Vec2 origin, to_b, to_c;  ///< barycentric coordinates are products with p - origin
  };
  static constexpr int kCells = 64;

  static std::size_t cell_of(Vec2 p) {
    const auto index = [](float x) { return std::clamp(int((x + 1) * (0.5f * kCells)), 0, kCells - 1); };
    return std::size_t(index(p.y) * kCells + index(p.x));
  }
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vec2 p = points_[a], u = points_[b] - p, v = points_[c] - p;
    const float area = u.x * v.y - u.y * v.x;
    if (!(std::abs(area) > 1e-12f)) return;
    triangles_.push_back({a, b, c, p, Vec2{v.y, -v.x} * (1 / area), Vec2{-u.y, u.x} * (1 / area)});
  }
  void fill_cells() {
    cells_.resize(kCells * kCells);
    for (std::uint32_t k = 0; k < triangles_.size(); ++k) {
      const Triangle& t = triangles_[k];
      const Vec2 a = points_[t.a], b = points_[t.b], c = points_[t.c];
      const std::size_t low = cell_of({std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})}),
                        high = cell_of({std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})});
      for (std::size_t y = low / kCells; y <= high / kCells; ++y)
        for (std::size_t x = low % kCells; x <= high % kCells; ++x) cells_[y * kCells + x].push_back(k);
    }
  }

  std::vector<Vec2> points_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

/// Key of an angle: angles within a hundredth of a degree are equal.
long angle_key(double degrees) { return std::lround(100 * degrees); }

double wrapped_degrees(double phi) { return phi - 360 * std::floor(phi / 360); }

}  // namespace

ScatteredMeasurements read_scattered_measurements(const std::filesystem::path& path, bool has_cosine) {
  const std::string name = path.string();
  std::istringstream stream = read_table_file(path);
  try {
    const std::vector<pigment::TextRow> rows = pigment::read_text_table(stream);
    if (rows.size() < 2) throw Error({name, 0, 0}, "a heading and rows of measured directions are expected");
    ScatteredMeasurements m;
    int columns[4] = {-1, -1, -1, -1};  // indices of the columns theta_i, phi_i, theta_o, phi_o
    int rgb[3] = {-1, -1, -1};
    std::vector<std::pair<double, std::size_t>> wavelengths;
    std::vector<std::size_t> value_columns;
    std::map<std::string, std::size_t> error_columns;  // by the heading of the value
    for (std::size_t c = 0; c < rows[0].cells.size(); ++c) {
      std::string heading = lower_case(rows[0].cells[c].text);
      constexpr const char* kAngles[4] = {"theta_i", "phi_i", "theta_o", "phi_o"};
      const auto angle = std::find(std::begin(kAngles), std::end(kAngles), heading);
      if (angle != std::end(kAngles)) {
        columns[angle - kAngles] = int(c);
      } else if (heading.starts_with("u(") && heading.ends_with(")")) {
        error_columns[heading.substr(2, heading.size() - 3)] = c;
      } else if (heading == "r" || heading == "g" || heading == "b") {
        rgb[heading == "r" ? 0 : heading == "g" ? 1 : 2] = int(c);
      } else if (heading == "f") {
        value_columns = {c};
      } else {
        if (heading.ends_with("nm")) heading.resize(heading.size() - 2);
        const auto nm = pigment::finite_number(heading);
        if (!nm || !(*nm > 0))
          throw Error(
              {name, rows[0].line, rows[0].cells[c].column},
              fmt::format(
                  "unknown column \"{}\"; theta_i, phi_i, theta_o, phi_o, wavelengths such as 550nm, or r, g "
                  "and b, or f are known, and standard uncertainties such as u(550nm)",
                  rows[0].cells[c].text.substr(0, 40)));
        wavelengths.emplace_back(*nm, c);
      }
    }
    if (columns[0] < 0 || columns[2] < 0)
      throw Error({name, rows[0].line, 1}, "there is no column theta_i or theta_o");
    if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0)
      value_columns = {std::size_t(rgb[0]), std::size_t(rgb[1]), std::size_t(rgb[2])};
    if (!wavelengths.empty()) {
      std::sort(wavelengths.begin(), wavelengths.end());
      value_columns.clear();
      for (const auto& [nm, c] : wavelengths) {
        if (!m.nm.empty() && nm == m.nm.back())
          throw Error({name, rows[0].line, rows[0].cells[c].column},
                      fmt::format("there are two columns of {:g} nm", nm));
        m.nm.push_back(nm), value_columns.push_back(c);
      }
    }
    m.channels = value_columns.size();
    if (m.channels == 0 || m.channels > kMaxScatteredChannels)
      throw Error({name, rows[0].line, 1},
                  fmt::format("there are {} columns of values; one to {} are expected", m.channels,
                              kMaxScatteredChannels));
    std::vector<std::size_t> uncertainties;
    for (const std::size_t c : value_columns) {
      std::string heading = lower_case(rows[0].cells[c].text);
      if (const auto at = error_columns.find(heading); at != error_columns.end())
        uncertainties.push_back(at->second);
    }
    if (!error_columns.empty() &&
        (uncertainties.size() != value_columns.size() || error_columns.size() != value_columns.size()))
      throw Error(
          {name, rows[0].line, 1},
          fmt::format(
              "{} columns of uncertainties, of which {} belong to values, stand beside {} columns of values",
              error_columns.size(), uncertainties.size(), value_columns.size()));
    for (std::size_t r = 1; r < rows.size(); ++r) {
      const pigment::TextRow& row = rows[r];
      if (row.cells.size() != rows[0].cells.size())
        throw Error({name, row.line, 1}, fmt::format("there are {} cells under {} headings", row.cells.size(),
                                                     rows[0].cells.size()));
      const auto angle = [&](int k) {
        return columns[k] < 0 ? 0.0 : pigment::number_of(row, std::size_t(columns[k]));
      };
      const ScatteredMeasurements::Direction d{angle(0), wrapped_degrees(angle(1)), angle(2),
                                               wrapped_degrees(angle(3)), row.line};
      if (!(d.theta_i >= 0 && d.theta_i < 90))
        throw Error({name, row.line, 1},
                    fmt::format("theta_i is {:g}; 0 to below 90 degrees are expected", d.theta_i));
      if (!(d.theta_o >= 0 && d.theta_o <= 180))
        throw Error({name, row.line, 1},
                    fmt::format("theta_o is {:g}; 0 to 180 degrees are expected", d.theta_o));
      const double cosine = std::abs(std::cos(d.theta_o * kDegree));
      if (cosine < 1e-4) continue;  // no radiance can be measured along the surface, at 90 degrees
      for (const std::size_t c : value_columns) {
        double value = pigment::number_of(row, c);
        if (has_cosine) value /= cosine;
        if (value > 1e30)
          throw Error({name, row.line, row.cells[c].column}, "the value is no scattering per steradian");
        if (value < 0) value = 0, ++m.negative;
        m.values.push_back(float(value));
      }
      for (const std::size_t c : uncertainties) {
        const double error = pigment::number_of(row, c) / (has_cosine ? cosine : 1);
        if (!(error >= 0 && error < 1e30))
          throw Error({name, row.line, row.cells[c].column}, "a standard uncertainty is positive");
        m.errors.push_back(float(error));
      }
      m.directions.push_back(d);
    }
    return m;
  } catch (const pigment::TextError& e) {
    throw Error({name, e.line(), e.column()}, e.what());
  }
}

ScatteredTable::ScatteredTable(const ScatteredMeasurements& measured, bool transmitted,
                               const std::string& file, const SpectralGrid& grid) {
  // Measurements grouped by direction of incidence.
  std::map<std::pair<long, long>, std::vector<std::size_t>> groups;  // keys are phi_i, theta_i
  std::map<long, double> azimuths, angles;
  for (std::size_t k = 0; k < measured.directions.size(); ++k) {
    const auto& d = measured.directions[k];
    if ((d.theta_o > 90) != transmitted) continue;
    // At normal incidence phi_i is the orientation of the sample.
    groups[{angle_key(d.phi_i), angle_key(d.theta_i)}].push_back(k);
    azimuths[angle_key(d.phi_i)] = d.phi_i, angles[angle_key(d.theta_i)] = d.theta_i;
  }
  if (groups.empty()) return;
  is_isotropic_ = azimuths.size() == 1;
  for (const auto& [phi_key, phi] : azimuths)
    for (const auto& [theta_key, theta] : angles)
      if (!groups.contains({phi_key, theta_key}))
        throw Error(
            {file, 0, 0},
            fmt::format("no measurement has theta_i {:g} and phi_i {:g}; all azimuths of incidence need the "
                        "same angles",
                        theta, phi));
  const bool is_spectral = !measured.nm.empty();
  std::vector<float> nm(measured.nm.begin(), measured.nm.end());
  if (is_spectral) wavelengths_ = SpectralNodes(grid, nm);
  stride_ = is_spectral ? wavelengths_.count() : measured.channels;
  for (const auto& [key, theta] : angles) nodes_.second.push_back(float(theta * kDegree));
  std::vector<long> phi_keys;
  if (is_isotropic_) {
    nodes_.first = {0}, phi_keys = {azimuths.begin()->first};
  } else {
    // A full circle from -180 degrees on: the azimuths from 180 degrees come first, and both ends are repeated.
    for (const auto& [key, phi] : azimuths)
      nodes_.first.push_back(float((phi > 180 ? phi - 360 : phi) * kDegree)), phi_keys.push_back(key);
    std::vector<std::size_t> order(phi_keys.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return nodes_.first[a] < nodes_.first[b]; });
    std::vector<float> phi = {nodes_.first[order.back()] - 2 * kPi};
    std::vector<long> keys = {phi_keys[order.back()]};
    for (const std::size_t k : order) phi.push_back(nodes_.first[k]), keys.push_back(phi_keys[k]);
    phi.push_back(nodes_.first[order.front()] + 2 * kPi), keys.push_back(phi_keys[order.front()]);
    nodes_.first = phi, phi_keys = keys;
  }
  const std::size_t area = kTableWidth * kTableHeight;
  if (double(nodes_.count()) * double(area * stride_) > 3e8)
    throw Error({file, 0, 0},
                fmt::format("{} directions of incidence with {} wavelengths need more than 1.2 GB",
                            nodes_.count(), stride_));
  values_.resize(nodes_.count() * area * stride_);
  std::vector<long> theta_keys;
  for (const auto& [key, theta] : angles) theta_keys.push_back(key);
  // Doubles half of the azimuths, which were measured on a sample that is symmetric about the plane of
  // incidence.
  if (is_isotropic_) {
    was_mirrored_ = true;
    bool leaves_plane = false;
    for (const auto& [key, list] : groups)
      for (const std::size_t k : list) {
        const double relative = wrapped_degrees(measured.directions[k].phi_o - measured.directions[k].phi_i);
        if (relative > 180.01) was_mirrored_ = false;
        leaves_plane |= relative > 0.01 && relative < 179.99;
      }
    was_mirrored_ &= leaves_plane;
  }
  const auto fill = [&](std::size_t slice) {
    const std::size_t i = slice / nodes_.second.size(), j = slice % nodes_.second.size();
    const std::vector<std::size_t>& list = groups.at({phi_keys[i], theta_keys[j]});
    std::vector<Vec2> points;
    std::vector<std::size_t> sources;
    const auto add = [&](const ScatteredMeasurements::Direction& d, double phi, std::size_t source) {
      const double sine = std::sin(d.theta_o * kDegree);
      points.push_back({float(sine * std::cos(phi * kDegree)), float(sine * std::sin(phi * kDegree))});
      sources.push_back(source);
    };
    for (const std::size_t k : list) {
      const auto& d = measured.directions[k];
      // Azimuths of isotropic tables are relative to the azimuth of the incident direction.
      const double phi = is_isotropic_ ? d.phi_o - d.phi_i : d.phi_o;
      add(d, phi, k);
      if (was_mirrored_ && std::sin(d.theta_o * kDegree) * std::abs(std::sin(phi * kDegree)) > 1e-6)
        add(d, -phi, k);
    }
    const int line = measured.directions[list.front()].line;
    if (points.size() < 3)
      throw Error({file, line, 0},
                  fmt::format("theta_i {:g} has {} outgoing directions; three or more are needed",
                              measured.directions[list.front()].theta_i, points.size()));
    const Triangulation triangles(points);
    if (triangles.empty())
      throw Error({file, line, 0},
                  fmt::format("all outgoing directions of theta_i {:g} lie in one plane; a surface needs "
                              "directions outside of the plane of incidence",
                              measured.directions[list.front()].theta_i));
    const float theta = nodes_.second[j], phi = is_isotropic_ ? 0.f : nodes_.first[i];
    const Vec3 wi{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    for (int y = 0; y < kTableHeight; ++y)
      for (int x = 0; x < kTableWidth; ++x) {
        const Vec3 m = square_to_half_vector({float(x) / (kTableWidth - 1), float(y) / (kTableHeight - 1)});
        const Vec3 wo = 2 * dot(m, wi) * m - wi;
        // Directions below the surface take the values at the horizon.
        Vec2 p{wo.x, wo.y};
        if (!(wo.z > 0)) p = p * (1 / std::max(std::sqrt(dot(p, p)), 1e-6f));
        const Triangulation::Weights w = triangles.at(p);
        float* to = values_.data() + (slice * area + std::size_t(y * kTableWidth + x)) * stride_;
        for (std::size_t c = 0; c < stride_; ++c) {
          const std::size_t channel = is_spectral ? wavelengths_.source(c) : c;
          for (int k = 0; k < 3; ++k)
            to[c] += std::max(w.weight[k], 0.f) *
                     measured.values[sources[w.point[k]] * measured.channels + channel];
        }
      }
  };
  for_ranges(
      nodes_.count(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t slice = begin; slice < end; ++slice) fill(slice);
      },
      1);
}

template <class Visit>
void ScatteredTable::visit_nodes(const Vec3& wi, const Vec3& wo, Visit&& visit) const {
  const float sine = std::sqrt(wi.x * wi.x + wi.y * wi.y);
  const SliceBlend blend = nodes_.at(is_isotropic_ ? 0.f : azimuth_of(wi), angle_above_axis(sine, wi.z));
  Vec3 m = normalize(wi + wo);
  if (is_isotropic_ && sine > 0) {
    const float c = wi.x / sine, s = wi.y / sine;
    m = {m.x * c + m.y * s, m.y * c - m.x * s, m.z};
  }
  const Vec2 p = half_vector_to_square(m);
  const GridCell x(p.x, kTableWidth), y(p.y, kTableHeight);
  for (int k = 0; k < blend.count; ++k)
    for (int corner = 0; corner < 4; ++corner) {
      const float weight = blend.weight[std::size_t(k)] * (corner & 1 ? x.fraction : 1 - x.fraction) *
                           (corner & 2 ? y.fraction : 1 - y.fraction);
      const std::size_t row = std::size_t(y.index + (corner >> 1)),
                        column = std::size_t(x.index + (corner & 1));
      visit(values_.data() +
                ((blend.slice[std::size_t(k)] * kTableHeight + row) * kTableWidth + column) * stride_,
            weight);
    }
}

Spectrum ScatteredTable::spectrum(const Vec3& wi, const Vec3& wo, const Wavelengths& w) const {
  const SpectralNodes::Place place = wavelengths_.at(w);
  SpectralSum sum(place);
  visit_nodes(wi, wo, [&](const float* node, float weight) { sum.add(node, weight); });
  return sum.value();
}

std::array<float, 3> ScatteredTable::colour(const Vec3& wi, const Vec3& wo) const {
  std::array<float, 3> sum{};
  visit_nodes(wi, wo, [&](const float* node, float weight) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * node[stride_ == 3 ? c : 0];
  });
  return sum;
}

float ScatteredTable::mean(const Vec3& wi, const Vec3& wo) const {
  float sum = 0;
  visit_nodes(wi, wo, [&](const float* node, float weight) {
    for (std::size_t c = 0; c < stride_; ++c) sum += weight * node[c];
  });
  return sum / float(stride_);
}

}  // namespace aureole
