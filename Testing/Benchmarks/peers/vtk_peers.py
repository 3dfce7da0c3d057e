#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""VTK's mappers of this Python's VTK next to the package stratus_volume, in one process and in turns. `vtk-from-pypi` runs it.

Usage: vtk_peers.py BUILD ROUNDS SIZE SCENE|MESH.vtu ...

BUILD is a build folder with libstratus-scenes.so and, in the module path, stratus_volume. Rows of stratus-bench's tables go to the standard
output. Needs a display (xvfb-run), or EGL, which VTK's wheel finds by itself. A round draws two views by each method. VERSION is VTK's:

  vtk:fixedpoint-VERSION:STEP  vtkFixedPointVolumeRayCastMapper, with its automatic adjustments off; STEP in voxels
  vtk:empty-VERSION            the window without a volume
  vtk:raycast-VERSION, vtk:projected-VERSION  of meshes: vtkUnstructuredGridVolumeRayCastMapper, vtkProjectedTetrahedraMapper
  stratus:auto~TOLERANCE+vtk-VERSION          stratus_volume, which draws into an array and needs no window

  frame_ms, cpu_ms  of a whole Render(), or of the call: time, and processor time of all threads. Mean over the views of the rounds' medians
  psnr8_db          of the window's bytes, compared with stratus_volume at the tolerance 1e-6, over the pixels that either shows
