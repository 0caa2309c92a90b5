// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/diffracting_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include "aureole/shape/geometry/outline.h"
#include "aureole/shape/instance.h"
#include "aureole/shape/mesh/mesh.h"

namespace aureole {
namespace {

/// Largest number of edges of round shapes in a scene. Beyond it these shapes get fewer sides, or no edges if
/// that does not suffice.
constexpr double kMostRoundEdges = 2e6;
constexpr int kLeastPieces = 16, kMostPieces = 1024;

/// Calls visit(shape, bsdf, part) for every shape, and once per instance for instanced shapes.
template <class Visit>
void for_each_shape(const SceneParts& parts, const Visit& visit) {
  for (const Primitive& part : parts.surfaces) {
    if (part.instance) {
      const ShapeList& list = part.instance->list();
      for (std::size_t i = 0; i < list.shapes.size(); ++i) visit(*list.shapes[i], *list.bsdfs[i], part);
    } else {
      visit(*part.shape, *part.bsdf, part);
    }
  }
}

/// Returns the largest angle by which light turns around a round surface without creeping along it, which
/// damps it: the width of the zone (2/(k R))^(1/3) in which the field falls off behind a grazing ray (Levy &
/// Keller 1959, "Diffraction by a smooth object").
double turn_without_creeping(double wave_number, double radius) {
  return std::min(0.5, std::cbrt(2 / (wave_number * radius)));
}

/// Returns how a BSDF reflects waves; one that reflects light in one direction alone, by amplitudes that are not known, is a perfect mirror.
DiffractingShapes::Reflection reflection_of(const Bsdf& bsdf) {
  const MirrorReflection* amplitudes = mirror_reflection_of(bsdf);
  const bool reflects_as_mirror = has(bsdf.lobes(), Lobe::delta) && has(bsdf.lobes(), Lobe::reflect) &&
                                  !has(bsdf.lobes(), Lobe::diffuse | Lobe::glossy);
  return {amplitudes || reflects_as_mirror, amplitudes};
}

}  // namespace

const EdgeDiffraction* edge_diffraction_of(const Bsdf& bsdf) {
  if (const auto* own = dynamic_cast<const EdgeDiffraction*>(&bsdf)) return own;
  for (const Properties::Entry& entry : bsdf.properties().entries())
    if (const auto* object = std::get_if<ObjectPtr>(&entry.value))
      if (const auto* nested = dynamic_cast<const Bsdf*>(object->get()))
        if (const EdgeDiffraction* found = edge_diffraction_of(*nested)) return found;
  return nullptr;
}

const Bsdf* first_diffracting_bsdf(const SceneParts& parts) {
  const Bsdf* found = nullptr;
  std::unordered_set<const Bsdf*> seen;
  for_each_shape(parts, [&](const Shape&, const Bsdf& bsdf, const Primitive&) {
    if (found || !seen.insert(&bsdf).second) return;
    if (const EdgeDiffraction* mark = edge_diffraction_of(bsdf); mark && mark->is_enabled()) found = &bsdf;
  });
  return found;
}

DiffractingShapes::DiffractingShapes(const SceneParts& parts, SeenThrough seen_through, Balls balls)
    : seen_through_(seen_through), balls_(balls) {
  const SpectralGrid& grid = parts.context->grid;
  middle_ = Wavelengths::at(grid, Spectrum(float(0.5 * (grid.min_nm + grid.max_nm))));
  const double shortest_m = parts.context->grid.min_nm * 1e-9;
  wave_number_ = 2 * std::numbers::pi * parts.context->length_unit_m / shortest_m;
  std::unordered_set<const Bsdf*> seen;
  for_each_shape(parts, [&](const Shape&, const Bsdf& bsdf, const Primitive&) {
    if (seen.insert(&bsdf).second && edge_diffraction_of(bsdf)) marked_.push_back(&bsdf);
  });
  only_marked_ = !marked_.empty();
  for_each_shape(parts, [&](const Shape& shape, const Bsdf& bsdf, const Primitive& part) {
    add(shape, bsdf, bool(part.emitter), part.instance.get());
  });
  add_round_shapes();
  if (left_out_ > 0)
    remarks.push_back(
        "diffraction: the edges of " + std::to_string(left_out_) +
        " shapes that light passes straight through in part (masks, panes, thin walls) do not diffract");
  for (std::size_t i = 0; i < triangles_.size(); ++i) sets.push_back({positions_[i], triangles_[i]});
}

/// The transmittance is evaluated at normal incidence without a surface point, so that a BSDF with textures
/// counts as transmitting.
bool DiffractingShapes::passes_light(const Bsdf& bsdf) const {
  if (!has(bsdf.lobes(), Lobe::null)) return false;
  const auto& entries = bsdf.properties().entries();
  if (std::any_of(entries.begin(), entries.end(),
                  [](const auto& e) { return std::holds_alternative<ObjectPtr>(e.value); }))
    return true;
  constexpr float kOpaque = 0.01f;
  const SurfacePoint point;
  return max_component(bsdf.null_transmittance({0, 0, 1}, BsdfContext{middle_, point})) >= kOpaque;
}

void DiffractingShapes::add(const Shape& shape, const Bsdf& bsdf, bool shines, const Instance* instance) {
  if (bsdf.lobes() == kNullLobe) return;
  if (seen_through_ == SeenThrough::left_out && passes_light(bsdf)) {
    ++left_out_;
    return;
  }
  const EdgeDiffraction* mark = only_marked_ ? edge_diffraction_of(bsdf) : nullptr;
  if (only_marked_ && !(mark && mark->is_enabled() && mark->scale() > 0)) return;
  const float factor = mark ? mark->scale() : 1.f;
  const Reflection reflects = reflection_of(bsdf);
  if (const auto* mesh = dynamic_cast<const Mesh*>(&shape)) {
    add_triangles(mesh->data().positions, mesh->data().triangles, instance, factor, 0, reflects);
    return;
  }
  const auto* round = dynamic_cast<const RoundShape*>(&shape);
  if (!round || shines || round->is_hollow()) return;
  double magnified = 1, reduced = 1;
  if (instance) {
    magnified = 0, reduced = kInfinity;
    const Vec3 origin = instance->point_to_world({0, 0, 0});
    // The diagonals detect a shear.
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0.6f, 0.8f, 0},
                             Vec3{0, 0.6f, 0.8f}, Vec3{0.8f, 0, 0.6f}}) {
      const double by = double(length(instance->point_to_world(axis) - origin));
      magnified = std::max(magnified, by), reduced = std::min(reduced, by);
    }
  }
  constexpr double kStretched = 1e-4;
  const auto center = round->ball_center();
  if (balls_ == Balls::listed && center && reduced > (1 - kStretched) * magnified) {
    const double radius = magnified * round->round_radius();
    const double turn = turn_without_creeping(wave_number_, radius);
    const Vec3 at = center->to_float();
    balls.push_back({instance ? Double3(instance->point_to_world(at)) : *center, radius,
                     0.5 * radius * turn * turn, wanted_pieces(radius, false)});
    return;
  }
  rounds_.push_back({&shape, instance, factor, magnified * round->round_radius(), reflects});
}

