#!/bin/sh
# Installs what of the named Debian packages is missing; quick and silent when nothing is.
#   sh apps/install_packages.sh build        what building and running rigfit needs
#   sh apps/install_packages.sh test         that, and what its tests need
#   sh apps/install_packages.sh study       what apps/study needs besides the program (80 packages, 700 MB)
#   sh apps/install_packages.sh check       what tests and study need, and the formatter and linter
set -eu

build="ca-certificates cmake g++ ninja-build pkg-config
  libeigen3-dev libceres-dev libfftw3-dev libgsl-dev libsundials-dev
  libmatio-dev libpugixml-dev libsndfile1-dev libssl-dev zlib1g-dev libcli11-dev libfmt-dev libtomlplusplus-dev nlohmann-json3-dev
  python3-dev python3-pybind11 python3-numpy"
test="libgtest-dev libgmock-dev python3 chromium chromium-driver poppler-utils
  calculix-ccx dpkg-dev python3-pandas python3-pip python3-uncertainties"
study="snakemake"
check="clang clang-format clang-tidy clang-tools doxygen"

case "${1:-}" in
  build) wanted="$build" ;;
  test) wanted="$build $test" ;;
  study) wanted="$study" ;;
  check) wanted="$build $test $study $check" ;;
  *) echo "usage: $0 build|test|study|check" >&2; exit 2 ;;
esac

missing=""
for package in $wanted; do
  state=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
  [ "$state" = "install ok installed" ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

echo "Installing Debian packages:$missing"
as_root=""
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || {
    echo "error: not root and no sudo here; as root run: apt-get install$missing" >&2
    exit 1
  }
  as_root="sudo"
fi
log=$(mktemp)
trap 'rm -f "$log"' EXIT
for step in "update" "install -y --no-install-recommends $missing"; do
  # shellcheck disable=SC2086
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=120 $step \
    >"$log" 2>&1 || {
    tail -n 30 "$log" >&2
    echo "error: apt-get $step failed (above)" >&2
    exit 1
  }
done
