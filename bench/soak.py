#!/usr/bin/env python3
"""A long sweep, and what it takes while it runs: does memory stay flat, are file descriptors and threads given back?

Surfaces are generated in a temporary folder (eights, pants, one-holed tori, a torus that admits no cone, a file that is no
mesh), and named again and again on one command line, so that one process opens thousands of items for as long as --minutes
says; then it is interrupted (SIGINT: exit 130, resumable). Resident size, descriptors and threads are read from /proc every
two seconds. Growth is the slope of a straight line through the resident size after the first tenth, over the rate of
finished items: names and places of finished items stay in memory, their rows do not. Exit status 1 where it exceeds
--most-growth, or anything else goes wrong.
"""

import argparse
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import running

SURFACES = [("eight", 400), ("pants", 300), ("punctured-torus", 300), ("torus", 200), ("eight", 900)]


def make_files(ricci, folder):
    files = []
    for number, (name, faces) in enumerate(SURFACES):
        files.append(str(folder / f"{name}{number}.off"))
        subprocess.run([ricci, "generate", name, "--faces", str(faces), "-o", files[-1], "--quiet"], check=True)
    broken = folder / "broken.off"
    broken.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", encoding="utf-8")
    return [*files, str(broken)]


def sample(pid):
    """Resident size in MB, descriptors, threads."""
    status = Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    value = {line.split(":")[0]: line.split()[1] for line in status.splitlines() if line.startswith(("VmRSS", "Threads"))}
    return int(value["VmRSS"]) / 1024, sum(1 for _ in Path(f"/proc/{pid}/fd").iterdir()), int(value["Threads"])


def soak(arguments, folder):
    files = make_files(arguments.ricci, folder) * arguments.rounds
    command = [arguments.ricci, "sweep", *files, "--threads", str(arguments.threads), "--quiet", "-o", str(folder / "soak.h5")]
    with open(folder / "stderr.txt", "w", encoding="utf-8") as error:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=error)
    samples, started = [], time.monotonic()
    while time.monotonic() - started < 60 * arguments.minutes and process.poll() is None:
        time.sleep(2)
        try:
            samples.append((time.monotonic() - started, *sample(process.pid)))
        except (OSError, KeyError):
            break
    ended = process.poll() is not None
    if not ended:
        process.send_signal(signal.SIGINT)
    return samples, process.wait(), ended, sum(1 for _ in (folder / "soak.h5.parts").glob("sweep-*")) if not ended else 0


def growth(samples):
    """MB an hour."""
    later = [(t, size) for t, size, _, _ in samples if t >= 0.1 * samples[-1][0]]
    return 3600 * statistics.linear_regression(*zip(*later)).slope


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.set_defaults(threads=2)
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--rounds", type=int, default=8000, help="how often the files are named")
    parser.add_argument("--most-growth", type=float, default=2, help="kB for each block of solves, one per item here")
    parser.add_argument("--write", action="store_true", help="the table to docs/results/soak.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        samples, status, ended, blocks = soak(arguments, Path(folder))
    if ended or status != 130:
        print(f"soak: the sweep ended by itself, exit {status}", file=sys.stderr)
        return 1
    slope = growth(samples)
    each = 1024 * slope * samples[-1][0] / 3600 / max(1, blocks)
    rows = [[f"{t / 60:.1f}", f"{size:.1f}", descriptors, threads]
            for t, size, descriptors, threads in samples[::max(1, len(samples) // 12)]]
    text = (f"# Soak\n\n{running.command_note(arguments.ricci)}\n\n{samples[-1][0] / 60:.1f} minutes, {blocks} blocks of solves "
            f"written: **resident size grows by {each:.2f} kB for each**, {slope:.1f} MB an hour.\n\n"
            + running.markdown_table(["minutes", "resident, MB", "descriptors", "threads"], rows))
    print(text)
    if arguments.write:
        running.write(running.RESULTS / "soak.md", text)
    return 0 if each <= arguments.most_growth else 1


if __name__ == "__main__":
    sys.exit(main())
