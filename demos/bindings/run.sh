#!/bin/sh
# run.sh CLIENT LIBRARY FOLDER: builds a client (c, python, rust, csharp, lua) in the folder, runs it with the library
# libpdepth.so, and compares what it prints. Exit code 77: the client's tools are not installed.
set -eu
client=$1 library=$2 folder=$3
here=$(cd "$(dirname "$0")" && pwd)
include=$here/../../pd_core/include
libraries=$(dirname "$library")
mkdir -p "$folder"
cd "$folder"

need() {
  for tool in "$@"; do
    command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }
  done
}

export LD_LIBRARY_PATH="$libraries"
case $client in
  c)
    need "${CC:=cc}"
    "$CC" -std=c99 -pedantic -Wall -Wextra -Werror "$here/c/client.c" "-I$include" "-L$libraries" -lpdepth -o client
    ./client >found ;;
  python)
    need python3
    python3 -B "$here/python/client.py" "$library" >found ;;
  rust)
    need "${RUSTC:=$(command -v /usr/bin/rustc || echo rustc)}"
    "$RUSTC" --edition 2021 -D warnings -O "$here/rust/src/main.rs" -L "native=$libraries" -l dylib=pdepth -o client
    ./client >found ;;
  csharp)
    need mcs mono
    mcs -unsafe -warnaserror -nowarn:649 -out:client.exe "$here/csharp/Client.cs" "$here/csharp/Pdepth.cs"
    mono client.exe >found ;;
  lua)
    need luajit
    luajit "$here/lua/client.lua" "$here/lua" "$include/pdepth/pdepth.h" "$library" >found ;;
  *)
    echo "no such client: $client" && exit 2 ;;
esac
cat found
diff "$here/expected.txt" found
