// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/film_theory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>
#include <span>
#include <stdexcept>
#include <vector>

#include "aureole/optics/stack/plane_stack.h"
#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {
namespace {

/// Value and derivatives of R = 1/(a + b coth(b S)) and T^2 enter through R over a substrate Rg:
///     R = (1 - Rg (a - c))/(a + c - Rg),  a = 1 + K/S,  b^2 = a^2 - 1,  c = b coth(b S)  (Kubelka 1948, (16)).
FilmValue two_flux_over(double ln_k, double ln_s, double substrate) {
  const double k = std::exp(ln_k), s = std::exp(ln_s), ratio = k / s;
  const double a = 1 + ratio, b = std::sqrt(ratio * (2 + ratio)), z = b * s;
  // c = b coth(b S) with its derivatives by the ratio K/S at fixed S, and by ln S at a fixed ratio.
  double c, c_by_ratio, c_by_ln_s;
  if (z < 1e-3) {
    // Series for small z = b S: c = 1/S + z b/3 + ..., where z b = b^2 S.
    c = 1 / s + b * z / 3;
    c_by_ratio = 2 * a * s / 3;
    c_by_ln_s = -1 / s + b * z / 3;
  } else {
    const double coth = 1 / std::tanh(z), csch2 = z > 300 ? 0 : 1 / (std::sinh(z) * std::sinh(z));
    c = b * coth;
    c_by_ratio = (coth - z * csch2) * a / b;  // db/dratio = a/b
    c_by_ln_s = -b * z * csch2;
  }
  const double top = 1 - substrate * (a - c), bottom = a + c - substrate;
  const double value = top / bottom;
  const double by_a = (-substrate - value) / bottom, by_c = (substrate - value) / bottom;
  FilmValue result;
  result.value = value;
  result.by_ln_k = (by_a + by_c * c_by_ratio) * ratio;
  result.by_ln_s = -result.by_ln_k + by_c * c_by_ln_s;
  result.by_substrate = (value - (a - c)) / bottom;
  return result;
}

class TwoFlux final : public FilmTheory {
public:
  explicit TwoFlux(const Surface& surface) : surface_(surface) {}

  std::string name() const override { return "two fluxes"; }

  double card(double measured) const override {
    const double body = std::max(0.0, measured - surface_.seen);
    return std::min(1.0, body / (surface_.through + surface_.k2 * body));
  }

  FilmValue over(const FilmLayer& layer, double substrate) const override {
    return seen(two_flux_over(layer.ln_k, layer.ln_s, substrate));
  }

  FilmValue opaque(const FilmLayer& layer) const override {
    const double ratio = std::exp(std::min(layer.ln_k - layer.ln_s, 40.0)),
                 root = std::sqrt(ratio * (2 + ratio));
    FilmValue r;
    r.value = 1 / (1 + ratio + root);
    r.by_ln_k = -r.value * ratio / root;
    r.by_ln_s = -r.by_ln_k;
    return seen(r);
  }

  FilmLight light(const FilmLayer& of) const override {
    // With an inner reflectance Rg of the card, R = R0 + T^2 Rg/(1 - R0 Rg) and the outer one is seen + through R/(1 - k2 R).
    const LayerTransfer t = layer({std::exp(of.ln_k), std::exp(of.ln_s)}, 1);
    const double open = 1 - surface_.k2 * t.reflectance, t2 = t.transmittance * t.transmittance;
    return {surface_.seen + surface_.through * t.reflectance / open, surface_.through * t2 / (open * open),
            t.reflectance + surface_.k2 * t2 / open};
  }

  FilmValue free_reflectance(const FilmLayer& layer) const override { return free(layer, true); }
  FilmValue free_transmittance(const FilmLayer& layer) const override { return free(layer, false); }

private:
  FilmValue seen(FilmValue r) const {
    const double left = 1 - surface_.k2 * r.value, slope = surface_.through / (left * left);
    r.value = surface_.seen + surface_.through * r.value / left;
    r.by_ln_k *= slope, r.by_ln_s *= slope, r.by_substrate *= slope;
    return r;
  }

