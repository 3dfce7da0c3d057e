# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of rays (SetQuantities) on every grid, with what cuts and hides, against sums in double precision along the same rays."""
import os
import sys

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import matrix_reference as reference
import matrix_scenes as scenes

NAMES = "integral length mean maximum maximum_depth cells transmittance transmittance_depth".split()
THRESHOLD = 0.6
CASES = [("image", ()), ("tetrahedra", ("clip",)), ("tetrahedra", ("mask",)), ("amr", ()), ("rectilinear", ("mask",)), ("blocks", ("crop",)), ("several", ()), ("image_and_mesh", ())]
if os.environ.get("STRATUS_LONG"):
    CASES += [(grid, features) for grid in scenes.GRIDS for features in ((), ("clip",))]
    CASES += [(grid, (feature,)) for grid in ("image", "rectilinear", "blocks", "amr", "several") for feature in ("mask", "crop")]
    CASES += [("image", ("two_components",)), ("tetrahedra", ("two_components",)), ("image", ("light", "gradient_opacity"))]
LIMITS = {"maximum": 1e-3, "maximum_depth": 4e-3, "transmittance": 2e-3, "transmittance_depth": 3e-3}  # of a number's largest
CUT = {"clip": 6e-3, "crop": 6e-3, "mask": 2e-2}  # more, because the reference sees an edge only to its step, and a mask has many
failures = 0


def check(good, what):
    global failures
    if not good:
        failures += 1
        print(f"FAILED: {what}")


def settings_of(volume):
    if hasattr(volume, "GetVolume"):  # the settings of the first hold for all
        return volume.GetVolume(0).GetMapper()
    mapper = volume.GetMapper()
    return mapper.GetSettings() if hasattr(mapper, "GetSettings") else mapper


def drawn(grid, features, device, names=" ".join(NAMES)):
    window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1)
    window.SetSize(scenes.SIZE, scenes.SIZE)
    window.SetMultiSamples(0)
    window.AddRenderer(renderer)
    volume, teller = scenes.scene(grid, "composite", features, device)
    settings_of(volume).SetQuantities(names)
    settings_of(volume).SetTransmittanceThreshold(THRESHOLD)
    settings_of(volume).SetImageErrorTolerance(1e-4)
    renderer.AddVolume(volume)
    renderer.ResetCamera()
    renderer.GetActiveCamera().Azimuth(30)
    renderer.GetActiveCamera().Elevation(20)
    renderer.ResetCameraClippingRange()
    window.Render()
    return teller, renderer


def arrays_of(image):
    data = image.GetPointData()
    return {data.GetArrayName(n): vtk_to_numpy(data.GetArray(n)).astype(float) for n in range(data.GetNumberOfArrays())}


def expected(grid, features, renderer):
    camera = numpy.array(renderer.GetActiveCamera().GetDirectionOfProjection())
    eye = numpy.array(renderer.GetActiveCamera().GetPosition())
    parts = {"several": ("image", "second"), "image_and_mesh": ("image", "tetrahedra")}.get(grid, (grid,))
    layers = [reference.Layer(part, features if n == 0 else (), "composite", camera) for n, part in enumerate(parts)]
    eyes, ways = reference.rays_of(renderer)
    some, first, last, steps = reference.samples(layers, eyes, ways)
    rays = len(eyes)
    integral, length, largest = numpy.zeros(rays), numpy.zeros(rays), numpy.full(rays, -numpy.inf)
    where, passed, falls = numpy.full(rays, numpy.nan), numpy.ones(rays), numpy.full(rays, numpy.nan)
    from_eye = numpy.linalg.norm(eyes - eye, axis=-1)  # the reference's rays begin at the near plane
    for n in range(steps):
        s = first + (n + 0.5) * reference.STEP
        at = some[s[some] - 0.5 * reference.STEP < last[some]]
        extent = numpy.minimum(last[at] - (s[at] - 0.5 * reference.STEP), reference.STEP)
        points = eyes[at] + (s[at] - 0.5 * reference.STEP + 0.5 * extent)[:, None] * ways[at]
        depth = numpy.zeros(len(at))
        for layer in layers:
            value = layer.value_at(points)
            has = numpy.isfinite(value[:, 0])
            integral[at[has]] += value[has, 0] * extent[has]
            length[at[has]] += extent[has]
            better = has & (value[:, 0] > largest[at])
            largest[at[better]], where[at[better]] = value[better, 0], (from_eye[at] + s[at])[better]
            tau = numpy.zeros(len(at))
            tau[has] = layer.shade(points[has], ways[at[has]], value[has])[0]
            depth += tau * extent
        before = passed[at]
        passed[at] *= numpy.exp(-depth)
        falling = (before >= THRESHOLD) & (passed[at] < THRESHOLD)
        part = numpy.log(before[falling] / THRESHOLD) / depth[falling]
        falls[at[falling]] = (from_eye[at] + s[at] - 0.5 * reference.STEP)[falling] + part * extent[falling]
    with numpy.errstate(invalid="ignore"):
        mean = integral / length
    return dict(integral=integral, length=length, mean=mean, maximum=numpy.where(length > 0, largest, numpy.nan), maximum_depth=where,
                transmittance=passed, transmittance_depth=falls)


