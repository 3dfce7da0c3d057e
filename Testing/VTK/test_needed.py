# SPDX-License-Identifier: BSD-3-Clause
"""`import stratus` where its VTK is missing, or another one: a sentence, and the program goes on."""
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))
from checking import check, done

from vtkmodules.vtkCommonCore import vtkVersion


def warnings_of(code, path=None):
    """What the import says, of a program that catches it."""
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(filter(None, [path, os.environ.get("PYTHONPATH")])))
    code = "import sys\n" + code + "\ntry:\n    import stratus\nexcept ImportError as error:\n    print(error)\nprint('goes on')"
    ended = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    check(ended.returncode == 0 and ended.stdout.endswith("goes on\n") and not ended.stderr, f"the program goes on: {ended}")
    return ended.stdout.splitlines()[:-1]


check(warnings_of("") == [], "here nothing is missing")
built = vtkVersion.GetVTKVersion()
missing = warnings_of("sys.modules['vtkmodules'] = None")
check(len(missing) == 1 and missing[0].startswith("stratus needs VTK 9") and "can't be imported" in missing[0], f"without VTK: {missing}")
with tempfile.TemporaryDirectory() as folder:
    package = os.path.join(folder, "vtkmodules")
    os.mkdir(package)
    for version, words in (".".join(built.split(".")[:2] + ["0"]), "second VTK"), ("9.0.3", "9.0.3"):
        for name in "__init__", "vtkRenderingOpenGL2", "vtkRenderingVolumeOpenGL2", "vtkCommonCore":
            with open(os.path.join(package, name + ".py"), "w", encoding="ascii") as file:
                file.write(f"class vtkVersion:\n    @staticmethod\n    def GetVTKVersion():\n        return {version!r}\n")
        other = warnings_of("sys.dont_write_bytecode = True", folder)
        check(len(other) == 1 and words in other[0] and folder in other[0] and built in other[0], f"with another VTK, {version}: {other}")
    os.remove(os.path.join(package, "vtkRenderingVolumeOpenGL2.py"))
    part = warnings_of("sys.dont_write_bytecode = True", folder)
    check(len(part) == 1 and "vtkRenderingVolumeOpenGL2" in part[0], f"with a part of a VTK: {part}")
done()
