#!/usr/bin/env python3
"""What a sweep from Python costs beside the same sweep by the command line.

Both sweep one mesh file into a result file, in processes of their own, taking turns; the order changes from round to
round, since other work on the machine comes and goes. Reported are wall and processor time of whole processes (the
interpreter's start and imports included), the same within Python for the call alone, and the ratios of medians. The
results are compared bit by bit first.

    python_cost.py --ricci build/bin/ricci --module build/python [--faces 20000] [--vertices sample:600] [--rounds 7]
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

SCRIPT = """
import json, resource, sys, time
import numpy, ricci
def used():
    u = resource.getrusage(resource.RUSAGE_SELF)
    return u.ru_utime + u.ru_stime
wall, cpu = time.perf_counter(), used()
ricci.sweep({mesh!r}, vertices={vertices!r}, threads={threads}, output={output!r})
print(json.dumps([time.perf_counter() - wall, used() - cpu]))
"""


def timed(command, environment):
    """Wall and processor seconds of a process, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    wall = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, done.stdout


def same(path, other):
    """Whether the sweeps in two files agree bit by bit, but for times."""
    import h5py

    with h5py.File(path) as a, h5py.File(other) as b:
        x, y = (next(iter(f["items"].values()))["sweep"] for f in (a, b))
        names = ("vertex", "status", "area_distortion", "newton_iterations", "residual_max", "flips")
        return all(x[n][()].tobytes() == y[n][()].tobytes() for n in names)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ricci", required=True, help="the program")
    parser.add_argument("--module", required=True, help="folder of the package")
    parser.add_argument("--faces", type=int, default=20000)
    parser.add_argument("--vertices", default="sample:600")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--json", action="store_true")
    a = parser.parse_args()
    environment = {**os.environ, "PYTHONPATH": os.path.abspath(a.module)}
    program, times = os.path.abspath(a.ricci), {"program": [], "python": [], "call": []}
    with tempfile.TemporaryDirectory() as folder:
        mesh = os.path.join(folder, "eight.off")
        subprocess.run([program, "generate", "eight", "--faces", str(a.faces), "-o", mesh, "-q"], check=True)
        outputs = {kind: os.path.join(folder, f"{kind}.h5") for kind in ("program", "python")}
        script = SCRIPT.format(mesh=mesh, vertices=a.vertices, threads=a.threads, output=outputs["python"])
        commands = {
            "program": [program, "sweep", mesh, "--vertices", a.vertices, "--threads", str(a.threads), "-q", "-o",
                        outputs["program"]],
            "python": ["/usr/bin/python3", "-c", script],
        }  # fmt: skip
        for round_number in range(a.rounds):
            order = ("program", "python") if round_number % 2 == 0 else ("python", "program")
            for kind in order:
                wall, cpu, out = timed(commands[kind], environment)
                times[kind].append((wall, cpu))
                if kind == "python":
                    times["call"].append(tuple(json.loads(out)))
        if not same(outputs["program"], outputs["python"]):
            sys.exit("the results differ")
    result = {"faces": a.faces, "vertices": a.vertices, "threads": a.threads, "rounds": a.rounds}
    for k, measure in enumerate(("wall", "cpu")):
        median = {kind: statistics.median(t[k] for t in values) for kind, values in times.items()}
        # Of neighbours in time, so that what else the machine does weighs on both alike.
        pairs = {kind: statistics.median(p[k] / c[k] for p, c in zip(times[kind], times["program"]))
                 for kind in ("python", "call")}  # fmt: skip
        result[measure] = {**{f"{kind}_seconds": value for kind, value in median.items()},
                           "ratio_of_process": pairs["python"], "ratio_of_call": pairs["call"]}  # fmt: skip
    if a.json:
        print(json.dumps(result))
        return
    print(f"sweep of {a.faces} faces, {a.vertices}, {a.threads} threads, {a.rounds} rounds; same bits")
    for measure in ("wall", "cpu"):
        r = result[measure]
        print(f"{measure:>5}: program {r['program_seconds']:.3f} s, Python process {r['python_seconds']:.3f} s "
              f"(ratio {r['ratio_of_process']:.4f}), call alone {r['call_seconds']:.3f} s "
              f"(ratio {r['ratio_of_call']:.4f})")  # fmt: skip


if __name__ == "__main__":
    main()
