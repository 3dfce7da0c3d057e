# SPDX-License-Identifier: BSD-3-Clause
"""The table of VTK's tests in docs/vtk-parity.md: its rows, and whether what was measured agrees with them."""
import decimal
import re

from vtk_verdict import Better, Different, Refused, Same, differences

HEADING = "## VTK's own tests"
MOST_OF_SAME = 0.6, 8  # mean and maximum of 255 that may be called the same
NUMBER = r"([\d.]+)"
PAIR = rf"mean {NUMBER}, maximum {NUMBER}"
VERDICTS = (
    (Different, rf"differs: {PAIR} because (?P<why>.+?)(?:; where (?P<how>[^;]+), {PAIR})?"
                rf"(?:; from the reference ours {NUMBER}, VTK's {NUMBER})?"),
    (Better, rf"better: we hold (?:{NUMBER} )?(?P<we>.+?) / VTK fails (?:{NUMBER} )?(?P<vtk>.+)"),
    (Refused, r"refused: (?P<sentence>.+)"),
    (Same, rf"same: {PAIR}"),
)


class Row:
    """A row: the name of VTK's test, the kind of its verdict (a class of vtk_verdict), its numbers in order, and its texts."""

    def __init__(self, cells):
        self.name = cells[0].strip("`")
        for kind, pattern in VERDICTS:
            match = re.fullmatch(pattern, cells[2])
            if match:
                named = match.re.groupindex.values()
                self.kind, self.texts = kind, match.groupdict()
                self.numbers = [None if part is None else decimal.Decimal(part) for i, part in enumerate(match.groups(), 1) if i not in named]
                return
        raise ValueError(f"{self.name}: no verdict is written like that: {cells[2]}")


def read(path):
    """The rows by name; a name that comes twice is an error."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    section = text.split("\n" + HEADING + "\n")[1].split("\n## ")[0]
    lines = [line for line in section.split("\n") if line.startswith("|")][2:]
    rows = {}
    for line in lines:
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) != 3 or not all(cells):
            raise ValueError(f"not three cells: {line}")
        row = Row(cells)
        if row.name in rows:
            raise ValueError(f"{row.name} has two rows")
        rows[row.name] = row
    return rows


def compare(stated, measured, what):
    """Complaints: the measured value is at most what rounds to the stated one, which above 1 is less than twice as large."""
    if stated is None:
        return [f"{what}: {measured:.3g} is measured, and the row states nothing"]
    half = decimal.Decimal(5).scaleb(stated.as_tuple().exponent - 1)  # processors round reciprocals in different ways
    if measured > stated + half:
        return [f"{what}: {measured:.4g} is measured, more than {stated:f}"]
    if stated > 1 and measured < stated / 2:
        return [f"{what}: {measured:.4g} is measured, less than half of {stated:f}"]
    return []


def judge(row, result):
    """Returns complaints about a row and its case's measurements."""
    if type(result) is not row.kind:
        return [f"the case is {type(result).__name__}, the row is {row.kind.__name__}"]
    if row.kind is Refused:
        stated = row.texts["sentence"]
        return [] if result.sentence == stated else [f"the mapper says '{result.sentence}', not '{stated}'"]
    if row.kind is Better:
        complaints = [f"it does not hold that {fact}" for fact, truth in result.facts.items() if not truth]
        for stated, measured, what in zip(row.numbers, (result.ours, result.vtks), ("ours", "VTK's")):
            if measured is not None or stated is not None:
                complaints += compare(stated, measured, what)
        return complaints
    numbers = row.numbers
    complaints = [c for n, m, what in zip(numbers, differences(result.pairs), ("mean", "maximum")) for c in compare(n, m, what)]
    if row.kind is Same:
        return complaints + [f"{n:f} is not the same" for n, most in zip(numbers, MOST_OF_SAME) if n > most]
    if result.without:
        parts = zip(numbers[2:4], differences(result.without), ("mean without the cause", "maximum without the cause"), MOST_OF_SAME)
        for stated, measured, what, most in parts:
            complaints += compare(stated, measured, what)
            if stated is not None and stated > most:
                complaints.append(f"{what}: {stated:f} is not the same")
    elif numbers[2] is not None:
        complaints.append("no case without the cause")
    if result.reference is not None:
        for stated, measured, what in zip(numbers[4:6], result.reference[::-1], ("ours from the reference", "VTK's from the reference")):
            complaints += compare(stated, measured, what)
    elif numbers[4] is not None:
        complaints.append("no reference")
    if not result.without and result.reference is None:
        complaints.append("nothing proves the cause")
    return complaints
