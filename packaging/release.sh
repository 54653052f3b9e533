#!/usr/bin/env bash
# Makes a release, step by step. Nothing is published from here: whoever publishes pushes the tag and the files.
#
#   packaging/release.sh check            1. the version is the same wherever it stands, and the changelog has a section of it
#   packaging/release.sh build [OLD.deb]  2. as check; then, from the committed tree into build/release-VERSION:
#                                              the Debian packages and the source (packaging/debian.sh), a wheel, the site
#                                         3. the interface against OLD.deb, the library's package of the last release
#                                         4. SHA256SUMS of it all, and the command that makes the tag
#
# Before: tests/run.sh, tests/long/run.sh and packaging/try_debian.sh have passed for this commit, and the picture of
# `pdepth accuracy` was taken on a quiet machine. After: the tag, the files, and a new section "unreleased" in CHANGELOG.md.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
version=$(sed -n 's/^project(pdepth VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)

faults=0
# stands FILE PATTERN: the version stands there.
stands() {
  if ! grep -qE "$2" "$1"; then
    printf '%s: nothing like %s\n' "$1" "$2"
    faults=$((faults + 1))
  fi
}
check() {
  local dotted=${version//./\\.}
  stands pyproject.toml "^version = \"${dotted}\"$"
  stands demos/python/pdepth/__init__.py "^__version__ = \"${dotted}\"$"
  stands CITATION.cff "^version: ${dotted}$"
  stands CHANGELOG.md "^## \[${dotted}\]"
  stands packaging/debian/changelog "^pdepth \(${dotted}-[0-9]+\)"
  stands packaging/debian/control "^Package: libpdepth-core${dotted%\\.*}$"
  if ((faults > 0)); then
    printf '%d places do not say %s, as CMakeLists.txt does\n' "${faults}" "${version}" >&2
    exit 1
  fi
  printf 'version %s stands everywhere\n' "${version}"
}

build() {
  local out=${PWD}/build/release-${version} old=${1-}
  git diff --quiet HEAD || { printf 'commit first: a release is made of a commit\n' >&2 && exit 1; }
  stands CHANGELOG.md "^## \[${version//./\\.}\] - [0-9]{4}-[0-9]{2}-[0-9]{2}$"
  ((faults == 0)) || { printf 'give the section of the changelog its date\n' >&2 && exit 1; }
  rm -rf "${out}"
  mkdir -p "${out}"
  packaging/debian.sh
  find build/debian -maxdepth 1 -type f -exec cp {} "${out}" \;
  /usr/bin/python3 -m build --no-isolation --wheel --outdir "${out}" .
  mkdocs build --quiet --strict -f pd_core/docs/mkdocs.yml -d "${out}/site"
  tar -C "${out}" -czf "${out}/pdepth-${version}-site.tar.gz" site
  rm -rf "${out}/site"
  if [[ -n ${old} ]]; then
    packaging/abi.sh "${old}" "${out}"/libpdepth-core*_*.deb
  else
    printf 'the first release of its minor version: there is no interface to compare with\n'
  fi
  (cd "${out}" && sha256sum -- * >SHA256SUMS && cat SHA256SUMS)
  printf '\nThe tag, by whoever publishes:\n  git tag -s v%s -m "pdepth %s" %s\n' "${version}" "${version}" "$(git rev-parse --short HEAD)"
}

case ${1-} in
  check) check ;;
  build) check && build "${2-}" ;;
  *)
    pd_usage >&2
    exit 2
    ;;
esac
