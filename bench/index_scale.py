#!/usr/bin/env python3
"""An index of two thousand surfaces of genus two: how fast it is built, where the time goes, how fast it answers, and
whether a build that is killed and resumed ends with the same bits.

The surfaces are smooth deformations (ricci_make_variants --deform) of the sample surfaces of genus two, about 2,000
vertices each; they are made in the work folder, which is kept. Spectra are complete to length 4, with coordinates. Exit
status 1 where an item fails, bits differ, or a goal is missed: 12 shapes a second on two threads, 10 ms for a query after
its own solve.
"""

import argparse
import os
import shutil
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np

import running

SOURCES = ["closed_g2/eight.off", "closed_g2/cup.off", "closed_g2/brezel.obj", "closed_g2/double-torus.obj",
           "closed_g2/skull.obj", "closed_g2/doubletorus_60v.obj", "families/loopycuts_slivers/sculpt_rem.obj",
           "pairs/g2_mac/mac_smooth.obj", "pairs/g2_mac/mac_blocky.obj", "pairs/g2_doubletorus/double_torus_blocky.obj",
           "pairs/g2_doubletorus/double_torus_round_iso.obj"]
FACES = 4004  # 2,000 vertices at genus two
GOAL_RATE, GOAL_QUERY = 12.0, 0.010


def make_shapes(arguments, count, seed):
    """`count` surfaces, made where they are not there. Returns their folder."""
    folder = Path(arguments.work) / f"shapes{count}seed{seed}"
    if len(list(folder.glob("*.off"))) == count:
        return folder
    paths = [str(running.data_folder() / "meshes" / name) for name in SOURCES]
    words = ["-o", str(folder), "--deform", str(count), "--seed", str(seed), "--faces", str(FACES)]
    status, out, error = running.run([arguments.make_variants, *paths, *words])
    if status != 0 or len(running.json_lines(out)) != count:
        sys.exit(f"ricci_make_variants: exit {status}\n{error}")
    return folder


def build_command(arguments, folder, index, threads):
    return [arguments.ricci, "index", "build", str(folder), "-o", str(index), "--max-length", "4", "--threads", str(threads),
            "--quiet", *arguments.index_options.split()]


def remove_run(index):
    for path in (Path(index), Path(f"{index}.parts")):
        if path.is_dir():
            shutil.rmtree(path)
        elif path.exists():
            path.unlink()


def build(arguments, folder, index, threads):
    """A build from nothing. Returns wall seconds, processor seconds and exit status."""
    remove_run(index)
    before, start = os.times(), time.perf_counter()
    status, _, error = running.run(build_command(arguments, folder, index, threads))
    wall, after = time.perf_counter() - start, os.times()
    if status not in (0, 1):
        sys.exit(f"index build: exit {status}\n{error[-2000:]}")
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return wall, cpu, status


def build_with_kills(arguments, folder, index, threads, seconds):
    """The same build, killed with SIGKILL after each of `seconds`, and resumed. Returns how often it was really killed."""
    remove_run(index)
    kills = 0
    for patience in seconds:
        command = build_command(arguments, folder, index, threads) + (["--resume"] if kills else [])
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            try:
                process.wait(patience)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                process.wait()
                kills += 1
                continue
        return kills
    status, _, error = running.run(build_command(arguments, folder, index, threads) + ["--resume"])
    if status not in (0, 1):
        sys.exit(f"index build --resume: exit {status}\n{error[-2000:]}")
    return kills


def datasets(path):
    """Every dataset of a file but those that hold times: name -> bytes and type."""
    found = {}

    def visit(name, node):
        if isinstance(node, h5py.Dataset) and "seconds" not in name:
            value = node[()]
            if isinstance(value, np.ndarray) and value.dtype.hasobject:
                found[name] = (str(node.dtype), repr(value.tolist()))
            else:
                found[name] = (str(node.dtype), np.asarray(value).tobytes())

    with h5py.File(path) as run:
        run.visititems(visit)
    return found


def differences(one, two):
    """Names of datasets that one file lacks, or that differ in a bit."""
    a, b = datasets(one), datasets(two)
    return sorted(set(a) ^ set(b)) + sorted(name for name in set(a) & set(b) if a[name] != b[name]), len(a)


def time_shares(arguments, index, cpu):
    """Rows of part, processor seconds and share of all the build took: what `index stats` adds up, and the rest."""
    status, out, error = running.run([arguments.ricci, "index", "stats", str(index), "--json"])
    totals = {}
    for record in running.json_lines(out):
        for kind, value in record.get("seconds", {}).items():
            totals[kind] = totals.get(kind, 0.0) + value
    if status != 0 or not totals:
        sys.exit(f"index stats: exit {status}\n{error}")
    totals["reading, writing, the rest"] = max(0.0, cpu - sum(totals.values()))
    return [[kind, f"{value:.1f}", f"{100 * value / cpu:.1f} %"] for kind, value in totals.items()]


