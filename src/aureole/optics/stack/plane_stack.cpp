// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/plane_stack.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"
#include "aureole/optics/stack/stack_single_scattering.h"
#include "aureole/optics/stack/stack_solver.h"

namespace aureole::optics {
namespace {

[[noreturn]] void refuse(const std::string& what, double value) {
  throw std::domain_error(what + ", got " + std::to_string(value));
}

void check_index(const std::string& where, double index) {
  if (!(index >= 1e-3 && index <= 1e3))
    refuse(where + " must have an index of refraction in [0.001, 1000]", index);
}

void check_interface(const std::string& where, const StackInterface& interface) {
  if (interface.kind != InterfaceKind::smooth && !(interface.alpha >= 0.05 && interface.alpha <= 1))
    refuse("roughness of the interface " + where + " must be in [0.05, 1]", interface.alpha);
}

void check_lights(std::span<const StackLight> lights, const StackDescription& d) {
  for (const StackLight& light : lights) {
    if (light.cosine && !(*light.cosine > 0 && *light.cosine <= 1))
      refuse("cosine of a beam must be in (0, 1]", *light.cosine);
    if (light.from_below && d.substrate)
      throw std::domain_error("no light comes from below where there is a substrate");
  }
}

void check_position(const StackPosition& p, const StackDescription& d) {
  if (!(p.layer >= 0 && p.layer < int(d.layers.size())))
    refuse("layer must be in [0, " + std::to_string(d.layers.size()) + ")", p.layer);
  if (!(p.depth >= 0 && p.depth <= d.layers[p.layer].thickness))
    refuse("depth in layer " + std::to_string(p.layer) + " must be in [0, " +
               std::to_string(d.layers[p.layer].thickness) + "]",
           p.depth);
}

double index_outside(const StackDescription& d, bool below) { return below ? d.index_below : d.index_above; }

/// Returns the direction of each beam, for the solver.
std::vector<IndexedCosine> beam_directions(std::span<const StackLight> lights, const StackDescription& d) {
  std::vector<IndexedCosine> directions;
  for (const StackLight& light : lights)
    if (light.cosine) directions.push_back({index_outside(d, light.from_below), *light.cosine});
  return directions;
}

bool has_beam(std::span<const StackLight> lights) {
  return std::any_of(lights.begin(), lights.end(),
                     [](const StackLight& light) { return light.cosine.has_value(); });
}

/// Incident light, one column for each of `lights`, of irradiance 1. Beams are the first extra channels.
struct Incident {
  Matrix above, below;
  Incident(std::span<const StackLight> lights, const StackDescription& d, const Channels& channels,
           int mode) {
    const auto count = Eigen::Index(lights.size());
    above = Matrix::Zero(channels.count(d.index_above), count);
    below = Matrix::Zero(d.substrate ? 0 : channels.count(d.index_below), count);
    int beam = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      Matrix& side = lights[i].from_below ? below : above;
      if (lights[i].cosine) {
        const int channel = channels.extra()[beam++];
        side(channel, i) = 1 / std::sqrt(channels.etendue(channel));
      } else if (mode == 0) {
        const double n = index_outside(d, lights[i].from_below);
        side.col(i) = root_etendues(channels, n) / (kPi * n * n);
      }
    }
  }
};

/// Returns the flux of each column.
Eigen::RowVectorXd flux(const Channels& channels, double index, const Matrix& x) {
  return root_etendues(channels, index).transpose() * x;
}

/// Returns the fractions of unscattered light at all levels, in the order of StackSolver::unscattered.
Vector unscattered_light(const StackSolver& solver, const StackLight& light, int channel_of_beam) {
  const Channels& channels = solver.channels();
  const int start = light.from_below ? 2 * solver.last_level() + 1 : 0;
  if (light.cosine) return solver.unscattered(channel_of_beam, false).col(start);
  const double n = solver.index(light.from_below ? solver.last_level() : 0);
  Vector sum = Vector::Zero(2 * solver.last_level() + 2);
  for (int i = 0; i < channels.count(n); ++i)
    if (!channels.is_extra(i))
      sum += channels.etendue(i) / (kPi * n * n) * solver.unscattered(i, false).col(start);
  return sum;
}

}  // namespace

