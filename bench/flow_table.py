#!/usr/bin/env python3
"""One `ricci flow` on every sample mesh, as a table.

Closed surfaces get the same curvature at every vertex, surfaces with boundary the same geodesic curvature at every
boundary vertex; with --auto no target is given and the geometry follows the topology. Exit status 1 when a mesh did
not converge.
"""

import argparse
import sys

import running


def solve(row, arguments):
    """The result lines of one mesh; one line saying what happened where the program gave none."""
    command = [arguments.ricci, "flow", row["path"], "--json", "--quiet", "--scheme", "vertex-scaling",
               "--tolerance", "1e-10", "--threads", str(arguments.threads), "--timeout", str(arguments.timeout)]
    if not arguments.auto:
        command += ["--target", "uniform" if row["boundaries"] == "0" else "boundary"]
    status, out, error = running.run(command, 3 * arguments.timeout)
    results = running.json_lines(out)
    if results:
        return results
    words = "timeout" if status == "timeout" else f"exit {status}"
    return [{"status": words, "message": error.strip().splitlines()[-1] if error.strip() else ""}]


def table_row(row, result):
    item = result.get("item", "").split("@")[0]
    name = row["name"]
    if ".c" in item and item.rsplit(".c", 1)[1].isdigit():
        name += " .c" + item.rsplit(".c", 1)[1]
    cells = [name, row["V"], row["genus"], row["boundaries"], result.get("geometry", "-"), result["status"],
             result.get("newton_iterations", "-"), result.get("flips", "-"), running.number(result.get("residual_max")),
             "yes" if result.get("extended_precision") else "no", running.number(result.get("seconds"), 3)]
    return cells


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.add_argument("--auto", action="store_true", help="no target: the geometry follows the topology")
    parser.add_argument("--only", default="", help="only meshes whose name contains this (writes no file)")
    parser.add_argument("--timeout", type=float, default=150.0, help="seconds per solve")
    arguments = parser.parse_args()

    rows, failures, converged, extended, seconds = [], [], 0, 0, 0.0
    for row in running.sample_meshes():
        if arguments.only not in row["name"]:
            continue
        for result in solve(row, arguments):
            cells = table_row(row, result)
            rows.append(cells)
            seconds += result.get("seconds", 0.0)
            extended += bool(result.get("extended_precision"))
            if result["status"] == "converged":
                converged += 1
            else:
                failures.append(f"{cells[0]}: {result['status']}, residual "
                                f"{running.number(result.get('residual_max'), 3)}: {result.get('message', '')}")
            print(*cells, sep="\t", flush=True)
    by_geometry = {}
    for cells in rows:
        count = by_geometry.setdefault(cells[4], [0, 0])
        count[0] += cells[5] == "converged"
        count[1] += 1
    parts = ", ".join(f"{geometry} {good} of {total}" for geometry, (good, total) in by_geometry.items())
    summary = (f"{converged} of {len(rows)} surfaces converged to max |K - target| <= 1e-10 ({parts}); {extended} of all "
               f"needed extended precision; {seconds:.0f} s in all on {arguments.threads} thread(s).")
    print(summary)
    print(*failures, sep="\n")
    if not arguments.only:
        title = "Flow on every sample mesh, " + ("geometry by topology" if arguments.auto else "flat with uniform target")
        text = f"# {title}\n\n{running.command_note(arguments.ricci)}\n\n{summary}\n\n"
        text += running.markdown_table(["mesh", "V", "genus", "boundaries", "geometry", "status", "steps", "flips", "residual",
                                        "extended precision", "seconds"], rows)
        if failures:
            text += "\nNot converged:\n\n" + "".join(f"* {line}\n" for line in failures)
        running.write(running.RESULTS / ("flow_auto_table.md" if arguments.auto else "flow_table.md"), text)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
