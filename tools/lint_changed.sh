#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# lint_changed.sh [BASE]: checks the files that differ from the git revision BASE (default: main, else the commit before), committed or not:
# C++ of src and apps by clang-tidy, Python by ruff, shell scripts by shellcheck. Where one of these is not installed, says so and goes on.
# Fails where one of them finds something.
set -euo pipefail
cd "$(dirname "$0")/.."
base=${1:-}
if [[ -z $base ]]; then
  base=HEAD~1
  for name in origin/main main; do
    if git rev-parse -q --verify "$name" > /dev/null && [[ $(git rev-parse "$name") != $(git rev-parse HEAD) ]]; then
      base=$name
      break
    fi
  done
fi
start=$(git merge-base "$base" HEAD)
mapfile -t files < <({ git diff --name-only --diff-filter=d "$start" && git ls-files -o --exclude-standard; } | sort -u)
cpp=() python=() shell=()
for file in "${files[@]}"; do
  [[ -f $file ]] || continue
  case $file in
    src/*.cpp | apps/*.cpp) cpp+=("$file") ;;
    *.py) python+=("$file") ;;
    *.sh | .ci/*) shell+=("$file") ;;
  esac
done
echo "lint: ${#cpp[@]} C++, ${#python[@]} Python, ${#shell[@]} shell files differ from $base"

failed=0
has() {
  command -v "$1" > /dev/null && return
  echo "lint: $1 is not installed, its files are not checked"
  return 1
}
if ((${#cpp[@]})) && has clang-tidy; then
  # Clang's flags, one source a unit and no precompiled headers: nothing has to be compiled first.
  compiler=()
  if command -v clang++ > /dev/null; then compiler=(-DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang); fi
  if cmake -S . -B build/lint -G Ninja -DCMAKE_BUILD_TYPE=Release -DAUREOLE_BATCHES=OFF -DAUREOLE_PRECOMPILED_HEADERS=OFF \
    -DAUREOLE_PYTHON=OFF -DBUILD_TESTING=OFF "${compiler[@]}" > lint-configure.log 2>&1; then
    rm -f lint-configure.log
    printf '%s\0' "${cpp[@]}" | xargs -0 -n 1 -P "${JOBS:-$(nproc)}" clang-tidy --quiet -p build/lint || failed=1
  else
    cat lint-configure.log
    rm -f lint-configure.log
    failed=1
  fi
fi
if ((${#python[@]})) && has ruff; then ruff check "${python[@]}" || failed=1; fi
if ((${#shell[@]})) && has shellcheck; then shellcheck "${shell[@]}" || failed=1; fi
exit $failed
