// SPDX-License-Identifier: Apache-2.0
// The fraction of the light that a microfacet surface scatters once, and the rest, which single-scattering
// models lose: light reflected towards other facets.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "aureole/bsdf/microfacet/microfacet.h"
#include "aureole/core/table_fields.h"

namespace aureole {

/// Fractions of the light from a direction that leave the surface after one scattering.
struct ScatteredEnergy {
  double reflected = 0, transmitted = 0;
};

/// Computes these fractions for an interface by quadrature over `points` visible normals; eta is the index
/// beyond over the index on the side of wi (wi.z > 0).
ScatteredEnergy scattered_energy(const Microfacets& d, const Vec3& wi, float eta, int points);
/// Computes the fraction for facets that reflect all light.
double mirrored_energy(const Microfacets& d, const Vec3& wi, int points);
/// Returns both fractions for diffuse light: the cosine-weighted mean of `scattered_energy`.
ScatteredEnergy diffuse_scattered_energy(const Microfacets& d, float eta);

/// Reads the parameter `energy_preserving`. Its default is that of the scene, else false.
bool read_energy_preserving(const Properties& properties);
/// Whether the scene file states whether light may be lost by single scattering.
bool states_energy_preserving(const Properties& properties);

/// The fraction of diffuse light that an interface loses by single scattering, computed on demand.
class DiffuseLoss {
public:
  /// Returns the lost fraction. `eta`: index within over index outside. All calls of an object must have
  /// equal arguments.
  double operator()(const Microfacets& d, float eta, bool from_within) const;

private:
  /// known fractions from outside and from within; negative: not computed yet
  mutable std::atomic<float> known_[2] = {-1.f, -1.f};
};

/// The lost fraction 1 - E(w), tabulated over the direction, the surface's roughnesses and the index of
/// refraction.
class LossTable {
public:
  /// Computes E(wi) by quadrature with `points` points.
  using Energy = std::function<double(const Microfacets&, const Vec3& wi, float eta, int points)>;

  LossTable() = default;
  static constexpr TableKind kTable{"energy loss of a rough surface", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.u_, self.v_, self.isotropic_, self.rows_, self.azimuths_, self.etas_, self.inverse_step_,
        self.loss_, self.mass_below_);
  }
  /// `etas`: equidistant nodes; a single one if the index does not depend on the wavelength.
  LossTable(const Roughness& roughness, std::vector<float> etas, const Energy& energy);

  /// The position of a roughness in the table.
  struct Place {
    int count = 0, row[4] = {};  ///< rows of up to four neighbouring roughnesses
    float weight[4] = {};
    float u2 = 0, v2 = 0, smaller = 0,
          /// inverse range of the squared roughnesses, for the roughness along the direction
        inverse_span = 0;
  };
  Place locate(const Microfacets& d) const;