def query(arguments, index, path):
    """The answer of `index query`, and seconds of the whole command."""
    start = time.perf_counter()
    status, out, error = running.run([arguments.ricci, "index", "query", str(index), str(path), "-k", "5", "--json", "--quiet"])
    records = running.json_lines(out)
    if status != 0 or not records:
        sys.exit(f"index query {path}: exit {status}\n{error[-500:]}")
    return records[0], time.perf_counter() - start


def ask(arguments, folder, index):
    """Of shapes that the index does not hold: median seconds of the whole command, of their own description, of what comes
    after. Of shapes that it holds: how many do not find themselves."""
    fresh = make_shapes(arguments, arguments.queries, 6)
    answers = [query(arguments, index, path) for path in sorted(fresh.glob("*.off"))]
    held = sorted(folder.glob("*.off"))[:: max(1, arguments.count // arguments.queries)]
    lost = sum(Path(query(arguments, index, path)[0]["neighbours"][0]["file"]).name != path.name for path in held)
    return (statistics.median(wall for _, wall in answers), statistics.median(a["describe_seconds"] for a, _ in answers),
            statistics.median(a["search_seconds"] for a, _ in answers), lost)


def report(arguments, rows, shares, answers, kills, changed, changed_threads, count, size):
    wall, describe, search, lost = answers
    return (f"# An index of {arguments.count} surfaces of genus two\n\n{running.command_note(arguments.ricci)}\n\n"
            f"Smooth deformations of {len(SOURCES)} sample surfaces, {FACES} faces each, spectra complete to length 4 and "
            f"coordinates; {os.cpu_count()} processors; the file has {size / 1e6:.1f} MB.\n\n"
            + running.markdown_table(["threads", "wall seconds", "shapes per second", "processor seconds", "a day"], rows)
            + "\nOne thread:\n\n" + running.markdown_table(["part", "seconds", "share"], shares)
            + f"\nA query with a shape that the index does not hold (medians of {arguments.queries}): {1000 * search:.2f} ms beyond "
            f"the {1000 * describe:.1f} ms of its own description, opening the index included; {1000 * wall:.1f} ms with the start "
            f"of the program. Of the shapes that it holds, asked for themselves, {lost} do not come first.\n\n"
            f"Killed {kills} times (SIGKILL) during the build on two threads and resumed: {count - len(changed)} of {count} "
            f"datasets equal those of the undisturbed run bit for bit (times left out); between one thread and two "
            f"{len(changed_threads)} differ.\n")


def complaints_of(arguments, seconds, failed, answers, kills, changed, changed_threads):
    wanted = [
        (not failed, "an item failed: `index build` ended with status 1"),
        (kills > 0 and not changed, f"killed {kills} times and resumed: these differ: {changed[:5]}"),
        (not changed_threads, f"one thread and two: these differ: {changed_threads[:5]}"),
        (arguments.count / seconds[2] >= GOAL_RATE, f"{arguments.count / seconds[2]:.2f} shapes a second, not {GOAL_RATE}"),
        (answers[2] <= GOAL_QUERY, f"a query takes {1000 * answers[2]:.1f} ms after its own solve"),
        (answers[3] == 0, f"{answers[3]} shapes are not their own nearest neighbours"),
    ]
    return [words for good, words in wanted if not good]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.add_argument("--make-variants", default=str(running.ROOT / "build" / "bench" / "ricci_make_variants"))
    parser.add_argument("--work", default=str(running.ROOT / "out" / "index_scale"), help="folder of shapes and indices")
    parser.add_argument("--count", type=int, default=2000, help="shapes (another number writes no file)")
    parser.add_argument("--queries", type=int, default=50)
    parser.add_argument("--index-options", default="", help="more words for `ricci index build`")
    arguments = parser.parse_args()
    work = Path(arguments.work)
    work.mkdir(parents=True, exist_ok=True)
    folder = make_shapes(arguments, arguments.count, 5)
    rows, seconds, failed = [], {}, 0
    for threads in (2, 1):
        seconds[threads], cpu, status = build(arguments, folder, work / f"threads{threads}.h5", threads)
        failed = max(failed, status)
        rows.append([threads, f"{seconds[threads]:.1f}", f"{arguments.count / seconds[threads]:.2f}", f"{cpu:.1f}",
                     f"{86400 * arguments.count / seconds[threads] / 1e6:.2f} million"])
        print(*rows[-1], sep="\t", flush=True)
    shares = time_shares(arguments, work / "threads1.h5", cpu)
    patience = [share * seconds[2] for share in (0.2, 0.35, 0.2)]
    kills = build_with_kills(arguments, folder, work / "killed.h5", 2, patience)
    changed, count = differences(work / "threads2.h5", work / "killed.h5")
    changed_threads, _ = differences(work / "threads2.h5", work / "threads1.h5")
    answers = ask(arguments, folder, work / "threads2.h5")
    text = report(arguments, rows, shares, answers, kills, changed, changed_threads, count,
                  (work / "threads2.h5").stat().st_size)
    complaints = complaints_of(arguments, seconds, failed, answers, kills, changed, changed_threads)
    if complaints:
        text += "\nBeyond the goals:\n\n" + "".join(f"* {line}\n" for line in complaints)
    print(text)
    if arguments.count == 2000:
        running.write(running.RESULTS / "index_scale.md", text)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
