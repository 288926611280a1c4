#!/usr/bin/env python3
"""Length spectra by a second method (bench/fuchsian.py), compared with `ricci spectrum` length by length.

Known values: Klein's quartic 3.935946 x 21 and 5.208017 x 28, Bolza's surface 3.057142 x 12, 4.896905 x 12, 5.828071 x 24
(primitive classes up to orientation). One-holed tori: the simple closed geodesics, from the traces of a basis alone, must
add up to the boundary's length (McShane 1998, Mirzakhani 2007):

    sum over simple closed geodesics of 2 log((e^(L/2) + e^l) / (e^(-L/2) + e^l)) = L

and each must be in the spectrum. Exit status 1 where anything differs, or the program has no `spectrum` yet (--alone: only
the second method).
"""

import argparse
import math
import sys
import tempfile
import time
from pathlib import Path

import fuchsian
import running

TOLERANCE = 1e-8  # on lengths; those of the second method agree among conjugates to about 1e-12
GENERATED = [("klein-quartic", 56, 10.0), ("klein-quartic", 896, 6.0), ("bolza", 16, 10.5), ("bolza", 1024, 6.0)]
MESHES = [("closed_g2/eight_173v.off", 10.0), ("closed_g2/eight.off", 10.0), ("closed_g2/cup.off", 6.0),
          ("closed_g2/doubletorus_60v.obj", 6.0), ("closed_g2/hyperbolic_convergence_model.obj", 8.0),
          ("closed_g2/femur_noisy.off", 6.0), ("closed_g2/brezel.obj", 5.0), ("closed_g2/skull.obj", 5.0),
          ("closed_g3/3Torus_Simple.obj", 8.0), ("closed_g3/3holes.off", 5.0), ("closed_g3/genus3.off", 5.0),
          ("closed_g3/elephant.off", 4.0), ("pairs/g3_on_box/dog_on_box.obj", 5.0), ("closed_g4/deckel.off", 4.0),
          ("closed_g4/4Torus.obj", 5.0), ("closed_g4/anchor_dense.off", 4.0),
          ("families/fertility_resolutions/fertility_1013v.obj", 4.0), ("families/torus_gk/5Torus_Simple.obj", 4.0),
          ("families/loopycuts_slivers/bearing_plate_rem.obj", 4.0), ("closed_g5plus/bracket_g6.obj", 4.0),
          ("pants/TwoHoleExample.off", 8.0), ("pants/aqua-center.off", 9.0),
          ("handles_with_boundary/punctured-torus_g1b1.obj", 8.0), ("handles_with_boundary/chipped-torus_g1b1.obj", 11.0),
          ("handles_with_boundary/eight.hole_g2b1.off", 6.0), ("tube_colon/ct_colon_segment_g3b1.off", 4.0)]
KNOWN = {"klein-quartic": [(3.935946, 21), (5.208017, 28)], "bolza": [(3.057142, 12), (4.896905, 12), (5.828071, 24)]}
HEADER = ["surface", "g, r", "up to", "rho", "R", "elements", "miscount", "lengths", "primitive", "shortest", "ricci", "seconds",
          "largest difference", "verdict"]


def expanded(lengths):
    """One number per class, ascending, and whether it is primitive."""
    rows = sorted((length, k < primitive) for length, primitive, powers in lengths for k in range(primitive + powers))
    return [r[0] for r in rows], [r[1] for r in rows]


def ricci_spectrum(arguments, path, longest):
    """The record of `ricci spectrum`, or None where the program does not know the command; and seconds."""
    start = time.perf_counter()
    command = [arguments.ricci, "spectrum", path, "--max-length", repr(longest), "--json", "--quiet"]
    status, out, error = running.run([*command, "--threads", str(arguments.threads)], arguments.timeout)
    records = running.json_lines(out)
    if status != 0 or not records:
        return None, time.perf_counter() - start, f"exit {status}: {error.strip()[-200:]}"
    return records[0], time.perf_counter() - start, ""


