#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# install_deps.sh [program]: installs the missing Debian packages: for the program alone, or also for the tests, the benchmarks
# and the Python module, whose virtual environment .venv it makes. Does nothing, quickly, where all is there.
set -euo pipefail
packages=(g++ cmake ninja-build pkg-config ccache python3
  libembree-dev libtbb-dev libopenexr-dev libpng-dev libjpeg62-turbo-dev libtiff-dev liblcms2-dev libstb-dev zlib1g-dev libbz2-dev liblzma-dev liblz4-dev
  libpugixml-dev nlohmann-json3-dev libcli11-dev libfmt-dev libboost-math1.81-dev
  libpolyclipping-dev libkissfft-dev libeigen3-dev libcerf-dev libopenvdb-dev libnanovdb-dev libblosc-dev libzstd-dev libblas3 liblapack3)
# Headers and static libraries of these are taken into build/opencv where they are not installed: 4 MB. Their packages depend on the shared
# libraries, these on OpenGL, and so on Mesa and LLVM: 41 packages and 200 MB that nothing here uses.
opencv=(libopencv-core-dev libopencv-imgproc-dev)
cd "$(dirname "$0")/.."
if [[ "${1:-}" != program ]]; then
  packages+=(clang clang-format clang-tidy python3-dev python3-venv libgtest-dev libbenchmark-dev)
fi
is_installed() { dpkg-query -W -f '${db:Status-Status}\n' "$1" 2> /dev/null | grep -qx installed; }
missing=()
for p in "${packages[@]}"; do
  is_installed "$p" || missing+=("$p")
done
sudo=""
if ((EUID != 0)); then sudo="sudo"; fi
if ((${#missing[@]})); then
  echo "installing: ${missing[*]}"
  export DEBIAN_FRONTEND=noninteractive
  $sudo apt-get update -qq
  $sudo apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
fi

# The folder gets its name last, when it is complete.
if [[ ! -d build/opencv ]] && ! { is_installed "${opencv[0]}" && is_installed "${opencv[1]}"; }; then
  echo "taking OpenCV's static libraries from ${opencv[*]}"
  rm -rf build/opencv-unfinished
  mkdir -p build/opencv-unfinished
  cd build/opencv-unfinished
  # As the user who runs this: apt's own one may not write here. Lists of packages may be missing where nothing had to be installed.
  download=(apt-get download -qq -o APT::Sandbox::User="$(id -un 2> /dev/null || echo root)" "${opencv[@]}")
  "${download[@]}" 2> /dev/null || { $sudo apt-get update -qq && "${download[@]}"; }
  for p in ./*.deb; do dpkg-deb -x "$p" .; done
  rm ./*.deb
  cd ../..
  mv build/opencv-unfinished build/opencv
fi

if [[ "${1:-}" == program ]]; then exit 0; fi

# The virtual environment: made of nothing where it is broken, half made or of another Python; brought up to date where only the
# requirements have changed. The stamp is written last. A link is somebody's own environment and stays as it is.
if [[ -L .venv ]]; then exit 0; fi
python=$(command -v "${PYTHON:-python3}")
requirements=python/requirements.txt
interpreter=$("$python" -c 'import sys; print(sys.version, sys.base_prefix)')
wanted="$interpreter
$(sha256sum < $requirements)"
stamp=.venv/made-from
found=""
if [[ -f $stamp ]] && .venv/bin/python -c 'import pip' 2> /dev/null; then found=$(< $stamp); fi
if [[ "$found" == "$wanted" ]]; then exit 0; fi
echo "making the virtual environment .venv (Python packages of $requirements, from PyPI)"
if [[ "$found" == "$interpreter"* ]]; then rm $stamp; else rm -rf .venv && "$python" -m venv .venv; fi
.venv/bin/python -m pip install -q --disable-pip-version-check -r $requirements || {
  echo "the packages of $requirements could not be installed; without the Python module: cmake -S . -B build/native -DAUREOLE_PYTHON=OFF" >&2
  exit 1
}
printf '%s\n' "$wanted" > $stamp
