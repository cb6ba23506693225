"""EA of a cable from hanging-mass records, with its budget.

    python3 axial_rigidity.py LENGTH=FILE,FILE,... LENGTH=FILE,...
"""

import sys

import rigfit

if len(sys.argv) < 2:
    sys.exit(__doc__)

files, lengths = [], []
for group in sys.argv[1:]:
    length, _, names = group.partition("=")
    for name in names.split(","):
        files.append(name)
        lengths.append(float(length))

result = rigfit.axial(files, length=lengths, length_std=0.001, mass=2.2, mass_std=0.002,
                      mass_per_length=0.16667, mass_per_length_std=0.0003, band=(20, 100))
print(f"EA            {result.EA_N}")
print(f"damping ratio {result.damping_ratio}")
for term in result.budget:
    print(f"  {term.source:<40} {term.contribution_N:8.1f} N")