  double free_value(double ln_k, double ln_s, bool reflected) const {
    const LayerTransfer t = outer_transfer(surface_, layer({std::exp(ln_k), std::exp(ln_s)}, 1));
    return reflected ? t.reflectance : t.transmittance;
  }

  FilmValue free(const FilmLayer& layer, bool reflected) const {
    constexpr double kStep = 1e-4;
    const double ln_k = layer.ln_k, ln_s = layer.ln_s;
    FilmValue r;
    r.value = free_value(ln_k, ln_s, reflected);
    r.by_ln_k =
        (free_value(ln_k + kStep, ln_s, reflected) - free_value(ln_k - kStep, ln_s, reflected)) / (2 * kStep);
    r.by_ln_s =
        (free_value(ln_k, ln_s + kStep, reflected) - free_value(ln_k, ln_s - kStep, reflected)) / (2 * kStep);
    return r;
  }

  Surface surface_;
};

/// A film over a Lambertian card of inner reflectance r reflects body + down r up/(1 - inside r).
struct FilmParts {
  double body = 0;    ///< light that never reached the card
  double down = 0;    ///< fraction of the incident light that arrives at the card
  double up = 0;      ///< fraction of the card's diffuse light that the instrument receives
  double inside = 0;  ///< fraction of the card's diffuse light that returns to the card
};

class Streams final : public FilmTheory {
public:
  Streams(const StreamsSettings& settings, const ParallelFor& threads) : settings_(settings) {
    if (!(settings.index >= 1 && settings.index <= 4))
      throw std::domain_error("the binder's index must be in [1, 4]");
    if (!(std::abs(settings.g) <= 0.95)) throw std::domain_error("the mean cosine must be in [-0.95, 0.95]");
    if (settings.varies_g) {
      // Mean cosines of the tables, as steps of ln(1 - g) from the g of the settings.
      const double isotropy = 1 - settings.g;
      tables_.first_g = -std::min(kMostSteps, int(std::log(isotropy / kLeastIsotropy) / kStepG));
      tables_.last_g = std::min(kMostSteps, int(std::log(kMostIsotropy / isotropy) / kStepG));
    }
    tables_.nodes =
        tabulate(threads, [this](double k, double s, double g) { return logarithms(solve(k, s, g)); });
    // The parts without a film, by the interface alone.
    const FilmParts bare = solve(1e-9, 1e-9, settings_.g);
    tables_.bare = bare.down * bare.up, tables_.bare_inside = bare.inside;
    const auto reflected = [&] {
      optics::StackDescription stack;
      stack.layers = {{0, 0, 1, optics::LegendrePhase::isotropic(), settings.index}};
      stack.index_below = settings.index;
      return optics::PlaneStack(stack, {settings.streams}).fluxes(light()).unscattered_reflectance;
    };
    tables_.gloss = settings.specular == Specular::included && settings.geometry != Geometry::angle_45_0
                        ? reflected()
                        : 0;
    for (int table = tables_.first_g; table <= tables_.last_g; ++table)
      for (int i = 0; i < kRatios; ++i)
        tables_.opaque.push_back(at_the_end(kFirstRatio + kStep * i, kStepG * table));
  }

  Streams(const StreamsSettings& settings, StreamsTables tables)
      : settings_(settings), tables_(std::move(tables)) {}
  const StreamsTables& tables() const { return tables_; }

  std::string name() const override { return "streams"; }
  std::optional<double> mean_cosine() const override {
    return settings_.varies_g ? std::optional(settings_.g) : std::nullopt;
  }

  std::optional<StreamsSettings> streams() const override { return settings_; }

  double card(double measured) const override {
    const double body = std::max(0.0, measured - tables_.gloss);
    return std::min(1.0, body / (tables_.bare + tables_.bare_inside * body));
  }

  FilmValue over(const FilmLayer& layer, double substrate) const override {
    const Interpolated p = at(layer, tables_.nodes);
    const double body = std::exp(p.value[0]), pass = std::exp(p.value[1] + p.value[2]), inside = p.value[3];
    const double left = 1 - inside * substrate, through = pass * substrate / left;
    const auto slope = [&](const std::array<double, 4>& d) {
      return body * d[0] + through * (d[1] + d[2] + substrate * d[3] / left);
    };
    return {tables_.gloss + body + through, slope(p.by_k), slope(p.by_s), pass / (left * left),
            slope(p.by_g)};
  }

