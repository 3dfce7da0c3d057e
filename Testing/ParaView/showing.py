# SPDX-License-Identifier: BSD-3-Clause
"""A file as "Stratus Volume" in a view of ParaView."""
import os

from paraview import simple

READERS = {".vti": ("XMLImageDataReader", "UniformGridRepresentation"), ".vtr": ("XMLRectilinearGridReader", "UniformGridRepresentation"),
           ".vtu": ("XMLUnstructuredGridReader", "UnstructuredGridRepresentation"),
           ".vts": ("XMLStructuredGridReader", "StructuredGridRepresentation"),
           ".nc": ("StratusCFReader", "UniformGridRepresentation"),
           ".vtm": ("XMLMultiBlockDataReader", "UnstructuredGridRepresentation"), ".vthb": ("XMLUniformGridAMRReader", "AMRRepresentation")}


def make_view(width, height):
    view = simple.CreateView("RenderView")
    view.ViewSize = [width, height]
    view.UseColorPaletteForBackground = 0
    view.Background = [0, 0, 0]
    view.OrientationAxesVisibility = 0
    view.UseFXAA = 0  # it blurs where colours change fast
    return view


def show_volume(path, array, opacity, color, unit, view, representation=None, component=None, of="POINTS"):
    """Returns the file's reader and its representation. representation: where the reader's is another; component: of a vector, by name; of:
    what the array is of, POINTS or CELLS."""
    reader, usual = READERS[os.path.splitext(path)[1]]
    source = getattr(simple, reader)(FileName=[path])
    if hasattr(source, "DefaultNumberOfLevels"):
        source.DefaultNumberOfLevels = 0  # all of them
    if reader == "StratusCFReader":  # values stay in the file, however few they are
        source.LeaveValuesInFile = 1
        source.LeastBytesLeftInFile = 0
    source.UpdatePipeline()
    shown = simple.Show(source, view, representation or usual)
    simple.ColorBy(shown, (of, array, component) if component else (of, array))
    look, fade = simple.GetColorTransferFunction(array), simple.GetOpacityTransferFunction(array)
    look.ColorSpace, look.UseLogScale = "RGB", 0
    look.RGBPoints = [number for point in color for number in point]
    fade.Points = [number for value, alpha in opacity for number in (value, alpha, 0.5, 0.0)]
    shown.SetRepresentationType("Stratus Volume")
    shown.ScalarOpacityUnitDistance = unit
    shown.SetScalarBarVisibility(view, False)
    return source, shown
