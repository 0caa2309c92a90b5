#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# ccache.sh CCACHE SOURCE_FOLDER COMPILER ARGUMENTS...: the compiler behind a compiler cache that knows paths below the source folder
# relative to it, so that it serves every checkout, and that knows a precompiled header (more than 100 MB) by a checksum made once
# beside it: hashing the header for each file would take a third of the compiler's own time.
export CCACHE_BASEDIR="$2" CCACHE_PCH_EXTSUM=1
export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
ccache=$1
shift 2
"$ccache" "$@" || exit
case " $* " in
  *" -x c++-header "*) ;;
  *) exit 0 ;;
esac
while [ $# -gt 1 ]; do
  if [ "$1" = -o ]; then sha256sum < "$2" > "$2.sum"; fi
  shift
done