  FilmValue opaque(const FilmLayer& layer) const override {
    const double ratio = layer.ln_k - layer.ln_s,
                 x = (std::clamp(ratio, kFirstRatio, kLastRatio) - kFirstRatio) / kStep;
    const int i = std::clamp(int(x), 0, kRatios - 2);
    double wx[4], dx[4];
    weights(x - i, wx, dx);
    FilmValue r;
    const auto add = [&](int table, double weight, double slope) {
      const double* of_table = tables_.opaque.data() + std::ptrdiff_t(table - tables_.first_g) * kRatios;
      for (int n = 0; n < 4; ++n) {
        const double value = of_table[std::clamp(i + n - 1, 0, kRatios - 1)];
        r.value += weight * wx[n] * value, r.by_ln_k += weight * dx[n] * value / kStep;
        r.by_g_shift += slope * wx[n] * value;
      }
    };
    if (tables_.first_g == tables_.last_g) {
      add(0, 1, 0);
    } else {
      const TablesOfG tables = tables_of(layer.g_shift);
      for (int n = 0; n < 4; ++n)
        add(tables.index[n], tables.weight[n], tables.is_within ? tables.slope[n] / kStepG : 0);
    }
    r.by_ln_s = -r.by_ln_k;  // the reflectance depends on K/S alone
    return r;
  }

  FilmLight light(const FilmLayer& layer) const override {
    std::array<double, 4> v{};
    if (tables_.first_g == tables_.last_g) {
      v = values(layer.ln_k, layer.ln_s, 0);
    } else {
      const TablesOfG tables = tables_of(layer.g_shift);
      for (int a = 0; a < 4; ++a) {
        if (tables.weight[a] == 0) continue;
        const std::array<double, 4> one = values(layer.ln_k, layer.ln_s, tables.index[a]);
        for (std::size_t c = 0; c < 4; ++c) v[c] += tables.weight[a] * one[c];
      }
    }
    return {tables_.gloss + std::exp(v[0]), std::exp(v[1] + v[2]), v[3]};
  }

  double opaque_value(const FilmLayer& layer) const override {
    const double x = (std::clamp(layer.ln_k - layer.ln_s, kFirstRatio, kLastRatio) - kFirstRatio) / kStep;
    const int i = std::clamp(int(x), 0, kRatios - 2);
    double wx[4], dx[4];
    weights(x - i, wx, dx);
    const auto row = [&](int table) {
      const double* of_table = tables_.opaque.data() + std::ptrdiff_t(table - tables_.first_g) * kRatios;
      double sum = 0;
      for (int a = 0; a < 4; ++a) sum += wx[a] * of_table[std::clamp(i + a - 1, 0, kRatios - 1)];
      return sum;
    };
    if (tables_.first_g == tables_.last_g) return row(0);
    const TablesOfG tables = tables_of(layer.g_shift);
    double value = 0;
    for (int a = 0; a < 4; ++a)
      if (tables.weight[a] != 0) value += tables.weight[a] * row(tables.index[a]);
    return value;
  }

  FilmValue free_reflectance(const FilmLayer& layer) const override { return free(layer, 0); }
  FilmValue free_transmittance(const FilmLayer& layer) const override { return free(layer, 1); }

private:
  static constexpr double kStep = 0.125, kFirstK = -11.5, kLastK = 5.5, kFirstS = -6.5, kLastS = 7.25;
  static constexpr int kAcross = int((kLastK - kFirstK) / kStep) + 1,
                       kDown = int((kLastS - kFirstS) / kStep) + 1;
  /// Step of ln(1 - g) between tables, the number of tables on each side of the g of the settings, and bounds
  /// of 1 - g.
  static constexpr double kStepG = 0.3, kLeastIsotropy = 0.05, kMostIsotropy = 1.3;
  static constexpr int kMostSteps = 4;
  /// Bounds of ln(K/S) in the table of opaque layers.
  static constexpr double kFirstRatio = kFirstK - kLastS, kLastRatio = kLastK - kFirstS;
  static constexpr int kRatios = int((kLastRatio - kFirstRatio) / kStep) + 1;

