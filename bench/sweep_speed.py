#!/usr/bin/env python3
"""How fast sweeps and single solves are, against the honest baseline, as tables.

Runs ricci_bench_sweep once (the baseline is measured inside the same run) and ricci_bench_one_solve, measures the peak
memory of `ricci sweep` on a surface of 100,000 vertices, and writes docs/results/sweep_speed.md with what is required
beside what was seen. The programs should come from a Release build. --only tries a part and writes no file. Exit status
1 when a benchmark reported an error or a requirement is missed.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import running

# Name in ricci_bench_sweep: mesh, required ratio, aim.
MESHES = {"eight": ("closed_g2/eight.off", 20, 50),
          "brezel": ("closed_g2/brezel.obj", 12, 30),
          "fertility_14k": ("families/fertility_resolutions/fertility_13971v.obj", 12, 30),
          "eight_loop_22k": ("closed_g2/eight.off, Loop subdivided once", 20, 50),
          "botijo": ("closed_g5plus/botijo_g5.obj", 10, 25)}
THREADS_REQUIRED = 1.85
EXPONENT_REQUIRED = 1.15
MEMORY_REQUIRED = 1.5  # GB
MEMORY_FACES = 200000


def benchmarks(program, pattern):
    """Runs a benchmark program. Returns its results by name, without the settings that end the names."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "results.json"
        command = [program, f"--benchmark_filter={pattern}", f"--benchmark_out={output}",
                   "--benchmark_out_format=json"]
        status = subprocess.run(command, stdout=sys.stderr, check=False).returncode
        if status != 0:
            sys.exit(f"{program}: exit {status}")
        text = output.read_text(encoding="utf-8") if output.exists() else ""
    results = json.loads(text)["benchmarks"] if text.strip() else []
    return {result["name"].split("/iterations:")[0]: result for result in results}


def peak_memory(ricci):
    """Peak resident GB of a sweep in 16 lanes on two threads; nothing when it failed."""
    with tempfile.TemporaryDirectory() as folder:
        mesh = str(Path(folder) / "eight.off")
        status, _, error = running.run([ricci, "generate", "eight", "--faces", str(MEMORY_FACES), "--jitter", "0.3",
                                        "--seed", "1", "-o", mesh])
        if status != 0:
            sys.exit(f"generate: exit {status}\n{error}")
        command = [ricci, "sweep", mesh, "-o", str(Path(folder) / "eight.h5"), "--vertices", "sample:200:1",
                   "--threads", "2", "--solver", "lanes", "--lanes", "16", "--quiet"]
        with open(os.devnull, "w", encoding="utf-8") as nowhere:
            child = subprocess.Popen(command, stdout=nowhere)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_maxrss * 1024 / 1e9 if child.returncode == 0 else None


def exponent(points):
    """Of cost ~ vertices ** exponent, by least squares of the logarithms."""
    x, y = ([math.log(p[k]) for p in points] for k in (0, 1))
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def ms(value):
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


class Report:
    """Sections of the file, and whether anything was missed."""

    def __init__(self):
        self.sections, self.missed = [], []

    def judge(self, good, what):
        """'yes' or 'NO' for a cell."""
        if not good:
            self.missed.append(what)
        return "yes" if good else "NO"

    def failed(self, results):
        """Notes benchmarks that ended in an error; returns the others."""
        for name, result in results.items():
            if result.get("error_occurred"):
                self.missed.append(f"{name}: {result['error_message']}")
                self.sections.append(f"`{name}`: error: {result['error_message']}.\n")
        return {name: result for name, result in results.items() if not result.get("error_occurred")}

    def table(self, title, text, header, rows):
        if rows:
            self.sections.append(f"## {title}\n\n{text}\n\n" + running.markdown_table(header, rows))


def sweep_cells(result):
    return [ms(result["baseline_ms"]), f"{ms(result['baseline_p50_ms'])} / {ms(result['baseline_p99_ms'])}",
            ms(result["sweep_ms"]), ms(result["sweep_rest_ms"]),
            f"{ms(result['sweep_p50_ms'])} / {ms(result['sweep_p99_ms'])}",
            f"{result['ratio']:.1f}", f"{result['processor_ratio']:.1f}"]


SWEEP_HEADER = ["mesh", "vertices", "baseline ms/solve", "baseline p50 / p99", "sweep ms/solve", "rest, ms",
                "sweep p50 / p99", "ratio", "ratio of processor time"]


def report_sweeps(report, results):
    rows = []
    for name, (mesh, required, aim) in MESHES.items():
        result = results.get(f"sweep/{name}")
        if not result:
            continue
        good = report.judge(result["ratio"] >= required, f"{mesh}: ratio {result['ratio']:.1f}, required {required}")
        rows.append([mesh, int(result["vertices"]), *sweep_cells(result), required, aim, good,
                     int(result["baseline_solves"]), f"{result['baseline_steps']:.1f}", f"{result['steps']:.1f}",
                     f"{result['flips']:.0f}", f"{result['worst_residual']:.1e}", f"{result['worst_distance']:.1e}"])
    report.table(
        "Whole sweeps, one thread",
        "`ricci sweep --vertices sample:1000:1 --threads 1 --solver lanes`, run inside the benchmark program by the\n"
        "program's own entry point; wall time of all of it over 1000 solves: reading the file, preparing the surface,\n"
        "solving, writing HDF5. Baseline: independent Newton with the same flips, one supernodal CHOLMOD factorisation\n"
        "per step, nested dissection chosen once. It solves an evenly drawn part of the same 1000 vertices (column\n"
        "\"baseline solves\"; half before the sweep, half after), and its mean counts 1000 times; its own reading,\n"
        "preparing and writing are measured once and added. p50 and p99: of single solves, a second that n lanes share\n"
        "counting 1/n for each. Rest: the sweep's wall time without the solves (reading, preparing, area distortion,\n"
        "writing). Distance: largest difference between the conformal factors of sweep and baseline at the baseline's\n"
        "vertices.",
        SWEEP_HEADER + ["required", "aim", "met", "baseline solves", "steps of the baseline", "steps", "flips",
                        "worst residual", "worst distance"], rows)


