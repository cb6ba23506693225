"""Peak memory of `frf` beside the samples it is given: no channel but the force is copied.

usage: PYTHONPATH=build/release/apps/python python3 tests/python/large_array.py [SAMPLES [CHANNELS]]

8388608 samples of 16 channels are 1.07 GB. The samples stay in the caller's arrays; what is added is two copies of the
force channel (its offset, and the median that its noise is judged by), each hit's block with its FRFs, and the results.
The exit code is 1 where more than three force channels and 16 MB of such blocks are added.
"""

import resource
import sys
import time
import warnings

import numpy as np

import rigfit

FS, BLOCK_S, EVERY = 2048.0, 1.9, 1 << 18


def peak():
    """Bytes that the process had at most."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def hits(samples, channels):
    """Noise, and every 128 s (once at least) a hit with the response of a mode of 60 Hz."""
    rng = np.random.default_rng(1)
    data = np.empty((channels, samples))
    for row in data:
        rng.standard_normal(out=row)
        row *= 1e-3
    t = np.arange(4096) / FS
    pulse = 100 * np.sin(np.pi * np.arange(8) / 8)
    response = np.convolve(pulse, np.exp(-0.02 * 2 * np.pi * 60 * t) * np.sin(2 * np.pi * 60 * t))
    for first in range(600, samples - len(response), EVERY):
        data[0, first:first + 8] += pulse
        for c in range(1, channels):
            data[c, first:first + len(response)] += c * response
    return data


def recording(data):
    """The rows as they lie: a force and accelerations."""
    return rigfit.Recording([{"name": "force" if c == 0 else f"a{c}", "data": row, "fs": FS,
                              "unit_str": "N" if c == 0 else "m/s^2"} for c, row in enumerate(data)])


def main(samples=1 << 23, channels=16):
    warnings.simplefilter("ignore", rigfit.DataWarning)
    data = hits(samples, channels)
    one = recording(data)
    rigfit.frf(recording(hits(1 << 14, channels)), "force", block=BLOCK_S, threads=1)  # what the first call alone takes
    before, started = peak(), time.monotonic()
    result = rigfit.frf(one, "force", block=BLOCK_S, threads=1)
    grown, took = peak() - before, time.monotonic() - started
    bound = 3 * data[0].nbytes + (16 << 20)
    print(f"{data.nbytes / 1e6:.0f} MB of samples in {channels} channels, {result.averages} hits: peak memory grew by "
          f"{grown / 1e6:.0f} MB (bound {bound / 1e6:.0f} MB) in {took:.2f} s")
    return 0 if grown < bound and result.averages else 1


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