PlaneStack::PlaneStack(StackDescription description, DiscreteOrdinates method)
    : description_(std::move(description)), method_(method) {
  if (!(method_.streams >= 2 && method_.streams <= 512 && method_.streams % 2 == 0))
    refuse("streams must be an even number in [2, 512]", method_.streams);
  if (!(method_.modes >= 0)) refuse("modes must not be negative", method_.modes);
  if (description_.layers.empty()) throw std::domain_error("a stack needs a layer");
  check_index("the medium above", description_.index_above);
  for (std::size_t i = 0; i < description_.layers.size(); ++i) {
    const StackLayer& layer = description_.layers[i];
    const std::string where = "layer " + std::to_string(i);
    if (!(layer.absorption >= 0 && std::isfinite(layer.absorption)))
      refuse("absorption of " + where + " must be finite and not negative", layer.absorption);
    if (!(layer.scattering >= 0 && std::isfinite(layer.scattering)))
      refuse("scattering of " + where + " must be finite and not negative", layer.scattering);
    if (!(layer.thickness >= 0)) refuse("thickness of " + where + " must not be negative", layer.thickness);
    check_index(where, layer.index);
    check_interface("above " + where, layer.top);
  }
  if (!description_.substrate && (description_.mirror || description_.brdf))
    throw std::domain_error(
        "a mirror or BRDF below a stack without a substrate; give its Lambertian share, 0");
  if (description_.substrate) {
    if (!(*description_.substrate >= 0 && *description_.substrate <= 1))
      refuse("reflectance of the substrate must be in [0, 1]", *description_.substrate);
  } else {
    check_index("the medium below", description_.index_below);
    check_interface("below the last layer", description_.bottom);
  }
}

StackFluxes PlaneStack::fluxes(const StackLight& light) const { return fluxes(std::span(&light, 1)).front(); }

std::vector<StackFluxes> PlaneStack::fluxes(std::span<const StackLight> lights) const {
  check_lights(lights, description_);
  const StackSolver solver(description_, method_, false, beam_directions(lights, description_));
  const Channels& channels = solver.channels();
  const Incident incident(lights, description_, channels, 0);
  // Last level that counts: above a substrate all levels count; without a substrate the last level is the
  // exit.
  const int bottom = solver.last_level() - (description_.substrate ? 1 : 0);
  const int levels[] = {0, bottom};
  const auto light = solver.light(0, incident.above, incident.below, levels);
  const auto up = flux(channels, solver.index(0), light[0].up);
  const auto down = flux(channels, solver.index(bottom), light[1].down);
  Eigen::RowVectorXd back = Eigen::RowVectorXd::Zero(up.size());
  if (description_.substrate) back = flux(channels, solver.index(bottom), light[1].up);

  std::vector<StackFluxes> result;
  int beam = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const int channel = lights[i].cosine ? channels.extra()[beam++] : -1;
    const Vector paths = unscattered_light(solver, lights[i], channel);
    // Light that a specular substrate reflects is unscattered as well.
    const double u = paths[solver.last_level() + 1], d = description_.substrate
                                                             ? (1 - *description_.substrate) * paths[bottom] -
                                                                   paths[solver.last_level() + 1 + bottom]
                                                             : paths[bottom];
    StackFluxes f{up[i], down[i] - back[i], u, d};
    if (lights[i].from_below) {
      std::swap(f.reflectance, f.transmittance);
      std::swap(f.unscattered_reflectance, f.unscattered_transmittance);
    }
    result.push_back(f);
  }
  return result;
}

