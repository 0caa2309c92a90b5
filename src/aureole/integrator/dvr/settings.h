// SPDX-License-Identifier: Apache-2.0
// `DvrSettings`: the conventions by which the integrator `dvr` makes a picture of a volume.
#pragma once

#include <vector>

#include "aureole/plugin/registry.h"

namespace aureole {

struct DvrSettings {
  enum class Method {
    composite,
    emission_absorption,
    single_scattering,
    isosurface,
    mip,
    average,
    xray,
    splatting
  };
  /// The colour of a step: `premultiplied`, the light emitted along it; `opacity_weighted`, that light times
  /// the opacity of the step.
  enum class Form { premultiplied, opacity_weighted };
  enum class Alpha { exponential, taylor };
  enum class Order { front_to_back, back_to_front };
  /// The planes on which splatting sums footprints: planes of voxels, or planes parallel to the picture.
  enum class Sheets { axis, image };
  /// Lengths of steps: all equal; halved until the light of a step agrees with the light of its halves; set
  /// by the bounds of blocks.
  enum class Steps { fixed, adaptive, by_opacity };

  Method method;
  Form form;
  Alpha alpha;
  Order order;
  Sheets sheets;
  Steps steps;
  bool preintegrated, jitter, skip_empty;
  bool interleaves;   ///< whether the phases of jitter follow a pattern of pixels; else they are random
  float step;         ///< length of a step in world space; 0: half of the smallest distance between voxels
  float termination;  ///< transmittance below which the rest of a ray is left out; 0: never
  /// tolerance of emission_absorption, relative to the light of the ray, and of adaptive steps
  float tolerance;
  float step_opacity;  ///< largest part of the light from behind that a step `by_opacity` can absorb
  float kernel_width;  ///< standard deviation of splatting's kernel [voxels]
  Vec3 view{0, 0, 1};  ///< unit direction in which the sensor looks, for splatting
  bool gradient_lighting, shadows, halfway;
  int occlusion_samples;   ///< rays of ambient occlusion; 0: none
  float occlusion_radius;  ///< length of the rays of ambient occlusion in world space
  std::vector<float> isovalues;

  static DvrSettings read(const Properties& properties);
  static std::vector<ParameterDoc> rows();
};

}  // namespace aureole
