# SPDX-License-Identifier: BSD-3-Clause
"""The wheel stratus-vtk in its VTK: pictures are those of Debian's VTK to the bit, pyvista takes the mappers, unchanged programs draw by them.
in_newest_vtk.py FOLDER BUILD"""
import os
import subprocess
import sys

from checking import check, done

import numpy
import pyvista
from cvista.util.numpy_support import vtk_to_numpy
from cvista.vtkCommonCore import vtkVersion

import stratus

folder, build = sys.argv[1:3]
print("VTK", vtkVersion.GetVTKVersion(), "pyvista", pyvista.__version__)


# The same array by the package for Debian's VTK, in a process of its own.
SHOW = """
import numpy, stratus, sys
z, y, x = numpy.mgrid[-1:1:48j, -1:1:48j, -1:1:48j]
field = (numpy.cos(9 * x) + numpy.cos(9 * y) + numpy.cos(9 * z)).astype(numpy.float32)
mapper = stratus.vtkStratusVolumeMapper()
shown = stratus.show(field, opacity=[(0.6, 0), (2.5, 0.5)], mapper=mapper, size=(300, 240))
last = mapper.GetLastImage().GetPointData()
numpy.savez(sys.argv[1], shown=shown, **{name: to_numpy(last.GetArray(name)) for name in ("RGBA", "Depth")})
"""
before = os.path.join(folder, "debian.npz")
debians = subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24 -noreset", "/usr/bin/python3", "-c",
                       "from vtkmodules.util.numpy_support import vtk_to_numpy as to_numpy\n" + SHOW, before],
                      env=dict(os.environ, PYTHONPATH=os.path.join(build, "lib", "python3", "dist-packages")), capture_output=True, text=True)
check(debians.returncode == 0, debians.stderr)
sys.argv[1] = os.path.join(folder, "newest.npz")
exec("to_numpy = vtk_to_numpy\n" + SHOW)
old, new = numpy.load(before), numpy.load(sys.argv[1])
for name in "RGBA", "Depth", "shown":
    check((old[name].view(numpy.uint8) == new[name].view(numpy.uint8)).all(), f"{name} has the bits of Debian's VTK")
check((new["RGBA"][:, 3] > 0).mean() > 0.1, "it shows something")

# pyvista's scenes take the mappers.
grid = pyvista.ImageData(dimensions=(48, 48, 48))
grid["values"] = field.ravel()
plotter = pyvista.Plotter(off_screen=True, window_size=(300, 240))
plotter.add_mesh(pyvista.Sphere(radius=12, center=(24, 24, 24)))
actor = plotter.add_volume(grid, opacity=[0, 0, 0, 0.2, 0.6], show_scalar_bar=False)
vtks = plotter.screenshot(return_img=True).astype(int)
mapper = stratus.vtkStratusVolumeMapper()
mapper.SetInputData(grid)
actor.mapper = mapper
plotter.render()
apart = abs(plotter.screenshot(return_img=True) - vtks)
check(mapper.GetLastError() == "" and mapper.GetSamplesTaken() > 0, mapper.GetLastError())
check(0 < apart.max() and apart.mean() < 1, f"from VTK's mapper {apart.mean():.2f} in the mean, {apart.max()} at most")

# Cells, and filters.
cells = grid.to_tetrahedra()
tetrahedra = stratus.vtkStratusTetrahedraMapper()
tetrahedra.SetInputData(cells)
actor.mapper = tetrahedra
plotter.render()
check(tetrahedra.GetLastError() == "" and tetrahedra.GetNumberOfTetrahedra() == cells.n_cells > 0, tetrahedra.GetLastError())
partition = stratus.vtkStratusPartitionFilter()
partition.SetInputData(cells)
partition.SetDepth(2)
partition.Update()
leaves = vtk_to_numpy(partition.GetOutput().GetCellData().GetArray("StratusLeaf"))
check(len(numpy.unique(leaves)) == 4, f"leaves {numpy.unique(leaves)}")
tree = stratus.vtkStratusHybridTreeFilter()
tree.SetInputData(grid)
tree.Update()
check(tree.GetOutputDataObject(1).GetNumberOfCells() > 0, "a tree")

# An unchanged program.
factory = os.path.join(os.path.dirname(stratus.__file__), "stratus", "factory")
told = subprocess.run([sys.executable, "-c", "import cvista.vtkRenderingVolumeOpenGL2; from cvista.vtkRenderingVolume import vtkGPUVolumeRayCastMapper as mapper; "
                       "print(mapper().GetClassName())"], env=dict(os.environ, VTK_AUTOLOAD_PATH=factory), capture_output=True, text=True)
check("vtkStratusFactoryVolumeMapper" in told.stdout, f"the object factory: {told}")
done()
