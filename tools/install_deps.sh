#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs from Debian's packages what is missing, and nothing else. Does nothing, quickly, where all is there.
set -euo pipefail
packages=(g++ cmake ninja-build pkg-config ccache clang-format python3
  libembree-dev libtbb-dev libopenexr-dev libpng-dev libjpeg62-turbo-dev libtiff-dev libstb-dev zlib1g-dev
  libpugixml-dev nlohmann-json3-dev libcli11-dev libfmt-dev libboost-math1.81-dev libgtest-dev libbenchmark-dev
  libpolyclipping-dev libkissfft-dev libopencv-core-dev libopencv-imgproc-dev)
missing=()
for p in "${packages[@]}"; do
  dpkg-query -W -f '${db:Status-Status}\n' "$p" 2>/dev/null | grep -qx installed || missing+=("$p")
done
if ((${#missing[@]} == 0)); then exit 0; fi
echo "installing: ${missing[*]}"
sudo=""
if ((EUID != 0)); then sudo="sudo"; fi
export DEBIAN_FRONTEND=noninteractive
$sudo apt-get update -qq
$sudo apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
