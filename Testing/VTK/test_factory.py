# SPDX-License-Identifier: BSD-3-Clause
"""VTK_AUTOLOAD_PATH makes an unchanged program's mappers ours: its pictures equal our mappers' to the bit, or VTK's own, with one line that
says why, if ours refuse. One line reports a library that cannot be used, and the program goes on.
test_factory.py FOLDER runs itself as that program: test_factory.py --draw FILE."""
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done

import numpy

SIZE = 200, 160
FACTORY = os.path.normpath(os.path.join(os.environ["PYTHONPATH"].split(os.pathsep)[0], "..", "..", "stratus", "factory"))


def scenes(vtk, mappers):
    """Yields (name, mapper, property, source). mappers: name -> a new mapper for images, or for cells."""
    wave = vtk.vtkRTAnalyticSource()
    wave.SetWholeExtent(-12, 12, -12, 12, -12, 12)
    cells = vtk.vtkDataSetTriangleFilter()
    cells.SetInputConnection(wave.GetOutputPort())
    mask = vtk.vtkImageData()
    mask.SetDimensions(25, 25, 25)
    mask.SetOrigin(-12, -12, -12)
    mask.AllocateScalars(vtk.VTK_UNSIGNED_CHAR, 1)
    vtk.util.numpy_support.vtk_to_numpy(mask.GetPointData().GetScalars())[:] = numpy.arange(25**3) % 25 < 15

    def look(**settings):
        made = vtk.vtkVolumeProperty()
        made.SetInterpolationTypeToLinear()
        color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
        for value, rgb in (40, (0.2, 0.3, 0.9)), (150, (0.9, 0.8, 0.2)), (270, (1, 0.1, 0.1)):
            color.AddRGBPoint(value, *rgb)
        for value, alpha in (100, 0), (200, 0.1), (270, 0.5):
            opacity.AddPoint(value, alpha)
        made.SetColor(color)
        made.SetScalarOpacity(opacity)
        for name, value in settings.items():
            getattr(made, "Set" + name)(value)
        return made

    def made(kind, source=wave, **settings):
        mapper = mappers(kind)
        mapper.SetInputConnection(source.GetOutputPort())
        for name, value in settings.items():
            getattr(mapper, "Set" + name)(*value if isinstance(value, tuple) else (value,))
        return mapper
    yield "smart", made("smart"), look()
    yield "gpu-lit", made("gpu"), look(Shade=1)
    steep = vtk.vtkPiecewiseFunction()
    steep.AddPoint(0, 0)
    steep.AddPoint(15, 1)
    yield "gradient", made("gpu"), look(GradientOpacity=steep)
    yield "cropped", made("gpu", Cropping=1, CroppingRegionPlanes=(-12, 3, -5, 12, -12, 12)), look()
    yield "maximum", made("smart", BlendMode=1), look()
    masked = made("gpu", MaskInput=mask)
    masked.SetMaskTypeToBinary()
    yield "masked", masked, look()
    yield "array", made("gpu", ScalarMode=3), look()
    yield "cells", made("cells", cells), look()
    yield "lit-maximum", made("gpu", BlendMode=1), look(Shade=1) # both leave the light out
    # Ours refuse isosurfaces of values taken as they are; and know nothing of shaders.
    boxes = look(InterpolationType=0)
    boxes.GetIsoSurfaceValues().SetValue(0, 200)
    yield "refused", made("gpu", BlendMode=5), boxes
    yield "shader", made("gpu"), look()


