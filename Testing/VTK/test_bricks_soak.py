# SPDX-License-Identifier: BSD-3-Clause
"""Turning and stepping through the time steps of a file that is larger than the memory it may take, for long: pictures are the same whenever
a step is seen again from the same place, and memory, open files and threads do not grow.

Testing/run takes some twenty seconds and little memory. STRATUS_LONG=1 goes on for an hour in 512 MiB, or for as many seconds as
STRATUS_SOAK_SECONDS says."""
import hashlib
import os
import random
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Python"))
from checking import check, done, errors_of

import netCDF4
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import stratus

LONG = os.environ.get("STRATUS_LONG", "0") not in ("", "0")
SECONDS = float(os.environ.get("STRATUS_SOAK_SECONDS", 3600 if LONG else 20))
MEBIBYTE = 1 << 20
LIMIT, SIDE, STEPS = (512 * MEBIBYTE, 256, 16) if LONG else (48 * MEBIBYTE, 96, 24)
GROWTH = 8 * MEBIBYTE  # that the allocator's fragments may take
OPENING = 2000  # bytes that libnetcdf 4.9.0 loses each time it opens a file, which is once a step
OPEN = 8  # files that readers of the next step may have open when they are counted; one lost a step would be twenty a lap
VIEWS, FUNCTIONS = 6, 3

folder = os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "bricks_soak")
os.makedirs(folder, exist_ok=True)
os.chdir(folder)
os.environ["STRATUS_CACHE_DIR"] = os.path.join(folder, "cache")


def write():
    """Some balls that move, in noise of which most is too faint to show."""
    z, y, x = numpy.ogrid[tuple(slice(-1, 1, SIDE * 1j) for _ in range(3))]
    noise = numpy.random.default_rng(3).random((SIDE, SIDE, SIDE), "f4")
    with netCDF4.Dataset("soak.nc", "w") as file:
        for axis, count in (("time", STEPS), ("z", SIDE), ("y", SIDE), ("x", SIDE)):
            file.createDimension(axis, count)
        file.createVariable("time", "f8", ("time",))[:] = numpy.arange(STEPS)
        file["time"].units = "hours since 2001-01-01"
        rho = file.createVariable("rho", "f4", ("time", "z", "y", "x"), chunksizes=(1, 32, 32, 32), zlib=True, complevel=1)
        for step in range(STEPS):
            a = 2 * numpy.pi * step / STEPS
            balls = sum(numpy.exp(-20 * ((x - 0.5 * numpy.cos(a + b)) ** 2 + (y - 0.5 * numpy.sin(a + b)) ** 2 + (z - 0.2 * b) ** 2))
                for b in range(3))
            rho[step] = balls.astype("f4") + 0.1 * noise * (balls > 0.05)


def held():
    """Bytes of the process that are of no file, bricks included; the same without bricks, of which there are more or fewer by what was shown
    last; open files; threads."""
    with open("/proc/self/status") as status:
        lines = dict(line.split(":", 1) for line in status)
    kibibytes = int(lines["RssAnon"].split()[0]) + int(lines["RssShmem"].split()[0])
    return 1024 * kibibytes, 1024 * kibibytes - Reader.GetMemoryUsed(), len(os.listdir("/proc/self/fd")), int(lines["Threads"])


write()
Reader = stratus.vtkStratusVariableReader
Reader.SetMemoryLimit(LIMIT)
reader = stratus.vtkStratusCFReader()
reader.SetFileName("soak.nc")
reader.SetMapFile(True)
reader.SetMappedBytesLeast(0)
reader.UpdateTimeStep(0.0)
if not reader.GetMapped():
    print("SKIPPED: this system offers no pages that stop their readers")
    sys.exit(77)
