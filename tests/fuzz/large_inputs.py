#!/usr/bin/env python3
"""Files of 50 MB made to take time or memory, one for every weakness that readers of each format may have.

    tests/fuzz/large_inputs.py [--program build/bin/ricci] [--megabytes 50] [CASE...]

Runs `ricci info` on each, plainly and with every repair, and prints processor seconds, peak memory (beyond that of
the program without a file) over the file's size (of what it unpacks to), the exit status and the first complaint. Fails when a run dies of a signal, or
takes more than 600 processor seconds.
"""
import argparse
import gzip
import math
import os
import random
import resource
import struct
import subprocess
import sys
import tempfile


def fill(piece, size):
    """`piece` again and again, up to so many bytes."""
    return piece * max(1, size // len(piece))


def lines(make, size):
    """make(0), make(1), ... up to so many bytes."""
    parts, total, i = [], 0, 0
    while total < size:
        part = make(i)
        parts.append(part)
        total += len(part)
        i += 1
    return b"".join(parts)


def grid_points(n):
    side = int(n ** 0.5) + 1
    return [(i % side, i // side) for i in range(n)]


def obj_grid(n):
    return b"".join(b"v %d %d 0\n" % p for p in grid_points(n))


def polygon(n, corners, star):
    """The same polygon n times; convex, or a star with every second corner towards the middle."""
    points = b""
    for k in range(corners):
        radius, angle = 1 + k % 2 * star, 2 * math.pi * k / corners
        points += b"v %.6f %.6f 0\n" % (radius * math.cos(angle), radius * math.sin(angle))
    face = b"f " + b" ".join(b"%d" % (k + 1) for k in range(corners)) + b"\n"
    return points + face * n


def ply(header, body, encoding="binary_little_endian"):
    return (f"ply\nformat {encoding} 1.0\n" + header + "end_header\n").encode() + body


VERTEX = "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
FACE = "element face %d\nproperty list %s int vertex_indices\n"


def colliding_edges(size):
    """Polygons whose edges have keys (low << 32 | high) that differ by multiples of a large prime: they fall into one
    bucket of a hash table of that many buckets, where hashing is the identity."""
    prime, quads = 3_145_739, []
    vertices = 400_000
    for low in range(0, vertices - 1, 2):
        high = (-(low << 32)) % prime
        while high <= low:
            high += prime
        if high < vertices:
            quads.append(b"f %d %d %d %d\n" % (low + 1, high + 1, low + 2, high))
    return (obj_grid(vertices) + b"".join(quads))[:size]


def flat_strip(size):
    """Faces of zero area in one long chain, and all on one line."""
    n = size // 40
    return b"".join(b"v %d 0 0\n" % i for i in range(n)) + b"v 0 1 0\n" + b"".join(
        b"f 1 %d %d\n" % (i, i + 1) for i in range(2, n)) + b"f 1 %d %d\n" % (n, n + 1)


def many_flat(size):
    """Flat faces next to one another, each with an edge to flip."""
    n = size // 90
    return b"".join(b"v %d 0 0\nv %d.5 0 0\nv %d.5 1 0\n" % (i, i, i) for i in range(n)) + b"".join(
        b"f %d %d %d\nf %d %d %d\n" % (3 * i + 1, 3 * i + 2, 3 * i + 4, 3 * i + 4, 3 * i + 3, 3 * i + 1)
        for i in range(n - 1))


def stl_facets(size, same):
    rng = random.Random(1)
    count = (size - 84) // 50
    if same:
        body = struct.pack("<12fH", *([0.0] * 12), 0) * count
    else:
        body = b"".join(struct.pack("<12fH", 0, 0, 0, *[rng.random() for _ in range(9)], 0) for _ in range(count))
    return b"\0" * 80 + struct.pack("<I", count) + body


def deflated(size, text):
    return gzip.compress(text, 9, mtime=0)


def cases():
    """Name, suffix, bytes by size."""
    M = b"\n"
    yield "obj_one_line", "obj", lambda s: b"f " + fill(b"1 ", s)
    yield "obj_one_token", "obj", lambda s: b"v " + fill(b"9", s)
    yield "obj_one_comment", "obj", lambda s: fill(b"#.#Q", s)
    yield "obj_continued", "obj", lambda s: b"f" + fill(b" 1\\\n", s)
    yield "obj_returns", "obj", lambda s: fill(b"v 0 0 0\r", s)
    yield "obj_empty_faces", "obj", lambda s: b"v 0 0 0\n" + fill(b"f\n", s)
    yield "obj_short_faces", "obj", lambda s: b"v 0 0 0\nv 1 0 0\nv 0 1 0\n" + fill(b"f 1 2 3\n", s)
    yield "obj_short_quads", "obj", lambda s: b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n" + fill(b"f 1 2 3 4\n", s)
    yield "obj_negative", "obj", lambda s: lines(lambda i: b"v %d %d %d\n" % (i, i * i % 1009, i * i * i % 1013) +
                                                (b"f -1 -2 -3\n" if i > 1 else b""), s)
    yield "obj_fan", "obj", lambda s: obj_grid(s // 40) + lines(lambda i: b"f 1 %d %d\n" % (i + 2, i + 3), s // 2)
    yield "obj_million_corners", "obj", lambda s: obj_grid(1000000) + b"f " + b" ".join(
        b"%d" % (i + 1) for i in range(1000000)) + b"\n"
    yield "obj_large_polygons", "obj", lambda s: polygon(s // 49000, 10000, 1)
    yield "obj_convex_polygons", "obj", lambda s: polygon(s // 49000, 10000, 0)
    yield "obj_small_polygons", "obj", lambda s: polygon(s // 250, 64, 1)
    yield "obj_colliding_edges", "obj", colliding_edges
    yield "obj_flat_chain", "obj", flat_strip
    yield "obj_many_flat", "obj", many_flat
    yield "obj_points", "obj", lambda s: fill(b"v 0 0 0\n", s) + b"f 1 2 3\n"
    yield "obj_defects", "obj", lambda s: fill(b"f 7 8 9\n", s)
    yield "off_counts", "off", lambda s: b"OFF\n9000000000000000000 9000000000000000000 0\n" + fill(b"0 0 0\n", s)
    yield "off_faces_of_none", "off", lambda s: b"OFF\n1 %d 0\n0 0 0\n" % (s // 2) + fill(b"0\n", s)
    yield "off_one_line", "off", lambda s: b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n%d " % (s // 2) + fill(b"0 ", s)
    yield "ply_properties", "ply", lambda s: ply(lines(lambda i: b"property int p%d\n" % i, s).decode().join(
        ["element vertex 1\n", ""]), b"")
    yield "ply_elements", "ply", lambda s: ply(lines(lambda i: b"element e%d 1\n" % i, s).decode(), b"")
    yield "ply_empty_lists", "ply", lambda s: ply(VERTEX % 1 + FACE % (s, "uchar"), b"\0" * (s + 12))
    yield "ply_huge_list", "ply", lambda s: ply(VERTEX % 1 + FACE % (1, "uint"), b"\0" * 12 + struct.pack(
        "<I", s // 4) + b"\0" * s)
    yield "ply_triangles", "ply", lambda s: ply(VERTEX % 3 + FACE % (s // 13, "uchar"), struct.pack(
        "<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<Biii", 3, 0, 1, 2) * (s // 13))
    yield "ply_skipped_lists", "ply", lambda s: ply(VERTEX % 1 + "element junk %d\nproperty list uchar double j\n" % s +
                                                   FACE % (0, "uchar"), b"\0" * (s + 12))
    yield "ply_ascii_corner_colours", "ply", lambda s: ply(
        VERTEX % 3 + FACE % (s // 28, "uchar") + "property uchar red\nproperty uchar green\nproperty uchar blue\n",
        b"0 0 0\n1 0 0\n0 1 0\n" + fill(b"3 0 1 2 9 1 2 3 4 5 6 7 8 9\n", s), "ascii")
    yield "stl_random", "stl", lambda s: stl_facets(s, False)
    yield "stl_same", "stl", lambda s: stl_facets(s, True)
    yield "stl_ascii_words", "stl", lambda s: b"solid\n" + fill(
        b"facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet ", s)
    yield "stl_ascii_solids", "stl", lambda s: fill(b"solid\nendsolid\n", s)
    yield "len_counts", "len", lambda s: b"%d %d\n" % (s, s) + fill(b"0 0 0 1 1 1 -1 -1 -1\n", s)
    yield "len_unused", "len", lambda s: b"%d 1\n0 1 2 1 1 1 -1 -1 -1\n" % s + fill(M, s)
    yield "len_pinch", "len", lambda s: b"1 %d\n" % (s // 21) + fill(b"0 0 0 1 1 1 -1 -1 -1\n", s)
    yield "gz_members", "off.gz", lambda s: fill(gzip.compress(b"", mtime=0), s)
    yield "gz_bomb", "off.gz", lambda s: gzip.compress(b"\0" * (1 << 30), 1, mtime=0)
    yield "gz_lines", "obj.gz", lambda s: gzip.compress(fill(b"f\n", s), 9, mtime=0)


def run(program, path, repair):
    command = [program, "info", path] + (["--repair", "orient,weld,drop-degenerate"] if repair else [])
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace",
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (600, 600)))
    output = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    complaint = next((line.strip() for line in output.splitlines() if "error" in line.lower()), "loads")
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, complaint


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--program", default="build/bin/ricci")
    options.add_argument("--megabytes", type=float, default=50)
    options.add_argument("case", nargs="*")
    options = options.parse_args()
    size, failed = int(options.megabytes * 1e6), 0
    own = run(options.program, os.devnull, False)[2]  # what the program takes without a file
    print("| case | MB | seconds | memory | with repairs | memory | exit | first complaint |\n|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, suffix, make in cases():
            if options.case and name not in options.case:
                continue
            path = os.path.join(folder, f"{name}.{suffix}")
            with open(path, "wb") as file:
                file.write(make(size))
            stored = os.path.getsize(path)
            against = size if name == "gz_lines" else stored
            rows = [run(options.program, path, repair) for repair in (False, True)]
            failed += any(code not in (0, 1, 3) for code, *_ in rows)
            cells = [f"{cpu:.1f} | {(memory - own) / against:.1f} x" for _, cpu, memory, _ in rows]
            print(f"| {name} | {stored / 1e6:.1f} | {cells[0]} | {cells[1]} | {rows[0][0]} | "
                  f"{rows[0][3].replace(path, os.path.basename(path))[:70].replace('|', '/')} |", flush=True)
            os.remove(path)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
