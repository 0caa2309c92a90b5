#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Instructions per sample by callgrind: what a render of many samples takes more than one of few, so that loading does not count. One
# thread, small pictures, the sampler sobol; the numbers are the same on a busy machine. Usage: bench/instructions.sh [PROGRAM]
set -euo pipefail
. "$(dirname "$0")/scenes.sh"
program=${1:-$root/build/release/bin/aureole}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

instructions() {  # SPP SCENE ARGUMENTS...
  local spp=$1
  shift
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" render "$@" --sampler sobol --spp "$spp" --threads 1 -q \
    -o "$folder/out.exr" --restart 2>&1 | sed -n 's/.*Collected *: *\([0-9]*\).*/\1/p'
}

measure() {  # NAME PIXELS SCENE ARGUMENTS...
  local name=$1 pixels=$2 few many
  shift 2
  few=$(instructions 16 "$@")
  many=$(instructions 80 "$@")
  awk -v name="$name" -v d=$((many - few)) -v n=$((pixels * 64)) 'BEGIN { printf "%-14s %7.0f instructions per sample\n", name, d / n }'
}

if have cbox "$cbox"; then
  measure cbox 2304 "$cbox" -D res=48
  measure "cbox ptracer" 2304 "$cbox" -D res=48 --integrator ptracer
  measure "cbox bdpt" 2304 "$cbox" -D res=48 --integrator bdpt
fi
if have matpreview "$matpreview"; then measure matpreview 3072 "$matpreview" -D width=64 -D height=48; fi
measure condensation 1536 "$demo" -D width=48 -D height=32
measure fog 384 "$root/scenes/media/fog.xml" -D width=24 -D height=16
measure milk 384 "$root/scenes/milk/milk.xml" -D width=24 -D height=16
measure caustic 768 "$root/bench/two_way/caustic.xml" -D width=32 -D height=24
star_box=$shared/data/cornell-box/box.xml
if have "star box" "$star_box"; then measure "star box" 576 "$star_box" -D res=24 -D spp=16 --integrator path; fi
