"""A campaign of very many synthetic recordings: hits of a beam and free decays, for the size of its report.

usage: many_recordings.py FOLDER [RECORDINGS [STATES]]     (4000 recordings in 200 states)
"""

import cmath
import math
import pathlib
import random
import sys

RATE, SAMPLES = 1000.0, 2000  # Hz; of a recording
MODES = ((11.7, 0.012), (38.2, 0.009), (77.0, 0.008))  # Hz, damping ratio


def answer(factor, pulse):
    """Acceleration to a force of given samples: each mode's impulse response, summed."""
    total = [0.0] * SAMPLES
    for hz, damping in MODES:
        omega = 2 * math.pi * hz * factor
        pole = complex(-damping * omega, omega * math.sqrt(1 - damping ** 2))
        step, state = cmath.exp(pole / RATE), 0j
        for i in range(SAMPLES):
            state = state * step + (pulse[i] if i < len(pulse) else 0.0) / RATE
            total[i] += (pole * state).real
    return total


def main():
    folder = pathlib.Path(sys.argv[1])
    recordings = int(sys.argv[2]) if len(sys.argv) > 2 else 4000
    states = int(sys.argv[3]) if len(sys.argv) > 3 else 200
    folder.mkdir(parents=True, exist_ok=True)
    each, hit_states = recordings // states, states - states // 4
    pulse = [math.sin(math.pi * i / 8) for i in range(9)]
    campaign = ['title = "Many recordings (synthetic)"',
                '[[test]]\nname = "hits"\nkind = "modal"\nforce = "force"\nband = [5.0, 100.0]\nexponential_window = 0.05']
    for state in range(states):
        if state == hit_states:
            campaign.append('[[test]]\nname = "decays"\nkind = "decay"\nchannels = ["acceleration"]\nband = [5.0, 100.0]')
        of_state = random.Random(state)
        tension = 100.0 + state
        clean = answer(1 + 0.0005 * state, pulse)
        for k in range(each):
            size = of_state.uniform(0.8, 1.2)
            rows = ["time [s],force [N],acceleration [m/s^2]"]
            for i in range(SAMPLES):
                at = i - 50
                force = 10 * size * pulse[at] if 0 <= at < len(pulse) else 0.0
                value = 10 * size * clean[at] if at >= 0 else 0.0
                rows.append("%.3f,%.4f,%.5f" % (i / RATE, force + of_state.gauss(0, 0.002), value + of_state.gauss(0, 2e-4)))
            (folder / ("s%04d-%02d.csv" % (state, k))).write_text("\n".join(rows) + "\n")
        campaign.append('[[test.recording]]\nfiles = ["s%04d-*.csv"]\ntension = %.1f\nsynthetic = true' % (state, tension))
    (folder / "campaign.toml").write_text("\n".join(campaign) + "\n")


if __name__ == "__main__":
    main()
