#!/usr/bin/env python3
"""Checks README.md and docs/**/*.md against the tree and the program.

    tests/docs/docs_test.py --ricci build/bin/ricci [--example build/tests/docs/ricci_docs_example] [unittest's arguments]

Links, pictures and anchors lead somewhere; every command line of `ricci` names subcommands and options that exist; no
paths of one machine; every subcommand has its place in the thesis's map or the cookbook; the map's commands run and its
sources exist; docs/commands.md is current; the example of docs/api.md builds and runs.
"""
import argparse
import functools
import glob
import os
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "docs"))
sys.dont_write_bytecode = True
import make_commands  # noqa: E402

PROGRAM = os.path.join(ROOT, "build/bin/ricci")
EXAMPLE = os.path.join(ROOT, "build/tests/docs/ricci_docs_example")


def pages():
    found = sorted(glob.glob(os.path.join(ROOT, "docs/**/*.md"), recursive=True))
    return [os.path.join(ROOT, "README.md"), *found]


@functools.lru_cache(maxsize=None)
def lines_of(path):
    """(number, text, within a code block) of each line."""
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    result, fence, blank, listed = [], None, True, False
    for number, line in enumerate(lines, 1):
        match = re.match(r" {0,3}(```+|~~~+)", line)
        if match and fence is None:
            fence = match.group(1)
            result.append((number, line, True))
            continue
        if fence is not None:
            result.append((number, line, True))
            if match and match.group(1).startswith(fence) and line.strip() == match.group(1):
                fence = None
            blank = True
            continue
        # Four blanks behind an empty line (or a line of code) are code; seven within a list.
        if line.strip():
            if not line.startswith(" "):
                listed = bool(re.match(r"([*+-]|\d+\.) ", line))
            code = blank and line.startswith(" " * (7 if listed else 4))
        else:
            code = False
        result.append((number, line, code))
        blank = not line.strip() or code
    return tuple(result)


def without_code_spans(text):
    return re.sub(r"(`+).*?\1", lambda m: " " * len(m.group(0)), text)


@functools.lru_cache(maxsize=None)
def anchors_of(path):
    """Names of the headings as forges make them."""
    found, seen = set(), {}
    for _, line, code in lines_of(path):
        match = None if code else re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
        if not match:
            continue
        text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", match.group(1)).replace("`", "")
        slug = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
        count = seen.get(slug, 0)
        seen[slug] = count + 1
        found.add(slug if count == 0 else f"{slug}-{count}")
    return found


def links_of(path):
    """(line number, target) of every link and picture, over line ends too."""
    text = "\n".join("" if code else without_code_spans(line) for _, line, code in lines_of(path))
    for match in re.finditer(r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)", text):
        yield text.count("\n", 0, match.start()) + 1, match.group(1)
    for match in re.finditer(r"(?:src|href)=\"([^\"]+)\"", text):
        yield text.count("\n", 0, match.start()) + 1, match.group(1)


@functools.lru_cache(maxsize=None)
def help_of(words):
    """Help text of `ricci WORDS`, which exist."""
    return make_commands.help_text(PROGRAM, words)


@functools.lru_cache(maxsize=None)
def options_of(words):
    """Names of the options of `ricci WORDS`."""
    found = set()
    for line in help_of(words).split("\n"):
        match = re.match(r"  (-[A-Za-z0-9,-]+)", line)
        found.update(match.group(1).split(",") if match else ())
        found.update(re.findall(r"(--no-[a-z-]+)\{", line))
    return found


def shell_words(text):
    """Words of a command line; shell operators are words of their own."""
    lexer = shlex.shlex(text, posix=True, punctuation_chars=";&|()<>")
    lexer.whitespace_split = True
    lexer.commenters = "#"
    return list(lexer)


def invocations(words):
    """Argument lists of each `ricci` among the words of one line."""
    current, begins = None, True
    for word in words:
        if re.fullmatch(r"[;&|()<>]+", word):
            if current is not None:
                yield current
            current = None
        elif current is not None:
            current.append(word)
        elif begins and (word == "ricci" or word.endswith("/bin/ricci")):
            current = []
        begins = bool(re.fullmatch(r"[;&|()<>]+|\w+=.*|nice|time", word))
    if current is not None:
        yield current


def check_invocation(arguments):
    """What is wrong with `ricci ARGUMENTS`, or None."""
    if not arguments or arguments[0] in ("--help", "--version") or re.fullmatch(r"\.\.\.|[A-Z]+", arguments[0]):
        return None
    words, rest = [], list(arguments)
    while rest and rest[0] in dict(make_commands.subcommands(help_of(tuple(words)))):
        words.append(rest.pop(0))
    if not words:
        return f"no subcommand '{arguments[0]}'"
    if "Subcommands:" in help_of(tuple(words)) and rest and re.fullmatch(r"[a-z]+", rest[0]):
        return f"no subcommand '{' '.join(words)} {rest[0]}'"
    options = options_of(tuple(words))
    for argument in rest:
        argument = argument.strip("[]")
        if not argument.startswith("-") or re.fullmatch(r"-[\d.]+", argument) or argument == "-":
            continue
        name = argument.split("=")[0]
        if (name if name.startswith("--") else name[:2]) not in options:
            return f"`ricci {' '.join(words)}` has no option {name}"
    return None


def command_lines(path):
    """(line number, text) of what a reader may type: lines of code blocks, joined at a backslash, and code spans."""
    joined, first = "", 0
    for number, line, code in lines_of(path):
        if code:
            first = first or number
            if line.rstrip().endswith("\\"):
                joined += line.rstrip()[:-1] + " "
                continue
            yield first, joined + line
            joined, first = "", 0
    text = "\n".join("" if code else line for _, line, code in lines_of(path))
    for match in re.finditer(r"(`+)(.+?)\1", text, re.DOTALL):
        yield text.count("\n", 0, match.start()) + 1, match.group(2).replace("\n", " ")