namespace {

struct View {
  int level;
  double cosine;
};

std::vector<double> radiance_at(const StackSolver& solver, const StackDescription& d,
                                const DiscreteOrdinates& method, std::span<const StackLight> lights,
                                std::span<const View> views, std::span<const double> azimuths) {
  const Channels& channels = solver.channels();
  std::vector<int> levels;
  for (const View& v : views) levels.push_back(v.level);
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  const auto count = lights.size();
  const std::size_t beams = beam_directions(lights, d).size();
  std::vector<double> result(count * views.size() * azimuths.size(), 0);
  const auto at = [&](std::size_t light, std::size_t view) {
    return result.begin() + std::ptrdiff_t((light * views.size() + view) * azimuths.size());
  };

  const int modes = beams > 0 ? solver.modes() : 1;
  for (int m = 0; m < modes; ++m) {
    const Incident incident(lights, d, channels, m);
    const auto fields = solver.light(m, incident.above, incident.below, levels);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const auto which = std::lower_bound(levels.begin(), levels.end(), views[v].level) - levels.begin();
      const Matrix& x = views[v].cosine > 0 ? fields[which].up : fields[which].down;
      const int channel = channels.extra()[beams + v];
      const double n = solver.index(views[v].level), unit = n * n / std::sqrt(channels.etendue(channel));
      for (std::size_t i = 0; i < count; ++i) {
        if (m > 0 && !lights[i].cosine) continue;
        const double value = unit * x(channel, Eigen::Index(i));
        auto out = at(i, v);
        for (std::size_t a = 0; a < azimuths.size(); ++a)
          *out++ += m == 0 ? value : 2 * value * std::cos(m * azimuths[a]);
      }
    }
  }
  if (!method.delta_m || beams == 0) return result;

  // The exact single scattering replaces the single scattering of the truncated series.
  const SingleScattering single(solver, d);
  std::size_t beam = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!lights[i].cosine) continue;
    const auto light = single.light(channels.extra()[beam++], lights[i].from_below);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const auto change = single.correction(light, channels.extra()[beams + v], views[v].level,
                                            views[v].cosine > 0, azimuths);
      std::transform(change.begin(), change.end(), at(i, v), at(i, v), std::plus<>());
    }
  }
  return result;
}

void check_cosines(std::span<const double> cosines) {
  for (const double c : cosines)
    if (!(c != 0 && std::abs(c) <= 1)) refuse("cosine of a direction must be in [-1, 1] and not 0", c);
}

}  // namespace

std::vector<double> PlaneStack::radiance(std::span<const StackLight> lights, std::span<const double> cosines,
                                         std::span<const double> azimuths) const {
  check_lights(lights, description_), check_cosines(cosines);
  std::vector<IndexedCosine> extra = beam_directions(lights, description_);
  for (const double c : cosines) {
    if (c < 0 && description_.substrate)
      refuse("no light goes down below a substrate: cosines must be positive", c);
    extra.push_back({index_outside(description_, c < 0), std::abs(c)});
  }
  const StackSolver solver(description_, method_, has_beam(lights), extra);
  std::vector<View> views;
  for (const double c : cosines) views.push_back({c > 0 ? 0 : solver.last_level(), c});
  return radiance_at(solver, description_, method_, lights, views, azimuths);
}

std::vector<double> PlaneStack::radiance(std::span<const StackLight> lights, const StackPosition& position,
                                         std::span<const double> cosines,
                                         std::span<const double> azimuths) const {
  check_lights(lights, description_), check_cosines(cosines), check_position(position, description_);
  std::vector<IndexedCosine> extra = beam_directions(lights, description_);
  for (const double c : cosines) extra.push_back({description_.layers[position.layer].index, std::abs(c)});
  const StackSolver solver(description_, method_, has_beam(lights), extra, std::span(&position, 1));
  std::vector<View> views;
  for (const double c : cosines) views.push_back({solver.level(0), c});
  return radiance_at(solver, description_, method_, lights, views, azimuths);
}

