#!/usr/bin/env python3
"""Retrieval: does the nearest neighbour of a surface, in an index without it, show the same shape?

Every sample surface of genus one or more, with ten variants each (ricci_make_variants: Moebius images, decimation,
subdivision, noise of 0.1 % of the diagonal, retriangulation, relabelling). Files that show one shape are one shape
(SHAPES below). Topological types with fewer than four shapes are filled up with new ones, made by smooth deformations of
space and then varied like the others; those that stay below four are listed apart. The data set and the index are made in the
work folder and kept there; --fresh makes them anew.

--independent takes the twelve shortest lengths of bench/fuchsian.py (tori: the modulus) and the Euclidean distance of their
logarithms (tori: the Teichmueller distance) instead of an index (writes no file).
Exit status 1 where fewer than 99 % of the counted queries find their shape.
"""

import argparse
import json
import math
import shutil
import sys
import time
from collections import Counter, defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import fuchsian
import running

# Resolutions and remeshings of one shape. Beside what the names say: eight_173v and double-torus have the principal radii of
# gyration of eight to 4 % and 0.4 %, and its ratio volume^2 / area^3 to 12 % (of 350 faces) and 1.2 %.
SHAPES = {
    "eight": ["closed_g2/eight.off", "closed_g2/eight_173v.off", "closed_g2/double-torus.obj"],
    "sculpt": ["families/loopycuts_slivers/sculpt_rem.obj", "families/loopycuts_slivers/sculpt_rem_splitted.obj"],
    "bearing_plate": ["families/loopycuts_slivers/bearing_plate_rem.obj",
                      "families/loopycuts_slivers/bearing_plate_rem_splitted.obj"],
    "fertility": [f"families/fertility_resolutions/fertility_{v}" for v in
                  ("1013v.obj", "4494v.off", "5877v.obj", "13971v.obj")],
    "4Torus": ["closed_g4/4Torus.obj", "families/torus_gk/4Torus_Simple.obj"],
}
FEWEST_SHAPES = 4
MOST_FACES = 60000  # of a variant; larger surfaces are decimated to that first
WANTED = 0.99


def shape_of(name):
    for shape, names in SHAPES.items():
        if name in names:
            return shape
    return Path(name).stem


def make_variants(arguments, words):
    status, out, error = running.run([arguments.make_variants, *words])
    if status not in (0, 1):
        sys.exit(f"{' '.join(words)}: exit {status}\n{error}")
    if error:
        print(error.strip(), file=sys.stderr, flush=True)
    return running.json_lines(out), error


def deformed_shapes(arguments, folder, members, count):
    """`count` new shapes of the type of `members`, by deformations of its smallest surfaces in turn."""
    sources = sorted(members, key=lambda row: int(row["F"]))
    sources = [row for row in sources if int(row["F"]) >= 1000] or sources
    faces = min(20000, max(2000, int(sources[0]["F"])))
    records, _ = make_variants(arguments, [*(row["path"] for row in sources[:count]), "-o", str(folder / "deformed"),
                                           "--deform", str(count), "--seed", "7", "--faces", str(faces)])
    return [(Path(record["file"]).stem, record["file"]) for record in records]


def make_data_set(arguments, folder):
    """Items: dictionaries of file, shape, surface, variant, type (genus, boundaries); and notes for the report."""
    types, items, notes = defaultdict(list), [], []
    for row in running.sample_meshes():
        if int(row["genus"] or 0) >= 1 and row["components"] == "1":
            types[int(row["genus"]), int(row["boundaries"])].append(row)
    for kind, members in sorted(types.items()):
        if arguments.only and arguments.only != f"{kind[0]},{kind[1]}":
            continue
        surfaces = [(shape_of(row["name"]), row["path"]) for row in members]
        missing = FEWEST_SHAPES - len({shape for shape, _ in surfaces})
        if missing > 0:
            surfaces += deformed_shapes(arguments, folder, members, missing)
        for shape, path in surfaces:
            original = folder / "variants" / f"{Path(path).stem}.original{Path(path).suffix}"
            original.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, original)
            item = {"shape": shape, "surface": Path(path).stem, "type": kind, "made": "deformed" in Path(path).parts[-2]}
            items.append({**item, "file": str(original), "variant": "original"})
            records, errors = make_variants(arguments, [path, "-o", str(folder / "variants"), "--faces", str(MOST_FACES),
                                                        "--most-faces", str(MOST_FACES)])
            items += [{**item, "file": r["file"], "variant": r["variant"]} for r in records]
            notes += [line for line in errors.splitlines() if ": no " in line]
        print(kind, len({s for s, _ in surfaces}), "shapes,", sum(i["type"] == kind for i in items), "items", flush=True)
    return items, notes


