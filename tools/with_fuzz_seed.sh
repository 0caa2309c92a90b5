#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# with_fuzz_seed.sh COMMAND...: runs the command with "--seed N", N a number made from the commit, so that every
# commit is tested with other cases and the same one always with the same. Without a command it prints N.
set -euo pipefail
commit=$(git -C "$(dirname "$0")" rev-parse HEAD 2>/dev/null || true)
seed=1
[[ -z $commit ]] || seed=$((16#${commit:0:8}))
if (($# == 0)); then
  echo "$seed"
else
  exec "$@" --seed "$seed"
fi
