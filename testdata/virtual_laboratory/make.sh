#!/bin/sh
# Makes the recordings of this folder again: every file here that is not a scene, a table or text.
#   sh testdata/virtual_laboratory/make.sh build/release/apps/rigfit
set -eu
rigfit=$(realpath "$1")
cd "$(dirname "$0")"
"$rigfit" synthesize truth/bench.toml --out bench --seed 11 --tension 25 100 200 300 \
  --stiffness truth/stiffness.csv --bending-span 0.5 --bending-load 4 \
  --axial-length 0.7 1.0 1.3 --axial-length-std 0.001 --axial-mass 2.2 --axial-damping 0.017
"$rigfit" synthesize truth/cable-in-plane.toml --out cable-in-plane --seed 12 \
  --tension 25 100 200 300 --tension-std 0.01 --stiffness truth/stiffness.csv \
  --hits 6 --double-hits 1 --record 6 --rate 2048 --format uff
"$rigfit" synthesize truth/cable-out-of-plane.toml --out cable-out-of-plane --seed 112 \
  --tension 25 100 200 300 --tension-std 0.01 --stiffness truth/stiffness.csv \
  --hits 6 --double-hits 1 --record 6 --rate 2048 --format uff
"$rigfit" synthesize truth/beam.toml --out beam --seed 13 \
  --hits 5 --double-hits 1 --record 5 --rate 2048 --format uff
"$rigfit" synthesize truth/rig.toml --out rig --seed 14 --tension 200 300 --tension-std 0.01 \
  --stiffness truth/stiffness.csv --hits 5 --double-hits 1 --record 5 --rate 2048 --format uff