def place(path, number):
    return f"{os.path.relpath(path, ROOT)}:{number}"


class Pages(unittest.TestCase):
    longMessage = False

    def test_links_lead_somewhere(self):
        wrong = []
        for path in pages():
            for number, target in links_of(path):
                if re.match(r"[a-z]+:", target):
                    continue
                name, _, anchor = urllib.parse.unquote(target).partition("#")
                file = os.path.normpath(os.path.join(os.path.dirname(path), name)) if name else path
                if not os.path.exists(file):
                    wrong.append(f"{place(path, number)}: no file {target}")
                elif anchor and file.endswith(".md") and anchor not in anchors_of(file):
                    wrong.append(f"{place(path, number)}: no heading {target}")
        self.assertFalse(wrong, "\n" + "\n".join(wrong))

    def test_pictures_are_shown_and_small(self):
        shown = set()
        for path in pages():
            for _, target in links_of(path):
                shown.add(os.path.normpath(os.path.join(os.path.dirname(path), target)))
        wrong, total = [], 0
        for file in sorted(glob.glob(os.path.join(ROOT, "docs/pictures/*"))):
            size = os.path.getsize(file)
            total += size
            if file not in shown:
                wrong.append(f"{os.path.relpath(file, ROOT)} is shown nowhere")
            if size > 150_000:
                wrong.append(f"{os.path.relpath(file, ROOT)} has {size} bytes, more than 150 kB")
        if total > 1_500_000:
            wrong.append(f"docs/pictures has {total} bytes, more than 1.5 MB")
        self.assertFalse(wrong, "\n" + "\n".join(wrong))

    def test_sources_of_the_thesis_map_exist(self):
        path = os.path.join(ROOT, "docs/thesis.md")
        wrong, seen = [], 0
        for number, line, _ in lines_of(path):
            before = ""
            for name in re.findall(r"`([\w./]+(?:/|\.(?:h|cpp|py)))`", line if line.startswith("|") else ""):
                seen += 1
                tried = [os.path.join(ROOT, prefix, name) for prefix in ("", "engine", "tests", before)]
                found = [file for file in tried if os.path.exists(file)]
                if found:
                    before = os.path.dirname(os.path.relpath(found[0].rstrip("/"), ROOT))
                else:
                    wrong.append(f"{place(path, number)}: no source {name}")
        self.assertFalse(wrong, "\n" + "\n".join(wrong))
        self.assertGreater(seen, 80)

    def test_no_paths_of_one_machine(self):
        wrong = []
        for path in pages():
            for number, line, _ in lines_of(path):
                if re.search(r"(?<![\w./-])/(?:work|tmp|home|root|Users)/", line):
                    wrong.append(f"{place(path, number)}: {line.strip()}")
        self.assertFalse(wrong, "\n" + "\n".join(wrong))


