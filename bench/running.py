"""Shared by the scripts of this folder: where the program and the sample meshes are, and how results are written."""

import csv
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "docs" / "results"


def data_folder():
    """$RICCI_DATA, else <source>/../shared/data; ends the script where neither exists."""
    folder = Path(os.environ.get("RICCI_DATA", ROOT.parent / "shared" / "data"))
    if not (folder / "MESHES.tsv").is_file():
        sys.exit(f"{folder}: no MESHES.tsv; set RICCI_DATA to the folder that holds the sample meshes")
    return folder


def sample_meshes():
    """Rows of MESHES.tsv in its order, with 'path'; tetrahedral meshes left out."""
    folder = data_folder()
    with open(folder / "MESHES.tsv", newline="", encoding="utf-8") as table:
        rows = [row for row in csv.DictReader(table, delimiter="\t") if not row["file"].startswith("meshes/tets/")]
    for row in rows:
        row["path"] = str(folder / row["file"])
        row["name"] = row["file"].removeprefix("meshes/")
    return rows


def add_common_arguments(parser):
    parser.add_argument("--ricci", default=str(ROOT / "build" / "bin" / "ricci"), help="the program")
    parser.add_argument("--threads", type=int, default=1)


def run(arguments, timeout=None):
    """Runs a command. Returns exit status, standard output and standard error; the status is 'timeout' when killed."""
    try:
        done = subprocess.run(arguments, capture_output=True, text=True, timeout=timeout, check=False)
    except subprocess.TimeoutExpired:
        return "timeout", "", f"killed after {timeout} s"
    return done.returncode, done.stdout, done.stderr


def json_lines(text):
    return [json.loads(line) for line in text.splitlines() if line.startswith("{")]


def version(ricci):
    return run([ricci, "--version"])[1].strip().splitlines()[0]


def command_note(ricci):
    """Which command made a file, and with what."""
    words = ["python3", os.path.relpath(sys.argv[0], ROOT)] + [w for w in sys.argv[1:]]
    kept, skip = [], False
    for word in words:  # where things lie says nothing to a reader
        if skip:
            skip = False
        elif word in ("--ricci", "--work", "--layer"):
            skip = True
        else:
            kept.append(word)
    return f"Made by `{shlex.join(kept)}` with {version(ricci)}."


def markdown_table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def number(value, digits=2):
    return "-" if value is None else f"{value:.{digits}g}"


def quantile(values, q):
    """The nearest-rank quantile."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, max(0, int(-(-q * len(ordered) // 1)) - 1))]


def write(path, text):
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    print(f"wrote {path}", file=sys.stderr)
