"""A cable model fitted to frequencies that another model of it gives: the parameters come back."""

import numpy as np

import rigfit

scene = rigfit.Scene("""
title = "cable"
node = [{name = "left", position = [0.0, 0.0, 0.0], support = "pinned"},
        {name = "right", position = [2.4, 0.0, 0.0], support = "pinned"}]
[[member]]
name = "cable"
kind = "cable"
nodes = ["left", "right"]
segments = 30
mass_per_length = 0.16667
EA = 221780.0
EI = 0.5
GJ = 0.1
tension = 190.0
""")
truth = scene.with_parameters({"cable.EI": 0.6, "cable.tension": 200.0})
modes = [m for m in rigfit.modes(truth, band=(1, 80)).modes if m.plane == "in"]
noise = np.random.default_rng(3).standard_normal(len(modes))
measured = [{"frequency_hz": m.frequency_hz * (1 + 5e-4 * e), "std": 5e-4 * m.frequency_hz, "plane": "in"}
            for m, e in zip(modes, noise)]

fit = rigfit.update(scene, measured=measured, free=["cable.EI", "cable.tension"])
for parameter, true in zip(fit.parameters, (0.6, 200.0)):
    print(f"{parameter.name:<14} {parameter.start:8.4f} -> {parameter.value:8.4f} +- {parameter.std:.4f}   (truth {true})")
d = np.sqrt(np.diag(fit.covariance))
print(f"correlation    {fit.covariance[0, 1] / (d[0] * d[1]):+.3f}")
print(f"rms error      {100 * fit.rms_relative_error_before:.2f} % -> {100 * fit.rms_relative_error:.3f} %")
