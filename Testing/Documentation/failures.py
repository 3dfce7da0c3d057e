#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""docs/failures.md, made from the tables of failures next to the tests.

Usage: failures.py [--write] [ROOT-OF-THE-REPOSITORY]

Without --write the program compares: it fails if the committed page differs from its output, if a row names a test or a
case that is not there, where a figure is not what the CSV or the test has, and where a test of Testing/Stability has no row.

Testing/*/failures.toml has a [[row]] for each failure:

    section = "Values and transfer functions"   a heading of Testing/Documentation/failures.md.in
    case    = "what the method meets"
    method  = "whose method fails: VTK's, a paper's, a baseline's, any that does so and so, or Stratus"
    fails   = "how it fails"
    number  = "by how much; {rms('vtk:raycast', 'post/ramp'); .1f} is an expression of measurements, and its format"
    figures = "the CSV below Testing/Benchmarks/results that the expressions are about"
    stands  = ["text in the first test's source, so that a number in plain text is one that the test asserts"]
    ours    = "what Stratus does"
    tests   = ["test_name", "test_name:a_case_of_it"]   none: no test shows it, and the page says so

Expressions are as in test_measurements.py, whose metrics take a method and a scene. In failures.md.in, `@rows SECTION` stands for the
table of a section, and `@cases FOLDER` for all cases of the tests in a folder.
"""
import difflib
import os
import re
import sys
import tomllib

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
import test_measurements  # noqa: E402

KEYS = {"section", "case", "method", "fails", "number", "figures", "stands", "ours", "tests"}
NEEDED = {"section", "case", "method", "fails", "ours", "tests"}
RESULTS = "Testing/Benchmarks/results"
PAGE = "docs/failures.md"
TEMPLATE = "Testing/Documentation/failures.md.in"
WHOLE = "Testing/Stability"  # each of its tests has a row


class Tests:
    """The names of all tests, the sources that have them, and the cases of those that cmocka runs."""

    def __init__(self, root):
        self.source, self.cases, self.root = {}, {}, root
        for folder, folders, files in os.walk(os.path.join(root, "Testing")):
            folders.sort()
            for name in sorted(files):
                path = os.path.join(folder, name)
                relative = os.path.relpath(path, root)
                if name.startswith("test_") and name.endswith(".c"):
                    self.add_c(relative)
                elif re.fullmatch(r"(Test\w+)\.cxx|(test\w+)\.py", name):
                    self.source[name.rsplit(".", 1)[0]] = relative
                elif name == "test_command_line":  # each part is a function
                    self.source[name] = relative
                    self.cases[name] = re.findall(r"^(\w+)\(\) \{$", self.read(relative), re.M)
                elif name == "CMakeLists.txt" or name.endswith(".cmake"):
                    for test in re.findall(r"stratus_add_test\((\w+) ", self.read(relative)):
                        self.source.setdefault(test, relative)
        self.source["fuzz_*"] = "Testing/Stability/fuzz/fuzz.c"
        self.source["corpus_*"] = "Testing/Stability/fuzz/CMakeLists.txt"

    def read(self, relative):
        with open(os.path.join(self.root, relative), encoding="utf-8") as file:
            return file.read()

    def add_c(self, relative):
        text = self.read(relative)
        for match in re.finditer(r"^int (test_[a-z0-9_]+)\(void\)\n\{(.*?)^\}", text, re.M | re.S):
            self.source[match[1]] = relative
            found = re.findall(r"\bcmocka_unit_test\w*\(\s*(\w+)|\bON\(\w+,\s*(\w+)\)", match[2])
            self.cases[match[1]] = [one or other for one, other in found]


def number_of(row, root, wrong):
    """Returns the row's number, with its expressions replaced by their values."""
    text = row.get("number", "")
    if not re.search(r"\{.*\}", text):
        return text
    path = os.path.join(RESULTS, row["figures"])
    table = test_measurements.Table(os.path.join(root, path))

    def value(match):
        expression, _, form = match[1].partition(";")
        number = test_measurements.evaluate(expression.strip(), table, "", set())
        if number is None:
            wrong.append(f"{row['case']}: {path} has no {expression.strip()}")
            return "?"
        return format(number, form.strip())

    return re.sub(r"\{([^{}]*)\}", value, text)


def check_row(row, where, tests, wrong):
    for key in sorted(NEEDED - set(row)) + sorted(set(row) - KEYS):
        wrong.append(f"{where}: {row.get('case', 'a row')}: key {key} is {'missing' if key in NEEDED else 'unknown'}")
    for test in row.get("tests", []):
        name, _, case = test.partition(":")
        if name not in tests.source:
            wrong.append(f"{where}: there is no test {name}")
        elif case and case not in tests.cases.get(name, []):
            wrong.append(f"{where}: {name} has no case {case}")
    for text in row.get("stands", []):
        if not row["tests"] or text not in tests.read(tests.source.get(row["tests"][0].partition(":")[0], PAGE)):
            wrong.append(f"{where}: {row['case']}: {text} is not in the source of its first test")


def rows_of(root, tests, wrong):
    rows = []
    for folder, folders, files in os.walk(os.path.join(root, "Testing")):
        folders.sort()
        if "failures.toml" in files:
            where = os.path.relpath(os.path.join(folder, "failures.toml"), root)
            for row in tomllib.loads(tests.read(where)).get("row", []):
                check_row(row, where, tests, wrong)
                rows.append(row)
    return rows


def table_of(rows, root, wrong):
    lines = ["| case | method | how it fails | number | what Stratus does | test |", "|---|---|---|---|---|---|"]
    for row in rows:
        tests = ", ".join(f"`{test.replace(':', '` `')}`" for test in row["tests"]) or "-"
        lines.append(f"| {row['case']} | {row['method']} | {row['fails']} | {number_of(row, root, wrong) or '-'} | {row['ours']} | {tests} |")
    return lines


def cases_of(folder, tests):
    lines = ["| test | cases |", "|---|---|"]
    for name, source in sorted(tests.source.items()):
        if source.startswith(folder + "/test_") and tests.cases.get(name):
            lines.append(f"| `{name}` | {'; '.join(case.replace('_', ' ') for case in dict.fromkeys(tests.cases[name]))} |")
    return lines


def page_of(root, wrong):
    tests = Tests(root)
    rows = rows_of(root, tests, wrong)
    named = {test.partition(":")[0] for row in rows for test in row.get("tests", [])}
    for name, source in sorted(tests.source.items()):
        if source.startswith(WHOLE + "/test_") and name not in named:
            wrong.append(f"{name} has no row in {WHOLE}/failures.toml")
    if wrong:
        return ""
    lines, sections = [], {row["section"] for row in rows}
    for line in tests.read(TEMPLATE).splitlines():
        word, _, rest = line.partition(" ")
        if word == "@rows":
            lines += table_of([row for row in rows if row["section"] == rest], root, wrong)
            sections.discard(rest)
        elif word == "@cases":
            lines += cases_of(rest, tests)
        else:
            lines.append(line)
    wrong += [f"{TEMPLATE} has no section '{section}'" for section in sorted(sections)]
    return "\n".join(lines) + "\n"


def main(arguments):
    write = "--write" in arguments
    rest = [argument for argument in arguments if argument != "--write"]
    root = rest[0] if rest else "."
    wrong = []
    page = page_of(root, wrong)
    path = os.path.join(root, PAGE)
    if not wrong and write:
        with open(path, "w", encoding="utf-8") as file:
            file.write(page)
    elif not wrong:
        with open(path, encoding="utf-8") as file:
            committed = file.read()
        if committed != page:
            sys.stdout.writelines(difflib.unified_diff(committed.splitlines(True), page.splitlines(True), PAGE, "as it should be"))
            wrong.append(f"{PAGE} is another: Testing/Documentation/failures.py --write makes it anew")
    for line in wrong:
        print("FAILED:", line)
    if not wrong:
        print(f"{page.count(chr(10))} lines as the tests have them")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
