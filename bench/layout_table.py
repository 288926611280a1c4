#!/usr/bin/env python3
"""One `ricci layout` on every sample mesh, as a table: geometry by topology, generators, errors, flipped pieces.

Exit status 1 when a surface did not converge, a relator misses the identity by more than 1e-8, a frame carried round a
side by more than 1e-8, or a piece is turned over.
"""

import argparse
import sys

import running

HEADER = ["mesh", "V", "genus", "boundaries", "geometry", "status", "relator error", "digits", "closing error", "digits",
          "radius", "pieces", "flipped", "degenerate", "unresolved", "seconds", "flow", "group"]
LIMIT = 1e-8


def layout(row, arguments):
    """The result lines of one mesh; one line saying what happened where the program gave none."""
    command = [arguments.ricci, "layout", row["path"], "--json", "--quiet", "--threads", str(arguments.threads),
               "--timeout", str(arguments.timeout)]
    status, out, error = running.run(command, 4 * arguments.timeout)
    results = running.json_lines(out)
    if results:
        return results
    words = "timeout" if status == "timeout" else f"exit {status}"
    return [{"status": words, "message": error.strip().splitlines()[-1] if error.strip() else ""}]


def table_row(row, result):
    stages = result.get("stage_seconds", {})
    return [row["name"], row["V"], row["genus"], row["boundaries"], result.get("geometry", "-"), result["status"],
            running.number(result.get("relator_error")), result.get("group_digits", "-"),
            running.number(result.get("closing_error")), result.get("layout_digits", "-"),
            running.number(result.get("radius"), 3), result.get("pieces", "-"), result.get("flipped_pieces", "-"),
            result.get("degenerate_pieces", "-"), result.get("unresolved_pieces", "-"),
            running.number(result.get("seconds"), 3), running.number(stages.get("flow"), 3),
            running.number(stages.get("group"), 3)]


def complaint(name, result):
    if result["status"] != "converged":
        return f"{name}: {result['status']}: {result.get('message', '')}"
    for key in ("relator_error", "closing_error"):
        value = result.get(key)
        if value is None or not value <= LIMIT:
            return f"{name}: {key} {value}"
    if result["flipped_pieces"]:
        return f"{name}: {result['flipped_pieces']} pieces turned over"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.add_argument("--only", default="", help="only meshes whose name contains this (writes no file)")
    parser.add_argument("--timeout", type=float, default=150.0, help="seconds per flow")
    arguments = parser.parse_args()

    rows, complaints, results = [], [], []
    for row in running.sample_meshes():
        if arguments.only not in row["name"]:
            continue
        for result in layout(row, arguments):
            cells = table_row(row, result)
            rows.append(cells)
            results.append(result)
            problem = complaint(row["name"], result)
            if problem:
                complaints.append(problem)
            print(*cells, sep="\t", flush=True)
    good = [r for r in results if r["status"] == "converged"]
    summary = (f"{len(good)} of {len(results)} surfaces converged; largest relator error "
               f"{running.number(max((r['relator_error'] for r in good), default=None))}, largest closing error "
               f"{running.number(max((r['closing_error'] for r in good), default=None))}; "
               f"{sum(r['flipped_pieces'] for r in good)} flipped, {sum(r['degenerate_pieces'] for r in good)} degenerate of "
               f"{sum(r['pieces'] for r in good)} pieces; {sum(r['seconds'] for r in good):.0f} s in all on "
               f"{arguments.threads} thread(s).")
    print(summary)
    print(*complaints, sep="\n")
    if not arguments.only:
        text = (f"# Structure and layout of every sample mesh\n\n{running.command_note(arguments.ricci)}\n\n{summary}\n\n"
                "Errors are largest matrix entries, measured in the arithmetic of the column after them (16: double, 19: long "
                "double). Unresolved pieces are turned the right way by their own frames but too small, or too far out, for "
                "coordinates in double to show it. Euclidean surfaces have area 1. Seconds: the whole command, of which flow "
                "and group.\n\n")
        text += running.markdown_table(HEADER, rows)
        if complaints:
            text += "\nBeyond the limits:\n\n" + "".join(f"* {line}\n" for line in complaints)
        running.write(running.RESULTS / "layout_table.md", text)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
