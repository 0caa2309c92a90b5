// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/integrator.h"

#include "aureole/core/keyed_random.h"
#include "aureole/plugin/registry.h"
#include "aureole/transport/connection.h"
#include "aureole/transport/diffraction.h"
#include "aureole/transport/dimensions.h"

namespace aureole {

namespace {

/// Estimates the light that arrives at a receiver from an emitter that no ray can hit, as the radiance along
/// the path's ray: divided by the integral of the response.
Spectrum received(const Scene& scene, const Receiver& receiver, const Path& path) {
  // A walk from the sensor has no vertex -1, so that its random numbers are free.
  KeyedRandom random(key(path.samples, -1, Stream::receiver));
  const auto choice = scene.lights().choose(receiver.p, receiver.facing(), random.next());
  if (!choice || !(choice->probability > 0) || !choice->light->is_delta()) return 0.f;
  const Vec2 u{random.next(), random.next()};
  const auto direct = choice->light->sample_direct(receiver.p, choice->part, u, path.wavelengths);
  if (!direct || !(direct->pdf > 0) || is_black(direct->radiance)) return 0.f;
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
    c.begin_in(start, std::uint32_t(random.next() * 0x1p32f));
  }
  c.weigh(scene.has_media(), choice->probability * direct->pdf, 0.f, path.wavelengths);
  const bool open = arrives(scene, c, path.wavelengths, key(path.samples, -1, Stream::receiver));
  return open ? c.estimate() : Spectrum(0.f);
}

}  // namespace

void Integrator::estimate(const Scene& scene, std::span<Path> paths, std::vector<Splat>& splats,
                          const BatchLog& log) const {
  trace(scene, paths, splats, log);
  if (!shows_emitters() || scene.lights().empty()) return;
  for (size_t i = 0; i < paths.size(); ++i) {
    const auto receiver = scene.sensor().receiver(paths[i].film);
    if (!receiver) continue;
    const Spectrum light = received(scene, *receiver, paths[i]);
    if (log.follows(int(i)) && !is_black(light))
      log({.kind = PathEvent::Kind::other, .estimate = light, .text = "from an emitter to the receiver"});
    paths[i].result.estimate += light;
  }
}

AUREOLE_FAMILY(FamilyInfo{.name = "integrator", .fallback = "path"});

}  // namespace aureole
