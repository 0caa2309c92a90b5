// SPDX-License-Identifier: Apache-2.0
// Light in a medium between two surfaces. A segment has two estimators: distance sampling, which may scatter
// the path along it, and transmittance, the fraction of a connection's light that arrives.
//
// Coefficients that vary are handled by null collisions (Miller, Georgiev & Jarosz 2019, "A null-scattering
// path integral formulation of light transport"): the medium is filled up to a majorant with matter that
// changes nothing, and the positions of such collisions belong to the path. The majorant is the largest over
// the wavelengths of a path, so that the pdf of collisions is the same for all of them and cancels.
#pragma once

#include "aureole/scene/emitting_media.h"
#include "aureole/spectrum/path_density.h"
#include "aureole/transport/dimensions.h"
#include "aureole/transport/ray_state.h"

namespace aureole {

/// A position where a path is scattered in a medium.
struct MediumPoint {
  Vec3 p;
  const Medium* medium = nullptr;
};

/// Random numbers of distance sampling: `first` decides where the first collision is, `key` gives all others.
struct DistanceRandom {
  float first;
  std::uint32_t key;
};

/// A vertex from which light sampling could have chosen a light; `facing` as of `Vertex::facing`.
struct LightReference {
  Vec3 p, facing;
};

/// How next-event estimation has sampled the emission of media along a ray.
struct EmissionSampling {
  /// the media that were sampled; null: no emission of media was sampled
  const EmittingMedia* media = nullptr;
  LightReference from;  ///< the vertex that the emission was sampled from
  /// The part of the path's `r_l` that counts: connections that only sample surfaces are not part of it.
  Spectrum share{1.f};
};

/// Emission of a medium along a segment, towards its origin.
struct SegmentEmission {
  /// Ratios of pdfs of the path before the segment (`BasicPathDensity`).
  Spectrum r_u{1.f}, r_l{0.f};
  /// The lights among which connections from the last vertex have sampled emission; null where connections
  /// have not sampled emission.
  const EmittingMedia* media = nullptr;
  LightReference from{};
  /// An estimate of the radiance over the sum of the pdfs of all techniques that find it.
  Spectrum radiance{0.f};
};

/// Distance sampling along `ray`, whose direction has unit length, up to the distance t_max. Returns true
/// where the path is scattered before, at the distance `t`: the value of the passage then holds the
/// scattering coefficient, its `flight` the pdf of this position, and its `connection` that of a technique
/// which goes to the position without a choice. False where the path arrives at t_max. Adds to `emission`
/// unless that is null.
bool sample_distance(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                     DistanceRandom random, Passage& passage, SegmentEmission* emission, float& t);

/// Distance sampling for a path with that density, from its vertex number `vertex`: `density` becomes that at
/// the end of the segment, and `p` the position where it is scattered. The medium's emission is added to
/// `estimate`, unless that is null, weighted against what `sampling` has found. Where the path is scattered
/// `chosen` receives the pdf of the path had its last position been sampled with density 1, relative to the
/// hero's pdf of distance sampling.
template <class Density>
bool sample_distance(const RayState& state, float t_max, const Wavelengths& w, SampleStream& samples,
                     int vertex, Density& density, Spectrum* estimate, Vec3& p,
                     const EmissionSampling& sampling, Spectrum& chosen) {
  const DistanceRandom random{get(samples, vertex, Choice::distance), key(samples, vertex, Stream::distance)};
  Passage passage;
  float t;
  bool scattered;
  const Ray ray = state.from_surface();
  const auto sample = [&](SegmentEmission* emission) {
    scattered = sample_distance(*state.medium, ray, t_max + state.offset, w, random, passage, emission, t);
  };
  if constexpr (Density::kBegin == PathStart::sensor) {
    if (estimate && state.medium->emits()) {
      SegmentEmission emission{density.r_u, density.r_l * sampling.share,
                               density.has_light_ratio() ? sampling.media : nullptr, sampling.from};
      sample(&emission);
      if (!is_black(emission.radiance)) *estimate += density.seen(emission.radiance) / w.pdf;
    } else {
      sample(nullptr);
    }
  } else {
    sample(nullptr);
  }
  if (scattered) {
    chosen = density.r_u * passage.connection;
    p = ray.o + ray.d * t;
  }
  density.pass(passage);
  return scattered;
}

/// Cuts the ray just behind the position where `sample_distance` will scatter it, given the first of its
/// random numbers, where that is known before: the ray tracer then searches no farther. Not for rays along
/// the whole of which something is sampled or seen.
void cut_at_collision(RayState& state, const Wavelengths& w, float first);

/// The pdf per length with which the MIS weights of all techniques assume that distance sampling finds
/// emission at `p`. The transmittance to `p` is not part of it. `inverse_size` is the inverse of the medium's
/// size.
float emission_rate(const Medium& medium, const Vec3& p, const Vec3& d, const Spectrum& sigma_t,
                    float inverse_size, const Wavelengths& w);

/// Transmittance of a medium.
struct Transmittance {
  /// An estimate, unbiased for each wavelength, or the exact value. It equals the ratio of two pdfs: of a
  /// walk that passes the segment, and of passing it without any scattering event.
  Spectrum value{1.f};
  float roulette = 1;  ///< factor of the estimate that is in no pdf; 0 where Russian roulette ended it
};
/// Transmittance along `ray` from its origin to the distance t_max. Adds the medium's emission to `emission`,
/// unless that is null; the `r_u` of `emission` is also the pdf of arriving at t_max, since nothing is
/// scattered.
Transmittance transmittance(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                            std::uint32_t key, SegmentEmission* emission = nullptr);
/// Transmittance without Russian roulette, for a path that may be scattered at the distance `t`.
Spectrum transmittance_to(const Medium& medium, const Ray& ray, float t, const Wavelengths& w,
                          std::uint32_t key);

}  // namespace aureole
