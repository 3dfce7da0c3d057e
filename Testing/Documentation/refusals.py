#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""docs/refused.md: every message of STRATUS_UNSUPPORTED in the core, by kind.

Usage: refusals.py [--write] [ROOT-OF-THE-REPOSITORY]

Without --write the program compares: it fails if the committed page differs from its output.
"""
import difflib
import os
import re
import sys

PAGE = "docs/refused.md"
HEAD = """# What is refused

Valid requests that the core does not draw, by the messages of their errors (`STRATUS_UNSUPPORTED`). An error names the value, and
another way if there is one. Values out of their range are not here (`STRATUS_INVALID_ARGUMENT`): they are refused everywhere. What has no
meaning in a mode is left out with one warning: [What is drawn](matrix.md). `Testing/Documentation/refusals.py --write` writes this page.
"""
# The first pattern that fits decides; the last one takes the rest.
KINDS = [
    ("Too large", "Numbers that rays and arrays cannot hold.",
     r"too large|need more than|table entries|at most %(d|zu) numbers|longer than|along an axis: at most|at most %d$|coordinates along"),
    ("Several volumes in one march",
     "Each of these is drawn if it is the only input. Rays of other modes gather no light that could mix, projected cells have no rays, and the\n"
     "picture of a piece with DUPLICATE ghosts is put in front of or behind its neighbours', which leaves no place for a volume within both.",
     r"of several|among several|mesh %d|volume %d"),
    ("Projected tetrahedra", "Marched, the same is drawn; `auto` marches it.", r"cannot be projected"),
    ("Paths of scattered light", "The reference of scattered light is of one medium on one grid.", r"^paths "),
    ("Other requests", "Combinations without a meaning, and some that nobody has needed yet.", r""),
]


def strings_after(text, at):
    """The string literals that begin at `at` or behind, joined, up to the first other token."""
    joined, pattern = "", re.compile(r'\s*"((?:[^"\\]|\\\\.)*)"')
    while match := pattern.match(text, at):
        joined, at = joined + match.group(1), match.end()
    return joined


def messages(root):
    """Yields (message, file) of each refusal."""
    for folder, folders, files in os.walk(os.path.join(root, "Core")):
        folders.sort()
        for name in sorted(files):
            if not name.endswith(".c"):
                continue
            path = os.path.join(folder, name)
            with open(path, encoding="utf-8") as file:
                text = file.read()
            for match in re.finditer(r"STRATUS_UNSUPPORTED,", text):
                message = strings_after(text, match.end())
                if message:
                    yield message, os.path.relpath(path, root)


def shown(message):
    """The message with its conversions as dots, in a table's cell."""
    return re.sub(r"%%", "%", re.sub(r"%[-#0-9.]*(?:ll|z)?[a-zA-Z]", "…", message)).replace("|", "\\\\|")


def page(root):
    rows = {title: [] for title, _, _ in KINDS}
    for message, path in messages(root):
        title = next(title for title, _, pattern in KINDS if re.search(pattern, message))
        rows[title].append(f"| {shown(message)} | `{path}` |")
    text = HEAD
    for title, about, _ in KINDS:
        text += f"\n## {title}\n\n{about}\n\n" + "| message | in |\n|---|---|\n" + "\n".join(sorted(set(rows[title]))) + "\n"
    return text, sum(map(len, rows.values()))


def main():
    words = [word for word in sys.argv[1:] if word != "--write"]
    root = words[0] if words else "."
    made, count = page(root)
    path = os.path.join(root, PAGE)
    if "--write" in sys.argv:
        with open(path, "w", encoding="utf-8") as file:
            file.write(made)
    with open(path, encoding="utf-8") as file:
        there = file.read()
    if there != made:
        sys.stdout.writelines(difflib.unified_diff(there.splitlines(True), made.splitlines(True), PAGE, "the messages"))
        sys.exit(f"{PAGE} is not what the core refuses: run Testing/Documentation/refusals.py --write")
    if count < 20:
        sys.exit(f"only {count} refusals were found")
    print(f"{count} refusals")


main()
