#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `bdpt` beside `path` and `ptracer` on a caustic and on a room of indirect light (bench/two_way): time and noise over 16
# independently scrambled pictures, as bench/wavelengths.sh does. Samples are those of a pixel; one of `bdpt` takes longer.
set -euo pipefail
. "$(dirname "$0")/scenes.sh"
cd "$root"
cmake -S . -B build/bench -G Ninja -DCMAKE_BUILD_TYPE=Release -DAUREOLE_BENCH=ON -DBUILD_TESTING=OFF > /dev/null
cmake --build build/bench --target aureole_render_bench >&2

build/bench/bin/aureole_render_bench --header efficiency
for scene in caustic indirect_room; do
  for integrator in path ptracer bdpt; do
    build/bench/bin/aureole_render_bench "$scene, $integrator" bench/two_way/$scene.xml -D integrator=$integrator \
      --spp "$([[ $integrator == bdpt ]] && echo 64 || echo 256)" --sampler sobol --replicates 16 --repeats "${REPEATS:-3}"
  done
done
