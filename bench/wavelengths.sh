#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# 4 or 8 wavelengths per path: builds both (build/bench4, build/bench) and compares time and noise over 16 independently
# scrambled pictures. efficiency = mean^2/(variance of a pixel between seeds x CPU seconds of a picture); "by pixel" takes
# the variance in units of the pixel's own squared mean. REPEATS (default 3) runs of each, the fastest counts.
set -euo pipefail
. "$(dirname "$0")/scenes.sh"
repeats=${REPEATS:-3}
cd "$root"
for n in 4 8; do
  folder=build/bench$(if [[ $n == 4 ]]; then echo 4; fi)
  cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release -DAUREOLE_BENCH=ON -DBUILD_TESTING=OFF \
    -DAUREOLE_WAVELENGTHS=$n > /dev/null
  cmake --build "$folder" --target aureole_render_bench >&2
done

build/bench/bin/aureole_render_bench --header efficiency
both() {
  for folder in build/bench4 build/bench; do
    $folder/bin/aureole_render_bench "$@" --spp 32 --sampler sobol --replicates 16 --repeats "$repeats"
  done
}
if have cbox-spectral "$cbox_spectral"; then both cbox-spectral "$cbox_spectral" -D res=128; fi
if have matpreview "$matpreview"; then both matpreview "$matpreview" -D width=171 -D height=128; fi
both condensation "$demo" -D width=180 -D height=120
