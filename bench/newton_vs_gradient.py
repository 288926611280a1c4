#!/usr/bin/env python3
"""Residual against steps and against time, for Newton's method and gradient descent (thesis Figures 52 and 53).

Three surfaces of about 20,000 faces (the spherical one 25,000), one per geometry, through `ricci flow --json`. The full logs go to
out/newton_vs_gradient/, a thinned copy and the picture to docs/results/.
"""

import argparse
import csv
import io
import json
import math
import sys

import running
import svg

COLOURS = {"newton": "#c0392b", "gradient": "#2c6fbb"}
CASES = [("euclidean", "closed_g1/kitten.obj"),
         ("hyperbolic", "closed_g2/cup.off"),
         ("spherical", "closed_g0/maxplanck.nf25k.off")]


def solve(arguments, geometry, path, method):
    command = [arguments.ricci, "flow", path, "--json", "--quiet", "--geometry", geometry, "--method", method,
               "--tolerance", "1e-10", "--threads", str(arguments.threads), "--timeout", str(arguments.timeout)]
    status, out, error = running.run(command, 4 * arguments.timeout)
    results = running.json_lines(out)
    if len(results) != 1:
        sys.exit(f"{path}, {geometry}, {method}: exit {status}: {error}")
    return results[0]


def thinned(log, keep=150):
    """Start, end, and about `keep` lines evenly spaced in the logarithm of the step."""
    if len(log) <= keep:
        return log
    wanted = {0, len(log) - 1}
    wanted.update(min(len(log) - 1, round(math.exp(math.log(len(log)) * k / keep)) - 1) for k in range(keep + 1))
    return [log[i] for i in sorted(wanted)]


def limits(values):
    positive = [v for v in values if v and v > 0]
    return math.floor(math.log10(min(positive))), math.ceil(math.log10(max(positive)) + 1e-9)


def draw(runs):
    width, height, left, gap, top = 270, 210, 72, 52, 70
    document = svg.Document(left + 3 * width + 2 * gap + 24, top + 2 * height + 70 + 66)
    document.text(left, 26, "Newton's method and gradient descent to curvature within 1e-10", 15, weight="bold")
    for k, method in enumerate(("newton", "gradient")):
        x = document.width - 250 + 110 * k
        document.line(x, 22, x + 24, 22, COLOURS[method], 3)
        document.text(x + 30, 26, method, 12)
    for column, (geometry, name, results) in enumerate(runs):
        logs = {m: [line for line in r["log"] if line["residual_max"] is not None] for m, r in results.items()}
        everything = [line for log in logs.values() for line in log]
        y_range = (-13, max(1, limits([line["residual_max"] for line in everything])[1]))
        for row, (key, label) in enumerate((("iteration", "step"), ("seconds", "seconds"))):
            box = (left + column * (width + gap), top + row * (height + 70), width, height)
            x_range = limits([line[key] for line in everything if line["iteration"] > 0])
            title = f"{geometry}: {name.split('/')[-1]}" if row == 0 else ""
            plot = svg.LogPlot(document, box, x_range, y_range, title, label,
                               "max |K \u2212 target|" if column == 0 else "")
            for method, log in logs.items():
                points = [(line[key], max(line["residual_max"], 1e-300)) for line in thinned(log) if line["iteration"] > 0]
                plot.curve(points, COLOURS[method], marks=len(points) <= 40)
        words = ", ".join(f"{m} {r['status'].replace('_', ' ')} ({r['newton_iterations']} steps)" for m, r in results.items())
        document.text(left + column * (width + gap) + width / 2, document.height - 14, words, 9.5, "middle")
    return str(document)


def csv_text(runs, thin):
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(["geometry", "mesh", "method", "status", "iteration", "seconds", "residual_max", "step", "flips"])
    for geometry, name, results in runs:
        for method, result in results.items():
            for line in thinned(result["log"]) if thin else result["log"]:
                writer.writerow([geometry, name, method, result["status"], line["iteration"], f"{line['seconds']:.6g}",
                                 "" if line["residual_max"] is None else f"{line['residual_max']:.6g}",
                                 f"{line['step']:.4g}", line["flips"]])
    return table.getvalue()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.add_argument("--timeout", type=float, default=90.0, help="seconds per solve")
    parser.add_argument("--spherical", default=CASES[2][1], help="the spherical mesh, relative to the sample meshes")
    arguments = parser.parse_args()
    folder = running.data_folder() / "meshes"
    runs = []
    for geometry, name in CASES:
        name = arguments.spherical if geometry == "spherical" else name
        results = {}
        for method in COLOURS:
            results[method] = solve(arguments, geometry, str(folder / name), method)
            r = results[method]
            print(f"{geometry} {name} {method}: {r['status']}, residual {running.number(r['residual_max'], 3)}, "
                  f"{r['newton_iterations']} steps, {r['seconds']:.3g} s {r['message']}", flush=True)
        runs.append((geometry, name, results))
    raw = running.ROOT / "out" / "newton_vs_gradient"
    running.write(raw / "logs.csv", csv_text(runs, thin=False))
    running.write(raw / "logs.json", json.dumps([[g, n, r] for g, n, r in runs]))
    running.write(running.RESULTS / "newton_vs_gradient.csv", csv_text(runs, thin=True))
    running.write(running.RESULTS / "newton_vs_gradient.svg", draw(runs))


if __name__ == "__main__":
    main()