  using Node = std::array<float, 4>;  ///< ln body, ln down, ln up, and inside of `FilmParts`
  struct Interpolated {
    std::array<double, 4> value, by_k, by_s, by_g;
  };

  /// The table of a function of K, S and g.
  template <class Solve>
  std::vector<Node> tabulate(const ParallelFor& threads, const Solve& solve) const {
    std::vector<Node> nodes(std::size_t(tables_.last_g - tables_.first_g + 1) * kAcross * kDown);
    threads(
        nodes.size() / kDown,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t row = begin; row < end; ++row) {
            const int table = tables_.first_g + int(row / kAcross), i = int(row % kAcross);
            const double g = table == 0 ? settings_.g : 1 - (1 - settings_.g) * std::exp(kStepG * table);
            for (int j = 0; j < kDown; ++j)
              nodes[row * kDown + std::size_t(j)] =
                  solve(std::exp(kFirstK + kStep * i), std::exp(kFirstS + kStep * j), g);
          }
        },
        8);
    return nodes;
  }

  /// Logarithms of reflectance and transmittance of a free film.
  Node solve_free(double k, double s, double g) const {
    optics::StackDescription stack;
    stack.layers = {
        {k / 2, 4. / 3 * s / (1 - g), 1, optics::LegendrePhase::henyey_greenstein(g), settings_.index}};
    const bool at_normal = settings_.geometry == Geometry::angle_45_0,
               has_gloss = settings_.specular == Specular::included && !at_normal;
    const optics::PlaneStack solver(stack, {settings_.streams, true, at_normal ? 1 : 0});
    const optics::StackLight lights[] = {light(), at_normal ? optics::StackLight::beam(1) : light()};
    const auto fluxes = solver.fluxes(lights);
    double reflectance = fluxes[0].reflectance - (has_gloss ? 0 : fluxes[0].unscattered_reflectance);
    if (at_normal) {
      const double normal[] = {1}, azimuth[] = {0};
      reflectance = std::numbers::pi * solver.radiance(std::span(lights, 1), normal, azimuth)[0];
    }
    return logarithms({reflectance, fluxes[1].transmittance, 1, 0});
  }

  /// A free film's reflectance (`which` 0) or transmittance (1).
  FilmValue free(const FilmLayer& layer, std::size_t which) const {
    std::call_once(free_once_, [this] {
      // Without threads, since callers are parallel themselves: one that waits for threads could begin another caller's work.
      free_nodes_ =
          tabulate(serial_for, [this](double k, double s, double g) { return solve_free(k, s, g); });
    });
    const Interpolated p = at(layer, free_nodes_);
    FilmValue r;
    r.value = std::exp(p.value[which]);
    r.by_ln_k = r.value * p.by_k[which], r.by_ln_s = r.value * p.by_s[which];
    r.by_g_shift = r.value * p.by_g[which];
    return r;
  }

  /// Illumination of the instrument; by reciprocity d:8 is computed as 8:d.
  optics::StackLight light() const {
    switch (settings_.geometry) {
      case Geometry::diffuse_diffuse:
        return optics::StackLight::diffuse();
      case Geometry::diffuse_8:
        return optics::StackLight::beam(std::cos(8 * std::numbers::pi / 180));
      case Geometry::angle_45_0:
        return optics::StackLight::beam(std::numbers::sqrt2 / 2);
    }
    throw std::logic_error("no such geometry");
  }

  FilmParts solve(double k, double s, double g) const {
    optics::StackDescription stack;
    stack.layers = {
        {k / 2, 4. / 3 * s / (1 - g), 1, optics::LegendrePhase::henyey_greenstein(g), settings_.index}};
    stack.index_below = settings_.index;  // no interface below: the film is in contact with the card
    const bool at_normal = settings_.geometry == Geometry::angle_45_0;
    // Radiance along the normal has the azimuthal mode 0 only.
    const optics::PlaneStack solver(stack, {settings_.streams, true, at_normal ? 1 : 0});
    const optics::StackLight lights[] = {light(), optics::StackLight::diffuse(true)};
    const auto fluxes = solver.fluxes(lights);
    FilmParts parts{fluxes[0].reflectance - fluxes[0].unscattered_reflectance, fluxes[0].transmittance,
                    fluxes[1].transmittance, fluxes[1].reflectance};
    if (at_normal) {
      const double normal[] = {1}, azimuth[] = {0};
      const auto radiance = solver.radiance(lights, normal, azimuth);
      parts.body = std::numbers::pi * radiance[0], parts.up = std::numbers::pi * radiance[1];
    }
    return parts;
  }

  static Node logarithms(const FilmParts& p) {
    const auto ln = [](double x) { return float(std::log(std::max(x, 1e-30))); };
    return {ln(p.body), ln(p.down), ln(p.up), float(p.inside)};
  }

  /// Weights and their derivatives of Catmull and Rom's cubic through four neighbours.
  static void weights(double t, double w[4], double d[4]) {
    const double t2 = t * t, t3 = t2 * t;
    w[0] = 0.5 * (-t + 2 * t2 - t3), w[1] = 0.5 * (2 - 5 * t2 + 3 * t3);
    w[2] = 0.5 * (t + 4 * t2 - 3 * t3), w[3] = 0.5 * (-t2 + t3);
    d[0] = 0.5 * (-1 + 4 * t - 3 * t2), d[1] = 0.5 * (-10 * t + 9 * t2);
    d[2] = 0.5 * (1 + 8 * t - 9 * t2), d[3] = 0.5 * (-2 * t + 3 * t2);
  }

  /// Interpolates in the table of one mean cosine, `table` steps from the g of the settings.
  Interpolated at(double ln_k, double ln_s, int table, const std::vector<Node>& of) const {
    const double x = (std::clamp(ln_k, kFirstK, kLastK) - kFirstK) / kStep,
                 y = (std::clamp(ln_s, kFirstS, kLastS) - kFirstS) / kStep;
    const int i = std::clamp(int(x), 0, kAcross - 2), j = std::clamp(int(y), 0, kDown - 2);
    const Node* nodes = of.data() + std::size_t(table - tables_.first_g) * kAcross * kDown;
    double wx[4], dx[4], wy[4], dy[4];
    weights(x - i, wx, dx), weights(y - j, wy, dy);
    Interpolated r{};
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        const Node& node = nodes[std::size_t(std::clamp(i + a - 1, 0, kAcross - 1) * kDown +
                                             std::clamp(j + b - 1, 0, kDown - 1))];
        for (std::size_t c = 0; c < 4; ++c) {
          r.value[c] += wx[a] * wy[b] * double(node[c]);
          r.by_k[c] += dx[a] * wy[b] * double(node[c]) / kStep;
          r.by_s[c] += wx[a] * dy[b] * double(node[c]) / kStep;
        }
      }
    return r;
  }

  /// Reflectance of a layer with this ln(K/S) at the end of the tables, where it is opaque.
  double at_the_end(double ratio, double g_shift) const {
    const double ln_s = std::min(kLastS, kLastK - ratio);
    return over({ln_s + ratio, ln_s, g_shift}, 0).value;
  }

  /// The values of `at` alone.
  std::array<double, 4> values(double ln_k, double ln_s, int table) const {
    const double x = (std::clamp(ln_k, kFirstK, kLastK) - kFirstK) / kStep,
                 y = (std::clamp(ln_s, kFirstS, kLastS) - kFirstS) / kStep;
    const int i = std::clamp(int(x), 0, kAcross - 2), j = std::clamp(int(y), 0, kDown - 2);
    const Node* nodes = tables_.nodes.data() + std::size_t(table - tables_.first_g) * kAcross * kDown;
    double wx[4], wy[4], unused[4];
    weights(x - i, wx, unused), weights(y - j, wy, unused);
    std::array<double, 4> sum{};
    for (int a = 0; a < 4; ++a) {
      const Node* row = nodes + std::size_t(std::clamp(i + a - 1, 0, kAcross - 1) * kDown);
      std::array<double, 4> across{};
      for (int b = 0; b < 4; ++b) {
        const Node& node = row[std::clamp(j + b - 1, 0, kDown - 1)];
        for (std::size_t c = 0; c < 4; ++c) across[c] += wy[b] * double(node[c]);
      }
      for (std::size_t c = 0; c < 4; ++c) sum[c] += wx[a] * across[c];
    }
    return sum;
  }

  /// The tables next to a mean cosine, and their weights in a cubic polynomial.
  struct TablesOfG {
    int index[4];
    double weight[4], slope[4];
    bool is_within = true;  ///< whether the mean cosine is one of those tabulated
  };
  TablesOfG tables_of(double g_shift) const {
    const double wanted = g_shift / kStepG,
                 z = std::clamp(wanted, double(tables_.first_g), double(tables_.last_g));
    const int base = std::clamp(int(std::floor(z)), tables_.first_g, tables_.last_g - 1);
    TablesOfG t;
    weights(z - base, t.weight, t.slope);
    for (int a = 0; a < 4; ++a) t.index[a] = std::clamp(base + a - 1, tables_.first_g, tables_.last_g);
    t.is_within = z == wanted;
    return t;
  }

  Interpolated at(const FilmLayer& layer, const std::vector<Node>& of) const {
    if (tables_.first_g == tables_.last_g) return at(layer.ln_k, layer.ln_s, 0, of);
    const TablesOfG tables = tables_of(layer.g_shift);
    Interpolated r{};
    for (int a = 0; a < 4; ++a) {
      const double weight = tables.weight[a], slope = tables.slope[a];
      if (weight == 0 && slope == 0) continue;
      const Interpolated one = at(layer.ln_k, layer.ln_s, tables.index[a], of);
      for (std::size_t c = 0; c < 4; ++c) {
        r.value[c] += weight * one.value[c];
        r.by_k[c] += weight * one.by_k[c], r.by_s[c] += weight * one.by_s[c];
        if (tables.is_within) r.by_g[c] += slope * one.value[c] / kStepG;
      }
    }
    return r;
  }

  StreamsSettings settings_;
  mutable std::once_flag free_once_;
  mutable std::vector<Node> free_nodes_;  ///< ln R and ln T of free films, empty before the first one
  StreamsTables tables_;
};

}  // namespace

