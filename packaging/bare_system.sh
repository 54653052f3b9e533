# Sourced by try_debian.sh and try_wheel.sh: bare Debian 12 systems, as root, from Debian's mirror by mmdebstrap, and a count of
# what passed. The first one is kept in build/bare.tar; PD_MIRROR names another mirror than Debian's own.

passed=0
failed=0
# verdict STATUS NAME
verdict() {
  if (($1 == 0)); then
    passed=$((passed + 1))
    printf '%s: passed\n' "$2"
  else
    failed=$((failed + 1))
    printf '%s: FAILED\n' "$2"
  fi
}
last_line() {
  printf '%d passed, %d failed\n' "${passed}" "${failed}"
  ((failed == 0))
}

pd_workplace=$(mktemp -d)
trap 'rm -rf "${pd_workplace}"' EXIT

# bare_system FOLDER: an empty Debian 12 there, with its list of packages.
bare_system() {
  if [[ ! -s build/bare.tar ]]; then
    mkdir -p build
    mmdebstrap --quiet --variant=minbase bookworm build/bare.tar ${PD_MIRROR:+"${PD_MIRROR}"}
  fi
  mkdir "$1"
  tar -xf build/bare.tar -C "$1"
  cp /etc/resolv.conf "$1/etc/resolv.conf"
  chroot "$1" apt-get -qq update
}

# install_into FOLDER PACKAGE...: quietly, but for what went wrong.
install_into() {
  local root=$1
  shift
  if ! DEBIAN_FRONTEND=noninteractive chroot "${root}" apt-get -qq install -y --no-install-recommends "$@" \
      >"${pd_workplace}/install.log" 2>&1; then
    tail -n 20 "${pd_workplace}/install.log"
    return 1
  fi
}