  /// Returns 1 - E(w) for w.z >= 0: a float for one index, or one value per wavelength for its index.
  template <class T>
  T loss(const Place& place, const Vec3& w, const T& eta) const {
    const Cell mu = cell(std::sqrt(std::min(w.z, 1.f)) * (kCosines - 1), kCosines);
    const Cell azimuth = azimuths_ > 1 ? azimuth_cell(place, w) : Cell{};
    return over_indices(eta, [&](int e) {
      float sum = 0;
      for (int k = 0; k < place.count; ++k) {
        const float* line =
            &loss_[std::size_t((e * rows_ + place.row[k]) * azimuths_ + azimuth.index) * kCosines];
        float value = interpolate(line, mu);
        if (azimuths_ > 1) value += (interpolate(line + kCosines, mu) - value) * azimuth.fraction;
        sum += value * place.weight[k];
      }
      return sum;
    });
  }
  /// Returns the cosine-weighted mean of the loss over the hemisphere.
  template <class T>
  T average(const Place& place, const T& eta) const {
    return over_indices(eta, [&](int e) { return mass_below(place, e, kCosines - 1); });
  }
  /// Samples a direction with z > 0, with density loss(w) w.z/(pi average) up to steps of the table's cells.
  Vec3 sample(const Place& place, float eta, Vec2 u) const;
  /// Returns the density of `sample` over the density of `square_to_cosine_hemisphere`.
  template <class T>
  T density_over_cosine(const Place& place, float cos_theta, const T& eta) const {
    const int c = cell(std::sqrt(std::min(cos_theta, 1.f)) * (kCosines - 1), kCosines).index;
    const T all = average(place, eta), part = over_indices(eta, [&](int e) {
                                         return mass_below(place, e, c + 1) - mass_below(place, e, c);
                                       });
    return part / (all + 1e-12f) * (1 / (squared_cosine(c + 1) - squared_cosine(c)));
  }
  /// Interpolates f(node) over the nodes of the index.
  template <class T, class F>
  T over_indices(const T& eta, F&& f) const {
    // Piecewise linear: the first value, plus for every cell its difference times the clamped position in it.
    float last = f(0);
    T sum(last);
    for (int e = 1; e < int(etas_.size()); ++e) {
      const float next = f(e);
      sum = sum + clamp_unit((eta - etas_[std::size_t(e - 1)]) * inverse_step_) * (next - last);
      last = next;
    }
    return sum;
  }

private:
  static constexpr int kCosines = 64;  ///< nodes are uniform in sqrt(cos theta), dense near grazing angles

  struct Cell {
    int index = 0;
    float fraction = 0;
  };
  static Cell cell(float position, int nodes) {
    const int i = std::clamp(int(position), 0, nodes - 2);
    return {i, position - float(i)};
  }
  static float interpolate(const float* line, const Cell& c) {
    return line[c.index] + (line[c.index + 1] - line[c.index]) * c.fraction;
  }
  static float clamp_unit(float x) { return std::clamp(x, 0.f, 1.f); }
  static Spectrum clamp_unit(const Spectrum& x) { return min(max(x, 0.f), 1.f); }

  /// Nodes in the roughness along one axis, dense where it is small.
  struct Axis {
    float min = 0, range = 0;
    int nodes = 1;
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.min, self.range, self.nodes);
    }
    float node(int i) const {
      return min + (nodes > 1 ? range * float(i * i) / float((nodes - 1) * (nodes - 1)) : 0);
    }
    Cell locate(float alpha) const {
      if (nodes == 1) return {};
      return cell(std::sqrt(std::clamp((alpha - min) / range, 0.f, 1.f)) * float(nodes - 1), nodes);
    }
  };

  /// The loss at an azimuth depends mostly on the roughness along it, which is the table's coordinate; nodes
  /// are spaced as for a roughness.
  Cell azimuth_cell(const Place& p, const Vec3& w) const {
    const float x2 = w.x * w.x, y2 = w.y * w.y, r2 = x2 + y2;
    const float alpha = r2 > 0 ? std::sqrt((p.u2 * x2 + p.v2 * y2) / r2) : p.smaller;
    const float t = std::sqrt(std::clamp((alpha - p.smaller) * p.inverse_span, 0.f, 1.f));
    return cell(t * float(azimuths_ - 1), azimuths_);
  }
  Vec2 azimuth_of_node(const Microfacets& d, int node) const;
  static float squared_cosine(int node) {
    const float t = float(node) / (kCosines - 1);
    return t * t * t * t;
  }
  /// Returns the contribution to the average below a node of the cosine.
  float mass_below(const Place& place, int e, int node) const {
    float sum = 0;
    for (int k = 0; k < place.count; ++k)
      sum += mass_below_[std::size_t((e * rows_ + place.row[k]) * kCosines + node)] * place.weight[k];
    return sum;
  }
  void tabulate_masses(const std::vector<Microfacets>& rows);

  Axis u_, v_;
  bool isotropic_ = true;
  int rows_ = 0, azimuths_ = 1;
  std::vector<float> etas_;
  float inverse_step_ = 0;
  std::vector<float> loss_;        // lost fractions by [eta][alpha_u][alpha_v][azimuth][cosine]
  std::vector<float> mass_below_;  // contributions by [eta][alpha_u][alpha_v][cosine]
};

}  // namespace aureole
