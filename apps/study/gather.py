"""One summary of a study: what every campaign identified beside its truth, and how often the 95 % intervals hold it.

usage: gather.py FOLDER FIRST_SEED COUNT        writes FOLDER/summary.csv and FOLDER/summary.json
"""

import csv
import json
import math
import pathlib
import statistics
import sys

NORMAL_95 = 1.959964


def values(folder):
    """(quantity, estimate, truth) of one campaign; the estimate is None where the report gives no value."""
    truth = json.loads((folder / "truth.json").read_text())
    report = json.loads((folder / "report" / "report.json").read_text())
    tests = {pathlib.Path(t["file"]).name: t for part in report.get("bending", []) for t in part["tests"]}
    for record in truth.get("bending", []):
        found = tests.get(pathlib.Path(record["file"]).name, {})
        yield f"EI at {record['tension_N']:g} N, N m2", found.get("EI_Nm2"), record["EI_Nm2"]
    axial = report.get("axial", [{}])[0]
    if truth.get("axial"):
        yield "EA, N", axial.get("EA_N"), truth["axial"][0]["EA_N"]
        yield "damping ratio", axial.get("damping_ratio"), truth["axial"][0]["damping_ratio"]


def row_of(seed, quantity, estimate, truth):
    row = {"seed": seed, "quantity": quantity, "truth": truth}
    if not estimate or estimate.get("value") is None:
        return row | {"status": "refused"}
    value, std = estimate["value"], estimate.get("std")
    low, high = estimate.get("low"), estimate.get("high")
    if (low is None or high is None) and std is not None:
        low, high = value - NORMAL_95 * std, value + NORMAL_95 * std
    covered = None if low is None or high is None else low <= truth <= high
    return row | {"status": "identified", "value": value, "std": std, "low": low, "high": high, "covered": covered}


def summary_of(rows):
    by_quantity = {}
    for row in rows:
        by_quantity.setdefault(row["quantity"], []).append(row)
    result = []
    for quantity, group in by_quantity.items():
        found = [r for r in group if r["status"] == "identified"]
        judged = [r for r in found if r["covered"] is not None]
        errors = [r["value"] / r["truth"] - 1 for r in found]
        share = sum(r["covered"] for r in judged) / len(judged) if judged else None
        result.append({
            "quantity": quantity,
            "campaigns": len(group),
            "refused": len(group) - len(found),
            "covered_95": share,
            "covered_95_std": math.sqrt(0.95 * 0.05 / len(judged)) if judged else None,
            "relative_bias": statistics.fmean(errors) if errors else None,
            "relative_scatter": statistics.stdev(errors) if len(errors) > 1 else None,
        })
    return result


def main():
    out, first, count = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    rows = [row_of(seed, *value) for seed in range(first, first + count) for value in values(out / str(seed))]
    fields = ["seed", "quantity", "status", "value", "std", "low", "high", "truth", "covered"]

    with (out / "summary.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, fields, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    document = {"data": "synthetic", "first_seed": first, "campaigns": count, "quantities": summary_of(rows)}
    (out / "summary.json").write_text(json.dumps(document, indent=2) + "\n")


main()
