#!/bin/sh
# run.sh NPM answers PROGRAM FOLDER   the answers of the package have the bits of libpdepth.so's (PDEPTH_WEB_PAIRS: how many pairs)
# run.sh NPM package FOLDER           the tarball is installed in a clean folder and used there
# run.sh NPM samples ROOT FOLDER      the samples of the guide and of the package's page run and print what they say
# NPM is the folder that packaging/wasm.sh has written. Exit code 77: it was not run, or a tool is missing.
set -eu
npm=$1 what=$2
here=$(cd "$(dirname "$0")" && pwd)
skip() { echo "skipped: $1"; exit 77; }
[ -e "$npm/package/pdepth.wasm" ] || skip "packaging/wasm.sh was not run"
command -v node >/dev/null || skip "node is not installed"

# A clean folder with the package in it, as its users have it.
installed() {
  command -v npm >/dev/null || skip "npm is not installed"
  rm -rf "$1" && mkdir -p "$1"
  (cd "$1" && echo '{"type":"module","private":true}' >package.json &&
    npm install --silent --no-audit --no-fund --offline "$npm"/pdepth-*.tgz >/dev/null)
}

case $what in
  answers)
    file=$4/web_answers.bin
    "$3" "${PDEPTH_WEB_PAIRS:-400}" "$file" >"$4/native.txt"
    node "$here/answers.mjs" "$npm/package" "$file" >"$4/web.txt"
    rm -f "$file"
    cat "$4/web.txt"
    diff "$4/native.txt" "$4/web.txt" ;;
  package)
    installed "$3/clean"
    cp "$here"/*.test.mjs "$here/worker.mjs" "$3/clean"
    cd "$3/clean" && node --test --no-warnings ./*.test.mjs ;;
  samples)
    installed "$4/samples"
    node "$here/samples.mjs" "$4/samples" "$3/pd_core/docs/pages/web.md" "$3/packaging/npm/README.md" ;;
  *)
    echo "no such test: $what" && exit 2 ;;
esac