class Commands(unittest.TestCase):
    longMessage = False

    def setUp(self):
        self.assertTrue(os.path.exists(PROGRAM), f"no program {PROGRAM}: give --ricci")

    def test_command_lines_exist(self):
        wrong, seen = [], 0
        for path in pages():
            for number, text in command_lines(path) if path != make_commands.PAGE else ():
                if "ricci" not in text:
                    continue
                try:
                    words = shell_words(text)
                except ValueError:  # no command line: an apostrophe in output that is quoted
                    continue
                for arguments in invocations(words):
                    seen += 1
                    # `ricci index build/query ...`: each of them.
                    variants = [arguments]
                    for k, word in enumerate(arguments[:2]):
                        if re.fullmatch(r"[a-z]+(/[a-z]+)+", word):
                            variants = [[*arguments[:k], w, *arguments[k + 1:]] for w in word.split("/")]
                    for variant in variants:
                        problem = check_invocation(variant)
                        if problem:
                            wrong.append(f"{place(path, number)}: {problem}: ricci {' '.join(variant)}")
        self.assertFalse(wrong, "\n" + "\n".join(wrong))
        self.assertGreater(seen, 100, "hardly any command line found: the test looks at the wrong places")

    def test_the_checker_sees_mistakes(self):
        for text, sound in (("ricci flow a.off --cone=0:-2pi --log", True), ("ricci flow a.off --conee=0:1", False),
                            ("ricci flwo a.off", False), ("ricci index query i.h5 a.off -k 5", True),
                            ("ricci index ask i.h5", False), ("ricci info a.off && ricci layout a.off --nothing", False)):
            problems = [p for p in map(check_invocation, invocations(shell_words(text))) if p]
            self.assertEqual(not problems, sound, f"{text}: {problems}")

    def test_every_subcommand_has_its_place(self):
        text = ""
        for name in ("docs/thesis.md", "docs/cookbook.md"):
            with open(os.path.join(ROOT, name), encoding="utf-8") as file:
                text += file.read()
        missing = [" ".join(words) for words, _ in make_commands.commands(PROGRAM)
                   if not re.search(r"ricci " + " ".join(words) + r"\b", text)]
        self.assertFalse(missing, f"neither in docs/thesis.md nor in docs/cookbook.md: {', '.join(missing)}")

    def test_commands_of_the_thesis_map_run(self):
        """In its order, in one empty folder; all but those of the last section, which need more than a mesh."""
        path = os.path.join(ROOT, "docs/thesis.md")
        found, inside = [], True
        for number, line, code in lines_of(path):
            inside = inside and not line.startswith("## Beyond")
            if not inside:
                continue
            if code and line.strip():
                found.append((number, line.strip()))
            found += [(number, span) for span in re.findall(r"`(ricci [a-z]+ [^`]+)`", "" if code else line)]
        wrong = []
        with tempfile.TemporaryDirectory() as folder:
            environment = {**os.environ, "RICCI": PROGRAM, "NO_COLOR": "1"}
            for number, command in found:
                result = subprocess.run(["bash", "-c", 'ricci() { "$RICCI" "$@"; }; ' + command], cwd=folder,
                                        env=environment, capture_output=True, text=True)
                if result.returncode != 0:
                    wrong.append(f"{place(path, number)}: {command}: status {result.returncode}: "
                                 f"{result.stderr.strip()[-300:]}")
        self.assertFalse(wrong, "\n" + "\n".join(wrong))
        self.assertGreater(len(found), 50)

    def test_reference_of_commands_is_current(self):
        with open(make_commands.PAGE, encoding="utf-8") as file:
            current = file.read() == make_commands.page(PROGRAM)
        self.assertTrue(current, f"docs/commands.md is not current: run docs/make_commands.py {PROGRAM}")


class Library(unittest.TestCase):
    longMessage = False

    def test_example_of_the_library_page_is_the_one_that_is_built(self):
        with open(os.path.join(ROOT, "tests/docs/api_example.cpp"), encoding="utf-8") as file:
            source = file.read()
        with open(os.path.join(ROOT, "docs/api.md"), encoding="utf-8") as file:
            page = file.read()
        self.assertIn("```cpp\n" + source + "```\n", page, "docs/api.md and tests/docs/api_example.cpp differ")

    def test_example_runs(self):
        if not os.path.exists(EXAMPLE):
            self.skipTest(f"{EXAMPLE} is not built")
        with tempfile.TemporaryDirectory() as folder:
            mesh = os.path.join(folder, "eight.off")
            subprocess.run([PROGRAM, "generate", "eight", "--faces", "800", "-o", mesh, "--quiet"], check=True)
            output = subprocess.run([EXAMPLE, mesh], check=True, capture_output=True, text=True).stdout
        match = re.fullmatch(r"residual (\S+), relator error (\S+)\n", output)
        self.assertTrue(match, output)
        self.assertLess(float(match.group(1)), 1e-10)
        self.assertLess(float(match.group(2)), 1e-10)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--ricci", default=PROGRAM)
    parser.add_argument("--example", default=EXAMPLE)
    known, others = parser.parse_known_args()
    PROGRAM = os.path.abspath(known.ricci)
    EXAMPLE = os.path.abspath(known.example)
    unittest.main(argv=[sys.argv[0], *others])
