"""A hammer test: recordings of hits to modes.

    python3 hammer_test.py hammer-*.uff          (here: testdata/virtual_laboratory/beam/rig)
"""

import sys

import rigfit

if len(sys.argv) < 2:
    sys.exit(__doc__)

recordings = [rigfit.read(file) for file in sys.argv[1:]]
frf = rigfit.frf(recordings, force="force", force_window=0.012, exponential_window=0.05, band=(1, 160))
for i, hit in enumerate(frf.hits, 1):
    print(f"hit {i}: {hit.peak:.4g} N, {'accepted' if hit.accepted else hit.reason}")
print(f"{frf.averages} hits averaged; H is {frf.H.shape[0]} lines x {frf.H.shape[1]} responses")

modes = rigfit.modal(frf, band=(1, 160))
for mode in modes.modes:
    print(f"{mode.frequency_hz.value:9.4f} Hz +- {mode.frequency_hz.std:.2g}, damping {100 * mode.damping_ratio.value:.4f} %"
          f"{', doubtful: ' + mode.doubt if mode.doubtful else ''}")
