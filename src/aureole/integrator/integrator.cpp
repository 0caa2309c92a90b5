// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/integrator.h"

#include <optional>

#include "aureole/plugin/registry.h"
#include "aureole/transport/diffraction.h"
#include "aureole/transport/next_event.h"

namespace aureole {

namespace {

/// Whether light sampling at a receiver finds lights that rays of the receiver hit as well.
bool samples_all_lights(const Receiver& receiver, Integrator::ReceiverRays rays) {
  return rays != Integrator::ReceiverRays::unweighted && receiver.measure != Receiver::Measure::far;
}

/// Estimates the light that arrives at a receiver from an emitter, by light sampling, as the radiance along
/// the path's ray: divided by the integral of the response.
Spectrum received(const Scene& scene, const Receiver& receiver, Path& path, Integrator::ReceiverRays rays,
                  bool go_behind) {
  // The estimate is added to that of the walk, so that both may use the random numbers of the first vertex.
  const LightSample sample =
      sample_light(scene, receiver.p, receiver.facing(), get(path.samples, 0, Choice::light),
                   get(path.samples, 0, Pair::connection), path.wavelengths);
  if (!sample.has_light()) return 0.f;
  const auto& [choice, direct] = sample;
  if (!choice.light->is_delta() && !samples_all_lights(receiver, rays)) return 0.f;
  const float share = receiver.pdf(direct->wo);
  if (!(share > 0)) return 0.f;
  const RayOrigin from{receiver.p, receiver.p_error, receiver.ng};
  Connection c;
  if (direct->infinite)
    c.set(from, direct->wo);
  else
    c.set(from, direct->wo, RayOrigin::of(*direct));
  c.near = Weight(Spectrum(share));
  c.far = Unpolarised::emitted(direct->radiance);
  if (scene.has_media()) {
    RayState start{c.ray, nullptr, {}};
    find_interiors(scene, nullptr, start);
    c.begin_in(start, key(path.samples, -1, Stream::receiver));
    c.others_pass = rays != Integrator::ReceiverRays::scattered;
  }
  c.others_go_behind = go_behind;
  // The ray of the path has the pdf `share` of this direction.
  c.weigh(scene.has_media(), choice.probability * direct->pdf, direct->delta ? 0.f : share, path.wavelengths);
  const bool open = arrives(scene, c, path.wavelengths, key(path.samples, -1, Stream::receiver));
  return open ? c.estimate() : Spectrum(0.f);
}

}  // namespace

void Integrator::estimate(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
                          const BatchLog& log) const {
  if (!shows_emitters() || scene.lights().empty()) return trace(scene, paths, splats, log);
  const ReceiverRays rays = receiver_rays();
  const Arena::Frame frame;
  const auto receivers = frame.arena().make<std::optional<Receiver>>(paths.size());
  for (size_t i = 0; i < paths.size(); ++i) {
    receivers[i] = scene.sensor().receiver(paths[i].film);
    if (receivers[i] && samples_all_lights(*receivers[i], rays)) paths[i].receiver = &*receivers[i];
  }
  trace(scene, paths, splats, log);
  for (size_t i = 0; i < paths.size(); ++i) {
    paths[i].receiver = nullptr;
    if (!receivers[i]) continue;
    const Spectrum light = received(scene, *receivers[i], paths[i], rays, rays_go_behind());
    if (log.follows(int(i)) && !is_black(light))
      log({.kind = PathEvent::Kind::other, .estimate = light, .text = "from an emitter to the receiver"});
    paths[i].result.estimate += light;
  }
}

AUREOLE_FAMILY(FamilyInfo{.name = "integrator", .fallback = "path"});

}  // namespace aureole
