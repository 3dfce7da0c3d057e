# SPDX-License-Identifier: BSD-3-Clause
"""The table of docs/vtk-parity.md: it names every setter that VTK 9.1's volume mappers and property have; the mappers lack the
setters that it calls not there, and have all others; and the tests that it names exist, with the cases that it names."""
import os
import re
import sys

import vtk

import stratus

failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("does not hold:", what)


with open("docs/vtk-parity.md", encoding="utf-8") as file:
    text = file.read().split("\n## VTK's own tests\n")[0]  # the table of that section is test_vtk_verdicts' own
table = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in text.split("\n") if line.startswith("|")][2:]
check(len(table) > 30 and all(len(row) == 3 and all(row) for row in table), "rows of three cells")
words = {word: row for row in table for word in re.findall(r"`(\w+)`", row[0])}

# Setters with several names, and properties that a mapper gets from elsewhere.
plain = "InputData InputConnection RemoveInputConnection"


def setters(kind):
    """Names X of SetX, or of XOn, that a class has of its own; SetXToY is one of them, unless there is a GetXToY."""
    found = set()
    for name in vars(kind):
        match = re.fullmatch(r"Set(\w+)|([A-Z]\w*)On", name)
        if match:
            whole = match[1] or match[2]
            short = re.sub(r"To[A-Z0-9]\w*$", "", whole)
            found.add(whole if whole == short or hasattr(kind, "Get" + whole) or not short else short)
    found -= set(plain.split())
    return found


mappers = vtk.vtkVolumeMapper, vtk.vtkGPUVolumeRayCastMapper, vtk.vtkSmartVolumeMapper, vtk.vtkFixedPointVolumeRayCastMapper
ours = stratus.vtkStratusVolumeMapper()
if vtk.vtkVersion.GetVTKVersion().startswith("9.1"):
    offered = set().union(*map(setters, mappers))
    check(len(offered) > 30, f"VTK's mappers have setters: {offered}")
    for name in sorted(offered | setters(vtk.vtkVolumeProperty)):
        check(name in words, f"the table names {name}")
    for name in sorted(offered & set(words)):
        there = hasattr(ours, "Set" + name)
        gone = "not there" in words[name][1] or "no such method" in words[name][1]
        check(there != gone, f"{name} is {'there' if there else 'not there'}, the table says: {words[name][1]}")
for name, there in ("ScatteringAnisotropy", True), ("VolumetricScatteringBlending", True), ("GlobalIlluminationReach", True):
    check(hasattr(ours, "Set" + name) == there, f"{name} is {'' if there else 'not '}there")

# Tests by their names: `Shading: Shading, Setters` are functions of TestStratusVolumeMapperShading.
for what, _, tests in table:
    for test in tests.split(";"):
        name, _, cases = test.strip().strip("`").replace("`", "").partition(":")
        short = name.replace("TestStratusVolumeMapper", "")
        path = "Testing/VTK/" + (name + ".py" if name.startswith("test_") else f"TestStratusVolumeMapper{short}.cxx")
        check(os.path.exists(path), f"{what}: there is a test {path}")
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                source = file.read()
            for case in filter(None, (c.strip() for c in cases.split(","))):
                check(case == "all" or re.search(rf"^void {case}\(", source, re.M), f"{what}: {path} has a case {case}")
sys.exit(1 if failures else 0)
