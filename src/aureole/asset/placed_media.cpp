// SPDX-License-Identifier: Apache-2.0
#include "aureole/asset/placed_media.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace aureole {

namespace {

/// Maps points and directions of the world to those of an instance's group. Directions are turned by the
/// rotation nearest to the instance's transform, which leaves particles undeformed.
class Placement {
public:
  explicit Placement(std::shared_ptr<const Instance> instance) : instance_(std::move(instance)) {
    const Transform turn = instance_->to_world().orthogonal_part();
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) turn_[i][k] = float(turn.matrix()[i][k]);
  }

  Vec3 point_in_group(const Vec3& p) const { return instance_->point_to_group(p); }
  /// Returns a unit vector for a unit vector.
  Vec3 direction_in_group(const Vec3& d) const {
    Vec3 r;
    for (int k = 0; k < 3; ++k) r[k] = turn_[0][k] * d.x + turn_[1][k] * d.y + turn_[2][k] * d.z;
    return r;
  }
  Vec3 direction_in_world(const Vec3& d) const {
    Vec3 r;
    for (int i = 0; i < 3; ++i) r[i] = turn_[i][0] * d.x + turn_[i][1] * d.y + turn_[i][2] * d.z;
    return normalize(r);
  }
  Transform to_group() const { return instance_->to_group(); }

private:
  std::shared_ptr<const Instance> instance_;
  float turn_[3][3];  ///< orthogonal matrix from the group to the world
};

class PlacedPhase final : public PhaseFunction {
public:
  /// A phase function under a placement. `phase` must outlive this object.
  PlacedPhase(const PhaseFunction& phase, const Placement& placement)
      : PhaseFunction(phase.properties()), phase_(phase), placement_(placement) {}

  PhaseEval eval_pdf(const Vec3& wi, const Vec3& wo, const PhaseContext& ctx) const override {
    return phase_.eval_pdf(placement_.direction_in_group(wi), placement_.direction_in_group(wo),
                           {ctx.wavelengths, placement_.point_in_group(ctx.p)});
  }
  std::optional<PhaseSample> sample(const Vec3& wi, float u1, Vec2 u2,
                                    const PhaseContext& ctx) const override {
    auto s = phase_.sample(placement_.direction_in_group(wi), u1, u2,
                           {ctx.wavelengths, placement_.point_in_group(ctx.p)});
    if (s) s->wo = placement_.direction_in_world(s->wo);
    return s;
  }
  float projected_area(const Vec3& d, const Vec3& p) const override {
    return phase_.projected_area(placement_.direction_in_group(d), placement_.point_in_group(p));
  }
  float largest_projected_area() const override { return phase_.largest_projected_area(); }
  bool is_isotropic_medium() const override { return phase_.is_isotropic_medium(); }
  bool is_uniform() const override { return phase_.is_uniform(); }
  bool needs_choice() const override { return phase_.needs_choice(); }

private:
  const PhaseFunction& phase_;
  const Placement& placement_;
};

class PlacedMedium final : public Medium {
public:
  PlacedMedium(MediumPtr medium, const std::shared_ptr<const Instance>& instance)
      : Medium(medium->properties()), medium_(std::move(medium)), placement_(instance) {
    const PhaseFunction& phase = medium_->phase();
    if (!phase.is_isotropic_medium() || !phase.is_uniform()) phase_.emplace(phase, placement_);
    if (const MajorantGrid* grid = medium_->majorants().grid()) grid_.emplace(*grid, placement_.to_group());
  }

  void eval(const Vec3& p, const Vec3& d, const Wavelengths& w, MediumCoefficients& out) const override {
    medium_->eval(placement_.point_in_group(p), placement_.direction_in_group(d), w, out);
  }
  const PhaseFunction& phase() const override { return phase_ ? *phase_ : medium_->phase(); }
  Majorants majorants() const override { return grid_ ? Majorants(*grid_) : Majorants(); }
  Spectrum majorant(const Vec3& d, const Wavelengths& w) const override {
    return medium_->majorant(placement_.direction_in_group(d), w);
  }
  bool is_uniform() const override { return medium_->is_uniform(); }
  bool has_uniform_emission() const override { return medium_->has_uniform_emission(); }
  bool emits() const override { return medium_->emits(); }
  bool emits_by_direction() const override { return medium_->emits_by_direction(); }
  bool scatters() const override { return medium_->scatters(); }
  float sampling_weight() const override { return medium_->sampling_weight(); }

private:
  MediumPtr medium_;
  Placement placement_;
  /// rotated phase function; empty if the medium's phase function is the same in the world
  std::optional<PlacedPhase> phase_;
  std::optional<MajorantGrid> grid_;
};

}  // namespace

bool depends_on_place(const Medium& medium) {
  const PhaseFunction& phase = medium.phase();
  return !medium.is_uniform() || !phase.is_isotropic_medium() || !phase.is_uniform();
}

bool keeps_angles(const Instance& instance) {
  const Transform to_world = instance.to_world();
  const auto &m = to_world.matrix(), turn = to_world.orthogonal_part().matrix();
  const double size = std::cbrt(std::abs(to_world.determinant3()));
  constexpr double kTolerance = 1e-4;  // tolerance for transforms that were rounded to single precision
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (!(std::abs(m[i][k] - size * turn[i][k]) <= kTolerance * size)) return false;
  return true;
}

PlacedMedia::PlacedMedia(std::shared_ptr<const Instance> instance, const PlacedMedia* around)
    : instance_(std::move(instance)), around_(around) {
  const bool moves = !(instance_->to_world() == Transform());
  for (const SurfaceMedia& media : instance_->list().media)
    if (media.inside && depends_on_place(*media.inside)) {
      MediumPtr& placed = placed_[media.inside.get()];
      if (!placed) placed = moves ? std::make_shared<PlacedMedium>(media.inside, instance_) : media.inside;
    }
}

MediumPtr PlacedMedia::find(const Medium* medium) const {
  for (const PlacedMedia* p = this; p; p = p->around_)
    if (const auto found = p->placed_.find(medium); found != p->placed_.end()) return found->second;
  return nullptr;
}

MediumPtr PlacedMedia::placed(const MediumPtr& medium) const {
  const MediumPtr found = find(medium.get());
  return found ? found : medium;
}

std::vector<SurfaceMedia> PlacedMedia::of_shapes() const {
  std::vector<SurfaceMedia> all = instance_->list().media;
  bool differ = false;
  for (SurfaceMedia& media : all) {
    for (MediumPtr* medium : {&media.inside, &media.outside}) {
      MediumPtr moved = placed(*medium);
      differ |= moved != *medium;
      *medium = std::move(moved);
    }
  }
  if (!differ) all.clear();
  return all;
}

std::vector<MediumPtr> PlacedMedia::not_moved() const {
  std::vector<MediumPtr> all;
  for (const SurfaceMedia& media : instance_->list().media)
    if (media.outside && depends_on_place(*media.outside) && !find(media.outside.get()) &&
        std::find(all.begin(), all.end(), media.outside) == all.end())
      all.push_back(media.outside);
  return all;
}

bool PlacedMedia::has_oriented_particles() const {
  return std::any_of(placed_.begin(), placed_.end(),
                     [](const auto& p) { return !p.second->phase().is_isotropic_medium(); });
}

}  // namespace aureole
