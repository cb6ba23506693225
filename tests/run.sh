#!/bin/sh
# Builds everything and runs every test. On a fresh Debian 12 machine it first installs what is missing.
#   sh tests/run.sh [PRESET [CTEST OPTIONS]]    PRESET: release (default), dev or asan
#   sh tests/run.sh release -L fast             the fast set only; the rest is labelled evidence
set -eu
cd "$(dirname "$0")/.."
preset="${1:-release}"
[ $# -eq 0 ] || shift
others=ON
[ "$preset" != asan ] || others=OFF  # benchmarks and the Python package are not tested there

sh apps/install_packages.sh test
echo "Configuring ($preset) ..."
mkdir -p build
cmake --preset "$preset" -DRIGFIT_BUILD_TESTS=ON \
  -DRIGFIT_BUILD_BENCHMARKS="$others" -DRIGFIT_BUILD_PYTHON="$others" \
  >"build/configure-$preset.log" 2>&1 || {
  cat "build/configure-$preset.log" >&2
  echo "error: configuring failed (above)" >&2
  exit 1
}
echo "Building ($preset; a few minutes the first time) ..."
cmake --build "build/$preset"
echo "Testing ..."
exec ctest --preset "$preset" -j "$(($(nproc) + 1))" "$@"  # those in a browser wait
