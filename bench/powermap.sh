#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A power map of 512 x 512 cells in a city of a million triangles at 10 GHz: time, and the standard error of its cells in dB from
# four independent maps. TRIANGLES, SPP, CELLS and INTEGRATOR change it; further arguments go to `aureole powermap`.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
aureole=${AUREOLE:-build/release/bin/aureole}
folder=build/city
python3 bench/powermap/make_city.py $folder --triangles "${TRIANGLES:-1000000}" --frequency 10GHz
time "$aureole" powermap $folder/city.xml -o $folder/city.exr -D cells="${CELLS:-512}" \
  --spp "${SPP:-16}" --replicates 4 --integrator "${INTEGRATOR:-ptracer}" "$@"
