#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Each name in backquotes on the pages about the architecture occurs in the code: test_names.py ROOT

A page is cut into clauses at full stops, semicolons, list items, table rows and paragraphs. In each clause:

- A file or folder in backquotes exists. `*` is a wildcard, and `<...>` is a part that the reader fills in. Leading folders may be left out.
- A function, struct or field in backquotes occurs in the file that follows it (`name` in `file`, `name` (`file`)). If no file follows it,
  the name occurs in one of the clause's files or folders. If the clause names no file, the name occurs in any source.
- In the code, `name()` is followed by a parenthesis and `name[]` by a bracket. A comment does not count; a file's own name does.
"""
import fnmatch
import os
import re
import subprocess
import sys

ENDS = (".c", ".h", ".cl", ".cxx", ".py", ".cmake", ".txt", ".in", ".xml")
FILE = re.compile(r"[\w./*<>-]*[\w>*]\.(c|h|cl|cxx|py|cmake|md|txt|csv|xml)|[\w.-]+(/[\w.*-]+)*/|[\w.-]+(/[\w.-]+)+")
NAME = re.compile(r"[A-Za-z_]\w*((\.|->|::)[A-Za-z_]\w*)*(\(\)|\[\])?")
COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|/\*.*?\*/|//[^\n]*', re.S)


class Sources:
    """The repository's files, and the code of the files that are source."""

    def __init__(self, root, files):
        self.root, self.files, self.codes = root, files, {}
        self.stems = {os.path.basename(file).split(".")[0] for file in files}

    def find(self, text):
        """Return the files that a name of a file or folder means."""
        pattern = re.sub(r"<[^<>]*>|^(?=_)", "*", re.sub(r"^(\.\./)+", "", text))
        if pattern.endswith("/") or not os.path.splitext(pattern)[1]:
            inside = pattern.rstrip("/") + "/*"
            folder = self.match(inside)
            if folder or pattern.endswith("/"):
                return folder
        return self.match(pattern)

    def match(self, pattern):
        """Return the files whose path, or the end of whose path after a slash, matches."""
        expression = re.compile("(?:.*/)?" + fnmatch.translate(pattern))
        return [file for file in self.files if expression.match(file)]

    def code(self, file):
        """Return the text of a source without comments."""
        if file not in self.codes:
            text = ""
            if file.endswith(ENDS) or "." not in os.path.basename(file):
                with open(os.path.join(self.root, file), encoding="utf-8", errors="replace") as stream:
                    text = stream.read()
            if file.endswith((".c", ".h", ".cl", ".cxx")):
                text = COMMENT.sub(lambda found: found[0] if found[0][0] == '"' else " ", text)
            self.codes[file] = file + "\n" + text
        return self.codes[file]

    def contain(self, name, files):
        """True if each part of a name (`struct.field`) occurs in one of the files."""
        call = re.escape(name[-2]) if name.endswith(("()", "[]")) else ""
        parts = re.split(r"\.|->|::", name.rstrip("()[]"))
        patterns = [re.compile(rf"(?<!\w){part}(?!\w)") for part in parts[:-1]]
        start = r"\w*" if parts[-1].startswith("_") else ""  # `_same` abbreviates a name with the prefix of the name before it
        patterns.append(re.compile(rf"(?<!\w){start}{parts[-1]}" + (rf"\s*{call}" if call else r"(?!\w)")))
        if name in self.stems:
            return True  # a class or module that has a file of its own
        return any(all(pattern.search(self.code(file)) for pattern in patterns) for file in files)


def clauses(text):
    """Yield line number and text of each clause of a page."""
    text = re.sub(r"^```.*?^```$", lambda found: "\n" * found[0].count("\n"), text, flags=re.M | re.S)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    at = 0
    for part in re.split(r"((?:[.;]\s|\n(?=\||\s*- |\s*\d+\. |\n)))", text):
        yield text.count("\n", 0, at) + 1, part
        at += len(part)


def check(sources, page, text):
    """Return what is wrong on a page, and the number of names that were checked."""
    errors, checked = [], 0
    everywhere = [file for file in sources.files if file.endswith(ENDS) and not file.startswith("docs/")]
    for number, clause in clauses(text):
        words = list(re.finditer(r"`([^`\n]+)`", clause))
        found = {i: sources.find(word[1]) for i, word in enumerate(words) if FILE.fullmatch(word[1])}
        named = [file for files in found.values() for file in files]
        for i, word in enumerate(words):
            line = number + clause.count("\n", 0, word.start())
            if i in found:
                checked += 1
                if not found[i]:
                    errors.append(f"{page}:{line}: there is no {word[1]}")
                continue
            if not NAME.fullmatch(word[1]):
                continue
            checked += 1
            after = i + 1 < len(words) and clause[word.end() : words[i + 1].start()]
            if i + 1 in found and re.fullmatch(r"\s*\(|\s+(in|of)\s+", after):
                files = found[i + 1]
            else:
                files = named or everywhere
            if not sources.contain(word[1], files):
                where = "no source" if files is everywhere else "none of " + ", ".join(sorted({os.path.basename(file) for file in files})[:4])
                errors.append(f"{page}:{line}: {word[1]} occurs in {where}")
    return errors, checked


def check_judge(sources):
    """Return an error if the test accepts a false name or refuses a right one."""
    here = "Testing/Documentation/test_names.py"
    right = (f"`check_judge` in `{here}`", "`clauses` (`test_names.py`)", "`Sources`", f"`sources.files` in `{here}`", "`Testing/*/test_names.py`")
    wrong = (f"`check_{'mapper'}` in `{here}`", f"`clauses` and `no_{'clauses'}` (`test_names.py`)", f"`no_{'source'}`",
             f"see `{here}`: `errors{'[]'}`", f"`Testing/no_{'file'}.py`", f"`sources.no_{'files'}` in `{here}`")
    for text, good in [(text, True) for text in right] + [(text, False) for text in wrong]:
        if (not check(sources, "judge", text)[0]) != good:
            return [f"'{text}' was judged wrongly"]
    return []


def main():
    root = os.path.abspath(sys.argv[1])
    files = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=root, capture_output=True, text=True).stdout.split("\n")
    files = [file for file in files if os.path.isfile(os.path.join(root, file))]
    if not files:
        print("SKIPPED: no list of files from git")
        return 77
    sources = Sources(root, files)
    errors, checked = check_judge(sources), 0
    pages = [file for file in files if fnmatch.fnmatchcase(file, "docs/architecture/*.md")] + ["docs/architecture.md", "Core/README.md"]
    for page in pages:
        with open(os.path.join(root, page), encoding="utf-8") as stream:
            wrong, names = check(sources, page, stream.read())
        errors += wrong
        checked += names
    print("\n".join(errors + [f"{checked} names in {len(pages)} pages"]))
    return 1 if errors or checked < 200 else 0


if __name__ == "__main__":
    sys.exit(main())
