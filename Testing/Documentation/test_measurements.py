#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Every figure in the tables of docs/measurements.md, docs/measurements/, docs/install.md and README.md equals a value of a committed CSV.

Usage: test_measurements.py [--write] [ROOT-OF-THE-REPOSITORY]

--write replaces cells that differ, with three significant digits, and the index's commits. What a table says in words stays.

A comment before each table says where its cells come from:

    <!-- figures: MACHINE/volume.csv
    where S = stratus:auto; F = vtk:fixedpoint
    row *, lit = *+shade
    | text | {frame_ms(S)} | {frame_ms(F) / frame_ms(S)} (goal {text}) | {span psnr_db.all('stratus:*', '*')} |
    -->
    | scene | Stratus, ms | times faster | all errors, dB |

The CSV is below Testing/Benchmarks/results. The lines of the comment:

- | TEMPLATE | ... |: a template for each column. Text outside the braces is in the cell as it is. An expression is Python's. METRIC(METHOD, SCENE) is a value of
  the CSV; METRIC.all(METHODS, SCENES) lists those that match (* and ?); METRIC.over(METHOD, OTHER, SCENES) lists the first method's over
  the other's, scene by scene. Without SCENE it is the row's. The cell's number must be the value, rounded to the digits that it shows. It
  is `-` where the CSV lacks a value that the expression needs, and only there.
- {span LIST}: the cell is `LEAST to MOST` of the list.
- {text}, or a template that is only `text`: not checked.
- where NAME = METHOD; ...: names of methods, for the expressions.
- row LABEL = NAME: `scene` in the row whose first cell is LABEL (default: the first cell). A * of LABEL stands for any text, which replaces
  the * of NAME at the same place, without the commas of a number.
- `figures: none, REASON` for a table whose digits come from no CSV; all of its cells are text.

The index in measurements.md has `figures: index` and a line `SECTION = FILE.csv, SCENE: TEMPLATE` for each row. SECTION is the anchor to
which the first cell links; TEMPLATE describes the second cell. Without `, SCENE` it is `*`. The third cell is the commit of the values that
the expressions read, and the fourth cell is the CSV's MACHINE. A section of docs/measurements/ that has a table needs a row of the index.