"""
import ctypes
import math
import os
import statistics
import sys
import time

import numpy as np
import stratus_volume
import vtk
from stratus_volume import _core, _declarations
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

VERSION = vtk.vtkVersion().GetVTKVersion()
EXACT = "exact"
VIEWS = 0, 4  # of the 8 of scenes of record


def functions(opacity, color, unit_distance):
    to_opacity, to_color = vtk.vtkPiecewiseFunction(), vtk.vtkColorTransferFunction()
    to_opacity.AllowDuplicateScalarsOn()
    to_color.AllowDuplicateScalarsOn()
    for point in opacity:
        to_opacity.AddPoint(*point)
    for point in color:
        to_color.AddRGBPoint(*point)
    look = vtk.vtkVolumeProperty()
    look.SetInterpolationTypeToLinear()
    look.SetScalarOpacity(to_opacity)
    look.SetColor(to_color)
    look.SetScalarOpacityUnitDistance(unit_distance)
    return look


def fixed_point(image, step):
    mapper = vtk.vtkFixedPointVolumeRayCastMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.LockSampleDistanceToInputSpacingOff()
    mapper.SetImageSampleDistance(1)
    mapper.SetMinimumImageSampleDistance(1)
    mapper.SetMaximumImageSampleDistance(1)
    mapper.SetSampleDistance(step)
    mapper.SetInteractiveSampleDistance(step)
    mapper.SetInputData(image)
    return mapper


def ray_cast(grid):
    mapper = vtk.vtkUnstructuredGridVolumeRayCastMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetImageSampleDistance(1)
    mapper.SetInputData(grid)
    return mapper


def projected(grid):
    mapper = vtk.vtkProjectedTetrahedraMapper()
    mapper.SetInputData(grid)
    return mapper


def camera_of(eye, focal, up, angle):
    camera = vtk.vtkCamera()
    camera.SetPosition(eye)
    camera.SetFocalPoint(focal)
    camera.SetViewUp(up)
    camera.SetViewAngle(angle)
    return camera


class Scene:
    """A scene, its cameras, and its methods: functions of a camera, which return both times in seconds, and bytes."""

    def __init__(self, name, size, cameras):
        self.name, self.size, self.cameras, self.methods, self.volumes = name, size, cameras, {}, {}
        self.renderer, self.window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
        self.renderer.SetBackground(0, 0, 0)
        self.renderer.SetBackgroundAlpha(0)
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetAlphaBitPlanes(1)
        self.window.SetSize(size, size)
        self.window.AddRenderer(self.renderer)
        self.add_mapper(f"vtk:empty-{VERSION}", None, None)

    def add_mapper(self, name, mapper, look):
        if mapper:
            volume = vtk.vtkVolume()
            volume.SetMapper(mapper)
            volume.SetProperty(look)
            self.renderer.AddVolume(volume)
            self.volumes[name] = volume

        def draw(camera):
            for each, volume in self.volumes.items():
                volume.SetVisibility(each == name)
            self.renderer.SetActiveCamera(camera)
            self.renderer.ResetCameraClippingRange()
            times = timed(lambda: (self.window.Render(), self.window.WaitForCompletion()))
            pixels = vtk.vtkUnsignedCharArray()
            self.window.GetRGBACharPixelData(0, 0, self.size - 1, self.size - 1, 0, pixels)
            return times, vtk_to_numpy(pixels).reshape(self.size, self.size, 4)[::-1]

        self.methods[name] = draw

    def add_ours(self, drawn, look):
        def at(tolerance):
            def draw(camera):
                result = []
                times = timed(lambda: result.append(drawn.render(size=(self.size, self.size), camera=camera, tolerance=tolerance, **look)))
                return times, np.rint(result[0].rgba * 255)
            return draw

        for tolerance in 0.001, 0.0126:
            self.methods[f"stratus:auto~{tolerance}+vtk-{VERSION}"] = at(tolerance)
        self.methods[EXACT] = at(1e-6)

    def measure(self, rounds):
        pictures = {name: [draw(camera)[1] for camera in self.cameras] for name, draw in self.methods.items()}
        exact = pictures.pop(EXACT)
        times = {name: [[] for _ in self.cameras] for name in pictures}
        for turn in range(rounds):
            for view, camera in enumerate(self.cameras):
                for name in pictures if turn % 2 else reversed(pictures):
                    times[name][view].append(self.methods[name](camera)[0])
        for name, drawn in pictures.items():
            for metric, index in ("frame_ms", 0), ("cpu_ms", 1):
                value = statistics.mean(statistics.median(each[index] for each in of_view) for of_view in times[name])
                self.row(name, metric, 1e3 * value, "ms")
            if not name.startswith("vtk:empty"):
                self.row(name, "psnr8_db", psnr(drawn, exact), "dB")

    def row(self, method, metric, value, unit):
        print(f"vtk-peers,{self.name},{method},{metric},{value:.9g},{unit}", flush=True)


def timed(call):
    start = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - start[0], time.process_time() - start[1]


def psnr(pictures, exact):
    squares = count = 0
    for drawn, right in zip(pictures, exact):
        if not drawn.any():
            raise SystemExit("a picture shows nothing")
        shown = (drawn[..., 3] > 0) | (right[..., 3] > 0)
        squares += ((drawn[shown].astype(float) - right[shown]) ** 2).sum()
        count += 4 * shown.sum()
    return -10 * math.log10(max(squares, 1e-9) / count / 255 ** 2)


class SceneOfRecord(ctypes.Structure):
    """The struct stratus_scene of scenes.h."""
    _fields_ = [("name", ctypes.c_char_p), ("volume", _declarations.stratus_volume), ("transfer", _declarations.stratus_transfer),
                ("edited", _declarations.stratus_transfer), ("transfers", ctypes.c_void_p), ("up_axis", ctypes.c_int),
                ("occupied", ctypes.c_double), ("mean", ctypes.c_double)]


def array_at(address, shape, dtype):
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    return np.frombuffer((ctypes.c_uint8 * size).from_address(address), dtype).reshape(shape)


def scene_of_record(build, name, size):
    context, library = _core.context("host"), ctypes.CDLL(os.path.join(build, "lib", "libstratus-scenes.so"))
    made, camera = ctypes.POINTER(SceneOfRecord)(), _declarations.stratus_camera()
    context.call(library.stratus_scene_create, context.pointer, name.encode(), ctypes.byref(made))
    volume, transfer, up = made.contents.volume, made.contents.transfer, made.contents.up_axis
    dtype = {1: np.uint8, 3: np.uint16, 8: np.float32}[volume.type]
    image = vtk.vtkImageData()
    image.SetDimensions(*volume.dimensions)
    image.SetSpacing(*volume.spacing)
    image.SetOrigin(*volume.origin)
    image.GetPointData().SetScalars(numpy_to_vtk(array_at(volume.values, (np.prod(volume.dimensions),), dtype), deep=1))
    bounds = (ctypes.c_double * 6)(*image.GetBounds())
    cameras = []
    for view in VIEWS:
        context.call(library.stratus_scene_camera, context.pointer, bounds, up, view, 0, ctypes.c_double(1), ctypes.byref(camera))
        cameras.append(camera_of(camera.eye, image.GetCenter(), np.eye(3)[up], 21.6))
    look = dict(opacity=array_at(transfer.opacity, (transfer.opacity_count, 2), float).tolist(),
                color=array_at(transfer.color, (transfer.color_count, 4), float).tolist(), unit_distance=transfer.unit_distance)
    scene = Scene(name, size, cameras)
    for step, suffix in (1, ""), (0.5, ":0.5"):
        scene.add_mapper(f"vtk:fixedpoint-{VERSION}{suffix}", fixed_point(image, step * min(volume.spacing)), functions(**look))
    scene.add_ours(stratus_volume.Volume(image), look)
    return scene


def scene_of_mesh(path, size):
    """The function `ramp` of stratus-bench tetra, but linear in the attenuation, which VTK's mappers of cells read instead of opacity."""
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    middle, radius = np.array(grid.GetCenter()), 0.5 * grid.GetLength()
    cameras = []
    for view in VIEWS:
        azimuth, elevation = math.radians(30 + 45 * view), math.radians(25)
        away = np.array([math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)])
        cameras.append(camera_of(middle + radius / math.sin(math.radians(15)) * away, middle, (0, 0, 1), 21.6))
    low, high = grid.GetPointData().GetScalars().GetRange()
    ramp = np.linspace((low, 0.05), (high, 0.9), 257)
    look = dict(color=[(low, 0, 0, 1), (high, 1, 0.8, 0)], unit_distance=radius / 8)
    attenuation = functions(ramp[[0, -1]].tolist(), **look)
    scene = Scene(os.path.splitext(os.path.basename(path))[0], size, cameras)
    scene.add_mapper(f"vtk:raycast-{VERSION}", ray_cast(grid), attenuation)
    scene.add_mapper(f"vtk:projected-{VERSION}", projected(grid), attenuation)
    scene.add_ours(stratus_volume.Tetrahedra(grid), dict(look, opacity=[(value, 1 - math.exp(-each)) for value, each in ramp]))
    return scene


def main():
    build, rounds, size = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    for name in sys.argv[4:]:
        (scene_of_mesh(name, size) if name.endswith(".vtu") else scene_of_record(build, name, size)).measure(rounds)


if __name__ == "__main__":
    main()