mapper, volume = stratus.vtkStratusVolumeMapper(), vtk.vtkVolume()
mapper.SetInputConnection(reader.GetOutputPort())
errors, again = [errors_of(mapper), errors_of(reader)], []
mapper.AddObserver(vtk.vtkCommand.UpdateEvent, lambda *_: again.append(1))
volume.SetMapper(mapper)
opacity, color = volume.GetProperty().GetScalarOpacity(), volume.GetProperty().GetRGBTransferFunction()
volume.GetProperty().SetInterpolationTypeToLinear()
volume.GetProperty().SetScalarOpacityUnitDistance(SIDE / 20)
color.RemoveAllPoints(), color.AddRGBPoint(0, 0.1, 0.3, 0.9), color.AddRGBPoint(1, 0.9, 0.4, 0.1)
window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
window.SetOffScreenRendering(1), window.SetMultiSamples(0), window.SetSize(160, 120)
window.AddRenderer(renderer), renderer.AddVolume(volume)
grab = vtk.vtkWindowToImageFilter()
grab.SetInput(window), grab.ReadFrontBufferOff(), grab.ShouldRerenderOff()


def draw(step, view, function):
    """The exact picture's digest. On the way there are coarse ones, and pictures of a camera that moves."""
    reader.UpdateTimeStep(float(step))
    opacity.RemoveAllPoints(), opacity.AddPoint(0.1 + 0.2 * function, 0), opacity.AddPoint(1.2, 0.9)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(1, 0, 0), camera.SetFocalPoint(0, 0, 0), camera.SetViewUp(0, 0, 1)
    camera.Azimuth(360 * view / VIEWS), camera.Elevation(20)
    renderer.ResetCamera()
    window.SetDesiredUpdateRate(15)  # the camera moves
    window.Render()
    window.SetDesiredUpdateRate(0.001)
    again.append(1)
    while again:
        again.clear()
        window.Render()
    check(not mapper.GetLastPictureIsCoarse(), "the last picture is exact")
    grab.Modified(), grab.Update()
    return hashlib.sha1(vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).tobytes()).hexdigest()


chance, seen, laps, pictures, wrong, step, steps = random.Random(7), {}, [], 0, 0, 0, 0
begin = time.monotonic()
while time.monotonic() - begin < SECONDS:
    for _ in range(20):
        step = (step + 1) % STEPS if chance.random() < 0.7 else chance.randrange(STEPS)
        steps += 1
        for _ in range(chance.randrange(1, 4)):
            case = step, chance.randrange(VIEWS), chance.randrange(FUNCTIONS)
            digest = draw(*case)
            wrong += seen.setdefault(case, digest) != digest
            pictures += 1
    laps.append(held())
check(wrong == 0, f"{wrong} of {pictures} pictures differ from those that were drawn before")
check(len(set(seen.values())) > 0.9 * len(seen), "different cases are different pictures")
check(not any(errors), f"no errors: {errors}")
check(Reader.GetMemoryUsed() <= LIMIT, "bricks are within the limit")
quarter = max(1, len(laps) // 4)
for name, place, growth in (("bytes beside bricks", 1, GROWTH + OPENING * steps), ("open files", 2, OPEN), ("threads", 3, 0)):
    early, late = max(lap[place] for lap in laps[:2 * quarter]), max(lap[place] for lap in laps[-quarter:])
    check(late <= early + growth, f"{name} do not grow: {early} at most in the first half, {late} at the end")
print(f"{pictures} pictures of {len(seen)} cases in {time.monotonic() - begin:.0f} s; {Reader.GetBytesRead() / 1e9:.1f} GB were read; "
    f"at most {max(lap[0] for lap in laps) / MEBIBYTE:.0f} MiB, {max(lap[1] for lap in laps) / MEBIBYTE:.1f} beside bricks "
    f"({laps[0][1] / MEBIBYTE:.1f} after the first lap, {laps[-1][1] / MEBIBYTE:.1f} after the last), {max(lap[2] for lap in laps)} files, "
    f"{max(lap[3] for lap in laps)} threads")
done()