def compare(mine, primitive, record, longest):
    """Words about the difference (empty: none) and the largest difference of lengths."""
    theirs = [value for value in record["lengths"] if value <= longest + TOLERANCE]
    inside = [value for value in mine if value <= longest - TOLERANCE]
    if record.get("complete_up_to", longest) < longest - 1e-9:
        return f"complete up to {record['complete_up_to']} only", None
    if not len(inside) <= len(theirs) <= len(mine):
        missing = [x for x in inside if min((abs(x - y) for y in theirs), default=math.inf) > TOLERANCE]
        extra = [y for y in theirs if min((abs(x - y) for x in mine), default=math.inf) > TOLERANCE]
        return f"{len(theirs)} lengths, not {len(mine)}; missing {missing[:5]}, too many {extra[:5]}", None
    worst = max((abs(x - y) for x, y in zip(mine, theirs)), default=0.0)
    if worst > TOLERANCE:
        return "lengths differ", worst
    if sum(primitive[:len(theirs)]) != sum(bool(p) for p in record["primitive"][:len(theirs)]):
        return "primitive classes differ", worst
    return "", worst


def known_missing(name, lengths):
    for length, multiplicity in KNOWN.get(name, []):
        found = [p for value, p, _ in lengths if abs(value - length) < 1e-6]
        if found != [multiplicity]:
            return f"known {length} x {multiplicity}, found {found}"
    return ""


def examine(arguments, name, path, longest):
    """A row of the table, a complaint or an empty string, and both spectra."""
    elements, boundary, chi = fuchsian.group_of(arguments.ricci, path)
    result = fuchsian.spectrum(elements, boundary, chi, longest)
    mine, primitive = expanded(result["lengths"])
    problem = known_missing(name.split("@")[0], result["lengths"])
    if result["miscount"] > 1e-6:
        problem = f"counts are no whole numbers: {result['miscount']}"
    genus = (2 - len(boundary) - chi) // 2
    record, seconds, difference = None, None, None
    if not arguments.alone:
        record, seconds, failure = ricci_spectrum(arguments, path, longest)
        problem = problem or failure
        if record:
            words, difference = compare(mine, primitive, record, longest)
            problem = problem or words
    row = [name, f"{genus}, {len(boundary)}", longest, f"{result['radius']:.3f}", f"{result['displacement']:.2f}",
           result["elements"], running.number(result["miscount"], 1), len(mine), sum(primitive), f"{mine[0]:.6f}" if mine else "-",
           len([x for x in record["lengths"] if x <= longest + TOLERANCE]) if record else "-", running.number(seconds, 2),
           running.number(difference), problem or ("agree" if record else "alone")]
    return row, problem, {"mine": mine, "elements": elements, "boundary": boundary}


def simple_lengths(x, y, z, longest):
    """Lengths of the simple closed geodesics of a one-holed torus, of a basis with traces x, y and product's trace z: the
    tree of Markov triples from the smallest one."""
    triple = sorted(map(abs, (x, y, z)))
    while triple[0] * triple[1] - triple[2] < triple[2] - 1e-12:
        triple = sorted([triple[0], triple[1], triple[0] * triple[1] - triple[2]])
    limit, found = 2 * math.cosh(longest / 2), list(triple)
    stack = [(triple[1], triple[2], triple[0]), (triple[0], triple[2], triple[1]), (triple[0], triple[1], triple[2])]
    while stack:
        one, two, third = stack.pop()
        trace = one * two - third
        if trace <= limit:
            found.append(trace)
            stack += [(one, trace, two), (two, trace, one)]
    return sorted(2 * math.acosh(t / 2) for t in found if t <= limit)