def data_set(arguments):
    """The data set in the work folder, made where it is not there."""
    folder = Path(arguments.work)
    listing = folder / "items.json"
    if arguments.fresh and folder.exists():
        shutil.rmtree(folder)
    if not listing.exists():
        folder.mkdir(parents=True, exist_ok=True)
        items, notes = make_data_set(arguments, folder)
        listing.write_text(json.dumps({"items": items, "notes": notes}), encoding="utf-8")
    stored = json.loads(listing.read_text(encoding="utf-8"))
    for item in stored["items"]:
        item["type"] = tuple(item["type"])
    chosen = [i for i in stored["items"] if not arguments.only or arguments.only == f"{i['type'][0]},{i['type'][1]}"]
    return chosen, stored["notes"]


def build_index(arguments, items):
    """Builds the index unless it is there. Returns its path, seconds, and what the program said of failures."""
    index = Path(arguments.work) / (f"index{arguments.only}.h5")
    if index.exists() and not arguments.fresh:
        return index, None, ""
    start = time.perf_counter()
    status, _, error = running.run([arguments.ricci, "index", "build", *(i["file"] for i in items), "-o", str(index),
                                    "--threads", str(arguments.threads), "--quiet", *arguments.index_options.split()])
    if status not in (0, 1):
        sys.exit(f"index build: exit {status}\n{error[-2000:]}")
    return index, time.perf_counter() - start, error


def query(arguments, index, items):
    """For each item its neighbours in the index without itself, [(distance, file name)], nearest first; or an error in words."""
    words = ["-k", str(arguments.neighbours), "--json", "--quiet", "--threads", str(arguments.threads)]
    found = {}
    for start in range(0, len(items), 200):
        files = [item["file"] for item in items[start:start + 200]]
        status, out, error = running.run([arguments.ricci, "index", "query", str(index), *files, *words], 200 * arguments.timeout)
        if status not in (0, 1):
            sys.exit(f"index query: exit {status}\n{error[-2000:]}")
        for record in running.json_lines(out):
            own = Path(record["query"]).name
            found[own] = [(n["distance"], Path(n["file"]).name) for n in record["neighbours"] if Path(n["file"]).name != own]
    return [found.get(Path(item["file"]).name, "not in the index") for item in items]


def reduced_modulus(tau):
    tau = complex(tau.real, abs(tau.imag))
    while True:
        tau -= round(tau.real)
        if abs(tau) >= 1 - 1e-12:
            return tau
        tau = -1 / tau


def independent_descriptor(arguments, item):
    """A complex number for a torus, else the logarithms of twelve lengths."""
    status, out, error = running.run([arguments.ricci, "layout", item["file"], "--json", "--quiet"], arguments.timeout)
    records = running.json_lines(out)
    if status != 0 or not records or records[0]["status"] != "converged":
        return f"exit {status}: {error.strip()[-200:]}"
    if records[0]["geometry"] == "euclidean":
        one, two = (complex(g["matrix"][0][2], g["matrix"][1][2]) for g in records[0]["generators"])
        return reduced_modulus(two / one)
    try:
        group, lengths, longest = fuchsian.group_of(arguments.ricci, item["file"]), [], 2.5
        while len(lengths) < 12:
            longest += 0.75
            found = fuchsian.spectrum(*group, longest)["lengths"]
            lengths = [length for length, primitive, powers in found for _ in range(primitive + powers)]
    except fuchsian.GroupError as error:
        return str(error)
    return [math.log(length) for length in lengths[:12]]


def independent_distance(x, y):
    if isinstance(x, complex):  # Teichmueller's: half the hyperbolic distance; mirror images and shears by one as well
        images = [z + k for k in (-1, 0, 1) for z in (y, -y.conjugate())]
        return min(0.5 * math.acosh(1 + abs(x - z) ** 2 / (2 * x.imag * z.imag)) for z in images)
    return math.dist(x, y)


def independent_neighbours(arguments, items):
    """For each item what query() gives."""
    with ThreadPoolExecutor(arguments.threads) as pool:
        found = list(pool.map(lambda item: independent_descriptor(arguments, item), items))
    result = []
    for item, own in zip(items, found):
        if isinstance(own, str):
            result.append(own)
            continue
        others = [(independent_distance(own, other), Path(i["file"]).name) for i, other in zip(items, found)
                  if i is not item and i["type"] == item["type"] and not isinstance(other, str)]
        result.append(sorted(others)[:arguments.neighbours])
    return result


def judge(items, neighbours):
    """Adds to each item: found (the nearest), hit, distance; same and other, the distances of the nearest of either kind."""
    by_name = {Path(item["file"]).name: item for item in items}
    for item, found in zip(items, neighbours):
        item.update(hit=False, found=None, distance=None, same=None, other=None, error=None)
        if isinstance(found, str) or not found:
            item["error"] = found or "no neighbours"
            continue
        for distance, name in found:
            kind = "same" if by_name[name]["shape"] == item["shape"] else "other"
            if item[kind] is None:
                item[kind] = distance
        item["distance"], item["found"] = found[0]
        item["hit"] = by_name[found[0][1]]["shape"] == item["shape"]


