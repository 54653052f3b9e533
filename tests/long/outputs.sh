#!/usr/bin/env bash
# A full disk, a killed process, two writers: what the command has written is whole or was there before.
#
#   tests/long/outputs.sh [PROGRAM [ROUNDS]]        build/release/pdepth 40
#
# A disk of 64 KB needs the right to mount; without it that part says that it was left out.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../../pd_core/cmake/debian_packages.sh"
pd_no_options "$@"
program=$(realpath "${1:-build/release/pdepth}")
rounds=${2:-40}
folder=$(mktemp -d)
trap 'umount "$folder/disk" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"
fail() { printf 'outputs: %s\n' "$*" >&2; exit 1; }

# A scan whose hull takes some time and some hundred kilobytes.
awk 'BEGIN { srand(7); for (i = 0; i < 200000; ++i) { x = rand() - .5; y = rand() - .5; z = rand() - .5
             r = sqrt(x * x + y * y + z * z); if (r > 0) printf "v %.17g %.17g %.17g\n", x / r, y / r, z / r } }' > scan.obj
whole() { # the last face of a whole file names three vertices or more and ends with its newline
  [[ $(tail -c 1 "$1" | od -An -c | tr -d ' ') == '\n' ]] && [[ $(tail -n 1 "$1") =~ ^f( [0-9]+){3,}$ ]]
}

"$program" simplify scan.obj --epsilon 1e-4 -o hull.obj > /dev/null
whole hull.obj || fail "the first hull is not whole"
sum=$(sha256sum < hull.obj)

killed=0
for ((i = 0; i < rounds; ++i)); do
  "$program" simplify scan.obj --epsilon 1e-4 -o hull.obj > /dev/null &
  victim=$!
  sleep "0.$((RANDOM % 90 + 10))"
  kill -9 "$victim" 2> /dev/null && killed=$((killed + 1))
  wait "$victim" 2> /dev/null || true
  [[ $(sha256sum < hull.obj) == "$sum" ]] || fail "a killed process changed the file"
done
printf 'killed processes: %s of %s rounds, the file stayed whole\n' "$killed" "$rounds"
rm -f .pdepth-*

mkdir disk
if mount -t tmpfs -o size=64k none disk 2> /dev/null; then
  printf 'older\n' > disk/hull.obj
  if "$program" simplify scan.obj --epsilon 1e-4 -o disk/hull.obj > /dev/null 2>&1; then fail "a full disk was no failure"; fi
  [[ $(cat disk/hull.obj) == older ]] || fail "a full disk changed the file"
  [[ -z $(ls disk/.pdepth-* 2> /dev/null) ]] || fail "a full disk kept a part"
  awk 'BEGIN { for (i = 0; i < 400; ++i) printf "{\"id\":\"%0400d\",\"query\":\"hull\",\"a\":{\"type\":\"box\",\"half_extents\":[1,1,1]}}\n", i }' > lines
  if "$program" query lines --record disk/record > /dev/null 2>&1; then fail "a full record was no failure"; fi
  rm disk/hull.obj
  "$program" query <(head -n 1 lines) --record disk/record > /dev/null
  # At most one line was cut, and it is glued to no other.
  bad=$(grep -cvE '^\{"id":"[0-9]{400}","query":"hull","a":\{"type":"box","half_extents":\[1,1,1\]\}\}$' disk/record || true)
  ((bad <= 1)) || fail "$bad lines of the record are broken"
  umount disk
  printf 'full disk: the file stayed, the record has %s line that was cut\n' "$bad"
else
  printf 'full disk: left out, nothing may be mounted here\n'
fi

for ((i = 0; i < 500; ++i)); do printf '{"id":"%0*d","query":"hull","a":{"type":"box","half_extents":[1,1,1]}}\n' $((RANDOM % 6000 + 1)) "$i"; done > many
writers=()
for i in 1 2 3; do "$program" query many --threads 2 --record shared > /dev/null & writers+=($!); done
for writer in "${writers[@]}"; do wait "$writer"; done
"$program" query shared > answers
[[ $(wc -l < shared) == 1500 && $(grep -c '"error"' answers || true) == 0 ]] || fail "lines of three writers are mixed"
for i in 1 2; do "$program" simplify scan.obj --epsilon "1e-$((i + 2))" -o both.obj > /dev/null & done
wait
whole both.obj || fail "two writers left a mixture"
printf 'writers: 1500 lines of three, a hull of two, all whole\n'
