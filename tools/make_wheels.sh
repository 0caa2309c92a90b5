#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds wheels for CPython 3.9, 3.10, 3.11 and, as one, 3.12 and later: make_wheels.sh [FOLDER]. Interpreters are python3.9 to python3.12 of PATH
# or those that pyenv has installed; PYTHON_3_9=FILE and so on name others. An interpreter that is not there is said, and the exit code is 1.
set -euo pipefail
folder=${1:-dist}
cd "$(dirname "$0")/.."
missing=()
for version in 3.9 3.10 3.11 3.12; do
  name=PYTHON_${version/./_}
  python=${!name:-}
  for candidate in "${PYENV_ROOT:-$HOME/.pyenv}"/versions/"$version".*/bin/python "$(command -v "python$version" || true)"; do
    # pyenv's stand-ins for versions that are not active are no interpreters.
    if [[ -z "$python" && -x "$candidate" ]] && "$candidate" -c 'import venv, ensurepip' 2> /dev/null; then python=$candidate; fi
  done
  if [[ -z "$python" ]]; then missing+=("$version"); continue; fi
  tools/make_wheel.sh "$folder" "$python"
done
if ((${#missing[@]})); then
  echo "no wheels were made for CPython ${missing[*]}: there is no such interpreter with the module venv" >&2
  exit 1
fi