int DiffractingShapes::wanted_pieces(double radius, bool is_curved) const {
  // On a curved outline the angle between two edges is half the angle by which light turns; a polygon around
  // a flat rim deviates from it by a tenth of the wavelength.
  const double angle = is_curved ? 0.5 * turn_without_creeping(wave_number_, radius)
                                 : std::sqrt(0.8 * 2 * std::numbers::pi / (wave_number_ * radius));
  return int(
      std::clamp(4 * std::ceil(0.5 * std::numbers::pi / angle), double(kLeastPieces), double(kMostPieces)));
}

void DiffractingShapes::add_round_shapes() {
  const auto wanted_alone = [&](const Round& r) {
    return wanted_pieces(r.radius, dynamic_cast<const RoundShape&>(*r.shape).is_curved());
  };
  // A disc that closes a cylinder has as many corners as the cylinder, so that both share one rim.
  std::vector<std::pair<double, int>> rims;
  for (const Round& r : rounds_)
    if (dynamic_cast<const RoundShape&>(*r.shape).has_rims()) rims.push_back({r.radius, wanted_alone(r)});
  std::sort(rims.begin(), rims.end());
  rims.erase(std::unique(rims.begin(), rims.end()), rims.end());
  const auto wanted = [&](const Round& r) {
    int most = wanted_alone(r);
    if (!dynamic_cast<const RoundShape&>(*r.shape).has_rims()) return most;
    constexpr double kEqual = 1e-5;
    for (auto rim = std::lower_bound(rims.begin(), rims.end(), std::pair(r.radius * (1 - kEqual), 0));
         rim != rims.end() && rim->first <= r.radius * (1 + kEqual); ++rim)
      most = std::max(most, rim->second);
    return most;
  };
  const auto count = [&](double share) {
    double sum = 0;
    for (const Round& r : rounds_)
      sum += dynamic_cast<const RoundShape&>(*r.shape).edge_count(
          std::max(kLeastPieces, int(share * wanted(r))));
    return sum;
  };
  double share = 1;
  while (count(share) > kMostRoundEdges && share > 0.01) share *= 0.8;
  if (count(share) > kMostRoundEdges) {
    remarks.push_back("edges: none of " + std::to_string(rounds_.size()) +
                      " round shapes diffracts light: together they have too many edges");
    return;
  }
  std::size_t coarse = 0;
  for (const Round& r : rounds_) {
    const auto& round = dynamic_cast<const RoundShape&>(*r.shape);
    const int pieces = std::max(kLeastPieces, int(share * wanted(r)) / 4 * 4);
    coarse += pieces < wanted(r);
    // The polygon's outline lies before or behind the shape's outline, by at most the length of an edge, and
    // lower.
    const double turn =
        std::hypot(turn_without_creeping(wave_number_, r.radius), 1.6 * 2 * std::numbers::pi / pieces);
    OutlineMesh mesh = round.outline_mesh(pieces);
    add_triangles(std::move(mesh.positions), std::move(mesh.triangles), r.instance, r.scale,
                  round.is_curved() ? float(0.5 * r.radius * turn * turn) : 0.f, r.reflects);
  }
  if (coarse > 0)
    remarks.push_back(
        "edges: " + std::to_string(coarse) + " of " + std::to_string(rounds_.size()) +
        " round shapes have fewer sides than their wavelengths ask for, since there are many of them");
}

