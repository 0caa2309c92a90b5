// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/stack_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/optics/stack/rough_interface.h"

namespace aureole::optics {
namespace {

using Element = StackSolver::Element;

/// Returns the layer after delta-M scaling (Wiscombe 1977, (3) to (7)).
StackSolver::Scaled scaled_layer(const StackLayer& layer, const DiscreteOrdinates& method) {
  const double extinction = layer.extinction();
  StackSolver::Scaled s{1, extinction > 0 ? layer.scattering / extinction : 0,
                        layer.phase.moments(method.streams + 1)};
  const double peak = method.delta_m ? std::max(0.0, s.moments.back()) : 0;
  s.moments.pop_back();
  if (!(peak < 1)) throw std::domain_error("a phase function without anything but its forward peak");
  s.share = 1 - s.albedo * peak;
  s.albedo *= (1 - peak) / s.share;
  for (double& chi : s.moments) chi = (chi - peak) / (1 - peak);
  return s;
}

std::vector<double> all_indices(const StackDescription& d) {
  std::vector<double> indices{d.index_above};
  for (const StackLayer& layer : d.layers) indices.push_back(layer.index);
  if (!d.substrate) indices.push_back(d.index_below);
  return indices;
}

}  // namespace

StackSolver::StackSolver(const StackDescription& description, const DiscreteOrdinates& method, bool azimuths,
                         std::span<const IndexedCosine> extra, std::span<const StackPosition> positions,
                         std::span<const IndexedCosine> cuts, const StackSolver* like)
    : position_levels_(positions.size(), -1),
      index_above_(description.index_above),
      substrate_(description.substrate.value_or(0)),
      mirror_(description.mirror),
      channels_(all_indices(description), method.streams / 2, extra, cuts) {
  double before = description.index_above;
  std::vector<StackInterface> rough;
  const auto add_interface = [&](int layer, double index, const StackInterface& interface) {
    if (index != before) {
      elements_.push_back({Element::Kind::interface, layer, before, index, 0, 0});
      if (interface.kind != InterfaceKind::smooth) {
        elements_.back().rough = int(rough.size());
        rough.push_back(interface);
      }
    }
    before = index;
  };
  for (int i = 0; i < int(description.layers.size()); ++i) {
    const StackLayer& layer = description.layers[i];
    scaled_.push_back(scaled_layer(layer, method));
    layers_.emplace_back(channels_, layer.index, scaled_[i].albedo, scaled_[i].moments);
    for (int m = modes_; m < method.streams; ++m)
      if (layers_[i].scatters(m)) modes_ = m + 1;

    add_interface(i, layer.index, layer.top);
    std::set<double> depths{0, layer.thickness};
    for (const StackPosition& p : positions)
      if (p.layer == i) depths.insert(p.depth);
    for (auto depth = depths.begin(); depth != depths.end(); ++depth) {
      for (std::size_t k = 0; k < positions.size(); ++k)
        if (positions[k].layer == i && positions[k].depth == *depth)
          position_levels_[k] = int(elements_.size());
      const auto next = std::next(depth);
      if (next == depths.end() || !(layer.extinction() > 0)) continue;
      const double thickness = std::min(layer.extinction() * (*next - *depth), kInfiniteOpticalThickness);
      elements_.push_back({Element::Kind::layer, i, before, before, thickness, thickness * scaled_[i].share});
    }
  }
  const int count = int(description.layers.size());
  if (description.substrate)
    elements_.push_back({Element::Kind::substrate, count, before, before, 0, 0});
  else
    add_interface(count, description.index_below, description.bottom);

  if (!rough.empty() || description.brdf) modes_ = method.streams;
  if (method.modes > 0) modes_ = std::min(modes_, method.modes);
  if (!azimuths) modes_ = 1;
  if (like) {
    rough_ = like->rough_;
  } else {
    for (const Element& e : elements_)
      if (e.rough >= 0)
        rough_.push_back(std::make_shared<const std::vector<Operators>>(
            rough_interface(channels_, e.index_above, e.index_below, rough[e.rough], modes_)));
  }
  if (description.brdf) brdf_ = substrate_kernels(channels_, before, description.brdf, modes_);
}

Operators StackSolver::operators(const Element& e, int mode) const {
  switch (e.kind) {
    case Element::Kind::layer:
      return layers_[e.layer].operators(e.scaled, mode);
    case Element::Kind::interface:
      if (e.rough < 0) return smooth_interface(channels_, e.index_above, e.index_below);
      if (mode != kUnscattered) return (*rough_[e.rough])[mode];
      break;
    case Element::Kind::substrate:
      break;
  }
  if (mode == kUnscattered && e.kind == Element::Kind::interface) {
    const Operators& rough = rough_[e.rough]->front();
    return {Matrix::Zero(rough.r_above.rows(), rough.r_above.cols()),
            Matrix::Zero(rough.t_down.rows(), rough.t_down.cols()),
            Matrix::Zero(rough.r_below.rows(), rough.r_below.cols())};
  }
  Operators o = lambertian_substrate(channels_, e.index_above, substrate_, mode);
  if (!brdf_.empty() && mode != kUnscattered) o.r_above += brdf_[mode];
  if (mirror_)
    for (int i = 0; i < o.r_above.rows(); ++i) o.r_above(i, i) += mirror_(channels_.mu(i, e.index_above));
  return o;
}

Operators StackSolver::whole(int mode) const {
  Operators sum = operators(elements_.back(), mode);
  for (int i = last_level() - 2; i >= 0; --i) sum = Operators::stacked(operators(elements_[i], mode), sum);
  return sum;
}

std::optional<Operators> StackSolver::above_substrate(int mode) const {
  const int last = last_level() - 2;
  if (last < 0) return {};
  Operators sum = operators(elements_[last], mode);
  for (int i = last - 1; i >= 0; --i) sum = Operators::stacked(operators(elements_[i], mode), sum);
  return sum;
}

std::vector<StackSolver::Light> StackSolver::light(int mode, const Matrix& from_above,
                                                   const Matrix& from_below,
                                                   std::span<const int> levels) const {
  const int last = last_level();
  int highest = last, deepest = 0;  // first and last of the levels inside the stack
  bool needs_whole = false;
  for (const int level : levels) {
    if (level == 0 || level == last) {
      needs_whole = true;
    } else {
      highest = std::min(highest, level), deepest = std::max(deepest, level);
    }
  }
  std::vector<Operators> parts;
  for (const Element& e : elements_) parts.push_back(operators(e, mode));
  // Operators of partial stacks: upper[i] is all elements above level i; lower[i] all elements below it.
  std::vector<Operators> upper(last + 1), lower(last + 1);
  for (int i = 1; i <= deepest; ++i)
    upper[i] = i == 1 ? parts[0] : Operators::stacked(upper[i - 1], parts[i - 1]);
  for (int i = last - 1; i >= (needs_whole ? 0 : highest); --i)
    lower[i] = i == last - 1 ? parts[i] : Operators::stacked(parts[i], lower[i + 1]);

  std::vector<Light> result;
  for (const int level : levels) {
    if (last == 0) {
      result.push_back({from_above, from_below});
    } else if (level == 0) {
      result.push_back({from_above, product(lower[0].r_above, from_above) +
                                        product(lower[0].t_down.transpose(), from_below)});
    } else if (level == last) {
      result.push_back(
          {product(lower[0].t_down, from_above) + product(lower[0].r_below, from_below), from_below});
    } else {
      FieldBetween field(upper[level], lower[level], from_above, from_below);
      result.push_back({std::move(field.down), std::move(field.up)});
    }
  }
  return result;
}

Matrix StackSolver::unscattered(int channel, bool scaled) const {
  // factor below 1, which prevents a division by 0 for light trapped in clear glass, whose power is 0
  constexpr double kTotal = 1 - 1e-12;
  const int levels = last_level() + 1;
  Matrix step = Matrix::Zero(2 * levels, 2 * levels);
  for (int i = 0; i + 1 < levels; ++i) {
    const Element& e = elements_[i];
    double r = 0, t = 0;
    const bool above = channel < channels_.count(e.index_above),
               below = channel < channels_.count(e.index_below);
    if (e.kind == Element::Kind::layer && above) {
      t = std::exp(-(scaled ? e.scaled : e.optical_thickness) / channels_.mu(channel, e.index_above));
    } else if (e.kind == Element::Kind::interface && e.rough < 0) {
      const double n = std::min(e.index_above, e.index_below);
      r = above && below
              ? fresnel_reflectance(channels_.mu(channel, n), n, std::max(e.index_above, e.index_below))
              : kTotal;
      t = above && below ? 1 - r : 0;
    }
    if (e.kind == Element::Kind::substrate && above && mirror_)
      r = std::min(mirror_(channels_.mu(channel, e.index_above)), kTotal);
    const int up = levels + i;
    step(i + 1, i) = step(up, up + 1) = t;
    step(up, i) = above ? r : 0;
    step(i + 1, up + 1) = below && e.kind != Element::Kind::substrate ? r : 0;
  }
  return inverse(Matrix::Identity(2 * levels, 2 * levels) - step);
}

}  // namespace aureole::optics