OpaqueReflectance::OpaqueReflectance(const FilmTheory& theory) : values_(kCells + 3) {
  constexpr double kSmallest = 1e-30;
  for (int i = 0; i <= kCells; ++i) {
    const double r = double(i) / kCells, ratio = i == 0 ? 1 / kSmallest : (1 - r) * (1 - r) / (2 * r);
    values_[std::size_t(i + 1)] = theory.opaque({std::log(std::max(ratio, kSmallest)), 0}).value;
  }
  values_[0] = 2 * values_[1] - values_[2];
  values_[kCells + 2] = 2 * values_[kCells + 1] - values_[kCells];
}

InnerFilm inner_film(const FilmLight& light, const Surface& surface) {
  // The outer reflectance is seen + (a + b g)/(1 - inside g) with the interface's own `surface.seen` in `seen`, and the inner
  // one is o/(through + k2 o) of the rest o = (a + b g)/(1 - inside g).
  const double a = std::max(0.0, light.seen - surface.seen), b = light.pass - a * light.inside;
  const double c = surface.through + surface.k2 * a, d = surface.k2 * b - surface.through * light.inside;
  return {std::clamp(a / c, 0.0, 1.0), std::clamp((b * c - a * d) / (c * c), 0.0, 1.0),
          std::clamp(-d / c, 0.0, 1.0)};
}

std::unique_ptr<FilmTheory> two_flux_theory(const Surface& surface) {
  return std::make_unique<TwoFlux>(surface);
}

std::unique_ptr<FilmTheory> streams_theory(const StreamsSettings& settings, const ParallelFor& threads) {
  return std::make_unique<Streams>(settings, threads);
}

StreamsTables streams_tables(const StreamsSettings& settings, const ParallelFor& threads) {
  return Streams(settings, threads).tables();
}

std::unique_ptr<FilmTheory> streams_theory(const StreamsSettings& settings, StreamsTables tables) {
  return std::make_unique<Streams>(settings, std::move(tables));
}

}  // namespace aureole::pigment