void DiffractingShapes::add_triangles(std::vector<Vec3> positions, std::vector<TriangleIndices> triangles,
                                      const Instance* instance, float factor, float height,
                                      Reflection reflection) {
  if (instance)
    for (Vec3& p : positions) p = instance->point_to_world(p);
  positions_.push_back(std::move(positions));
  triangles_.push_back(std::move(triangles));
  scale.push_back(factor), lift.push_back(height), reflects.push_back(reflection);
}

bool DiffractingShapes::has_width() const {
  return std::any_of(marked_.begin(), marked_.end(), [](const Bsdf* bsdf) {
    const EdgeDiffraction& mark = *edge_diffraction_of(*bsdf);
    return mark.is_enabled() && mark.sigma();
  });
}

BeamWidth DiffractingShapes::width(const BeamWidth& of_integrator) const {
  const Bsdf* first = nullptr;
  double stated = 0;
  for (const Bsdf* bsdf : marked_) {
    const EdgeDiffraction& mark = *edge_diffraction_of(*bsdf);
    if (!mark.is_enabled() || !mark.sigma()) continue;
    const BeamWidth width{BeamWidth::Unit::wavelengths, *mark.sigma()};
    if (!(of_integrator == BeamWidth{}) && !(of_integrator == width))
      throw Error(bsdf->properties().where(),
                  "its \"sigma\" and the integrator's \"beam_width\" differ: state one of them");
    if (first && *mark.sigma() != stated)
      throw Error(bsdf->properties().where(), "\"sigma\" is one number for a scene, and that at " +
                                                  first->properties().where().str() + " is another one");
    first = bsdf, stated = *mark.sigma();
  }
  return first ? BeamWidth{BeamWidth::Unit::wavelengths, stated} : of_integrator;
}

}  // namespace aureole
