# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: ParaView's light kit on a volume whose gradient is the same everywhere, against the formula and a surface.

Two of the kit's lights come from behind. A surface that faces the eye has its back to them, so they add nothing, on ParaView's surfaces and
here: the normal is turned towards the eye before any light is looked at. VTK's own volume mapper (vtkVolumeShaderComposer) takes
the magnitude of N L for each light by itself, so that lights from behind shine through; ParaView's "Volume" is that much brighter.
pvbatch test_lights.py PLUGIN STRATUS COMPARE-PICTURES FOLDER."""
import os
import sys
from math import cos, radians

import numpy
from paraview import simple
from paraview.vtk import vtkIOXML, vtkCommonDataModel
from paraview.vtk.util.numpy_support import numpy_to_vtk

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import check, folder, leave, load, shot
from showing import make_view, show_volume

COLOR = 0.8
# The kit's lights: intensity, and the cosine of the angle between the way to the light and the way to the eye.
INTENSITY, TO_FILL, TO_BACK, TO_HEAD = 0.75, 3.0, 3.5, 3.0
LIGHTS = [(INTENSITY, cos(radians(50)) * cos(radians(10))), (INTENSITY / TO_FILL, cos(radians(-75)) * cos(radians(-10))),
          (INTENSITY / TO_HEAD, 1.0), (INTENSITY / TO_BACK, cos(radians(110))), (INTENSITY / TO_BACK, cos(radians(-110)))]


def write_ramp(path):
    n = 24
    image = vtkCommonDataModel.vtkImageData()
    image.SetDimensions(n, n, n)
    values = numpy_to_vtk(numpy.tile(numpy.arange(n, dtype=numpy.float32), n * n), deep=True)  # along x
    values.SetName("ramp")
    image.GetPointData().SetScalars(values)
    writer = vtkIOXML.vtkXMLImageDataWriter()
    writer.SetInputData(image)
    writer.SetFileName(path)
    check(writer.Write() == 1, "the ramp is written")


load()
path = os.path.join(folder, "ramp.vti")
write_ramp(path)
view = make_view(200, 200)
view.UseLight = 1
view.KeyLightWarmth = view.FillLightWarmth = view.BackLightWarmth = view.HeadLightWarmth = 0.5  # all lights are white
view.KeyLightIntensity, view.FillLightKFRatio, view.BackLightKBRatio, view.HeadLightKHRatio = INTENSITY, TO_FILL, TO_BACK, TO_HEAD
view.KeyLightElevation, view.KeyLightAzimuth, view.FillLightElevation, view.FillLightAzimuth = 50, 10, -75, -10
view.BackLightElevation, view.BackLightAzimuth = 0, 110
_, shown = show_volume(path, "ramp", [(-1, 0.999), (30, 0.999)], [(-1, COLOR, COLOR, COLOR), (30, COLOR, COLOR, COLOR)], 0.05, view)
shown.StratusShade, shown.Ambient, shown.Diffuse, shown.Specular = 1, 0, 1, 0
facing = COLOR * sum(intensity * max(cosine, 0) for intensity, cosine in LIGHTS)
through = COLOR * sum(intensity * abs(cosine) for intensity, cosine in LIGHTS)
for side, x in ("rising", -100), ("falling", 123):  # the value along the rays
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [x, 11.5, 11.5], [11.5, 11.5, 11.5], [0, 0, 1]
    view.CameraParallelProjection, view.CameraParallelScale = 1, 8
    for name, expected in ("Stratus Volume", facing), ("Volume", through):
        shown.SetRepresentationType(name)
        if name == "Volume":
            shown.Shade = 1
        seen = shot(view, f"ramp-{side}-{name.replace(' ', '-')}").reshape(200, 200, 3)[100, 100]
        print(f"{side}, {name}: {255 * seen[0]:.0f} of 255, expected {255 * expected:.1f}")
        check(abs(seen - expected).max() * 255 < 1.5, f"{side}: {name} is lit as the formula says")
# Of a light at the eye, half reaches even, thick matter that the eye sees: both ways have the same optical depth.
view.UseLight = 0
lamp = simple.AddLight(view=view)
lamp.Coords, lamp.Position, lamp.FocalPoint = "Camera", [0, 0, 1], [0, 0, 0]
lamp.Intensity = 0.3
half = lamp.Intensity * COLOR / 2
simple.Hide(shown.Input, view)
cells = simple.Tetrahedralize(Input=shown.Input)
grid = simple.Show(cells, view, "UnstructuredGridRepresentation")
simple.ColorBy(grid, ("POINTS", "ramp"))
grid.SetRepresentationType("Stratus Volume")
grid.StratusCellsShade, grid.Ambient, grid.Diffuse, grid.Specular = 1, 0, 1, 0
simple.Hide(cells, view)
for kind, display, source, prefix in ("image", shown, shown.Input, "Stratus"), ("cells", grid, cells, "StratusCells"):
    simple.Show(source, view)
    display.SetRepresentationType("Stratus Volume")
    display.StratusUnitDistance = 4
    setattr(display, prefix + "ImageErrorTolerance", 0.002)
    light = []
    for name, changes, expected in (("shadows", dict(Shadows=1), half), ("scattered", dict(Scattering=2), half),
                                    ("again", dict(MultipleScattering=1), None), ("sky", dict(SkyZenith=[0, 0, 0.2], SkyHorizon=[0, 0, 0.2]), None)):
        for change, value in changes.items():
            setattr(display, prefix + change, value)
        light.append(shot(view, f"ramp-{kind}-{name}").reshape(200, 200, 3)[100, 100])
        print(f"{kind}, {name}: {255 * light[-1][0]:.1f} of 255" + (f", expected {255 * expected:.1f}" if expected else ""))
        check(expected is None or abs(light[-1] - expected).max() * 255 < 2, f"{kind}: {name} follows the formula")
    check(light[2].min() > light[1].min() + 0.05, f"{kind}: light that is scattered again adds to that which is scattered once")
    check(light[3][2] > light[2][2] + 0.05 and abs(light[3] - light[2])[0] < 0.01, f"{kind}: a blue sky lights blue")
    simple.Hide(source, view)
simple.RemoveLight(lamp)
view.UseLight = 1
sheet = simple.Show(simple.Plane(Origin=[20, 0, 0], Point1=[20, 23, 0], Point2=[20, 0, 23]), view)
sheet.Ambient, sheet.Diffuse, sheet.Specular = 0, 1, 0
sheet.AmbientColor = sheet.DiffuseColor = 3 * [COLOR]
seen = shot(view, "ramp-surface").reshape(200, 200, 3)[100, 100]
print(f"a surface: {255 * seen[0]:.0f} of 255, expected {255 * facing:.1f}")
check(abs(seen - facing).max() * 255 < 1.5, "a surface that faces the eye is lit as the volume is")
leave()
