#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A power map of 512 x 512 cells in a city of a million triangles at 10 GHz: time, and the standard error of its cells in dB from
# four independent maps, apart for those that only diffraction reaches (with the Python package in build/release/python).
# TRIANGLES, SPP, CELLS, DEPTH and INTEGRATOR change it; further arguments go to `aureole powermap`.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
aureole=${AUREOLE:-build/release/bin/aureole}
folder=build/city
depth=${DEPTH:-6}
python3 bench/powermap/make_city.py $folder --triangles "${TRIANGLES:-1000000}" --frequency 10GHz
map() { "$aureole" powermap $folder/city.xml -o "$folder/$1.exr" -D cells="${CELLS:-512}" --integrator "${INTEGRATOR:-ptracer}" "${@:2}"; }
time map city -D depth="$depth" --spp "${SPP:-16}" --replicates 4 "$@"
# Cells that light reaches without diffraction, and by one diffraction alone.
map plain -D depth="$depth" -D diffraction=false --spp "${SPP:-16}" --replicates 4
map once -D depth=2 --spp "${SPP:-16}" --replicates 4
PYTHONPATH=build/release/python "${PYTHON:-python3}" bench/powermap/cells.py $folder/city.exr --plain $folder/plain.exr --once $folder/once.exr
