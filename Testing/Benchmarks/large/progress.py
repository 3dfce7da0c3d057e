#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Error over time of a large file's picture, one line a source: what is on the screen after so many seconds, and how far it is from the
picture of all values in memory.

progress.py measure FILE...     prints rows scene,method,metric,value,unit. Needs the packages stratus and vtk.
  --memory BYTES                limit of the bricks (default: half of what is free)
  --larger                      the files are larger than memory: none is read whole, and the first picture is the true one
progress.py chart CSV PICTURE   draws these rows

Methods: later/coarse and later/exact: pictures of a program that draws again at the mapper's UpdateEvent, of a file whose ranges are kept;
first/exact: of one that was never drawn; whole/exact: all values are read into memory before the picture. Each is drawn by a process of its
own, and its seconds are those from opening the file on. Errors are RMS of the window's colours, of 1; 0 is the same picture to the bit;
nothing: of an empty window. Files as large.py makes them."""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

NOTHING = 1e-5  # where the chart shows that two pictures are the same


def reader_of(path, whole):
    import stratus
    if path.endswith(".raw"):
        name, sizes = os.path.splitext(path)[0] + ".nhdr", os.path.basename(path)[:-4].split("-")[1].split("x")
        with open(name, "w") as header:
            header.write(f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {' '.join(sizes)}\nencoding: raw\ndata file: {os.path.basename(path)}\n")
        path = name
    kinds = {".nc": "CFReader", ".zarr": "ZarrReader", ".h5": "HDF5Reader", ".hdf": "HDF5Reader", ".nhdr": "ImageReader", ".vti": "ImageReader"}
    reader = getattr(stratus, "vtkStratus" + kinds[os.path.splitext(path)[1]])()
    reader.SetFileName(path)
    reader.SetMapFile(not whole)
    return reader


def draw(path, whole, memory, keep):
    """Draws until the picture is exact. Returns [name, seconds] of each picture, and keeps their pixels in the folder `keep`."""
    import numpy
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    import stratus
    stratus.vtkStratusVariableReader.SetMemoryLimit(memory)
    window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1), window.SetMultiSamples(0), window.SetSize(512, 512), window.AddRenderer(renderer)
    window.Render()  # so that opening a window does not count
    begin, again, pictures = time.perf_counter(), [], []
    reader = reader_of(path, whole)
    reader.Update()
    data = reader.GetOutputDataObject(0)
    high = 255 if data.GetPointData().GetScalars().GetDataType() == vtk.VTK_UNSIGNED_CHAR else 1
    mapper, volume = stratus.vtkStratusVolumeMapper(), vtk.vtkVolume()
    mapper.SetInputDataObject(data)
    mapper.AddObserver(vtk.vtkCommand.UpdateEvent, lambda *_: again.append(1))
    volume.SetMapper(mapper)
    look, size = volume.GetProperty(), max(b - a for a, b in zip(data.GetBounds()[::2], data.GetBounds()[1::2]))
    look.SetInterpolationTypeToLinear()
    look.SetScalarOpacityUnitDistance(size / 50)
    opacity, color = look.GetScalarOpacity(), look.GetRGBTransferFunction()
    opacity.RemoveAllPoints(), opacity.AddPoint(0.1 * high, 0), opacity.AddPoint(high, 0.8)
    color.RemoveAllPoints(), color.AddRGBPoint(0, 0.1, 0.3, 0.9), color.AddRGBPoint(high, 0.9, 0.4, 0.1)
    renderer.AddVolume(volume), renderer.ResetCamera()
    while not pictures or again:
        again.clear()
        window.Render()
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(window), grab.ReadFrontBufferOff(), grab.ShouldRerenderOff(), grab.Update()
        name = "coarse" if mapper.GetLastPictureIsCoarse() else "exact"
        pictures.append([name, time.perf_counter() - begin])
        numpy.save(os.path.join(keep, name + ".npy"), vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()))
    return pictures


def measure(paths, memory, larger):
    import numpy
    keep = tempfile.mkdtemp()
    try:
        for path in paths:
            scene = os.path.splitext(os.path.basename(path))[0]
            truth, told = None, []
            for method in ("whole", "first", "later")[larger:]:
                command = [sys.executable, __file__, "draw", path, "whole" if method == "whole" else "bricks", str(memory), keep]
                result = subprocess.run(command, env=dict(os.environ, STRATUS_CACHE_DIR=os.path.join(keep, "cache")), stdout=subprocess.PIPE,
                    check=True)
                if method == "whole":
                    shutil.rmtree(os.path.join(keep, "cache"), ignore_errors=True)
                for name, seconds in json.loads(result.stdout.splitlines()[-1]):
                    picture = numpy.load(os.path.join(keep, name + ".npy")).astype(float) / 255
                    if truth is None:
                        truth = picture
                        blank = float(numpy.sqrt(numpy.mean((truth - truth[0]) ** 2)))  # the window's corner is background
                        print(f"{scene},nothing,error,{blank:.6g},1")
                    error = float(numpy.sqrt(numpy.mean((picture - truth) ** 2)))
                    told.append((method + "/" + name, seconds, error))
            for method, seconds, error in told:
                print(f"{scene},{method},seconds,{seconds:.6g},s\n{scene},{method},error,{error:.6g},1", flush=True)
            shutil.rmtree(os.path.join(keep, "cache"), ignore_errors=True)
    finally:
        shutil.rmtree(keep, ignore_errors=True)


def chart(table, picture):
    """A line for each source and way of opening it: what is on the screen, nothing at first, stays until the next picture."""
    import csv
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk
    import numpy
    pictures, nothing = {}, {}
    for *_, scene, method, metric, value, _ in csv.reader(line for line in open(table) if not line.startswith("#")):
        if method == "nothing":
            nothing[scene] = float(value)
        elif metric in ("seconds", "error") and "/" in method:
            pictures.setdefault((scene, method.split("/")[0]), {}).setdefault(method, {})[metric] = float(value)
    seconds = [point["seconds"] for points in pictures.values() for point in points.values()]
    begin, end = min(seconds) / 2, max(seconds) * 1.3
    colors = [(11, 79, 138), (44, 160, 44), (214, 39, 40), (255, 127, 14), (94, 60, 153), (23, 190, 207)]
    styles = {"later": (vtk.vtkPen.SOLID_LINE, "ranges kept"), "first": (vtk.vtkPen.DASH_LINE, "first time"),
        "whole": (vtk.vtkPen.DOT_LINE, "read whole")}
    view, plot, kept, scenes = vtk.vtkContextView(), vtk.vtkChartXY(), [], []
    for (scene, way), points in sorted(pictures.items()):
        if scene not in scenes:
            scenes.append(scene)
        line = [(begin, nothing[scene])]
        for point in sorted(points.values(), key=lambda p: p["seconds"]):
            line += [(point["seconds"], line[-1][1]), (point["seconds"], max(point["error"], NOTHING))]
        line.append((end, line[-1][1]))
        data = vtk.vtkTable()
        for name, values in zip(("seconds", f"{scene}, {styles[way][1]}"), zip(*line)):
            column = numpy_to_vtk(numpy.array(values, "f4"), deep=1)
            column.SetName(name)
            data.AddColumn(column)
        drawn = plot.AddPlot(vtk.vtkChart.LINE)
        drawn.SetInputData(data, 0, 1)
        drawn.SetColor(*colors[scenes.index(scene) % len(colors)], 255)
        drawn.SetWidth(2)
        drawn.GetPen().SetLineType(styles[way][0])
        kept.append(data)
    for axis, title, low, high in ((vtk.vtkAxis.BOTTOM, "seconds from opening the file", begin, end),
            (vtk.vtkAxis.LEFT, "RMS error of the window, of 1 (none: 1e-5)", NOTHING / 1.5, 2 * max(nothing.values()))):
        plot.GetAxis(axis).SetTitle(title)
        plot.GetAxis(axis).LogScaleOn()
        plot.GetAxis(axis).SetBehavior(vtk.vtkAxis.FIXED)
        plot.GetAxis(axis).SetUnscaledRange(low, high)
        plot.GetAxis(axis).SetGridVisible(False)
    plot.SetShowLegend(True)
    plot.GetLegend().SetHorizontalAlignment(vtk.vtkChartLegend.LEFT)
    plot.GetLegend().SetVerticalAlignment(vtk.vtkChartLegend.BOTTOM)
    plot.GetLegend().SetInline(False)
    view.GetRenderer().SetBackground(1, 1, 1)
    view.GetRenderWindow().SetSize(1100, 560)
    view.GetRenderWindow().SetMultiSamples(0)
    view.GetScene().AddItem(plot)
    view.GetRenderWindow().SetOffScreenRendering(1)
    view.GetRenderWindow().Render()
    grab, writer = vtk.vtkWindowToImageFilter(), vtk.vtkPNGWriter()
    grab.SetInput(view.GetRenderWindow())
    writer.SetInputConnection(grab.GetOutputPort()), writer.SetFileName(picture), writer.Write()


if __name__ == "__main__":
    if len(sys.argv) == 6 and sys.argv[1] == "draw":
        print(json.dumps(draw(sys.argv[2], sys.argv[3] == "whole", int(sys.argv[4]), sys.argv[5])))
    elif len(sys.argv) == 4 and sys.argv[1] == "chart":
        chart(sys.argv[2], sys.argv[3])
    elif len(sys.argv) > 2 and sys.argv[1] == "measure":
        parser = argparse.ArgumentParser()
        parser.add_argument("--memory", type=int, default=0)
        parser.add_argument("--larger", action="store_true")
        parser.add_argument("files", nargs="+")
        options = parser.parse_args(sys.argv[2:])
        measure(options.files, options.memory, options.larger)
    else:
        sys.exit(__doc__)