A table without a comment fails; in README.md and install.md only if it contains digits (not counting code and links). In docs/measurements/
each section also has to name processor, commit and date of every run whose rows its tables show. Links of measurements.md and
docs/measurements/ must lead to files.
"""
import fnmatch
import glob
import math
import os
import re
import sys
from decimal import ROUND_HALF_UP, Decimal

RESULTS = "Testing/Benchmarks/results"
INDEX = "docs/measurements.md"
NUMBER = r"(-|[+]?(?:\d{1,3}(?:,\d{3})+|\d+)?(?:\.\d+)?)"


class Missing(Exception):
    """A CSV has no such value."""


class Table:
    """A CSV of stratus-bench: values by (scene, method, metric), and the origins of its scenes."""

    def __init__(self, path):
        self.values = {}
        self.origins = []
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()
        for line in lines:
            if line.startswith("# "):
                name, value = line[2:].split(",", 1)
                if name == "processor":
                    self.origins.append({})
                self.origins[-1][name] = value
        rows = [line.split(",") for line in lines if not line.startswith("#")]
        if rows[0] != "benchmark,scene,method,metric,value,unit".split(","):
            raise ValueError(path + ": not a table of stratus-bench")
        for _, scene, method, metric, value, _ in rows[1:]:
            if (scene, method, metric) in self.values:
                raise ValueError(f"{path}: {scene}, {method}, {metric} is there twice")
            self.values[scene, method, metric] = float(value)
        for origin in self.origins:
            for name in ("processor", "cores", "compiler", "commit", "date", "scenes"):
                if not origin.get(name):
                    raise ValueError(f"{path}: no {name} of a run")
        covered = {scene for origin in self.origins for scene in origin["scenes"].split(",")}
        uncovered = {scene for scene, _, _ in self.values} - covered
        if uncovered:
            raise ValueError(f"{path}: nothing says where {', '.join(sorted(uncovered))} come from")


class Metric:
    """A metric within a row: called it is a value, all() are several."""

    def __init__(self, table, name, scene, used):
        self.table, self.name, self.scene, self.used = table, name, scene, used

    def __call__(self, method, scene=None):
        scene = scene or self.scene
        if (scene, method, self.name) not in self.table.values:
            raise Missing(f"{self.name} of {method} in {scene}")
        self.used.add(scene)
        return self.table.values[scene, method, self.name]

    def all(self, methods, scenes=None):
        found = []
        for (scene, method, metric), value in self.table.values.items():
            if metric == self.name and fnmatch.fnmatchcase(method, methods) and fnmatch.fnmatchcase(scene, scenes or self.scene):
                self.used.add(scene)
                found.append(value)
        if not found:
            raise Missing(f"{self.name} of {methods} in {scenes or self.scene}")
        return found

    def over(self, method, other, scenes=None):
        found = []
        for (scene, name, metric), value in self.table.values.items():
            if (name, metric) == (method, self.name) and fnmatch.fnmatchcase(scene, scenes or self.scene):
                if (scene, other, metric) in self.table.values:
                    self.used.add(scene)
                    found.append(value / self.table.values[scene, other, metric])
        if not found:
            raise Missing(f"{self.name} of {method} and {other} in {scenes or self.scene}")
        return found


def evaluate(expression, table, scene, used, methods=None):
    """Return the value, or None if the CSV lacks a value that the expression needs."""
    names = {"scene": scene, "min": min, "max": max, "sum": sum, "len": len, **(methods or {})}
    for metric in {key[2] for key in table.values}:
        names[metric] = Metric(table, metric, scene, used)
    try:
        return float(eval(expression, {"__builtins__": {}, **names}))  # from a file of this repository
    except Missing:
        return None


def shown(value, digits):
    return Decimal(repr(value)).quantize(Decimal(1).scaleb(-digits), rounding=ROUND_HALF_UP)


def judge(text, value):
    """What is wrong with a number as it is written, or None."""
    if value is None or text == "-":
        return None if value is None and text == "-" else f"is {'no value' if value is None else format(value, '.6g')} in the CSV"
    plain = text.lstrip("+").replace(",", "")
    digits = len(plain.partition(".")[2])
    if shown(value, digits) != Decimal(plain):
        return f"is {shown(value, digits)} in the CSV ({value:.9g})"
    if value != 0 and Decimal(plain) == 0:
        return f"is not 0 in the CSV but {value:.3g}"
    return None


def written(value):
    """A number as a new cell has it."""
    if value == int(value) or abs(value) >= 1000:
        return f"{round(value):,}"
    return format(value, f".{max(0, 2 - math.floor(math.log10(abs(value))))}f")


def template_parts(template):
    """Expressions of a template, and the pattern of a cell."""
    if template == "text":
        return [], re.compile(r".*")
    template = re.sub(r"\{span ([^{}]*)\}", r"{min(\1)} to {max(\1)}", template)
    pieces = re.split(r"\{([^{}]*)\}", template)
    expressions, pattern = [], ""
    for i, piece in enumerate(pieces):
        if i % 2 == 0:
            pattern += re.escape(piece)
        elif piece == "text":
            pattern += r".*?"
        else:
            expressions.append(piece)
            pattern += NUMBER
    return expressions, re.compile(pattern)


def scene_of(label, rows):
    """Return the scene of a row, and the line of the comment that describes it or None."""
    for pattern, name in rows.items():
        match = re.fullmatch("(.*?)".join(map(re.escape, pattern.split("*"))), label)
        if match:
            for text in match.groups():
                name = name.replace("*", re.sub(r"(?<=\d),(?=\d)", "", text), 1)
            return name, pattern
    return label.replace("`", ""), None


def anchor_of(title):
    """Return the anchor that GitHub makes of a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def cells_of(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def tables_of(lines):
    """(number of the header's line, comment before it or None, header's cells, rows as (number, cells)) of each table."""
    i, fenced, comment = 0, False, None
    while i < len(lines):
        line = lines[i]
        if line.lstrip().startswith("```"):
            fenced = not fenced
        if fenced:
            i += 1
            continue
        if line.startswith("<!-- figures:"):
            start = i
            while "-->" not in lines[i]:
                i += 1
            comment = "\n".join(lines[start : i + 1])[len("<!-- figures:") :].split("-->")[0].strip()
        elif line.startswith("|") and i + 1 < len(lines) and re.fullmatch(r"\|[\s:|-]+\|?", lines[i + 1].strip()):
            header, rows, at = cells_of(line), [], i
            i += 2
            while i < len(lines) and lines[i].startswith("|"):
                rows.append((i + 1, cells_of(lines[i])))
                i += 1
            yield at + 1, comment, header, rows
            comment = None
            continue
        elif line.strip():
            comment = None  # it belongs to the table that follows at once
        i += 1


class Document:
    def __init__(self, root, name, strict, write=False):
        self.root, self.name, self.strict, self.write = root, name, strict, write
        with open(os.path.join(root, name), encoding="utf-8") as file:
            self.lines = file.read().splitlines()
        self.errors, self.checked, self.tables, self.numbers = [], 0, 0, []
        self.csv = {}
        self.anchors = []
        self.changed = False

    def fail(self, line, what):
        self.errors.append(f"{self.name}:{line}: {what}")

    def section(self, line):
        """Lines of the section (##) that a line is in."""
        heads = [i for i, text in enumerate(self.lines) if text.startswith("## ")]
        start = max([i for i in heads if i < line], default=0)
        end = min([i for i in heads if i >= line], default=len(self.lines))
        return self.lines[start:end]

    def check(self):
        for line, comment, header, rows in tables_of(self.lines):
            self.tables += 1
            if comment is None:
                visible = re.sub(r"`[^`]*`|\]\([^)]*\)", "", " ".join(" ".join(cells) for _, cells in [(line, header)] + rows))
                if self.strict or re.search(r"\d", visible):
                    self.fail(line, "no comment says where this table's figures come from")
            elif comment.startswith("none"):
                if not re.match(r"none, \S", comment):
                    self.fail(line, "a table without figures of ours needs a reason: none, REASON")
            elif comment.startswith("index"):
                self.check_index(line, comment.splitlines()[1:], header, rows)
            else:
                self.check_table(line, comment.splitlines(), header, rows)
                heads = [text.lstrip("# ") for text in self.lines[:line] if re.match("##+ ", text)]
                self.anchors.append(os.path.basename(self.name) + "#" + anchor_of(heads[-1] if heads else ""))
        if self.strict:
            for number, text in enumerate(self.lines, 1):
                for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
                    if not os.path.exists(os.path.join(self.root, os.path.dirname(self.name), target)):
                        self.fail(number, f"{target} is not there")

    @staticmethod
    def lines_of(comment):
        """Return the lines `NAME = TEXT` of a comment, and the methods of its lines `where`."""
        lines, methods = {}, {}
        for text in filter(None, map(str.strip, comment)):
            name, _, value = text.partition(" = ")
            if name.startswith("where "):
                methods.update(pair.strip().split(" = ") for pair in text[6:].split(";"))
            else:
                lines[name] = value.strip()
        return lines, methods

    def open(self, line, path):
        """Return the CSV of a comment, or None if it cannot be read."""
        try:
            self.csv[path] = self.csv.get(path) or Table(os.path.join(self.root, RESULTS, path))
        except (OSError, ValueError) as error:
            self.fail(line, str(error))
        return self.csv.get(path)

    def check_index(self, line, comment, header, rows):
        answers, methods = self.lines_of(comment)
        for number, cells in rows:
            target = re.fullmatch(r"\[.*\]\(measurements/(.*)#(.*)\)", cells[0])
            source = re.fullmatch(r"([^,:]+)(?:, (.*?))?: (.*)", answers.pop(target[2], "") if target else "")
            if not source or len(cells) != 4:
                self.fail(number, f"no line of the comment describes {cells[0]}, or the row has not four cells")
                continue
            table, used = self.open(line, f"{cells[3]}/{source[1]}"), set()
            if not table:
                continue
            self.anchors.append(f"{target[1]}#{target[2]}")
            self.check_cell(number, header[1], cells, 1, source[3], table, source[2] or "*", used, methods)
            commits = ", ".join(dict.fromkeys(run["commit"] for run in table.origins if used & set(run["scenes"].split(","))))
            self.checked += 2
            if cells[2] != commits and self.write:
                self.replace(number, cells, 2, commits)
            elif cells[2] != commits:
                self.fail(number, f"{header[2]}: '{cells[2]}' is not '{commits}'")
        for name in answers:
            self.fail(line, f"there is no row {name}")

    def check_table(self, line, comment, header, rows):
        path, used, met = comment[0].strip(), set(), set()
        table = self.open(line, path)
        if not table:
            return
        templates = [cells_of(text) for text in comment if text.startswith("|")]
        if len(templates) != 1 or len(templates[0]) != len(header):
            self.fail(line, f"the comment needs one line of {len(header)} templates")
            return
        lines, methods = self.lines_of(text for text in comment[1:] if not text.startswith("|"))
        scenes = {name[4:].strip(): scene for name, scene in lines.items() if name.startswith("row ")}
        for name in lines.keys() - {"row " + label for label in scenes}:
            self.fail(line, f"'{name}' is no line of a comment")
        for number, cells in rows:
            if len(cells) != len(header):
                self.fail(number, f"{len(cells)} cells under {len(header)} columns")
                continue
            scene, row = scene_of(cells[0], scenes)
            met.add(row)
            before = self.checked
            for column, (name, template) in enumerate(zip(header, templates[0])):
                self.check_cell(number, name, cells, column, template, table, scene, used, methods)
            if self.checked == before:
                self.fail(number, f"no figure of this row is checked ('{scene}' may be no scene)")
        for label in scenes.keys() - met:
            self.fail(line, f"there is no row '{label}'")
        if self.strict:
            self.check_origins(line, f"{RESULTS}/{path}", table, used)

    def replace(self, number, cells, column, text):
        cells[column] = text
        self.lines[number - 1] = "| " + " | ".join(cells) + " |"
        self.changed = True

    def fill_cell(self, number, cells, column, template, table, scene, methods):
        """Writes the cell anew if it differs from its template's values."""
        expressions, pattern = template_parts(template)
        values = [evaluate(expression, table, scene, set(), methods) for expression in expressions]
        match = pattern.fullmatch(cells[column].replace("`", ""))
        texts = match.groups() if match and "" not in match.groups() else ["-"] * len(expressions)
        if None in values:
            if cells[column] != "-":
                self.replace(number, cells, column, "-")
        elif any(judge(text, value) for text, value in zip(texts, values)) and "{text}" not in template:
            pieces = re.split(r"\{[^{}]*\}", re.sub(r"\{span ([^{}]*)\}", r"{\1} to {\1}", template))
            numbers = [written(value) for value in values] + [""]
            self.replace(number, cells, column, "".join(piece + text for piece, text in zip(pieces, numbers)))

    def check_cell(self, number, name, cells, column, template, table, scene, used, methods=None):
        if self.write:
            self.fill_cell(number, cells, column, template, table, scene, methods)
        cell = cells[column]
        expressions, pattern = template_parts(template)
        if cell == "-" and expressions:  # all of the cell's figures are missing
            texts = ["-"] * len(expressions)
        else:
            match = pattern.fullmatch(cell.replace("`", ""))
            if not match or "" in match.groups():
                self.fail(number, f"{name}: '{cell}' is not of the form '{template}'")
                return
            texts = match.groups()
        for expression, text in zip(expressions, texts):
            try:
                value = evaluate(expression, table, scene, used, methods)
            except Exception as error:  # whatever an expression may be wrong in
                self.fail(number, f"{name}: {expression}: {error}")
                continue
            wrong = judge(text, value)
            if wrong:
                self.fail(number, f"{name}: {text} {wrong}: {expression}")
            if value is not None:
                self.checked += 1
                self.numbers += [] if wrong else [(text, value)]

    def check_origins(self, line, path, table, used):
        section = " ".join(self.section(line))
        if os.path.relpath(path, os.path.dirname(self.name)) not in section:
            self.fail(line, f"its section has no link to {path}")
        for origin in table.origins:
            if used & set(origin["scenes"].split(",")):
                for name in ("processor", "commit", "date"):
                    if origin[name] not in section:
                        self.fail(line, f"its section does not name the {name} of {path}: {origin[name]}")


def check_judge():
    """The judge itself sees what it must."""
    alike = (("5.2", 5.1849), ("5.25", 5.2501), (".56", 0.557), ("-", None), ("5,527,203", 5527203.0), ("0", 0.0), ("3", 2.5), ("+5.8", 5.757))
    apart = (("5.2", 5.2501), ("-", 1.0), ("1", None), ("0", 0.2), ("2", 2.5), ("66", 66.64), ("5,527,203", 5527204.0))
    for text, value, right in [(*pair, True) for pair in alike] + [(*pair, False) for pair in apart]:
        if (judge(text, value) is None) != right:
            return f"'{text}' next to {value} was judged wrongly"
    for text, value in (("5.18", 5.1849), ("0.0567", 0.05673), ("66", 66.0), ("12,346", 12345.6), ("120", 120.4), ("0", 0.0), ("1.00", 1.0001)):
        if written(value) != text:
            return f"{value} was written as '{written(value)}', not as '{text}'"
    return None


def change_digit(text):
    """The same number with another last digit."""
    return text[:-1] + str((int(text[-1]) + 1) % 10)


def main():
    write = "--write" in sys.argv[1:]
    arguments = [word for word in sys.argv[1:] if word != "--write"]
    root = arguments[0] if arguments else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    errors = [error for error in (check_judge(),) if error]
    pages = sorted(os.path.relpath(path, root) for path in glob.glob(os.path.join(root, "docs", "measurements", "*.md")))
    indexed, sections = [], []
    for name in [INDEX, *pages, "README.md", "docs/install.md"]:
        strict = name not in ("README.md", "docs/install.md")
        document = Document(root, name, strict, write)
        document.check()
        if document.changed:
            with open(os.path.join(root, name), "w", encoding="utf-8") as file:
                file.write("\n".join(document.lines) + "\n")
        errors += document.errors
        if name == INDEX:
            indexed = document.anchors
        elif strict:
            sections += document.anchors
        # Any other last digit would have been seen.
        for text, value in document.numbers:
            if judge(change_digit(text), value) is None:
                errors.append(f"{name}: {change_digit(text)} for {text} would pass")
        if strict and document.checked == 0:
            errors.append(f"{name}: nothing was checked")
        print(f"{name}: {document.checked} figures in {document.tables} tables")
    errors += [f"{INDEX}: {name} is not in the index" for name in dict.fromkeys(sections) if name not in indexed]
    errors += [f"{INDEX}: {name} has no table" for name in dict.fromkeys(indexed) if name not in sections]
    print("\n".join(errors) if errors else "all as in the tables of the benchmarks")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
