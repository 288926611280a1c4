#!/usr/bin/env python3
"""Writes docs/commands.md from the help texts of the program.

    docs/make_commands.py build/bin/ricci            # writes the page
    docs/make_commands.py build/bin/ricci --check    # exit status 1 where it is not current
"""
import argparse
import os
import re
import subprocess
import sys

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "commands.md")
HEAD = """# Commands

Every subcommand with its options, as `ricci SUBCOMMAND --help` prints them. Made by `docs/make_commands.py build/bin/ricci`;
do not edit. What the commands are for: [tour](tour.md), [cookbook](cookbook.md), [thesis](thesis.md).

"""


def help_text(program, words):
    """Help of `ricci WORDS`, the same whatever machine it runs on."""
    result = subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True,
                            env={**os.environ, "COLUMNS": "100"})
    return result.stdout.replace(program, "ricci").rstrip() + "\n"


def subcommands(text):
    """(name, first line of its description) in the order of the help text."""
    found, reading = [], False
    for line in text.split("\n"):
        if line.startswith("Subcommands:"):
            reading = True
        elif reading and (match := re.match(r"  ([a-z][a-z0-9-]*)(?:\s+(\S.*))?$", line)):
            found.append((match.group(1), match.group(2) or ""))
        elif reading and line and not line.startswith(" "):
            break
    return found


def commands(program, words=()):
    """All subcommands, those that have some of their own followed by these: (words, help text)."""
    for name, _ in subcommands(help_text(program, words)):
        text = help_text(program, [*words, name])
        yield (*words, name), text
        yield from commands(program, (*words, name))


def page(program):
    listed = list(commands(program))
    out = [HEAD]
    for words, _ in listed:
        name = " ".join(words)
        out.append(f"{'  ' * (len(words) - 1)}* [`ricci {name}`](#ricci-{name.replace(' ', '-')})\n")
    out.append("\n## ricci\n\n```text\n" + help_text(program, []) + "```\n")
    for words, text in listed:
        out.append(f"\n## ricci {' '.join(words)}\n\n```text\n{text}```\n")
    return "".join(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="build/bin/ricci")
    parser.add_argument("--check", action="store_true", help="only tell whether docs/commands.md is current")
    arguments = parser.parse_args()
    text = page(arguments.program)
    if arguments.check:
        with open(PAGE, encoding="utf-8") as file:
            current = file.read() == text
        if not current:
            sys.exit(f"{PAGE} is not current: run docs/make_commands.py {arguments.program}")
        return
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(text)
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main()
