#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# ccache.sh CCACHE SOURCE_FOLDER COMPILER ARGUMENTS...: the compiler behind a compiler cache that knows paths below the source folder
# relative to it, so that it serves every checkout. A precompiled header is known by a checksum beside it, of the text of all the headers
# in it: the compiler never writes the same bytes twice, and hashing its 100 MB for each file would take a third of the compiler's time.
export CCACHE_BASEDIR="$2" CCACHE_PCH_EXTSUM=1
export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
ccache=$1
shift 2
case " $* " in
  *" -x c++-header "*) ;;
  *) exec "$ccache" "$@" ;;
esac
header='' dependencies=''
previous=''
for argument; do
  case $previous in
    -o) header=$argument ;;
    -MF) dependencies=$argument ;;
  esac
  previous=$argument
done
# Not by the cache: it compares preprocessed text, which has no comments. After an edit of comments alone it would return the precompiled form
# of the older headers, whose include guards the compiler does not recognise in the edited ones ("redefinition of class").
[ -n "$header" ] && rm -f "$header" "$header.sum"
"$@" || exit
[ -n "$header" ] && [ -f "$dependencies" ] || exit 0
# "target: header \ header ...", without the generated header, which names all others by their paths.
names=$(sed -e 's/^[^:]*://' -e 's/\\$//' "$dependencies" | tr -s ' ' '\n' | grep -v -e '^$' -e cmake_pch)
# Without a checksum, where a header cannot be read, ccache takes the precompiled header itself.
if printf '%s\n' "$names" | xargs ls > /dev/null 2>&1; then
  printf '%s\n' "$names" | xargs cat | sha256sum > "$header.sum"
fi
exit 0
