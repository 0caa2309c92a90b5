// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/direction_pairs.h"

#include "aureole/math/warp.h"

namespace aureole::check {

DirectionPairs make_direction_pairs(CheckRun& run) {
  SeededRandom random(run.options().seed + 9);
  std::vector<Vec3> wi, wo, from;
  std::vector<float> u1;
  std::vector<Vec2> u2;
  for (int k = 0; k < 4000; ++k) {
    wi.push_back(square_to_uniform_sphere(random.next2()));
    wo.push_back(square_to_uniform_sphere(random.next2()));
    if (k % 2) from.push_back(wi.back()), u1.push_back(random.next()), u2.push_back(random.next2());
  }
  std::vector<MaybeSample> drawn;
  run.sample(from, u1, u2, run.query(0), drawn);
  for (std::size_t k = 0; k < drawn.size(); ++k)
    if (drawn[k] && !drawn[k]->is_delta()) wo[2 * k + 1] = drawn[k]->wo;

  DirectionPairs pairs;
  const ScatteringFunction& f = run.function();
  for (std::size_t k = 0; k < wi.size(); ++k)
    if (f.area(wi[k]) >= 1e-3f && f.area(wo[k]) >= 1e-3f)
      pairs.wi.push_back(wi[k]), pairs.wo.push_back(wo[k]);
  run.eval(pairs.wi, pairs.wo, {0, TransportMode::radiance}, pairs.forward);
  run.eval(pairs.wo, pairs.wi, {0, TransportMode::radiance}, pairs.backward);
  run.eval(pairs.wi, pairs.wo, {0, TransportMode::importance}, pairs.adjoint);
  return pairs;
}

}  // namespace aureole::check
