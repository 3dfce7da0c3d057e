# SPDX-License-Identifier: BSD-3-Clause
"""The wheel stratus-vtk in its VTK: pictures equal Debian's VTK's to the bit, pyvista takes the mappers, unchanged programs draw by them.
in_newest_vtk.py FOLDER BUILD"""
import os
import re
import shutil
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

# Whatever pyvista enables, the volume shows, behind and in front of opaque geometry, and looks as FixedPoint's does.
ENABLED = {"nothing": lambda p: None, "ssaa": lambda p: p.enable_anti_aliasing("ssaa"), "fxaa": lambda p: p.enable_anti_aliasing("fxaa"),
           "msaa": lambda p: p.enable_anti_aliasing("msaa", multi_samples=8), "eye dome lighting": lambda p: p.enable_eye_dome_lighting(),
           "ssao": lambda p: p.enable_ssao(radius=5), "depth of field": lambda p: p.enable_depth_of_field(), "blur": lambda p: p.add_blurring(),
           "shadows": lambda p: p.enable_shadows(), "depth peeling": lambda p: p.enable_depth_peeling(8),
           "hidden lines": lambda p: p.enable_hidden_line_removal(), "parallel": lambda p: p.enable_parallel_projection()}


def enabled(what, way):
    """A picture of a ball inside a volume, drawn by FixedPoint, by ours, or left out."""
    seen = pyvista.Plotter(off_screen=True, window_size=(256, 256))
    seen.set_background("black")
    seen.add_mesh(pyvista.Sphere(radius=12, center=(24, 24, 24)), color="white")
    if way != "none":
        added = seen.add_volume(grid, opacity=[0, 0, 0, 0.2, 0.6], mapper="fixed_point", show_scalar_bar=False)
    if way == "ours":
        added.mapper = stratus.vtkStratusVolumeMapper()
        added.mapper.SetInputData(grid)
    seen.camera_position = "iso"
    ENABLED[what](seen)
    picture = seen.screenshot(return_img=True).astype(int)
    seen.close()
    return picture


for what in ENABLED:
    ours, theirs, without = (enabled(what, way) for way in ("ours", "fixed", "none"))
    shows, their_shows, apart = abs(ours - without).mean(), abs(theirs - without).mean(), abs(ours - theirs).mean()
    print(f"{what}: the volume changes {shows:.1f} of 255 in the mean, FixedPoint's {their_shows:.1f}; they are {apart:.2f} apart")
    # vtkDepthOfFieldPass draws no volume of any mapper. vtkSSAOPass says that it needs lit volumes, and draws FixedPoint's over all else.
    check(shows > 2 or their_shows < 0.01, f"under {what} the volume shows: {shows}")
    check(apart < 3 or what == "ssao", f"under {what} the volume looks as FixedPoint's: {apart}")

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
ran = subprocess.run([sys.executable, "-c", "import cvista.vtkRenderingVolumeOpenGL2; from cvista.vtkRenderingVolume import vtkGPUVolumeRayCastMapper as mapper; "
                       "print(mapper().GetClassName())"], env=dict(os.environ, VTK_AUTOLOAD_PATH=factory), capture_output=True, text=True)
check("vtkStratusFactoryVolumeMapper" in ran.stdout, f"the object factory: {ran}")

# Two VTKs in one process, each with its own objects.
both = subprocess.run([sys.executable, "-c", "import warnings; warnings.simplefilter('error')\nimport vtkmodules.vtkCommonDataModel as other\n"
                       "try:\n    import stratus\nexcept RuntimeWarning as error:\n    print(error)\nwarnings.simplefilter('ignore')\nimport stratus\n"
                       "try:\n    stratus.show(other.vtkImageData())\nexcept TypeError as error:\n    print(error)"], capture_output=True, text=True)
said = both.stdout.splitlines()
check(both.returncode == 0 and len(said) == 2 and "two VTKs" in said[0] and "vtkmodules is" in said[0] and "a vtkmodules." in said[1]
      and said[1].endswith("of cvista"), f"two VTKs: {both}")

# The package without VTK takes grids of any package's VTK, and loads no other for them.
other = os.path.join(folder, "other")
os.makedirs(other, exist_ok=True)
shutil.rmtree(os.path.join(other, "stratus_volume"), ignore_errors=True)
shutil.copytree(os.path.join(build, "lib", "python3", "dist-packages", "stratus_volume"), os.path.join(other, "stratus_volume"))
drawn = subprocess.run([sys.executable, "-c", "import sys; sys.modules['vtkmodules'] = None\nimport pyvista, stratus_volume\n"
                        "grid = pyvista.Wavelet(extent=(-8, 8, -8, 8, -8, 8))\n"
                        "for each in grid, grid.cast_to_unstructured_grid(), grid.cast_to_structured_grid(), grid.cast_to_rectilinear_grid():\n"
                        "    print(stratus_volume.render(each, size=(60, 40), device='host').rgba[..., 3].max() > 0.1)"],
                       env=dict(os.environ, PYTHONPATH=other), capture_output=True, text=True)
check(drawn.stdout.split() == 4 * ["True"], f"cvista's grids in stratus_volume: {drawn}")

# The core and VTK share one OpenMP runtime. A second one would have its own threads in addition to the first one's.
with open("/proc/self/maps", encoding="utf-8") as file:
    maps = {line.split(maxsplit=5)[5].strip() for line in file if len(line.split(maxsplit=5)) == 6}
runtimes = {path for path in maps if re.search(r"/lib(g|i|)omp[-.0-9]", path)}
check(len(runtimes) == 1 and "cvista.libs" in runtimes.pop(), f"OpenMP's runtimes in this process: {sorted(path for path in maps if 'omp' in path)}")

# Each library is there once, under the name by which others need it.
package = os.path.dirname(stratus.__file__)
names = [name.split(".so")[0] for name in os.listdir(package) if name.startswith("lib")]
check(len(names) == len(set(names)) > 8, f"no copies of libraries: {sorted(names)}")

# A machine without OpenCL: a name that does not exist replaces its loader's.
copy = os.path.join(folder, "without", "stratus")
shutil.rmtree(os.path.dirname(copy), ignore_errors=True)
shutil.copytree(package, copy, ignore=shutil.ignore_patterns("__pycache__"))
for part in "_needed.py", "libstratus-core.so.0.1", "no_opencl/libOpenCL.so.1":
    path = os.path.join(copy, part)
    with open(path, "rb") as file:
        content = file.read().replace(b"libOpenCL", b"libOpenCX")
    os.remove(path)
    with open(path.replace("libOpenCL", "libOpenCX"), "wb") as file:
        file.write(content)
for folder_name in "cvista", "cvista.libs":  # where the libraries look for them
    os.symlink(os.path.join(os.path.dirname(package), folder_name), os.path.join(folder, "without", folder_name))
shown = subprocess.run([sys.executable, "-c", "import numpy, stratus\nz = numpy.mgrid[:9, :9, :9][0] + 0.0\n"
                        "print(stratus.__file__, stratus.show(z, opacity=[(0, 0), (8, 0.5)], size=(60, 40))[..., 0].max())"],
                       env=dict(os.environ, PYTHONPATH=os.path.dirname(copy)), cwd=folder, capture_output=True, text=True)
check(shown.returncode == 0 and copy in shown.stdout, f"without an OpenCL loader the host draws: {shown}")
for each in other, os.path.dirname(copy):
    shutil.rmtree(each)
done()
