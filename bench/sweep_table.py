#!/usr/bin/env python3
"""Full sweeps of five sample surfaces, verified by recomputation, as a table.

Each surface is swept by `ricci sweep` into its own file in the output folder; a run that was interrupted continues
with --resume, and one that is complete is not repeated. Afterwards `ricci verify --recompute` solves a part again.
Wall seconds are those of the run that finished; after a resume they are marked with an asterisk, for they leave out
what was done before. Exit status 1 when a vertex failed or a file did not verify.
"""

import argparse
import sys
from pathlib import Path

import h5py
import numpy as np

import running

SURFACES = [("closed_g2/eight.off", "all"), ("closed_g3/3holes.off", "all"), ("closed_g4/deckel.off", "all"),
            ("families/fertility_resolutions/fertility_4494v.off", "all"), ("closed_g2/brezel.obj", "sample:500")]


def sweep(arguments, name, vertices):
    """Sweeps one surface unless its file is complete. Returns the output file and how it came about."""
    folder = Path(arguments.output)
    folder.mkdir(parents=True, exist_ok=True)
    output = folder / f"{Path(name).stem}.{vertices.replace(':', '_')}.h5"
    timing = output.with_suffix(".json")
    if output.exists() and timing.exists():
        with h5py.File(output) as run:
            if run.attrs.get("complete") == 1:
                return output, running.json_lines(timing.read_text(encoding="utf-8")), "kept"
    resumed = Path(f"{output}.parts").exists()
    mesh = str(running.data_folder() / "meshes" / name)
    command = [arguments.ricci, "sweep", mesh, "-o", str(output), "--vertices", vertices, "--tolerance", "1e-10",
               "--threads", str(arguments.threads), "--json", "--quiet"]
    status, out, error = running.run(command + (["--resume"] if resumed else []))
    items = running.json_lines(out)
    if status not in (0, 1) or not items:
        sys.exit(f"{name}: exit {status}\n{error}")
    for item in items:
        item["resumed"] = resumed
    timing.write_text("".join(running.json.dumps(item) + "\n" for item in items), encoding="utf-8")
    return output, items, "resumed" if resumed else "swept"


def statistics_of(path):
    """What the rows of the only item say."""
    with h5py.File(path) as run:
        (item,) = run["items"].values()
        group = item["sweep"]
        names = h5py.check_enum_dtype(group["status"].dtype)
        converged = group["status"][:] == names["converged"]
        vertex, distortion = group["vertex"][:], group["area_distortion"][:]
        result = {"solved": len(vertex), "converged": int(converged.sum()), "V": int(item.attrs["vertices"]),
                  "genus": int(item.attrs["genus"])}
        if converged.any():
            good = np.flatnonzero(converged)
            best, worst = good[np.argmin(distortion[good])], good[np.argmax(distortion[good])]
            result["best"] = (int(vertex[best]), float(distortion[best]))
            result["worst"] = (int(vertex[worst]), float(distortion[worst]))
            result["residual"] = float(group["residual_max"][:][good].max())
        for key in ("newton_iterations", "flips", "seconds"):
            values = group[key][:].astype(float)
            result[key] = (running.quantile(values, 0.5), running.quantile(values, 0.99))
    return result


def verify(arguments, path):
    status, out, error = running.run([arguments.ricci, "verify", str(path), "--recompute", "--threads", str(arguments.threads)])
    if status != 0:
        print(out, error, sep="\n", file=sys.stderr)
    return status == 0


def table_row(name, stats, items, good):
    place = "{0[0]}: {0[1]:.4g}".format
    seconds = items[0]["seconds"]
    return [name, stats["V"], stats["genus"], stats["solved"], stats["converged"],
            running.number(stats.get("residual")), place(stats["best"]) if "best" in stats else "-",
            place(stats["worst"]) if "worst" in stats else "-",
            "{:.0f} / {:.0f}".format(*stats["newton_iterations"]), "{:.0f} / {:.0f}".format(*stats["flips"]),
            "{:.3g} / {:.3g}".format(*stats["seconds"]), f"{seconds:.4g}" + ("*" if items[0].get("resumed") else ""),
            running.number(items[0]["solves_per_second"], 4), "yes" if good else "NO"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.add_argument("--vertices", help="instead of the full sweeps, like sample:20; writes the table beside the output")
    parser.add_argument("--only", default="", help="only surfaces whose name contains this")
    parser.add_argument("-o", "--output", default=str(running.ROOT / "out" / "sweeps"), help="folder of the result files")
    parser.add_argument("--no-verify", action="store_true", help="leave out verify --recompute")
    arguments = parser.parse_args()
    chosen = [s for s in SURFACES if arguments.only in s[0]]
    rows, bad = [], False
    for name, vertices in chosen:
        path, items, how = sweep(arguments, name, arguments.vertices or vertices)
        stats = statistics_of(path)
        good = arguments.no_verify or verify(arguments, path)
        bad = bad or not good or stats["converged"] < stats["solved"]
        rows.append(table_row(name, stats, items, good))
        print(how, *rows[-1], sep="\t", flush=True)
    header = ["surface", "V", "genus", "solves", "converged", "worst residual", "best vertex", "worst vertex", "steps p50 / p99",
              "flips p50 / p99", "seconds per solve p50 / p99", "wall seconds", "solves/s",
              "verified by recomputation"]
    if arguments.no_verify:
        header, rows = header[:-1], [row[:-1] for row in rows]
    text = (f"# Sweeps: every vertex as the only cone\n\n{running.command_note(arguments.ricci)} {arguments.threads} thread(s). "
            f"Best and worst vertex with their area distortion.\n\n" + running.markdown_table(header, rows))
    full = arguments.vertices is None and not arguments.only
    running.write(running.RESULTS / "sweep_table.md" if full else Path(arguments.output) / "sweep_table.md", text)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
