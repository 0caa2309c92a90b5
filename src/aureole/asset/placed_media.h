// SPDX-License-Identifier: Apache-2.0
// `PlacedMedia`: the media of a group of shapes as they are in one instance of the group.
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "aureole/asset/primitive.h"
#include "aureole/shape/instance.h"

namespace aureole {

/// Whether a medium changes when it is moved or rotated: it varies in space, or its particles have an
/// orientation.
bool depends_on_place(const Medium& medium);
/// Whether the instance's transform keeps angles, so that it turns particles without deforming them.
bool keeps_angles(const Instance& instance);

/// The media that fill shapes of a group have the group's coordinates, and an instance places them with the
/// shapes: volumes are evaluated at the point in the group, and the particles of phase functions are rotated,
/// but not deformed. Coefficients remain per length of the scene, so that an instance that is twice as large
/// has twice the optical thickness, with constant and with varying coefficients alike. Media that are the
/// same everywhere are not changed, and those around the group's shapes that fill none of them are not moved.
class PlacedMedia {
public:
  /// `around`: the media of the instance that contains this one, if it belongs to a nested group; else null.
  PlacedMedia(std::shared_ptr<const Instance> instance, const PlacedMedia* around);

  /// Returns the media of the group's shapes, in their order; empty if none of them depends on its place.
  std::vector<SurfaceMedia> of_shapes() const;
  /// Returns the media that depend on their place, but only surround shapes of the group: they are not moved.
  std::vector<MediumPtr> not_moved() const;
  /// Whether the instance has moved a medium with oriented particles.
  bool has_oriented_particles() const;

private:
  /// Returns the medium as it is in the instance, or null if it is not moved.
  MediumPtr find(const Medium* medium) const;
  MediumPtr placed(const MediumPtr& medium) const;

  std::shared_ptr<const Instance> instance_;
  const PlacedMedia* around_;
  std::unordered_map<const Medium*, MediumPtr> placed_;  ///< placed media by the medium of the group
};

}  // namespace aureole