def compare(grid, features, device):
    name = " ".join([grid, *features, device])
    teller, renderer = drawn(grid, features, device)
    check(not teller.GetLastError(), f"{name}: {teller.GetLastError()}")
    arrays, wanted = arrays_of(teller.GetLastImage()), expected(grid, features, renderer)
    check(set(NAMES) <= set(arrays), f"{name}: arrays {sorted(arrays)}")
    well = wanted["length"] > 2.0  # rays along the rim differ by a whole step of the reference
    check(well.sum() > 150, f"{name}: {well.sum()} rays")
    line = []
    for quantity, want in wanted.items():
        is_ = arrays[quantity]
        both = well & numpy.isfinite(is_) & numpy.isfinite(want)
        missing = (well & (numpy.isfinite(is_) != numpy.isfinite(want))).sum()
        scale = numpy.abs(want[both]).max() if both.any() else 1.0
        off = numpy.abs(is_ - want)[both] / scale
        # The place of a largest value jumps between two that are nearly equal, and the step of the reference is 1/24.
        worst = numpy.quantile(off, 0.98) if both.any() else 0.0
        limit = LIMITS.get(quantity, 2e-4 if len(features) == 0 and "several" != grid else 2e-3) + sum(CUT.get(feature, 0) for feature in features)
        line.append(f"{quantity} {worst:.1e}")
        check(worst < limit, f"{name}: {quantity} is {worst:.2e} of its largest off")
        check(missing <= 0.02 * well.sum(), f"{name}: {quantity}: {missing} rays have a number in one and none in the other")
    cells = arrays["cells"]
    check((cells[well] >= 1).all() and (cells[arrays["length"] == 0] == 0).all(), f"{name}: cells")
    check((arrays["integral"][arrays["length"] == 0] == 0).all() and numpy.isnan(arrays["mean"][arrays["length"] == 0]).all(), f"{name}: where there is nothing")
    print(f"{name}: {', '.join(line)}; at most {int(cells.max())} cells", flush=True)


def bad_names_are_errors():
    for grid in "image", "tetrahedra", "blocks", "several":
        vtk.vtkObject.GlobalWarningDisplayOff()
        teller, _ = drawn(grid, (), "host", "integral density")
        vtk.vtkObject.GlobalWarningDisplayOn()
        check("quantity 'density' must be one of integral, length" in teller.GetLastError(), f"{grid}: {teller.GetLastError()!r}")
        check(teller.GetLastImage() is None, f"{grid}: a refused picture has an image")


def arrays_are_only_those_asked_for():
    teller, _ = drawn("image", (), "host", "maximum, mean")
    check(set(arrays_of(teller.GetLastImage())) == {"RGBA", "Depth", "maximum", "mean"}, "arrays of two quantities")
    teller, _ = drawn("image", (), "host", "")
    check(set(arrays_of(teller.GetLastImage())) == {"RGBA", "Depth"}, "arrays of none")


for number, (grid, features) in enumerate(CASES):
    compare(grid, features, "host")
    if number < 2:
        compare(grid, features, "pthread")
bad_names_are_errors()
arrays_are_only_those_asked_for()
print(f"{failures} failures")
sys.exit(1 if failures else 0)
