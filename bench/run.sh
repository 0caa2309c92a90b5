#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Prints every measurement of docs/performance.md but the choice of the number of wavelengths (wavelengths.sh).
# Usage: bench/run.sh [folder of the benchmark programs]; REPEATS (default 3) renders of each scene, the best counts.
set -euo pipefail
. "$(dirname "$0")/scenes.sh"
bin=${1:-$root/build/bench/bin}
repeats=${REPEATS:-3}

if [[ ! -x $bin/aureole_render_bench ]]; then
  echo "there is no $bin/aureole_render_bench: configure with -DAUREOLE_BENCH=ON" >&2
  exit 1
fi

echo "== Renders: 2 threads, best of $repeats"
render=$bin/aureole_render_bench
"$render" --header speed
if have cbox "$cbox"; then
  "$render" cbox "$cbox" -D res=256 --spp 64 --sampler sobol --repeats "$repeats"
fi
if have matpreview "$matpreview"; then
  "$render" matpreview "$matpreview" -D width=342 -D height=256 --spp 64 --sampler sobol --repeats "$repeats"
fi
"$render" condensation "$demo" -D width=360 -D height=240 --spp 32 --repeats "$repeats"

echo
echo "== Where the time goes: % of the samples of perf, 1 thread"
if perf record -o /dev/null -- true > /dev/null 2>&1; then
  "$root/bench/profile.sh" "$bin"
else
  echo "skipped: perf is not installed or not allowed (apt-get install linux-perf)"
fi

echo
echo "== Single functions: CPU nanoseconds per call, least of 5 runs; pdf is eval_pdf"
"$bin/aureole_bench" --benchmark_min_time=0.05 --benchmark_repetitions=5 --benchmark_format=csv 2> /dev/null |
  awk '
    /^"/ && !/_(mean|median|stddev|cv)"/ {
      line = $0; match(line, /^"[^"]*"/); name = substr(line, 2, RLENGTH - 2); rest = substr(line, RLENGTH + 2)
      split(rest, f, ",")
      if (f[3] == "") next  # skipped
      if (!(name in least)) { order[++n] = name; least[name] = f[3] }
      if (f[3] < least[name]) least[name] = f[3]
    }
    END { for (i = 1; i <= n; ++i) printf "%-42s %8.1f\n", order[i], least[order[i]] }'
