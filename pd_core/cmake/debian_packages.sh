# Sourced by the scripts of demos, tests and packaging: their --help, and the Debian 12 packages that the project needs, by name.

# Prints the comment at the top of the script that runs.
pd_usage() {
  local script=$0
  [[ -r ${script} ]] || script=${OLDPWD}/${script}
  awk 'NR > 1 { if (!/^#/) exit; sub(/^# ?/, ""); print }' "${script}"
}

# pd_no_options ARGUMENT...: answers --help and ends; ends with the exit code of bad usage at any other option.
pd_no_options() {
  local argument
  for argument in "$@"; do
    case ${argument} in
      -h | --help) pd_usage; exit 0 ;;
      -*) printf '%s is no option here\n' "${argument}" >&2; pd_usage >&2; exit 2 ;;
    esac
  done
}

pd_build_packages=(
  g++ cmake ninja-build pkgconf libeigen3-dev libboost-dev libbullet-dev libosmesa6-dev libgl-dev libegl-dev libpng-dev
  libpango1.0-dev libassimp-dev libcli11-dev nlohmann-json3-dev libfmt-dev libpugixml-dev
)
# Loaded or run, not linked: the rasteriser, the fonts of the captions, the video encoder.
pd_demo_packages=(libosmesa6 libegl1 libegl-mesa0 fonts-inter fonts-dejavu-core ffmpeg)
# clang-14 with its runtime builds with the sanitizers, libc++-14-dev is its standard library, chromium opens the pages of --report.
# mkdocs, its theme and Doxygen build the documentation's site; luajit runs a client of the C interface, abigail-tools guard its ABI,
# libmujoco-dev, libfcl-dev and libode-dev are what the doors of these names are tested against.
pd_test_packages=(
  libgtest-dev libqhull-dev ccache clang-14 libclang-rt-14-dev libc++-14-dev chromium mkdocs mkdocs-material doxygen luajit abigail-tools libmujoco-dev libfcl-dev libode-dev
  python3-dev pybind11-dev python3-numpy python3-pytest python3-venv python3-pip python3-setuptools python3-wheel python3-build
  python3-distributed python3-jsonschema
)

# packaging/debian.sh and packaging/try_debian.sh need these beside them: the tools that make and check packages, and the peers
# whose answers pdepth-recorders records.
pd_package_packages=(
  dpkg-dev fakeroot debhelper dh-python lintian mmdebstrap git doxygen mkdocs mkdocs-material libccd-dev libfcl-dev libmujoco-dev libode-dev
  python3-dev pybind11-dev python3-numpy
)

# Prints those of the named packages that are not installed.
pd_missing_packages() {
  local name
  for name in "$@"; do
    if [[ "$(dpkg-query -W -f='${db:Status-Status}\n' "${name}" 2>/dev/null | head -n 1)" != installed ]]; then
      printf '%s\n' "${name}"
    fi
  done
}

# Installs what is missing of the named packages. Without root it says which and goes on where nothing is missing.
pd_require_packages() {
  if ! command -v dpkg-query >/dev/null; then
    printf 'This is not a Debian system. Trying with what is here; on Debian 12 these packages are used:\n  %s\n' "$*"
    return 0
  fi
  local missing
  mapfile -t missing < <(pd_missing_packages "$@")
  if ((${#missing[@]} == 0)); then
    return 0
  fi
  if ((EUID != 0)); then
    printf 'These Debian packages are missing:\n  %s\nInstall them as root, then run this again:\n' "${missing[*]}" >&2
    printf '  apt-get update && apt-get install --no-install-recommends %s\n' "${missing[*]}" >&2
    return 1
  fi
  printf 'Installing %d Debian packages: %s\n' "${#missing[@]}" "${missing[*]}"
  local log
  log=$(mktemp)
  if ! { apt-get -q update && DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends \
         "${missing[@]}"; } >"${log}" 2>&1 </dev/null; then
    tail -n 20 "${log}" >&2
    printf 'The packages could not be installed; the whole log: %s\n' "${log}" >&2
    return 1
  fi
  rm -f "${log}"
}

# Sets pd_launcher to the options that let ccache serve unchanged sources, where it is installed.
pd_use_ccache() {
  pd_launcher=()
  if command -v ccache >/dev/null; then
    pd_launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    # Sources with a precompiled header need the first; by the others one build folder's objects serve the next.
    export CCACHE_SLOPPINESS="${CCACHE_SLOPPINESS:-pch_defines,time_macros}" CCACHE_BASEDIR="${CCACHE_BASEDIR:-${PWD}}"
    export CCACHE_NOHASHDIR=1
  fi
}
