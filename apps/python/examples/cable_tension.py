"""Tension of a cable from its frequencies, and what its length contributes to the uncertainty."""

import warnings

import rigfit

warnings.simplefilter("ignore", rigfit.DataWarning)

measured = [7.36, 14.59, 22.15, 29.9]
for length_std in (0.0, 0.001, 0.01):
    result = rigfit.tension(frequencies=measured, frequency_std=0.1, length=(2.4, length_std),
                            mass_per_length=(0.16667, 0.0003), EA=221780, ends="pinned")
    tension = result.tension_N
    print(f"length to {1000 * length_std:4.1f} mm: {tension.value:.2f} N, std {tension.std:.2f} N, "
          f"95 % {tension.low:.1f} to {tension.high:.1f} N, EI {result.EI_Nm2.value:.3f} N m2")
for mode in result.modes:
    print(f"  mode {mode.order}: measured {mode.measured_hz:.2f} Hz, model {mode.model_hz:.2f} Hz")