def draw(path):
    import vtk
    import vtk.util.numpy_support

    def usual(kind):
        return {"smart": vtk.vtkSmartVolumeMapper, "gpu": vtk.vtkGPUVolumeRayCastMapper, "cells": vtk.vtkProjectedTetrahedraMapper}[kind]()

    def ours(kind):
        import stratus
        if kind == "cells":
            mapper = stratus.vtkStratusTetrahedraMapper()
        else:
            mapper = stratus.vtkStratusVolumeMapper()
            mapper.SetGradientOpacityDistance(-1)
        mapper.SetComponentMixingToMean()
        return mapper
    pictures = {}
    for name, mapper, prop in scenes(vtk, ours if "--ours" in sys.argv else usual):
        volume = vtk.vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(prop)
        if name == "shader":
            volume.GetShaderProperty().AddFragmentShaderReplacement("//VTK::Color::Dec", False, "//VTK::Color::Dec\n", False)
        if name == "array":
            mapper.SelectScalarArray("RTData")
        renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
        renderer.AddVolume(volume)
        window.SetMultiSamples(0)
        window.SetSize(*SIZE)
        window.AddRenderer(renderer)
        renderer.ResetCamera()
        renderer.GetActiveCamera().Azimuth(30)
        renderer.GetActiveCamera().Elevation(25)
        for _ in range(2):  # a refusal is said once
            window.Render()
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(window)
        grab.ReadFrontBufferOff()
        grab.Update()
        pictures[name] = vtk.util.numpy_support.vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).copy()
        pictures[name + ".class"] = numpy.array(mapper.GetClassName())
    numpy.savez(path, **pictures)


if "--draw" in sys.argv:
    draw(sys.argv[2])
    sys.exit(0)

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "factory")
os.makedirs(folder, exist_ok=True)


def run(name, *options, autoload=None):
    path = os.path.join(folder, name + ".npz")
    environment = dict(os.environ)
    environment.pop("VTK_AUTOLOAD_PATH", None)
    if autoload:
        environment["VTK_AUTOLOAD_PATH"] = autoload
    ran = subprocess.run([sys.executable, __file__, "--draw", path, *options], env=environment, capture_output=True, text=True)
    check(ran.returncode == 0, ran.stderr)
    return dict(numpy.load(path)), ran.stderr


if not os.path.isdir(FACTORY):
    print("SKIPPED: no factory was built here")
    sys.exit(77)
of_vtk, _ = run("vtk")
of_ours, _ = run("ours", "--ours")
changed, said = run("changed", autoload=FACTORY)
lines = [line for line in said.splitlines() if line.startswith("Stratus: ")]
apart = lambda a, b: int(abs(a.astype(int) - b).max())
for name in of_vtk:
    if name.endswith(".class"):
        continue
    if name in ("refused", "shader"):
        check(apart(changed[name], of_vtk[name]) == 0, f"{name}: VTK's own mapper draws, {apart(changed[name], of_vtk[name])} apart")
    else:
        check(apart(changed[name], of_ours[name]) == 0, f"{name}: ours draws to the bit, {apart(changed[name], of_ours[name])} apart")
        check(apart(changed[name], of_vtk[name]) > 0, f"{name}: and VTK's would be another picture")
    lit = (of_vtk[name].max(axis=1) > 20).mean()
    check(lit > 0.05, f"{name} shows: {lit}")
check(str(changed["gpu-lit.class"]) == "vtkStratusFactoryVolumeMapper" and str(changed["smart.class"]) == "vtkSmartVolumeMapper", "classes")
check(len(lines) == 2 and "nearest" in lines[0] and "shaders of its own" in lines[1], f"one line for each refusal: {lines}")

# A library that is not there, and none of VTK at all.
lonely = os.path.join(folder, "stratus", "factory")
shutil.rmtree(os.path.join(folder, "stratus"), ignore_errors=True)
shutil.copytree(FACTORY, lonely)
lonely_pictures, said = run("alone", autoload=lonely)
check(said.count("Stratus: its mappers can't be loaded") == 1, f"one line: {said}")
check(all((lonely_pictures[name] == of_vtk[name]).all() for name in of_vtk), "VTK's own draw")
entry = os.path.join(FACTORY, [name for name in os.listdir(FACTORY) if ".so" in name][0])
check(len(os.listdir(FACTORY)) == 1, f"VTK loads all that is there: {os.listdir(FACTORY)}")
without = subprocess.run([sys.executable, "-c", f"import ctypes; f = ctypes.CDLL({entry!r}).vtkGetFactoryVersion; f.restype = ctypes.c_char_p; print(f())"],
                         capture_output=True, text=True)
check("none" in without.stdout and "are for VTK 9." in without.stderr and "VTK's own draw" in without.stderr, f"{without}")
print("; ".join(f"{name} {apart(of_ours[name], of_vtk[name])}" for name in of_vtk if not name.endswith(".class")), "of 255 between ours and VTK's")
done()
