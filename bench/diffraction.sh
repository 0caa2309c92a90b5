#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# CPU seconds of a render with diffraction over those without: the box with a star of Steinberg et al., all of whose edges lie in one
# beam, and Mitsuba's Cornell box, far from whose edges visible light stays,
# by both models. One thread, in turns; RES and REPEATS make it shorter. Usage: bench/diffraction.sh [PROGRAM]
set -euo pipefail
. "$(dirname "$0")/scenes.sh"
program=${1:-$root/build/release/bin/aureole}
star_box=$shared/data/cornell-box/box.xml
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

seconds() {  # ARGUMENTS...
  local TIMEFORMAT=%U
  { time "$program" render "$@" --threads 1 -q -o "$folder/out.exr" --restart > /dev/null 2> "$folder/errors"; } 2> "$folder/time" ||
    { cat "$folder/errors" >&2; return 1; }
  cat "$folder/time"
}

measure() {  # NAME PARAMETER SCENE ARGUMENTS...
  local name=$1 parameter=$2 on=() off=()
  shift 2
  for _ in $(seq "${REPEATS:-5}"); do
    on[${#on[@]}]=$(seconds "$@" -D "$parameter=true")
    off[${#off[@]}]=$(seconds "$@" -D "$parameter=false")
  done
  printf '%s\n' "${on[*]}" "${off[*]}" | awk -v name="$name" '
    { $1 = $1; least = $1; for (i = 2; i <= NF; ++i) if ($i < least) least = $i; s[NR] = least }
    END { printf "%-32s %6.2f s  without %6.2f s  ratio %5.2f\n", name, s[1], s[2], s[1] / s[2] }'
}

for model in ${MODELS:-segments beams}; do
  for integrator in ${INTEGRATORS:-path ptracer bdpt}; do
    if have "star box, $model, $integrator" "$star_box"; then
      ln -sf "$(dirname "$star_box")"/*.obj "$folder/"
      sed "s|<spectrum name=\"wavelengths\"|<string name=\"diffraction_model\" value=\"$model\"/>&|" "$star_box" > "$folder/box.xml"
      grep -q diffraction_model "$folder/box.xml"
      measure "star box, $model, $integrator" fsd "$folder/box.xml" -D "res=${RES:-96}" -D spp=16 --integrator "$integrator" --spp 16
    fi
    if have "cbox, $model, $integrator" "$cbox"; then
      options="<boolean name=\"diffraction\" value=\"\$diffraction\"/><string name=\"diffraction_model\" value=\"$model\"/>"
      sed "s|<integrator type=\"path\">|&$options|" "$cbox" > "$folder/cbox.xml"
      grep -q diffraction_model "$folder/cbox.xml"
      ln -sf "$(dirname "$cbox")"/meshes "$folder/"
      measure "cbox, $model, $integrator" diffraction "$folder/cbox.xml" -D "res=${RES:-96}" --sampler sobol --integrator "$integrator" --spp 32
    fi
  done
done

# Leaves before the sun: a crowd of edges.
leaves=$root/scenes/diffraction/leaves.xml
# shellcheck disable=SC2016
sed -e '/diffraction_model\|beam_width/d' -e 's|<boolean name="diffraction" value="true"/>|<boolean name="diffraction" value="$diffraction"/>|' "$leaves" > "$folder/leaves.xml"
grep -q 'name="diffraction" value="[$]diffraction"' "$folder/leaves.xml"
ln -sf "$(dirname "$leaves")"/leaves.obj "$folder/"
measure "leaves, segments, path" diffraction "$folder/leaves.xml" -D "width=${RES:-96}" -D "height=${RES:-96}" --spp 32
