#!/bin/sh
# The core is read with Clang's standard library, which the modules for the web use, and macOS. It lacks what some of GCC's has.
#   libcxx.sh ROOT EIGEN FOLDER      exit code 77: Clang or its library is not installed
set -eu
root=$1 eigen=$2 folder=$3
compiler=$(command -v clang++-14 || command -v clang++) || { echo "skipped: Clang is not installed"; exit 77; }
check="$compiler -stdlib=libc++ -std=c++20 -fsyntax-only -w -I$root/pd_core/include -I$root/pd_core/src -isystem $eigen
       -include $root/packaging/npm/libcxx_13.hpp"
mkdir -p "$folder"
: >"$folder/none.cpp"
$check "$folder/none.cpp" 2>"$folder/none.txt" || { cat "$folder/none.txt"; echo "skipped: libc++ is not installed"; exit 77; }
status=0
for room in $(find "$root/pd_core/src" -name '*.cpp' -exec dirname {} + | sort -u); do
  find "$room" -maxdepth 1 -name '*.cpp' | sort | sed 's/.*/#include "&"/' >"$folder/room.cpp"
  $check "$folder/room.cpp" || { echo "$room does not compile"; status=1; }
done
exit $status
