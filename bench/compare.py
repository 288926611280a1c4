#!/usr/bin/env python3
"""Compares two Google Benchmark JSON files.

Prints new time / old time for every benchmark in both; exit status 1 when one got slower by more than the threshold,
when one that worked now fails, or when nothing could be compared. Times are manual or real where the benchmark asked
for them, else CPU time; of repetitions the median counts. Counters whose name ends in 'ratio' are shown, not judged.
"""

import argparse
import json
import statistics
import sys
import tempfile
from pathlib import Path

SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


class Measured:
    """What one file says about one benchmark."""

    def __init__(self):
        self.times, self.failed, self.ratios = [], False, {}

    @property
    def seconds(self):
        return statistics.median(self.times)


def read(path):
    """Benchmark name -> Measured."""
    with open(path, encoding="utf-8") as file:
        entries = json.load(file)["benchmarks"]
    result = {}
    for entry in entries:
        if entry.get("run_type") == "aggregate":
            continue
        name = entry.get("run_name", entry["name"])
        measured = result.setdefault(name, Measured())
        if entry.get("error_occurred"):
            measured.failed = True
            continue
        on_wall = name.endswith(("/real_time", "/manual_time"))
        measured.times.append(entry["real_time" if on_wall else "cpu_time"] * SECONDS[entry["time_unit"]])
        measured.ratios = {key: value for key, value in entry.items() if key.endswith("ratio")}
    return result


def compare(old, new, threshold):
    """Lines of the report, and the names that regressed."""
    lines, regressions = [], []
    for name in [n for n in old if n in new]:
        before, after = old[name], new[name]
        if after.failed or not after.times:
            lines.append(f"  FAILS  {name}")
            if not before.failed:
                regressions.append(name)
            continue
        if before.failed or not before.times:
            lines.append(f"  works  {name} (failed before)")
            continue
        ratio = after.seconds / before.seconds if before.seconds > 0 else float("inf")
        mark = "slower" if ratio > 1 + threshold else ("faster" if ratio < 1 / (1 + threshold) else "")
        notes = "".join(f"  {key} {before.ratios[key]:.3g} -> {value:.3g}"
                        for key, value in after.ratios.items() if key in before.ratios)
        lines.append(f"{ratio:7.3f}  {name}  {mark}{notes}".rstrip())
        if mark == "slower":
            regressions.append(name)
    for name in [n for n in old if n not in new]:
        lines.append(f"   gone  {name}")
    for name in [n for n in new if n not in old]:
        lines.append(f"    new  {name}")
    return lines, regressions


def report(old_path, new_path, threshold):
    old, new = read(old_path), read(new_path)
    lines, regressions = compare(old, new, threshold)
    print(*lines, sep="\n")
    if not set(old) & set(new):
        print("nothing in common to compare")
        return 1
    print(f"{len(regressions)} of {len(set(old) & set(new))} slower by more than {100 * threshold:g} % or failing")
    return 1 if regressions else 0


def self_test():
    """Made-up files with a known answer."""

    def entry(name, cpu, real=None, unit="ns", **more):
        return {"name": name, "run_name": name, "run_type": "iteration", "cpu_time": cpu,
                "real_time": cpu if real is None else real, "time_unit": unit, **more}

    def status(old, new, threshold=0.1):
        with tempfile.TemporaryDirectory() as folder:
            paths = [Path(folder) / "old.json", Path(folder) / "new.json"]
            for path, entries in zip(paths, (old, new)):
                path.write_text(json.dumps({"benchmarks": entries}), encoding="utf-8")
            return report(*paths, threshold)

    same = [entry("a", 100.0), entry("b", 5.0, unit="us")]
    checks = {
        "equal files agree": status(same, same) == 0,
        "5 % is noise": status(same, [entry("a", 105.0), entry("b", 5.0, unit="us")]) == 0,
        "20 % is a regression": status(same, [entry("a", 120.0), entry("b", 5.0, unit="us")]) == 1,
        "20 % passes a wider threshold": status(same, [entry("a", 120.0)], 0.25) == 0,
        "faster is fine": status(same, [entry("a", 50.0)]) == 0,
        "units count": status(same, [entry("b", 5000.0)]) == 0,
        "units count both ways": status(same, [entry("b", 5.0, unit="ms")]) == 1,
        "wall time where asked": status([entry("c/real_time", 1.0, 10.0)], [entry("c/real_time", 1.0, 20.0)]) == 1,
        "CPU time elsewhere": status([entry("c", 1.0, 10.0)], [entry("c", 1.0, 20.0)]) == 0,
        "median of repetitions": status([entry("a", 100.0)] * 3, [entry("a", t) for t in (101.0, 99.0, 900.0)]) == 0,
        "aggregates are not samples":
            status(same, same + [entry("a", 900.0, run_type_="x") | {"run_type": "aggregate"}]) == 0,
        "a new failure is a regression": status(same, [entry("a", 0.0, error_occurred=True)]) == 1,
        "an old failure is none":
            status([entry("a", 0.0, error_occurred=True)], [entry("a", 0.0, error_occurred=True)]) == 0,
        "new and gone names are no regression": status(same, [entry("a", 100.0), entry("new", 1.0)]) == 0,
        "nothing in common is an error": status([entry("x", 1.0)], [entry("y", 1.0)]) == 1,
    }
    failed = [name for name, good in checks.items() if not good]
    print(f"self-test: {len(checks) - len(failed)} of {len(checks)} checks hold", *failed, sep="\n  FAILED: ")
    return 1 if failed else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", nargs="?", help="JSON from --benchmark_out")
    parser.add_argument("new", nargs="?")
    parser.add_argument("--threshold", type=float, default=0.1, help="0.1: 10 %% slower is a regression")
    parser.add_argument("--self-test", action="store_true")
    arguments = parser.parse_args()
    if arguments.self_test:
        return self_test()
    if not arguments.old or not arguments.new:
        parser.error("two files to compare, or --self-test")
    return report(arguments.old, arguments.new, arguments.threshold)


if __name__ == "__main__":
    sys.exit(main())
