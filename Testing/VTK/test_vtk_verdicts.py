# SPDX-License-Identifier: BSD-3-Clause
"""VTK 9.1's own tests of volumes, redone on procedural data: each has the verdict that docs/vtk-parity.md gives it.

test_vtk_verdicts.py FOLDER judges all cases. With names, or parts of names, behind the folder it prints what these cases measure, and
writes their pictures to the folder: VTK's, ours, and eight times their difference, a row for each pair, the first at the bottom."""
import os
import sys

sys.dont_write_bytecode = True

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk

VERSION = "9.1"
if not vtk.vtkVersion.GetVTKVersion().startswith(VERSION + "."):  # other versions may lack what the cases name
    print(f"SKIPPED: the figures are VTK {VERSION}'s, and this is {vtk.vtkVersion.GetVTKVersion()}")
    sys.exit(77)

import vtk_verdict_components
import vtk_verdict_cuts
import vtk_verdict_grids
import vtk_verdict_light
import vtk_verdict_masks
import vtk_verdict_modes
import vtk_verdict_several
import vtk_verdict_surfaces
import vtk_verdict_table as table
import vtk_verdict_views
from vtk_verdict import Better, Refused, cases, differences


def save(path, pairs):
    rows = []
    for vtks, ours in pairs:
        if vtks.shape[:2] == pairs[0][0].shape[:2]:  # not the few pixels that a reference has
            both = [one[..., :3] if one.ndim == 3 else numpy.repeat(one[..., None], 3, 2) for one in (vtks, ours)]
            rows.append(numpy.concatenate([*both, 8 * numpy.abs(both[0] - both[1])], 1))
    picture = numpy.clip(numpy.concatenate(rows), 0, 255).astype(numpy.uint8)
    image = vtk.vtkImageData()
    image.SetDimensions(picture.shape[1], picture.shape[0], 1)
    image.GetPointData().SetScalars(numpy_to_vtk(picture.reshape(-1, 3), deep=True))
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.Write()


def described(result):
    """What a case measured, as a line."""
    if isinstance(result, Refused):
        return f"refused: {result.sentence} (VTK {'draws' if result.drawn else 'does not draw'} it)"
    if isinstance(result, Better):
        return f"{result.facts}, ours {result.ours}, VTK's {result.vtks}"
    lines = ["mean {:.3f}, maximum {:.0f}".format(*differences([one])) for one in result.pairs]
    lines += ["without the cause mean {:.3f}, maximum {:.0f}".format(*differences([one])) for one in getattr(result, "without", ())]
    if getattr(result, "reference", None):
        lines.append("from the reference VTK's {:.3f}, ours {:.3f}".format(*result.reference))
    return "; ".join(lines)


def look(folder, words):
    for name, one in cases.items():
        if any(word.lower() in name.lower() for word in words):
            result = one.function()
            print(f"{name}: {described(result)}", flush=True)
            pairs = [*getattr(result, "pairs", ()), *getattr(result, "without", ())]
            if pairs:
                save(os.path.join(folder, name + ".png"), pairs)


def judge():
    rows = table.read("docs/vtk-parity.md")
    complaints = [f"{name}: no row in the table" for name in cases if name not in rows]
    complaints += [f"{name}: a row without a case" for name in rows if name not in cases]
    for name, row in rows.items():
        if name in cases:
            complaints += [f"{name}: {complaint}" for complaint in table.judge(row, cases[name].function())]
    print(*complaints, sep="\n")
    kinds = [row.kind.__name__ for row in rows.values()]
    print(f"{len(rows)} tests:", ", ".join(f"{kinds.count(kind)} {kind.lower()}" for kind in sorted(set(kinds))))
    return 1 if complaints else 0


if sys.argv[2:]:
    look(sys.argv[1], sys.argv[2:])
else:
    sys.exit(judge())
