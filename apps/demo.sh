#!/bin/sh
# Builds rigfit and runs its main job on testdata/, twice: the published tables of a rig, and recordings of a virtual
# laboratory of that rig, each to a report of model against test.
# On a fresh Debian 12 machine it first installs what is missing.   sh apps/demo.sh [OUTPUT_FOLDER]
set -eu
cd "$(dirname "$0")/.."
out="${1:-build/demo}"

sh apps/install_packages.sh build
[ -f build/release/build.ninja ] || {
  echo "Configuring (release) ..."
  mkdir -p build
  cmake --preset release -DRIGFIT_BUILD_TESTS=OFF -DRIGFIT_BUILD_BENCHMARKS=OFF -DRIGFIT_BUILD_PYTHON=OFF \
    >build/configure-release.log 2>&1 || {
    cat build/configure-release.log >&2
    echo "error: configuring failed (above)" >&2
    exit 1
  }
}
echo "Building rigfit (some 5 minutes on 2 cores the first time) ..."
cmake --build build/release --target rigfit

report() {
  status=0
  build/release/apps/rigfit report "testdata/$1/campaign.toml" --out "$out/$1" || status=$?
  # 4: something was refused and the report says so; everything else there is there.
  if [ "$status" -ne 0 ] && [ "$status" -ne 4 ]; then
    echo "error: rigfit report ended with exit code $status" >&2
    exit "$status"
  fi
}

echo
echo "=== Published tables of the rig (testdata/jalali2021) ==="
report jalali2021
echo
echo "=== Recordings of the virtual laboratory (testdata/virtual_laboratory, synthetic) ==="
report virtual_laboratory
echo
echo "The reports, for any browser:"
for name in jalali2021 virtual_laboratory; do
  echo "  $(cd "$out/$name" && pwd)/report.html"
done