def one_holed_torus(name, spectra, longest):
    """McShane's sum for a (1,1), and whether its simple geodesics are in the spectrum."""
    x, y = (g for g in spectra["elements"][:2])
    traces = [2 * abs(g[0].real) for g in (x, y, fuchsian.multiply(x, y))]
    border = float(fuchsian.translation_length(spectra["boundary"])[0])
    relation = sum(t * t for t in traces) - math.prod(traces) - 2 + 2 * math.cosh(border / 2)
    simple = simple_lengths(*traces, 45.0)
    numerator, shift = 2 * math.sinh(border / 2), math.exp(-border / 2)
    total = sum(2 * math.log1p(numerator / (shift + math.exp(length))) for length in simple)
    within = [length for length in simple if length < longest]
    lost = [length for length in within if min(abs(length - m) for m in spectra["mine"]) > TOLERANCE]
    good = abs(total - border) < 1e-9 * border and not lost and abs(relation) < 1e-9 * math.cosh(border / 2)
    words = [name, f"{border:.12f}", f"{total:.12f}", len(simple), len(within), len(lost),
             running.number(relation)]
    return words, "" if good else f"{name}: McShane's sum {total}, boundary {border}, lost {lost}, relation {relation}"


def surfaces(folder, arguments):
    for name, faces, longest in GENERATED:
        path = str(Path(folder) / f"{name}{faces}.len")
        status, _, error = running.run([arguments.ricci, "generate", name, "--faces", str(faces), "-o", path, "--quiet"])
        if status != 0:
            sys.exit(f"generate {name}: {error}")
        yield f"{name}@{faces}", path, longest
    for name, longest in MESHES:
        yield name, str(running.data_folder() / "meshes" / name), longest


def report(arguments, rows, sums, complaints):
    text = (f"# Length spectra by a second method\n\n{running.command_note(arguments.ricci)}\n\n"
            "Elements of the group are listed by a Dirichlet domain of radius rho up to displacement R, and classes counted by the "
            "lengths that their axes have in the domain (bench/fuchsian.py; numpy, double precision). The miscount is the largest "
            "distance of such a count from a whole number. Lengths are closed geodesics up to orientation, powers included. "
            f"Beside them the number that `ricci spectrum` finds, its seconds (layout included), and the largest difference of "
            f"two lengths; more than {TOLERANCE} is a failure, as is any length too few or too many.\n\n"
            + running.markdown_table(HEADER, rows)
            + "\nOne-holed tori: the sum over simple closed geodesics that equals the boundary's length (McShane, Mirzakhani), and "
              "how many of them the spectrum above should have but has not.\n\n"
            + running.markdown_table(["surface", "boundary", "sum", "simple up to 45", "within the spectrum", "lost",
                                      "trace relation"], sums))
    if complaints:
        text += "\nDisagreements:\n\n" + "".join(f"* {line}\n" for line in complaints)
    running.write(running.RESULTS / "independent_spectrum.md", text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.add_argument("--only", default="", help="only surfaces whose name contains this (writes no file)")
    parser.add_argument("--alone", action="store_true", help="the second method only (writes no file)")
    parser.add_argument("--timeout", type=float, default=600.0, help="seconds per surface")
    arguments = parser.parse_args()
    rows, sums, complaints = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, path, longest in surfaces(folder, arguments):
            if arguments.only not in name:
                continue
            try:
                row, problem, spectra = examine(arguments, name, path, longest)
            except fuchsian.GroupError as error:
                complaints.append(f"{name}: {error}")
                print(name, error, sep="\t", flush=True)
                continue
            rows.append(row)
            print(*row, sep="\t", flush=True)
            if problem:
                complaints.append(f"{name}: {problem}")
            if row[1] == "1, 1":
                words, problem = one_holed_torus(name, spectra, longest)
                sums.append(words)
                print(*words, sep="\t", flush=True)
                complaints += [problem] if problem else []
    print(*complaints, sep="\n")
    if not arguments.only and not arguments.alone:
        report(arguments, rows, sums, complaints)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
