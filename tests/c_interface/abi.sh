#!/bin/sh
# abi.sh check|update LIBRARY: compares libpdepth.so and the types of pdepth.h with the stored description of the ABI, abi.xml,
# or writes that anew. Exit code 77: abidw (Debian: abigail-tools) or a C compiler is not installed, or this is not x86-64.
#
# Types stand in debug information alone, and the library is built without it. So the header's functions are compiled once more,
# without bodies of their own; the compiler has already held the library's functions to the header's declarations.
set -eu
mode=$1 library=$2
here=$(cd "$(dirname "$0")" && pwd)
core=$here/../../pd_core
: "${CC:=cc}"
for tool in abidw abidiff "$CC"; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
[ "$(uname -m)" = x86_64 ] || { echo "skipped: abi.xml describes x86-64"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

header=$core/include/pdepth/pdepth.h
{
  echo '#include <pdepth/pdepth.h>'
  awk '/^[a-z].*pdepth_[a-z_]*\(/ { inside = 1 } inside { print } /;$/ { inside = 0 }' "$header" |
    sed 's/);$/) { __builtin_trap(); }/'
} >"$work/types.c"
# The source is named without its folder, which would stand in the description.
(cd "$work" && "$CC" -std=c99 -g -shared -fPIC -w "-I$core/include" types.c \
  "-Wl,--version-script=$core/src/c_interface/exports.map" -Wl,-soname,libpdepth.so.0 -o types.so)

functions() { nm -D --defined-only "$1" | awk '{print $3}' | sort; }
functions "$library" >"$work/exported"
functions "$work/types.so" >"$work/declared"
if ! diff "$work/declared" "$work/exported"; then
  echo "the library does not export what pdepth.h declares (< declared, > exported)"
  exit 1
fi
if [ "$mode" = update ]; then
  abidw --no-show-locs --no-corpus-path --no-comp-dir-path --type-id-style hash "$work/types.so" >"$here/abi.xml"
  exit 0
fi
if ! abidiff "$here/abi.xml" "$work/types.so"; then
  echo "The ABI has changed. Additions: abi.sh update LIBRARY. Anything else breaks programs that are linked already,"
  echo "and needs another version of the library and of the symbols."
  exit 1
fi