std::vector<StackField> PlaneStack::fields(const StackLight& light,
                                           std::span<const StackPosition> positions) const {
  check_lights(std::span(&light, 1), description_);
  for (const StackPosition& p : positions) check_position(p, description_);
  const StackSolver solver(description_, method_, false, beam_directions(std::span(&light, 1), description_),
                           positions);
  const Channels& channels = solver.channels();
  const Incident incident(std::span(&light, 1), description_, channels, 0);
  std::vector<int> levels;
  for (std::size_t i = 0; i < positions.size(); ++i) levels.push_back(solver.level(int(i)));
  const auto lights = solver.light(0, incident.above, incident.below, levels);
  const Vector paths = unscattered_light(solver, light, light.cosine ? channels.extra()[0] : -1);

  std::vector<StackField> result;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const StackLayer& layer = description_.layers[positions[i].layer];
    const double n = layer.index, extinction = layer.extinction() * solver.scaled(positions[i].layer).share;
    const Vector root = root_etendues(channels, n);
    const UniformLayer::Rates rates = solver.layer(positions[i].layer).rates(0);
    // Backscattered flux per unit of (scaled) optical depth for each channel.
    const Vector backward = 0.5 * (rates.sum - rates.difference) * root;
    StackField f;
    f.unscattered_flux_down = paths[levels[i]];
    f.unscattered_flux_up = paths[solver.last_level() + 1 + levels[i]];
    const auto sums = [&](const Matrix& x, double& all, double& fluence, double& absorbed,
                          double& scattered) {
      all = root.dot(x.col(0));
      for (int c = 0; c < root.size(); ++c) fluence += root[c] * x(c, 0) / channels.mu(c, n);
      if (!(all > 0)) return;
      absorbed = layer.absorption * fluence / all;
      scattered = extinction * backward.dot(x.col(0)) / all;
    };
    sums(lights[i].down, f.flux_down, f.fluence_down, f.absorption_down, f.backscatter_down);
    sums(lights[i].up, f.flux_up, f.fluence_up, f.absorption_up, f.backscatter_up);
    result.push_back(f);
  }
  return result;
}

StackChannels PlaneStack::channels(std::span<const double> dividing_cosines) const {
  std::vector<IndexedCosine> cuts;
  double before = 1;
  for (const double c : dividing_cosines) {
    if (!(c > 0 && c < before)) refuse("cosines that divide directions must fall from 1 to 0", c);
    cuts.push_back({description_.index_above, c});
    before = c;
  }
  const StackSolver solver(description_, method_, false, {}, {}, cuts);
  const Channels& channels = solver.channels();
  const int rings = int(cuts.size()) + 1, bottom = solver.last_level() - (description_.substrate ? 1 : 0);
  const auto ring_of = [&](int channel) {
    const double mu = channels.mu(channel, description_.index_above);
    return int(std::count_if(cuts.begin(), cuts.end(), [&](const IndexedCosine& c) { return mu < c.mu; }));
  };

  const Vector root = root_etendues(channels, description_.index_above);
  StackChannels result;
  Matrix incident = Matrix::Zero(root.size(), rings);
  result.projected_solid_angle.assign(rings, 0);
  const double unit = description_.index_above * description_.index_above;
  for (int i = 0; i < root.size(); ++i) result.projected_solid_angle[ring_of(i)] += root[i] * root[i] / unit;
  for (int i = 0; i < root.size(); ++i)
    incident(i, ring_of(i)) = root[i] / (unit * result.projected_solid_angle[ring_of(i)]);
  const double below = solver.index(bottom);
  const Matrix nothing = Matrix::Zero(description_.substrate ? 0 : channels.count(below), rings);
  const int levels[] = {0, bottom};
  const auto light = solver.light(0, incident, nothing, levels);
  const auto by_ring = [&](const Matrix& x, double index) {
    std::vector<double> sums(std::size_t(rings) * rings, 0);
    const Vector r = root_etendues(channels, index);
    for (int i = 0; i < int(std::min(r.size(), root.size())); ++i)
      for (int j = 0; j < rings; ++j) sums[ring_of(i) * rings + j] += r[i] * x(i, j);
    return sums;
  };
  result.reflected = by_ring(light[0].up, description_.index_above);
  result.transmitted = by_ring(light[1].down, below);
  return result;
}

}  // namespace aureole::optics
