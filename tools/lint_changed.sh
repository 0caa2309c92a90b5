#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# lint_changed.sh [BASE]: checks all Python files by ruff and all shell scripts by shellcheck, which take a second, and by clang-tidy the C++
# of src and apps that differs from the git revision BASE (default: main, else the commit before), committed or not. Where one of these is
# not installed, says so and goes on. Fails where one of them finds something.
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
start=$(git merge-base "$base" HEAD 2> /dev/null || git rev-parse HEAD)  # a shallow clone does not have the base
mapfile -t files < <({ git diff --name-only --diff-filter=d "$start" && git ls-files -o --exclude-standard; } | sort -u)
cpp=()
for file in "${files[@]}"; do
  [[ -f $file ]] || continue
  case $file in
    src/*.cpp | apps/*.cpp) cpp+=("$file") ;;
  esac
done
mapfile -t shell < <(git ls-files -co --exclude-standard '*.sh' '.ci/*')
echo "lint: ${#cpp[@]} C++ files differ from $base"

failed=0
PATH=$PATH:$PWD/.venv/bin  # `make deps` installs ruff and shellcheck there
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
if has ruff; then ruff check . || failed=1; fi
if has shellcheck; then shellcheck "${shell[@]}" || failed=1; fi
exit $failed
