#!/usr/bin/env python3
"""Shows Doxygen the comments as this project writes them; the sources stay as they are.

Doxygen calls it with the name of one file and reads the result. Lines keep their numbers, so that warnings point at
the right ones. Of a header:
  * the `//` comment at its top becomes the documentation of the file;
  * a `//` comment behind a member or an enumerator, with the `//` lines that go on below it, becomes that member's;
  * everything in namespace ricci joins the group of its folder (rooms.dox);
  * in comments, < > & # \\ and so on are plain characters: they are no HTML and no links. Doxygen's commands are
    written with @ (@p x), at the start of a word;
  * lines that are indented by three blanks or more below a line that is not (formulas, tables, drawings) keep
    their form; those of lists do not.
Of a Markdown page: links to pages that are not part of the reference lead back to docs/.
"""
import os
import re
import sys

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CODE_SPAN = re.compile(r"(`[^`]*`)")
# A line with code and a comment behind it; a // within quotes is no comment here.
TRAILING = re.compile(r'^((?:[^"/]|"(?:[^"\\]|\\.)*"|/(?!/))*?)//(?![/!]) ?(.*)$')
SCOPE = re.compile(r"\b(namespace|struct|class|union|enum)\b")


LIST = re.compile(r"\s?(\d+\.|[-*+]) ")


def plain(text):
    """Text of a comment with the characters that mean something to Doxygen made harmless, code spans left alone."""
    parts = CODE_SPAN.split(text)
    for k in range(0, len(parts), 2):
        part = re.sub(r"(?<=\S)@|@(?![a-z])", "@@", parts[k].replace("\\", "\\\\"))
        parts[k] = re.sub(r"([<>#&*])", r"\\\1", part)
    return "".join(parts)


def keep_forms(out):
    """Wraps runs of indented comment lines in <pre>; `out` is changed in place, line by line."""
    line_of = re.compile(r"^(\s*///)(?!<)(.*)$")
    k, listed, above = 0, False, None
    while k < len(out):
        match = line_of.match(out[k])
        if not match:
            listed, above = False, None
        elif not match.group(2).strip():
            listed, above = False, ""
        elif LIST.match(match.group(2)):
            listed, above = True, match.group(2)
        elif match.group(2).startswith("   ") and not listed and above is not None:
            first = k
            while k + 1 < len(out):
                following = line_of.match(out[k + 1])
                if not following or not following.group(2).startswith("   "):
                    break
                k += 1
            out[first] = match.group(1) + " <pre>" + match.group(2)
            out[k] += "</pre>"
            for line in range(first, k + 1):
                out[line] = out[line].replace("\\*", "*")  # no Markdown within <pre>
        else:
            above = match.group(2)
        k += 1


class Scanner:
    """Knows for each line whether it stands where declarations are documented, or within a body."""

    def __init__(self):
        self.stack, self.statement, self.parentheses = [], "", 0

    def declaring(self):
        return all(self.stack) and self.parentheses == 0

    def read(self, code):
        code = re.sub(r'"(?:[^"\\]|\\.)*"|\'(?:[^\'\\]|\\.)\'', "", code)
        for c in code:
            if c == "{":
                head = self.statement
                self.stack.append(bool(SCOPE.search(head)) and "(" not in re.sub(r"alignas\([^)]*\)", "", head))
                self.statement = ""
            elif c == "}":
                if self.stack:
                    self.stack.pop()
                self.statement = ""
            elif c == ";":
                self.statement = ""
            else:
                self.parentheses += (c == "(") - (c == ")")
                self.statement += c
        self.statement += " "


def group_of(path):
    folder = os.path.dirname(os.path.relpath(os.path.abspath(path), TOP))
    return folder.replace(os.sep, "_")


def header(path, lines):
    group = group_of(path)
    out, scanner, column, k = [], Scanner(), None, 0
    # The comment at the top; `#pragma once` behind it gives its line to @file.
    while k < len(lines) and lines[k].startswith("//") and not lines[k].startswith("///"):
        out.append("/// " + plain(lines[k][2:].removeprefix(" ")))
        k += 1
    if k < len(lines) and lines[k].strip() == "#pragma once":
        out.append("/// @file" if k else "")
        k += 1
    opened = False
    while k < len(lines):
        line = lines[k]
        text = line.lstrip()
        if text.startswith("///"):
            out.append(line[: len(line) - len(text)] + "///" + plain(text[3:]))
            column = None
        elif text.startswith("//"):
            # Goes on with the comment behind the member above, or is nobody's documentation.
            if column is not None and len(line) - len(text) >= column - 2:
                out.append(line[: len(line) - len(text)] + "///< " + plain(text[2:].strip()))
            else:
                out.append(line)
                column = None
        else:
            match = TRAILING.match(line)
            code = match.group(1) if match else line
            before = scanner.declaring()
            scanner.read(code)
            member = match and before and scanner.declaring() and re.search(r"[;,{}\w)\]]\s*$", code) and code.strip()
            member = member and not code.lstrip().startswith(("}", "#", "namespace"))
            if member:
                column = len(code)
                out.append(code + "///< " + plain(match.group(2)))
            else:
                column = None
                out.append(line)
            if re.match(r"namespace ricci(::\w+)? \{", line) and k + 1 < len(lines) and not lines[k + 1].strip():
                out[-1] = line + " /** @addtogroup " + group
                out.append(" @{ */")
                k += 1
                opened = True
            elif opened and line.startswith("}  // namespace ricci"):
                out[-1] = "/** @} */ " + line
                opened = False
        k += 1
    keep_forms(out)
    return out


def page(path, lines):
    """Links as they are found from build/docs/html."""
    del path
    link = re.compile(r"\[([^\]]*)\]\((?!https?:|#)([^)]+)\)")
    return [link.sub(r'<a href="../../../docs/\2">\1</a>', line) for line in lines]


def main():
    path = sys.argv[1]
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    sys.stdout.write("\n".join(page(path, lines) if path.endswith(".md") else header(path, lines)))


main()
