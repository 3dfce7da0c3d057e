#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Light that is scattered once, by vtkOpenGLGPUVolumeRayCastMapper of VTK 9.2 and later, next to `stratus-bench light`.

Usage: vtk_gpu.py FOLDER CSV [SIZE [SECONDS [STEP,... [SCENE,...]]]]

FOLDER is that of `stratus-bench light --light single --export FOLDER`: scenes, cameras, the sun, and the path tracer's images of views 0
and 4. CSV is the table of that run, to which rows of the method vtk:gpu-VERSION are added. Needs a display (xvfb-run), and numpy.

The mapper has GlobalIlluminationReach 1 and VolumetricScatteringBlending 2: a ray goes from each sample to the light. SIZE: pixels each way
of the frames that are timed (default 512), of views 0 and 4. SECONDS: for the repeats of a view (default 60). STEP: sample distances in
voxels, which the methods' names have behind a colon (default 2,1). SCENE: default all that the folder has. Errors are measured at the size of
the path tracer's images, over the pixels that either image shows; the noise of the paths is subtracted.
"""
import json
import os
import statistics
import sys
import time

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def pipeline(scene, folder, step, size, lit):
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(os.path.join(folder, scene["name"] + ".vti"))
    reader.Update()
    mapper = vtk.vtkGPUVolumeRayCastMapper()
    mapper.SetInputData(reader.GetOutput())
    mapper.AutoAdjustSampleDistancesOff()
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.UseJitteringOff()
    mapper.SetImageSampleDistance(1.0)
    mapper.SetSampleDistance(step * scene["voxel"])
    opacity, color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    opacity.AllowDuplicateScalarsOn()
    color.AllowDuplicateScalarsOn()
    for value, alpha in scene["opacity"]:
        opacity.AddPoint(value, alpha)
    for value, red, green, blue in scene["color"]:
        color.AddRGBPoint(value, red, green, blue)
    material = vtk.vtkVolumeProperty()
    material.SetInterpolationTypeToLinear()
    material.SetScalarOpacity(opacity)
    material.SetColor(color)
    material.SetScalarOpacityUnitDistance(scene["unit_distance"])
    if lit:
        material.ShadeOn()
        material.SetAmbient(0.0)
        material.SetDiffuse(1.0)
        material.SetSpecular(0.0)
        material.SetScatteringAnisotropy(0.0)
        mapper.SetGlobalIlluminationReach(1.0)
        mapper.SetVolumetricScatteringBlending(2.0)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(material)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.SetBackgroundAlpha(0.0)
    renderer.AutomaticLightCreationOff()
    sun = vtk.vtkLight()
    sun.SetLightTypeToSceneLight()
    sun.PositionalOff()
    sun.SetPosition(scene["sun"])
    sun.SetFocalPoint(0, 0, 0)
    renderer.AddLight(sun)
    renderer.AddVolume(volume)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetAlphaBitPlanes(1)
    window.SetSize(size, size)
    window.AddRenderer(renderer)
    return window, renderer


def look(renderer, camera):
    to = renderer.GetActiveCamera()
    to.SetPosition(camera["eye"])
    to.SetFocalPoint(camera["focal"])
    to.SetViewUp(camera["up"])
    to.SetViewAngle(camera["angle"])
    renderer.ResetCameraClippingRange()


def frame(window):
    start = time.perf_counter()
    window.Render()
    window.WaitForCompletion()
    return 1e3 * (time.perf_counter() - start)


def times(scene, folder, step, size, lit, seconds):
    """Median over the judged views of the median frame of each."""
    window, renderer = pipeline(scene, folder, step, size, lit)
    look(renderer, scene["cameras"][0])
    frame(window)
    medians = []
    for view in scene["paths"]:
        look(renderer, scene["cameras"][int(view)])
        start, ms = time.perf_counter(), []
        while len(ms) < 3 and time.perf_counter() - start < seconds:
            ms.append(frame(window))
        medians.append(statistics.median(ms))
    return statistics.median(medians)


def image(window, size):
    pixels = vtk.vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, size - 1, size - 1, 0, pixels)
    return vtk_to_numpy(pixels).reshape(size, size, 4) / 255.0


def error_of(scene, folder, step):
    """The error, and bounds by the noise that is left, as light_judge.cxx has them."""
    squares = []
    for view, name in scene["paths"].items():
        floats = np.fromfile(os.path.join(folder, name), np.float32).astype(float)
        paths, deviations = floats.reshape(2, -1, 4)
        size = int(round(len(paths) ** 0.5))
        window, renderer = pipeline(scene, folder, step, size, True)
        look(renderer, scene["cameras"][int(view)])
        window.Render()
        drawn = image(window, size).reshape(-1, 4)
        shown = (drawn[:, 3] > 0) | (paths[:, 3] > 0)
        squares.append(((drawn - paths)[shown] ** 2 - deviations[shown] ** 2).mean(axis=1))
    squares = np.concatenate(squares)
    deviation = squares.std() / len(squares) ** 0.5
    return [max(squares.mean() + sigmas * deviation, 0.0) ** 0.5 for sigmas in (-2, 0, 2)]


def main():
    folder, table = sys.argv[1], sys.argv[2]
    size, seconds = int(sys.argv[3]) if len(sys.argv) > 3 else 512, float(sys.argv[4]) if len(sys.argv) > 4 else 60.0
    with open(os.path.join(folder, "scenes.json"), encoding="utf-8") as file:
        scenes = json.load(file)
    steps = [float(step) for step in sys.argv[5].split(",")] if len(sys.argv) > 5 else [2.0, 1.0]
    names = sys.argv[6].split(",") if len(sys.argv) > 6 else [scene["name"] for scene in scenes]
    version = vtk.vtkVersion().GetVTKVersion()
    with open(table, "a", encoding="utf-8") as file:
        for scene in (scene for scene in scenes if scene["name"] in names):
            for step in steps:
                method = f"vtk:gpu-{version}:{step:g}"
                lit, unlit = (times(scene, folder, step, size, light, seconds) for light in (True, False))
                low, error, high = error_of(scene, folder, step)
                measured = {"frame_ms": lit, "unlit_ms": unlit, "ratio": lit / unlit, "error_low": low, "error_high": high}
                if high - low <= error:  # otherwise it is the paths' noise
                    measured["error"] = error
                for metric, value in measured.items():
                    file.write(f"light,{scene['name']},{method},{metric},{value:.9g},{'ms' if metric.endswith('_ms') else '1'}\n")
                print(f"{scene['name']}, {method}: {lit:.0f} ms, unlit {unlit:.0f} ms, error {error:.3g} ({low:.3g} to {high:.3g})", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