def type_rows(items):
    """One row per topological type, and which types count."""
    rows, counted = [], set()
    for kind in sorted({i["type"] for i in items}):
        group = [i for i in items if i["type"] == kind]
        shapes = {i["shape"] for i in group}
        made = {i["shape"] for i in group if i["made"]}
        hits = sum(i["hit"] for i in group)
        enough = len({i["shape"] for i in group if i["error"] is None}) >= FEWEST_SHAPES
        if enough:
            counted.add(kind)
        margins = [i["other"] / i["same"] for i in group if i["same"] and i["other"]]
        margin = running.number(running.quantile(margins, 0.1), 3) if margins else "-"
        rows.append([f"{kind[0]}, {kind[1]}", len(shapes) - len(made), len(made), len(group), hits,
                     f"{100 * hits / len(group):.1f} %", sum(i["error"] is not None for i in group), margin,
                     "yes" if enough else "apart"])
    return rows, counted


def report(arguments, items, notes, index_seconds):
    rows, counted = type_rows(items)
    inside = [i for i in items if i["type"] in counted]
    hits = sum(i["hit"] for i in inside)
    share = hits / len(inside) if inside else 0.0
    misses = [[Path(i["file"]).name, i["shape"], i["found"] or i["error"], running.number(i["distance"], 4),
               running.number(i["same"], 4), "" if i["type"] in counted else "apart"] for i in items if not i["hit"]]
    variants = Counter(i["variant"] for i in items)
    by_variant = [[v, n, sum(i["hit"] for i in items if i["variant"] == v)] for v, n in sorted(variants.items())]
    seconds = f" The index took {index_seconds:.0f} s on {arguments.threads} thread(s)." if index_seconds else ""
    text = (f"# Retrieval\n\n{running.command_note(arguments.ricci)}\n\n"
            f"**{hits} of {len(inside)} queries ({100 * share:.2f} %) find their own shape** in the types that hold at least four "
            f"different shapes.{seconds}\n\n"
            "Every sample surface of genus one or more and ten variants of each (bench/mesh_variants.h): two Moebius images, a "
            f"half and a quarter of the faces, midpoint subdivision (or to {MOST_FACES} faces), noise of 0.1 % of the diagonal "
            "along normals and in all directions, two retriangulations, relabelling. Each item in turn asks the index for its "
            f"nearest neighbour other than itself. Variants of surfaces with more than {MOST_FACES} faces are made of the surface "
            "decimated to that. Below 2000 faces half and quarter, and the second retriangulation, are of the surface subdivided "
            "until it has so many.\n\n"
            "Files that count as one shape: " + "; ".join(f"{shape} ({', '.join(Path(n).stem for n in names)})"
                                                          for shape, names in SHAPES.items())
            + ". eight_173v and double-torus were decided by geometry: principal radii of gyration like those of eight to 4 % "
              "and 0.4 %. Shapes made: smooth deformations of space (bench/space_deformation.h).\n\n"
            + running.markdown_table(["genus, boundaries", "shapes found", "shapes made", "items", "hits", "share", "failed",
                                      "margin p10", "counted"], rows)
            + "\nMargin: distance of the nearest item of another shape over that of the same; a tenth of the items have less "
              f"(where both are among the {arguments.neighbours} nearest).\n\n"
            + running.markdown_table(["variant", "items", "hits"], by_variant))
    if misses:
        header = ["item", "shape", "nearest", "distance", "nearest of its shape", ""]
        text += "\nMisses:\n\n" + running.markdown_table(header, misses)
    if notes:
        text += "\nVariants that could not be made, another standing in:\n\n" + "".join(
            f"* {line.removeprefix(str(running.data_folder()) + '/')}\n" for line in notes)
    return text, share


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.add_argument("--make-variants", default=str(running.ROOT / "build" / "bench" / "ricci_make_variants"))
    parser.add_argument("--work", default=str(running.ROOT / "out" / "retrieval"), help="folder of data set and index")
    parser.add_argument("--fresh", action="store_true", help="make data set and index anew")
    parser.add_argument("--only", default="", help="only this type, like 2,0 (writes no file)")
    parser.add_argument("--independent", action="store_true", help="without `ricci index`; writes no file")
    parser.add_argument("--index-options", default="", help="more words for `ricci index build`")
    parser.add_argument("--neighbours", type=int, default=40)
    parser.add_argument("--timeout", type=float, default=300.0, help="seconds per query")
    arguments = parser.parse_args()
    items, notes = data_set(arguments)
    index_seconds = None
    if arguments.independent:
        neighbours = independent_neighbours(arguments, items)
    else:
        index, index_seconds, _ = build_index(arguments, items)
        neighbours = query(arguments, index, items)
    judge(items, neighbours)
    text, share = report(arguments, items, notes, index_seconds)
    print(text)
    if not arguments.only and not arguments.independent:
        running.write(running.RESULTS / "retrieval.md", text)
    return 0 if share >= WANTED else 1


if __name__ == "__main__":
    sys.exit(main())
