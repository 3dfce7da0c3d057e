#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The package's type annotations by `mypy --strict`: its public modules, a program that is right, and one whose faults must be found. Parameters and
defaults of annotated functions are compared with those of the package itself."""
from checking import check, done

import glob
import os
import shutil
import subprocess
import sys
import tempfile

import stratus_volume

folder = os.path.dirname(stratus_volume.__file__)
if subprocess.run([sys.executable, "-c", "import mypy"], capture_output=True).returncode == 0:
    mypy = [sys.executable, "-m", "mypy"]
elif shutil.which("mypy"):
    mypy = ["mypy"]
else:
    print("SKIPPED: no mypy")
    sys.exit(77)

RIGHT = """\
from typing import Any

import numpy
from numpy.typing import NDArray
import stratus_volume as sv
import stratus_volume.xarray

field: NDArray[numpy.float32] = numpy.zeros((8, 8, 8), numpy.float32)
picture: sv.Picture = sv.show(field, opacity=[(0.6, 0), (2.5, 0.5)], color="viridis", size=(320, 240), background=None)
picture.save("picture.png")
caption: str = picture.caption + sv.__version__
rgba, depth, counters = sv.render(field, 0.3, camera=dict(azimuth=70), quantities="integral")
alpha: NDArray[numpy.float32] = rgba[..., 3]
volume = sv.Volume(field, spacing=(1, 1, 2), device="host", threads=2)
low: float = volume.bounds[0]
shown: sv.Rendering = volume.render(mode="maximum", clip_planes=sv.slab((4, 4, 4), (0, 0, 1), 2), shade=dict(ambient=0.2))
film: sv.Film = sv.turn(volume, frames=4)
seconds: float = film.seconds + film[0].shape[0]
hits = sv.first_hits(field, [[0, 0, -5]], [[0, 0, 1]], lower=2.0)
first: NDArray[numpy.float64] = hits.t
names: list[str] = sv.color_maps() + sv.devices()


def draw(data: Any) -> sv.Picture:
    try:
        return stratus_volume.xarray.DatasetAccessor(data).show("qc", 0.5, size=(64, 64), tolerance=0.01)
    except (sv.DeviceError, sv.Unsupported, sv.Cancelled):
        return stratus_volume.xarray.DataArrayAccessor(data).render(color=(1, 0, 0)).picture()
"""

# Each line of a program has one fault, of this kind.
WRONG = [("arg-type", "sv.show(field, size='large')"), ("arg-type", "sv.Volume(field, device=1.5)"), ("call-arg", "sv.Volume(field, spaces=(1, 1, 2))"),
         ("arg-type", "sv.Volume(field).render(mode='maximal')"), ("attr-defined", "sv.render(field).colors"), ("attr-defined", "sv.draw(field)"),
         ("assignment", "number: int = sv.show(field)"), ("call-arg", "sv.show()"), ("misc", "a, b = sv.render(field)"),
         ("arg-type", "sv.slab((0, 0, 0), 'z', 2)"), ("arg-type", "sv.VisibilityOrder(sv.partition([], [], rule='mean'))"),
         ("call-arg", "stratus_volume.xarray.DatasetAccessor(field).show(color='fire')"), ("arg-type", "stratus_volume.xarray.DataArrayAccessor(field).render(size=3)")]


def checked(*arguments):
    """The exit status of mypy and its lines."""
    environment = dict(os.environ, MYPYPATH=os.path.dirname(folder))
    command = [*mypy, "--strict", "--show-error-codes", "--no-error-summary", "--cache-dir", os.path.join(temporary, "cache"), *arguments]
    ended = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=temporary)
    return ended.returncode, (ended.stdout + ended.stderr).splitlines()


check(os.path.exists(os.path.join(folder, "py.typed")), "py.typed is in the package")
public = [path for path in glob.glob(os.path.join(folder, "*.py")) if not os.path.basename(path).startswith("_")]
stubs = [path + "i" for path in (*public, os.path.join(folder, "__init__.py"))]
check(len(stubs) >= 3 and all(map(os.path.exists, stubs)), f"every public module has annotations: {stubs}")
with tempfile.TemporaryDirectory() as temporary:
    status, lines = checked(*stubs)
    check(status == 0, "the package:\n" + "\n".join(lines))
    right, wrong = (os.path.join(temporary, name) for name in ("right.py", "wrong.py"))
    with open(right, "w", encoding="utf-8") as file:
        file.write(RIGHT)
    status, lines = checked(right)
    check(status == 0, "a program:\n" + "\n".join(lines))
    with open(wrong, "w", encoding="utf-8") as file:
        file.write("import numpy\nimport stratus_volume as sv\nimport stratus_volume.xarray\nfield = numpy.zeros((8, 8, 8))\n")
        file.writelines(text + "\n" for _, text in WRONG)
    status, lines = checked(wrong)
    check(status == 1, f"a program with faults has the status {status}")
    for number, (kind, text) in enumerate(WRONG, 5):
        found = [line for line in lines if line.startswith(f"wrong.py:{number}: error:")]
        check(any(line.endswith(f"[{kind}]") for line in found), f"{text} is a fault of kind {kind}: {found}")

    # mypy.stubtest imports the package. Private modules have no annotations, and pyvista's is only looked at where pyvista is installed.
    private = ",".join("stratus_volume." + os.path.basename(path)[:-3] for path in glob.glob(os.path.join(folder, "_[a-z]*.py")))
    settings, allowed = (os.path.join(temporary, name) for name in ("settings.ini", "allowed.txt"))
    with open(settings, "w", encoding="utf-8") as file:
        file.write(f"[mypy]\nignore_missing_imports = True\n[mypy-{private}]\nignore_errors = True\n")
    with open(allowed, "w", encoding="utf-8") as file:
        file.write("stratus_volume\\.View\\.__init__\nstratus_volume\\._.*\n")  # the function view() makes views

    def compared(path):
        command = [sys.executable, "-m", "mypy.stubtest", "--mypy-config-file", settings, "--concise", "--ignore-missing-stub", "--allowlist", allowed,
                   "--ignore-unused-allowlist", "stratus_volume"]
        environment = dict(os.environ, MYPYPATH=path, PYTHONPATH=path)
        ended = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=temporary)
        return [line for line in (ended.stdout + ended.stderr).splitlines() if "disjoint base" not in line and "pyvista" not in line]

    if mypy[0] == sys.executable:
        lines = compared(os.path.dirname(folder))
        check(not lines, f"annotations are the functions': {lines}")
        copy = os.path.join(temporary, "copy", "stratus_volume")
        shutil.copytree(folder, copy)
        stub = os.path.join(copy, "__init__.pyi")
        with open(stub, encoding="utf-8") as file:
            text = file.read()
        with open(stub, "w", encoding="utf-8") as file:
            file.write(text.replace("def slab(center: ", "def slab(middle: "))
        lines = compared(os.path.dirname(copy))
        check(any(line.startswith("stratus_volume.slab is inconsistent") for line in lines), f"a parameter of another name is found: {lines}")
done()