def report_threads(report, results):
    rows = []
    for name, (mesh, _, _) in MESHES.items():
        result = results.get(f"sweep_threads/{name}")
        if not result:
            continue
        ratio = result["threads_ratio"]
        good = report.judge(ratio >= THREADS_REQUIRED, f"{mesh}: two threads {ratio:.2f}, required {THREADS_REQUIRED}")
        rows.append([mesh, f"{ratio:.2f}", f"{result['threads_ratio_least']:.2f} ... {result['threads_ratio_most']:.2f}",
                     f"{result['control_ratio']:.2f}", f"{result['processors']:.2f}",
                     f"{result['control_processors']:.2f}", f"{result['processor_growth']:.2f}", THREADS_REQUIRED, good])
    report.table(
        "Two threads",
        "Wall time of the same sweep on one thread over that on two, the median of five interleaved pairs. Control:\n"
        "the same of a loop of pure arithmetic in the first-level cache, in between: what the machine gave then.\n"
        "Processors: those that two threads had on average, less than two where something else ran. Processor time:\n"
        "two threads' over one's; it grows with contention inside the program and hardly on a busy machine.",
        ["mesh", "threads ratio", "least ... most", "control", "processors", "of the control", "processor time",
         "required", "met"], rows)


def report_growth(report, results):
    sizes = [result for name, result in results.items() if name.startswith("sweep/generated_eight/")]
    rows = [["generated eight", int(result["vertices"]), *sweep_cells(result)] for result in sizes]
    text = "Generated surfaces of genus 2, as above."
    if len(sizes) > 2:
        found = {key: exponent([(result["vertices"], result[key]) for result in sizes])
                 for key in ("sweep_ms", "sweep_processor_ms", "sweep_p50_ms", "baseline_ms")}
        good = report.judge(found["sweep_ms"] <= EXPONENT_REQUIRED,
                            f"exponent {found['sweep_ms']:.2f}, required {EXPONENT_REQUIRED}")
        text += (f" Cost of a sweep per solve grows as vertices to the power {found['sweep_ms']:.2f} (least squares of\n"
                 f"the logarithms; required at most {EXPONENT_REQUIRED}; met: {good}), in processor time "
                 f"{found['sweep_processor_ms']:.2f}; its p50\n{found['sweep_p50_ms']:.2f}; the baseline "
                 f"{found['baseline_ms']:.2f}.")
    report.table("Cost against size", text, SWEEP_HEADER, rows)


def report_memory(report, gigabytes):
    seen = "the run failed" if gigabytes is None else f"{gigabytes:.2f} GB"
    good = report.judge(gigabytes is not None and gigabytes < MEMORY_REQUIRED,
                        f"peak memory: {seen}, required {MEMORY_REQUIRED} GB")
    report.sections.append("## Memory\n\nPeak resident memory of `ricci sweep --lanes 16 --threads 2` on a generated "
                           f"eight of {MEMORY_FACES} faces (200 solves):\n{seen}; required: below {MEMORY_REQUIRED} GB; "
                           f"met: {good}.\n")


def report_single(report, results):
    rows = []
    for name, result in results.items():
        rows.append([name.removeprefix("one_solve/"), int(result["vertices"]), int(result["steps"]),
                     int(result["factorizations"]), ms(result["baseline_ms"]), ms(result["flow_ms"]),
                     f"{result['baseline_ratio']:.2f}", f"{result['flow_ratio']:.2f}"])
    report.table(
        "One solve",
        "`ricci flow` with one cone, preparation included, on one thread, in processor time (median of seven).\n"
        "Baseline: the same cone by independent Newton, its preparation and nested dissection included.",
        ["surface", "vertices", "steps", "factorisations", "baseline ms", "flow ms", "ratio",
         "over steps x factorisation"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ricci", default=str(running.ROOT / "build-bench" / "bin" / "ricci"), help="the program")
    parser.add_argument("--bench", help="folder of the benchmark programs; default: bench beside the program's folder")
    parser.add_argument("--only", default="", help="only matching benchmarks; writes to standard output")
    parser.add_argument("--no-memory", action="store_true", help="leave out the peak memory")
    parser.add_argument("--note", default="", help="a sentence for the file, like what else ran on the machine")
    arguments = parser.parse_args()
    running.data_folder()
    folder = Path(arguments.bench) if arguments.bench else Path(arguments.ricci).resolve().parent.parent / "bench"
    report = Report()
    pattern = arguments.only or "."
    sweeps = report.failed(benchmarks(str(folder / "ricci_bench_sweep"), pattern))
    report_sweeps(report, sweeps)
    report_threads(report, sweeps)
    report_growth(report, sweeps)
    if not arguments.no_memory and not arguments.only:
        report_memory(report, peak_memory(arguments.ricci))
    report_single(report, report.failed(benchmarks(str(folder / "ricci_bench_one_solve"), pattern)))
    text = (f"# Speed of sweeps and single solves\n\nMade by `python3 bench/sweep_speed.py` with "
            f"{running.version(arguments.ricci)}. {arguments.note}".rstrip() + "\n\n" + "\n".join(report.sections))
    if arguments.only:
        print(text)
    else:
        running.write(running.RESULTS / "sweep_speed.md", text)
    for missed in report.missed:
        print(f"missed: {missed}", file=sys.stderr)
    return 1 if report.missed else 0


if __name__ == "__main__":
    sys.exit(main())
