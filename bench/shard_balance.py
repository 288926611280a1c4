#!/usr/bin/env python3
"""How evenly shards divide the sample meshes: foreseen and in processor time, against one undivided run.

Every shard runs alone, on one thread; seconds are its processor time, so that a busy machine disturbs little. Each set
of shards is joined, and the result compared with the undivided run's by the checksums of all datasets but the seconds.
Prints a Markdown table. Exit status 1 when a joined file differs.
"""

import argparse
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py

import running


def processor_seconds(command):
    """Runs a command; seconds of it and its children, and what it printed on standard error."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        sys.exit(f"{' '.join(command[:4])} ...: exit {done.returncode}\n{done.stderr}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stderr


def digests(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, thing: found.__setitem__(name, int(thing.attrs["xxh3"]))
                        if isinstance(thing, h5py.Dataset) and not name.endswith("seconds") else None)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    running.add_common_arguments(parser)
    parser.add_argument("--shards", default="2,4,8,16")
    parser.add_argument("--vertices", default="sample:100")
    parser.add_argument("--meshes", nargs="*", help="default: all sample meshes")
    arguments = parser.parse_args()
    meshes = arguments.meshes or [row["path"] for row in running.sample_meshes()]
    sweep = [arguments.ricci, "sweep", *meshes, "--vertices", arguments.vertices, "--threads", "1"]
    same = True
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole, _ = processor_seconds(sweep + ["-q", "-o", str(folder / "whole.h5")])
        rows = []
        for count in map(int, arguments.shards.split(",")):
            seconds, foreseen, files = [], "", []
            for shard in range(count):
                files.append(str(folder / f"{shard}of{count}.h5"))
                took, log = processor_seconds(sweep + ["--shard", f"{shard}/{count}", "-o", files[-1]])
                seconds.append(took)
                foreseen = re.search(r"has ([0-9.]+) of the mean", log).group(1)
            merged = folder / f"{count}.h5"
            processor_seconds([arguments.ricci, "merge", *files, "-o", str(merged)])
            equal = digests(merged) == digests(folder / "whole.h5")
            same = same and equal
            rows.append([count, foreseen, f"{max(seconds) * count / sum(seconds):.2f}", f"{sum(seconds) / whole:.2f}",
                         "the same bits" if equal else "DIFFERS"])
        print(f"{len(meshes)} files, `--vertices {arguments.vertices}`, undivided {whole:.0f} s.\n")
        print(running.markdown_table(["shards", "largest / mean, foreseen", "largest / mean, processor time",
                                      "all shards / undivided", "joined"], rows))
        print(running.command_note(arguments.ricci))
    sys.exit(0 if same else 1)


if __name__ == "__main__":
    main()
