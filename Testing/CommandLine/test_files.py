# SPDX-License-Identifier: BSD-3-Clause
"""Files of every kind of grid, in steps and in parts, as `stratus` reads them. Usage: test_files.py PART PATH-OF-STRATUS FOLDER
[PATHS OF make-cumulus AND make-river, where libnetcdf was there to build with, OF write-vdb, where OpenVDB and NanoVDB were,
AND OF write-vtkhdf]"""
import gzip
import math
import os
import re
import shutil
import struct
import subprocess
import sys

from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (
    vtkImageData, vtkMultiBlockDataSet, vtkRectilinearGrid, vtkStructuredGrid, vtkUnstructuredGrid)
from vtkmodules.vtkFiltersCore import vtkAppendFilter
from vtkmodules.vtkIOImage import vtkBMPReader, vtkJPEGReader, vtkPNGReader
from vtkmodules.vtkIOXML import (
    vtkXMLImageDataWriter, vtkXMLMultiBlockDataWriter, vtkXMLRectilinearGridWriter, vtkXMLStructuredGridWriter,
    vtkXMLUniformGridAMRWriter, vtkXMLUnstructuredGridWriter)
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "VTK"))
from refined import Refined, uneven

PART, STRATUS, FOLDER = sys.argv[1], os.path.realpath(sys.argv[2]), sys.argv[3]
MAKERS = {os.path.basename(path): os.path.realpath(path) for path in sys.argv[4:]}
FEW = os.environ.get("STRATUS_FEW", "0") != "0"
SIDE = (5, 4, 6)
LOOK = ("--size", "48x40", "--device", "host", "--opacity", "0:0,30:.6", "--color", "viridis", "--unit-distance", "1")
failures = 0


def fail(text):
    global failures
    failures += 1
    print("FAILED:", text)


def run(*words):
    return subprocess.run([STRATUS, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)


def expect(status, pattern, *words):
    """Runs the command; returns what it said."""
    done = run(*words)
    if done.returncode != status or not re.search(pattern, done.stdout, re.MULTILINE):
        fail(f"{' '.join(words)} returned {done.returncode}, not {status} and '{pattern}':\n{done.stdout}")
    if status and len(done.stdout.splitlines()) > status:  # a usage error has a second line
        fail(f"{' '.join(words)} printed more than an error:\n{done.stdout}")
    return done.stdout


def picture(name, *words):
    expect(0, "picture", "render", name, "-o", "out.png", *LOOK, *words)
    with open("out.png", "rb") as file:
        return file.read()


def write(writer, data, name):
    writer = writer()
    writer.SetInputData(data)
    writer.SetFileName(name)
    writer.SetDataModeToAscii()
    if not writer.Write():
        fail(f"{name} was not written")
    return name


def values(step=0):
    x, y, z = numpy.meshgrid(*(numpy.arange(n) for n in SIDE), indexing="ij")
    return (x + 2 * y + 4 * z + step).astype(numpy.float32).ravel(order="F")


def fill(data, step=0):
    array = numpy_to_vtk(values(step), deep=True)
    array.SetName("qc")
    data.GetPointData().AddArray(array)
    if data.GetNumberOfCells():
        array = numpy_to_vtk(numpy.arange(data.GetNumberOfCells(), dtype=numpy.float64), deep=True)
        array.SetName("part")
        data.GetCellData().AddArray(array)
    return data


def axes(*lists):
    grid = vtkRectilinearGrid()
    grid.SetDimensions(*(len(one) for one in lists))
    for one, put in zip(lists, (grid.SetXCoordinates, grid.SetYCoordinates, grid.SetZCoordinates)):
        put(numpy_to_vtk(numpy.array(one, dtype=numpy.float64), deep=True))
    return grid


def curved(*lists):
    grid, points = vtkStructuredGrid(), vtkPoints()
    grid.SetDimensions(*(len(one) for one in lists))
    for z in lists[2]:
        for y in lists[1]:
            for x in lists[0]:
                points.InsertNextPoint(x, y, z)
    grid.SetPoints(points)
    return grid


def image(step=0):
    data = vtkImageData()
    data.SetDimensions(*SIDE)
    return fill(data, step)


def unstructured(data):
    append = vtkAppendFilter()
    append.AddInputData(data)
    append.Update()
    return append.GetOutput()


def make_files():
    """The files that several tests read."""
    stretched = (range(5), range(4), [0, 1, 2, 4, 7, 11])
    write(vtkXMLRectilinearGridWriter, fill(axes(*stretched)), "stretched.vtr")
    write(vtkXMLStructuredGridWriter, fill(curved(*stretched)), "stretched.vts")
    write(vtkXMLUnstructuredGridWriter, unstructured(fill(curved(*stretched))), "stretched.vtu")
    write(vtkXMLImageDataWriter, image(), "image.vti")
    write(vtkXMLStructuredGridWriter, fill(curved(range(5), range(4), range(6))), "low.vts")


def test_kinds():
    expect(0, "kind +rectilinear grid of 5 x 4 x 6 points", "info", "stretched.vtr")
    expect(0, "kind +curvilinear grid of 5 x 4 x 6 points", "info", "stretched.vts")
    expect(0, "kind +unstructured grid", "info", "stretched.vtu")
    expect(0, "kind +image of 5 x 4 x 6 points", "info", "image.vti")
    expect(0, "kind .*drawn by rays", "info", "stretched.vtr")
    expect(0, "mean spacing 1 x 1 x 2.2", "info", "stretched.vtr")
    write(vtkXMLRectilinearGridWriter, fill(axes(range(5), range(4), range(6))), "even.vtr")
    if picture("even.vtr") != picture("image.vti"):
        fail("a rectilinear grid of equal spacing is another picture than the image")
    if picture("stretched.vtr") == picture("even.vtr"):
        fail("coordinates change nothing")
    same = picture("stretched.vtu")
    if picture("stretched.vts") != same:
        fail("a curvilinear grid is another picture than its cells")
    if picture("stretched.vtu", "--variable", "part") == same:
        fail("--variable changes nothing")
    expect(1, r"no array 'x'; the arrays are: qc \(0 \.\. 30\), part \(0 \.\. 59\)$",
           "render", "stretched.vts", "-o", "no.png", "--variable", "x")
    # two halves that meet
    halves = vtkMultiBlockDataSet()
    for number, part in enumerate(([0, 1, 2], [2, 4, 7, 11])):
        grid, first = curved(range(5), range(4), part), (0, 2)[number]
        array = numpy_to_vtk(values()[20 * first:20 * (first + len(part))], deep=True)
        array.SetName("qc")
        grid.GetPointData().AddArray(array)
        halves.SetBlock(number, grid)
    write(vtkXMLMultiBlockDataWriter, halves, "halves.vtm")
    expect(0, "kind +2 parts: 2 vtkStructuredGrid", "info", "halves.vtm")
    if "360 tetrahedra, 120 points" not in expect(0, "mesh", "render", "halves.vtm", "-o", "out.png", *LOOK):
        fail("parts that meet do not share their points")
    if picture("halves.vtm") != same:
        fail("two halves are another picture than the whole")
    # blocks of images stay images
    whole = image()
    blocks = vtkMultiBlockDataSet()
    for number, extent in enumerate(((0, 2, 0, 3, 0, 5), (2, 4, 0, 1, 0, 5), (2, 4, 1, 3, 0, 5))):
        part = vtkImageData()
        part.DeepCopy(whole)
        part.Crop(extent)
        blocks.SetBlock(number, part)
    write(vtkXMLImageDataWriter, whole, "box.vti")
    write(vtkXMLMultiBlockDataWriter, blocks, "box.vtm")
    expect(0, "kind +3 blocks: 3 vtkImageData, drawn by rays", "info", "box.vtm")
    fixed = ("--sampling", "midpoint", "--sample-distance", ".05")
    if abs(drawn("box.vtm", *LOOK, *fixed) - drawn("box.vti", *LOOK, *fixed)).max() > 1:
        fail("blocks of an image are another picture than the whole")
    # the opacity is guessed from how often a value is there, and points that blocks share are there once
    if abs(drawn("box.vtm", *fixed) - drawn("box.vti", *fixed)).max() > 1:
        fail("the guessed opacity depends on how an image is divided")
    expect(2, "'box.vtm' is a volume of 3 blocks, which is drawn without --audit", "render", "box.vtm", "-o", "no.png", "--audit")


def test_modes_of_grids():
    seen = {picture("stretched.vts")}
    for words in (("maximum",), ("minimum",), ("average",), ("additive",), ("isosurface", "--contours", "12,20"),
                  ("average", "--average-range", "5,9"), ("slice", "--slice", "1,1,2,0,0.2,1"), ("first-hit",)):
        expect(0, f"mode +{words[0]}$", "render", "stretched.vts", "-o", "out.png", *LOOK, "--mode", *words)
        seen.add(open("out.png", "rb").read())
    seen.add(picture("stretched.vts", "--crop", "1,3,0,3,0,5"))
    seen.add(picture("stretched.vts", "--crop", "1,3,0,3,0,5", "--crop-regions", "12288"))
    seen.add(picture("stretched.vts", "--shade"))
    if len(seen) != 12:
        fail(f"of 12 pictures in other modes, cropped and lit, {len(seen)} differ")
    for words in (("--audit",), ("--nearest",)):
        expect(2, "are for images", "render", "stretched.vts", "-o", "no.png", *words)


def test_bad_grids():
    for name, bad, words in (("back", [0, 1, 2, 1.5, 3, 4], r"along z .* number 3 is 1\.5, after 2$"),
                            ("twice", [0, 0, 2, 3, 4, 5], r"along z .* number 1 is 0, after 0$"),
                            ("nan", [0, 1, math.nan, 3, 4, 5], r"along z .* number 2 is (-)?nan")):
        write(vtkXMLRectilinearGridWriter, fill(axes(range(5), range(4), bad)), name + ".vtr")
        if name != "nan":  # VTK's parser refuses the word itself
            expect(1, words, "render", name + ".vtr", "-o", "no.png")
    write(vtkXMLStructuredGridWriter, fill(curved(range(5), range(4), range(6))), "whole.vts")
    for name in ("stretched.vtr", "whole.vts", "halves.vtm"):
        with open(name, "rb") as file:
            text = file.read()
        with open("short" + name[-4:], "wb") as file:
            file.write(text[:len(text) * 2 // 3])
        expect(1, "^stratus: cannot read", "render", "short" + name[-4:], "-o", "no.png")
    if os.path.exists("no.png"):
        fail("a picture was left by a command that failed")


def collection(name, entries):
    with open(name, "w") as file:
        file.write('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1"><Collection>\n')
        for time, part, path in entries:
            file.write(f'<DataSet timestep="{time}" group="" part="{part}" file="{path}"/>\n')
        file.write("</Collection></VTKFile>\n")


def test_pictures_of_nothing():
    write(vtkXMLImageDataWriter, image(), "values.vti")
    write(vtkXMLStructuredGridWriter, fill(curved(*(range(n) for n in SIDE))), "values.vts")
    for name in ("values.vti", "values.vts"):
        small = ("render", name, "--array", "qc", "-o", "none.png", "--size", "24", "--device", "host", "--color", "viridis", "--unit-distance", "2")
        expect(0, r"warning: the picture shows nothing: the opacity is 0 for every value, and the values are in 0 \.\. 30$", *small, "--opacity", "0:0,9:0")
        expect(0, r"nothing: the opacity, for a length of 2, is above 0 only in 40 \.\. 60, and the values are in 0 \.\. 30$", *small, "--opacity",
               "10:0,40:0,50:1,60:0,70:0")
        expect(0, r"nothing: no contour is within the values, and the values are in 0 \.\. 30$", *small, "--mode", "isosurface", "--contours", "31")
        expect(0, r"nothing: no ray meets a value that shows", *small, "--opacity", "0:1", "--crop", "90,91,90,91,90,91")
        for words in (("--opacity", "0:0,30:.6"), ("--opacity", "0:0", "--quantity", "integral"), ("--opacity", "0:.5", "--background", "black")):
            if "shows nothing" in expect(0, "picture", *small, *words):
                fail(f"a picture of {name} with {words} is said to show nothing")


def test_surfaces_without_opacity():
    for name, mode, opacity in (("values.vti", ("isosurface", "--contours", "12"), "0:1"), ("values.vti", ("isosurface", "--contours", "12,20"), "0:.5"),
                                ("values.vti", ("slice", "--slice", "2,1,3,1,1,1"), "0:1"), ("values.vts", ("isosurface", "--contours", "12"), "0:1")):
        words = ("--array", "qc", "-o", "surface.png", "--size", "24", "--device", "host", "--color", "0:0:0:1,30:1:0:0", "--mode", *mode)
        pictures = []
        for given in ((), ("--opacity", opacity), ("--opacity", "0:.2")):
            expect(0, "picture", "render", name, *words, *given)
            with open("surface.png", "rb") as file:
                pictures.append(file.read())
        if pictures[0] != pictures[1] or pictures[0] == pictures[2]:
            fail(f"{mode} of {name} has not the opacity {opacity}")


def test_collections():
    for step in range(4):
        write(vtkXMLImageDataWriter, image(10 * step), f"step{step}.vti")
    collection("steps.pvd", [(1.5 * i, 0, f"step{i}.vti") for i in range(4)])
    expect(0, r"time +4 steps: 0 1\.5 3 4\.5", "info", "steps.pvd")
    expect(0, r"time +step 1 of 4, at 1\.5", "render", "steps.pvd", "-o", "one.png", *LOOK, "--time", "1.4")
    for words in (("last",), ("step:3",), ("99",), ("+4.4",)):
        expect(0, r"time +step 3 of 4, at 4\.5", "render", "steps.pvd", "-o", "three.png", *LOOK, "--time", *words)
    if picture("step3.vti") != open("three.png", "rb").read() or picture("step3.vti") == open("one.png", "rb").read():
        fail("a step of a collection is not its file's picture")
    expect(2, "within 0..3", "render", "steps.pvd", "-o", "no.png", "--time", "step:4")
    expect(2, "does not give the unit", "render", "steps.pvd", "-o", "no.png", "--time", "3h")
    expect(2, "'steps.pvd' has no times since a date: give a number or step:N, not 2001-01-01", "render", "steps.pvd", "-o", "no.png", "--time",
           "2001-01-01")
    expect(2, "'fortnight' is no unit", "render", "steps.pvd", "-o", "no.png", "--time", "3 fortnight")
    expect(2, "has no time", "render", "step0.vti", "-o", "no.png", "--time", "3")
    collection("back.pvd", [(0, 0, "step0.vti"), (2, 0, "step1.vti"), (1, 0, "step2.vti")])
    expect(1, r"backwards: 1 \(entry 2\) comes after 2$", "render", "back.pvd", "-o", "no.png")
    collection("lost.pvd", [(0, 0, "step9.vti")])
    expect(1, "step9.vti.*No such file", "render", "lost.pvd", "-o", "no.png")
    collection("none.pvd", [])
    expect(1, "names no file", "render", "none.pvd", "-o", "no.png")
    with open("cut.pvd", "w") as file:
        file.write(open("steps.pvd").read()[:150])
    expect(1, "cannot read 'cut.pvd'", "render", "cut.pvd", "-o", "no.png")
    for i, part in enumerate(([0, 1, 2], [2, 3, 4, 5])):
        grid = curved(range(5), range(4), part)
        array = numpy_to_vtk(values()[20 * (0, 2)[i]:20 * ((0, 2)[i] + len(part))], deep=True)
        array.SetName("qc")
        grid.GetPointData().AddArray(array)
        write(vtkXMLStructuredGridWriter, grid, f"part{i}.vts")
    collection("parts.pvd", [(7, 0, "part0.vts"), (7, 1, "part1.vts")])
    expect(0, "kind +2 parts", "info", "parts.pvd")


def test_films():
    words = ("--time", "all", "--frames", "film-%03d.png", *LOOK)
    said = expect(0, "frames +4, film-%03d.png", "render", "steps.pvd", *words)
    if said.count("s left") != 4 or not re.search(r"frame +film-002.png, step 2 of 4, at 3, ", said):
        fail("a film on a pipe does not report each frame:\n" + said)
    for step in range(4):
        if picture(f"step{step}.vti", "--time", "first") != open(f"film-00{step}.png", "rb").read():
            fail(f"frame {step} is not that step's picture")
    # a mesh that stays and values that change: neighbours are found once
    for step in range(5):
        write(vtkXMLUnstructuredGridWriter, unstructured(fill(curved(range(5), range(4), range(6)), 5 * step)), f"mesh{step}.vtu")
    collection("mesh.pvd", [(i, 0, f"mesh{i}.vtu") for i in range(5)])
    expect(0, "built +1 times the mesh, [56] times its values", "render", "mesh.pvd", "--frames", "mesh-%d.png", *LOOK)
    if len({open(f"mesh-{i}.png", "rb").read() for i in range(5)}) != 5:
        fail("frames of other values are the same")
    expect(2, "where to", "render", "steps.pvd", "--time", "all")
    expect(2, "leave out -o", "render", "steps.pvd", "--frames", "a-%d.png", "-o", "b.png")
    expect(2, "leave out --time 3", "render", "steps.pvd", "--frames", "a-%d.png", "--time", "3")
    for name in ("film.png", "a-%s.png", "a-%d-%d.png", "a-%.3d.png", "a-%1000d.png", "a-%%.png", "a-%"):
        expect(2, "needs one number", "render", "steps.pvd", "--frames", name)
    # a step that is broken ends the film, and leaves the frames before it
    collection("broken.pvd", [(0, 0, "step0.vti"), (1, 0, "step1.vti"), (2, 0, "short.vts"), (3, 0, "step2.vti")])
    done = run("render", "broken.pvd", "--frames", "broken-%d.png", *LOOK)
    if done.returncode != 1 or "short.vts" not in done.stdout or os.path.exists("broken-2.png"):
        fail("a film with a broken step: " + done.stdout)


def resident(steps, ending="vti"):
    collection("long.pvd", [(i, 0, f"big{i % 2}.{ending}") for i in range(steps)])
    said = expect(0, "resident", "render", "long.pvd", "--frames", "long-%d.png", "--size", "16x16", "--device", "host",
                  "--opacity", "0:0,30:.6", "--threads", "2")
    return float(re.search(r"memory +([0-9.]+) MiB", said).group(1))


def test_memory():
    for step in range(2):
        data = vtkImageData()
        data.SetDimensions(40, 40, 40)
        array = numpy_to_vtk((numpy.arange(40 ** 3, dtype=numpy.float32) % 31) + step, deep=True)
        array.SetName("qc")
        data.GetPointData().AddArray(array)
        writer = vtkXMLImageDataWriter()
        writer.SetInputData(data)
        writer.SetFileName(f"big{step}.vti")
        writer.SetCompressorTypeToNone()
        writer.Write()
    steps = 80 if FEW else 1000
    few, many = resident(20), resident(steps)
    print(f"resident at most: {few} MiB in 20 steps, {many} MiB in {steps}")
    if many > few + 8:  # a step has 0.25 MiB of values: a leak of one array a step would be 15 MiB or 245
        fail(f"memory grows: {few} MiB in 20 steps, {many} MiB in {steps}")


def memory_of_meshes(ending, writer):
    """A step has 0.25 MiB of points and .1 of values, a listed one 4 MiB of cells."""
    for step in range(2):
        grid = curved(range(28), range(28), [z * (1 + .1 * step * (ending == "vtu")) for z in range(28)])
        array = numpy_to_vtk((numpy.arange(28 ** 3, dtype=numpy.float32) % 31) + step, deep=True)
        array.SetName("qc")
        grid.GetPointData().AddArray(array)
        xml = writer()
        xml.SetInputData(unstructured(grid) if ending == "vtu" else grid)
        xml.SetFileName(f"big{step}.{ending}")
        xml.SetCompressorTypeToNone()
        xml.Write()
    steps = 80 if FEW else 220
    few, many = resident(20, ending), resident(steps, ending)
    print(f"resident at most of .{ending}: {few} MiB in 20 steps, {many} MiB in {steps}")
    if many > few + 12:  # of 60 or 200 more steps, .35 MiB each would be 21 or 70
        fail(f"memory grows: {few} MiB in 20 steps of .{ending}, {many} MiB in {steps}")


def test_memory_of_meshes_that_stay():
    memory_of_meshes("vts", vtkXMLStructuredGridWriter)


def test_memory_of_meshes_that_move():
    memory_of_meshes("vtu", vtkXMLUnstructuredGridWriter)


def pixels(name, reader=vtkPNGReader):
    reader = reader()
    reader.SetFileName(name)
    reader.Update()
    data = reader.GetOutput()
    return vtk_to_numpy(data.GetPointData().GetScalars()).reshape(data.GetDimensions()[1], data.GetDimensions()[0], -1).astype(int)


def drawn(name, *words):
    picture(name, *words)
    return pixels("out.png")


def test_exaggeration():
    tall = image()
    tall.SetSpacing(1, 1, 3)
    write(vtkXMLImageDataWriter, tall, "tall.vti")
    write(vtkXMLStructuredGridWriter, fill(curved(range(5), range(4), [0, 3, 6, 9, 12, 15])), "tall.vts")
    for low, high in (("image.vti", "tall.vti"), ("low.vts", "tall.vts")):
        one, other = drawn(low, "--exaggerate", "3"), drawn(high)
        if abs(one - other).max() > 1:  # by other roundings of the same positions
            fail(f"{low} three times as high differs from {high} by {abs(one - other).max()}")
        if abs(one - drawn(low)).max() < 20:
            fail(f"--exaggerate changes nothing of {low}")
    expect(2, "not above 0", "render", "image.vti", "-o", "no.png", "--exaggerate", "0")


def test_annotations():
    clear = ("--opacity", "0:0", "--background", "black")
    if drawn("image.vti", *clear).max() != 0:
        fail("nothing is to be seen")
    for words in (("--axes",), ("--color-bar",), ("--caption", "at {time}")):
        if not 200 < drawn("image.vti", *clear, "--size", "300x200", *words).max():
            fail(f"{words[0]} draws nothing")
    # The far edges of the box are behind the volume, the near ones before it: through an opaque box only the near ones are visible.
    solid = ("--opacity", "0:1", "--color", "0:1:0:0", "--background", "black", "--size", "300x200", "--parallel", "--axes")
    box = drawn("image.vti", *clear, "--size", "300x200", "--parallel", "--axes")
    both = drawn("image.vti", *solid)
    hidden = (both == [255, 0, 0]).all(axis=2) & (box.max(axis=2) > 100)
    seen = (both[:, :, 1] > 100) & (box.max(axis=2) > 100)
    if hidden.sum() < 50 or seen.sum() < 300:
        fail(f"an opaque box hides {hidden.sum()} pixels of its far edges, and shows {seen.sum()} of the near ones")
    for size in ("1x1", "30x20", "40x400"):
        drawn("image.vti", "--size", size, "--axes", "--color-bar", "--caption", "x", "--log", "--zoom", "3")
    expect(2, "leave out --axes", "render", "image.vti", "-o", "no.png", "--axes", "--show", "samples")
    expect(2, "OpenEXR", "render", "image.vti", "-o", "no.exr", "--caption", "x")
    if (drawn("image.vti", *clear, "--caption", "x") == drawn("image.vti", *clear, "--caption", "y")).all():
        fail("captions of other letters are the same")


def test_colors_and_logarithm():
    text = run("--help").stdout.replace("\n", " ")
    names = run("--color", "list").stdout.split()
    listed = re.sub(" +", " ", re.search(r"--color list prints the names: ([a-z., -]+)--crop ", text).group(1)).strip()
    if not {"viridis", "turbo", "thermal", "balance", "cool-warm", "storm"} <= set(names) or listed.split(", ") != names:
        fail(f"colour maps are {names}, and the help lists {listed}")
    for name, same in ("temperature", "cmo.thermal"), ("viridis_r", "0:1:1:1"):
        if (picture("image.vti", "--color", name) == picture("image.vti", "--color", same)) != (name == "temperature"):
            fail(f"{name} and {same}")
    expect(2, "'viridi' is no colour map, must be one of viridis, magma.*or a list value:r:g:b", "render", "image.vti", "-o", "no.png", "--color", "viridi")
    names = names[::3] if FEW else names
    if len({picture("image.vti", "--color", name) for name in names}) != len(names):
        fail("two colour maps are the same")
    with_log = expect(0, "over the logarithm: opacity 0 at 1e-06, ", "render", write_range("wide.vti", 1e-9, 1e-2), "-o", "log.png",
                      "--log", "--size", "64x64")
    if "histogram" in with_log and (pixels("log.png") == drawn("wide.vti", "--size", "64x64")).all():
        fail("--log changes nothing")
    expect(1, "no value above 0", "render", write_range("minus.vti", -5, -1), "-o", "no.png", "--log")


def write_range(name, low, high):
    data = vtkImageData()
    data.SetDimensions(*SIDE)
    array = numpy_to_vtk(numpy.linspace(low, high, 120), deep=True)
    array.SetName("qc")
    data.GetPointData().AddArray(array)
    return write(vtkXMLImageDataWriter, data, name)


def test_raw_types():
    for type, dtype, words in (("uint8", "u1", ""), ("int16", "<i2", ""), ("uint16", ">u2", ":big"), ("float32", "<f4", ":little"),
                               ("float64", ">f8", ":big:+7"), ("int32", "<i4", ":1,1,1")):
        with open("values.raw", "wb") as file:
            file.write(b"7 bytes" if "+7" in words else b"")
            file.write(values().astype(dtype).tobytes())
        # Each type has a table of its own, whose entries are rounded differently.
        difference = abs(drawn("values.raw", "--raw", f"5x4x6:{type}{words}") - drawn("image.vti")).max()
        if difference > (0 if "float" in type else 2):
            fail(f"--raw {type}{words} is another picture than image.vti, by {difference}")
    picture("values.raw", "--raw", "5x4x6:int32:1,2,.5")
    if "spacing 1 x 2 x 0.5" not in expect(0, "volume", "info", "values.raw", "--raw", "5x4x6:int32:1,2,.5"):
        fail("the spacing of --raw is lost")
    expect(2, "does not describe itself", "render", "values.raw", "-o", "no.png")
    expect(1, "needs 240 bytes, the file has 480$", "render", "values.raw", "-o", "no.png", "--raw", "5x4x6:int16")
    for bad in ("5x4:int16", "5x4x6", "5x4x6:int17", "5x4x0:int16", "5x4x6.5:int16", "ax4x6:int8", "5x4x6:int16:0,1,1", "5x4x6:int16:+x",
                "5x4x6:int16:middle"):
        expect(2, "--raw", "render", "values.raw", "-o", "no.png", "--raw", bad)


def test_netcdf():
    if "make-cumulus" not in MAKERS:
        open("some.nc", "w").close()
        expect(1, "built without libnetcdf", "render", "some.nc", "-o", "no.png")
        return
    subprocess.run([MAKERS["make-cumulus"], "cumulus.nc", "24"], check=True)
    said = expect(0, "rectilinear grid of 24 x 24 x 64 points", "info", "cumulus.nc", "--time", "2h")
    for pattern in (r"time +13 steps: 0 0\.25 0\.5 0\.75 1 \.\.\. 3 hours since 2024-06-01 09:00", r"step 8 of 13, at 2024-06-01 11:00$",
                    r"variable +'qc' in g kg-1, cloud liquid water mixing ratio, 0 \.\. [0-9.]+$", r"z by 'z' \(m\)"):
        if not re.search(pattern, said, re.MULTILINE):
            fail(f"info of cumulus.nc does not say '{pattern}':\n{said}")
    for time in ("2h", "120min", "+2 hours", "7200 s", "2", "step:8", "2024-06-01 11:00", "2024-06-01T11:07", "2024-06-01 13:00 +02:00"):
        expect(0, r"time +step 8 of 13, at 2024-06-01 11:00$", "render", "cumulus.nc", "-o", "qc.png", "--size", "32x32", "--time", time)
    expect(2, r"--time: time '2024-06-31' is no moment of the calendar standard", "render", "cumulus.nc", "-o", "no.png", "--time", "2024-06-31")
    expect(1, r"no variable 'qi' on a grid of three dimensions in 'cumulus.nc': did you mean qc\? Those that are: qc \(0 \.\. [-0-9.e]+ g kg-1\)$", "render", "cumulus.nc", "-o", "no.png",
           "--variable", "qi")
    with open("cumulus.nc", "rb") as file:
        text = file.read()
    with open("cut.nc", "wb") as file:
        file.write(text[:-1000])
    expect(1, "the file is cut short: it has ", "render", "cut.nc", "-o", "no.png")
    subprocess.run([MAKERS["make-river"], "river.nc", "1"], check=True)
    said = expect(0, "10 layers by sigma", "info", "river.nc", "--variable", "dye", "--time", "5h")
    for pattern in (r"vtkHexahedron \(12\)", r"vtkWedge \(13\)", r"0 without volume, 0 of negative orientation", r"variable +'salinity' in psu",
                    r"drawn +'dye' on points"):
        if not re.search(pattern, said):
            fail(f"info of river.nc does not say '{pattern}':\n{said}")
    expect(0, "frames +31, river-%02d.png", "render", "river.nc", "--variable", "dye", "--frames", "river-%02d.png", "--size", "48x32",
           "--exaggerate", "60", "--opacity", "0:0,1:.5", "--unit-distance", "300", "--device", "host")
    if len({open(f"river-{i:02d}.png", "rb").read() for i in range(31)}) < 25:
        fail("the film of a tide stands still")
    expect(0, "array 'salinity' on cells", "render", "river.nc", "--variable", "salinity", "-o", "salt.png", "--size", "32x32")


def test_vdb():
    if "write-vdb" not in MAKERS:
        open("cloud.vdb", "w").close()
        expect(1, "libopenvdb-dev", "render", "cloud.vdb", "-o", "no.png")
        return
    subprocess.run([MAKERS["write-vdb"], "."], check=True)
    said = expect(0, r"kind +image of 41 x 41 x 25 points", "info", "cloud.vdb")
    for pattern in (r"coordinates +fog volume of float, \d+ active voxels in a sparse grid of \d+ bytes", r"variable +'density', float, 0 \.\. 1$",
                    r"variable +'wind', vec3s, 0 \.\. 5$", r"drawn +'density'", r"spacing 0\.5 x 2 x 1"):
        if not re.search(pattern, said, re.MULTILINE):
            fail(f"info of cloud.vdb does not say '{pattern}':\n{said}")
    look = ("--opacity", "0:0,1:.5", "--unit-distance", "4", "--size", "200x150")
    cloud = drawn("cloud.vdb", *look)
    if not 40 < (cloud - drawn("cloud.vdb", *look, "--opacity", "0:0")).max():
        fail("nothing is drawn of cloud.vdb")
    if (drawn("cloud.nvdb", *look) != cloud).any() or (drawn("cloud.vdb", *look, "--variable", "density") != cloud).any():
        fail("cloud.nvdb is another picture than cloud.vdb")
    # the wind is the density times (3, -4, 0)
    single = drawn("cloud.vdb", *look, "--color", "0:0:0:1,1:1:1:0")
    for name, scale in (("wind", 5), ("wind.magnitude", 5), ("wind.x", 3), ("wind.y", -4)):
        words = ("--variable", name, "--opacity", f"0:0,{scale}:.5" if scale > 0 else f"{scale}:.5,0:0", "--color",
                 f"0:0:0:1,{scale}:1:1:0" if scale > 0 else f"{scale}:1:1:0,0:0:0:1")
        if abs(drawn("cloud.vdb", *look, *words) - single).max() > 1:  # by other roundings of the values
            fail(f"{name} of cloud.vdb is another picture than the density it is a multiple of")
    expect(1, r"no variable 'qc' on a grid of three dimensions in 'cloud.vdb'; those that are: density \(0 \.\. 1\), wind \(0 \.\. 5\)$",
           "render", "cloud.vdb", "-o", "no.png", "--variable", "qc")
    apart = drawn("apart.vdb", *look)  # 18 MB as an image, more than the least that stays in its file
    for words in (), ("--memory", "16M"):
        if not apart.any() or (drawn("apart.nvdb", *look, *words) != apart).any():
            fail(f"leaves that stay in apart.nvdb give another picture {words}")
    expect(0, r"read +\d+ MiB of bricks", "render", "apart.nvdb", "-v", "-o", "out.png", *look, "--memory", "16M")
    expect(0, r"2 blocks of 8000 bytes .* in place of an image of 256\d{9} bytes", "info", "wide.vdb")
    expect(0, "volume +2 blocks, the first of 10 x 10 x 10 float32", "render", "wide.vdb", "-o", "wide.png")
    expect(2, "'wide.vdb' is a volume of 2 blocks, which is drawn without others", "render", "cloud.vdb", "wide.vdb", "-o", "no.png")
    with open("cloud.vdb", "rb") as file:
        text = file.read()
    with open("cut.vdb", "wb") as file:
        file.write(text[:len(text) // 2])
    # OpenVDB reads grids one by one: the first one is whole
    expect(1, "^stratus: cannot read 'cut.vdb'", "render", "cut.vdb", "-o", "no.png", "--variable", "wind")


def test_vectors():
    grid = curved(range(5), range(4), range(6))
    array = numpy_to_vtk(numpy.stack([3 * values(), -4 * values(), 0 * values()], axis=1), deep=True)
    array.SetName("U")
    grid.GetPointData().AddArray(array)
    write(vtkXMLStructuredGridWriter, grid, "wind.vts")
    single = drawn("low.vts", "--opacity", "0:0,30:.6", "--color", "0:0:0:1,30:1:1:0")
    for name, scale in (("U", 5), ("U.x", 3)):
        words = ("--variable", name, "--opacity", f"0:0,{30 * scale}:.6", "--color", f"0:0:0:1,{30 * scale}:1:1:0")
        if abs(drawn("wind.vts", *words) - single).max() > 1:
            fail(f"{name} of wind.vts is another picture than its multiple")
    expect(1, r"no array 'U\.w'; the arrays are: U$", "render", "wind.vts", "-o", "no.png", "--variable", "U.w")


def test_vtkhdf():
    if "write-vtkhdf" not in MAKERS:
        print("no HDF5 to write with: .vtkhdf is not tested")
        return
    subprocess.run([MAKERS["write-vtkhdf"], "."], check=True)
    said = expect(0, "kind +image of 5 x 4 x 6 points", "info", "image.hdf")
    expect(0, "60 vtkHexahedron", "info", "stretched.vtkhdf")
    if picture("image.hdf") != picture("image.vti"):
        fail("image.hdf is another picture than image.vti")
    by_us = "VTKHDF 1.0" in said  # VTK's reader reads the other files
    if by_us and picture("plain.h5", "--variable", "/run/qc") != picture("image.vti"):
        fail("plain.h5 is another picture than image.vti")
    if picture("stretched.vtkhdf") != picture("stretched.vtu"):
        fail("stretched.vtkhdf is another picture than stretched.vtu")
    expect(1, r"no (array|variable) 'x'.* are: qc \(0 \.\. 30\)$", "render", "image.hdf", "-o", "no.png", "--variable", "x")
    for name in ("image.hdf", "stretched.vtkhdf"):
        with open(name, "rb") as file:
            text = file.read()
        for part in (.01, .3, .9, .9999):
            with open("cut-" + name, "wb") as file:
                file.write(text[:int(len(text) * part)])
            expect(1, f"^stratus: cannot read 'cut-{name}': .*cut short", "render", "cut-" + name, "-o", "no.png")


def test_raw():
    values().astype("<f4").tofile("values.raw")
    look = ("--raw", "5x4x6:float32")
    same = picture("image.vti")
    if picture("values.raw", *look) != same:
        fail("values.raw is another picture than image.vti")
    of_raw = expect(0, "hits|why", "tree", "values.raw", *look, "--lower", "10", "--device", "host")
    of_image = expect(0, "hits|why", "tree", "image.vti", "--lower", "10", "--device", "host")
    count = lambda text: re.findall(r"^  (voxels|nodes) +(.*)$", text, re.MULTILINE)
    if not count(of_raw) or count(of_raw) != count(of_image):
        fail(f"the tree of values.raw is another than image.vti's:\n{of_raw}{of_image}")
    shown = numpy.zeros(120, dtype=numpy.uint8)
    shown[60:] = 1
    shown.tofile("mask.raw")
    mask = vtkImageData()
    mask.SetDimensions(*SIDE)
    array = numpy_to_vtk(shown, deep=True)
    array.SetName("mask")
    mask.GetPointData().AddArray(array)
    write(vtkXMLImageDataWriter, mask, "mask.vti")
    masked = picture("image.vti", "--mask", "mask.vti")
    if masked == same or picture("values.raw", *look, "--mask", "mask.raw", "--mask-raw", "5x4x6:uint8") != masked:
        fail("a mask of bare bytes is another than the image of them")
    twice = picture("image.vti", "image.vti")
    if picture("values.raw", *look, "values.raw", *look) != twice or twice == same:
        fail("two inputs of bare values are another picture than two images")
    expect(2, "mask.raw' does not describe itself", "render", "image.vti", "-o", "no.png", "--mask", "mask.raw")
    expect(2, "of which file", "render", "image.vti", "-o", "no.png", "--mask-raw", "5x4x6:uint8")
    expect(1, "needs 240 bytes, the file has 120", "render", "image.vti", "-o", "no.png", "--mask", "mask.raw", "--mask-raw",
           "5x4x6:int16")
    expect(2, "values.raw' does not describe itself", "tree", "values.raw")


def openfoam(cells=(2, 2, 2)):
    """A block of hexahedra as polyMesh, two times."""
    nx, ny, nz = cells
    point = lambda i, j, k: i + (nx + 1) * (j + (ny + 1) * k)
    cell = lambda i, j, k: i + nx * (j + ny * k)
    inner, border = [], []
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                corners = {
                    (1, 0, 0): (point(i + 1, j, k), point(i + 1, j + 1, k), point(i + 1, j + 1, k + 1), point(i + 1, j, k + 1)),
                    (0, 1, 0): (point(i, j + 1, k), point(i, j + 1, k + 1), point(i + 1, j + 1, k + 1), point(i + 1, j + 1, k)),
                    (0, 0, 1): (point(i, j, k + 1), point(i + 1, j, k + 1), point(i + 1, j + 1, k + 1), point(i, j + 1, k + 1)),
                    (-1, 0, 0): (point(i, j, k), point(i, j, k + 1), point(i, j + 1, k + 1), point(i, j + 1, k)),
                    (0, -1, 0): (point(i, j, k), point(i + 1, j, k), point(i + 1, j, k + 1), point(i, j, k + 1)),
                    (0, 0, -1): (point(i, j, k), point(i, j + 1, k), point(i + 1, j + 1, k), point(i + 1, j, k))}
                for (di, dj, dk), face in corners.items():
                    a, b, c = i + di, j + dj, k + dk
                    if 0 <= a < nx and 0 <= b < ny and 0 <= c < nz:
                        if min(di, dj, dk) >= 0:
                            inner.append((face, cell(i, j, k), cell(a, b, c)))
                    else:
                        border.append((face, cell(i, j, k)))
    head = 'FoamFile {{ version 2.0; format ascii; class {}; location "{}"; object {}; }}\n'

    def put(folder, name, kind, text):
        os.makedirs(os.path.join("foam", folder), exist_ok=True)
        with open(os.path.join("foam", folder, name), "w") as file:
            file.write(head.format(kind, folder, name) + text)

    def lines(rows):
        rows = list(rows)
        return f"{len(rows)}\n(\n" + "\n".join(rows) + "\n)\n"

    mesh = "constant/polyMesh"
    put(mesh, "points", "vectorField", lines(
        f"({i} {j} {k})" for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)))
    put(mesh, "faces", "faceList", lines("4(" + " ".join(map(str, one[0])) + ")" for one in inner + border))
    put(mesh, "owner", "labelList", lines(str(one[1]) for one in inner + border))
    put(mesh, "neighbour", "labelList", lines(str(one[2]) for one in inner))
    put(mesh, "boundary", "polyBoundaryMesh", f"1 ( walls {{ type wall; nFaces {len(border)}; startFace {len(inner)}; }} )\n")
    put("system", "controlDict", "dictionary", "startTime 0; endTime 3600; deltaT 3600; writeControl timeStep; writeInterval 1;\n")
    for time in (0, 3600):
        put(str(time), "qc", "volScalarField", "dimensions [0 0 0 0 0 0 0];\ninternalField nonuniform List<scalar>\n" + lines(
            str(i + time / 600) for i in range(nx * ny * nz)) + ";\nboundaryField { walls { type zeroGradient; } }\n")
    open("foam/case.foam", "w").close()


def test_openfoam():
    openfoam()
    for name in ("foam/case.foam", "foam/system/controlDict"):
        expect(0, "time +[12] steps?: (0 )?3600 s", "info", name)
        expect(0, "array 'qc' on", "render", name, "-o", "foam.png", "--size", "40x40", "--time", "1h", "--variable", "qc")
    expect(0, "48 tetrahedra", "render", "foam/case.foam", "-o", "foam.png", "--size", "40x40", "--time", "60 min", "--variable", "qc")
    os.remove("foam/constant/polyMesh/faces")
    expect(1, "^stratus: ", "render", "foam/case.foam", "-o", "no.png")


def test_ensight():
    with open("box.case", "w") as file:
        file.write("FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: box.geo\nVARIABLE\nscalar per node: 1 qc box.qc**\n"
                   "TIME\ntime set: 1\nnumber of steps: 2\nfilename start number: 0\nfilename increment: 1\ntime values: 0 2.5\n")
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    with open("box.geo", "w") as file:
        file.write("a box\nof one cell\nnode id assign\nelement id assign\npart\n%10d\nbox\ncoordinates\n%10d\n" % (1, 8))
        for axis in range(3):
            file.write("".join("%12.5e\n" % corner[axis] for corner in corners))
        file.write("hexa8\n%10d\n" % 1 + "".join("%10d" % (i + 1) for i in range(8)) + "\n")
    for step in range(2):
        with open(f"box.qc0{step}", "w") as file:
            file.write("qc\npart\n%10d\ncoordinates\n" % 1 + "".join("%12.5e\n" % (i + 10 * step) for i in range(8)))
    expect(0, r"time +2 steps: 0 2\.5", "info", "box.case")
    expect(0, r"array +'qc', float, 1 component, 10 \.\. 17", "info", "box.case", "--time", "2.5")
    expect(0, "6 tetrahedra, 8 points", "render", "box.case", "-o", "ensight.png", "--size", "40x40")
    os.remove("box.geo")
    expect(1, "^stratus: ", "render", "box.case", "-o", "no.png")


def test_refined():
    """AMR looks as one fine grid of its field does, from levels that all are read; unsupported data is refused."""
    from vtkmodules import vtkCommonDataModel

    data = Refined(uneven())
    write(vtkXMLUniformGridAMRWriter, data.data(vtkCommonDataModel), "refined.vthb")
    os.replace("refined.vthb", "refined.vth")
    write(vtkXMLUniformGridAMRWriter, data.data(vtkCommonDataModel), "refined.vthb")
    field = data.field()
    fine = vtkImageData()
    fine.SetDimensions(*field.shape)
    fine.SetSpacing(1 / 8, 1 / 8, 1 / 8)
    array = numpy_to_vtk(field.ravel(order="F"), deep=True)
    array.SetName("values")
    fine.GetPointData().AddArray(array)
    write(vtkXMLImageDataWriter, fine, "fine.vti")
    look = ("--size", "120x100", "--device", "host", "--tolerance", "2e-4",
            "--opacity", "0:.01,.3:.02,.9:.6", "--color", "viridis", "--unit-distance", "1")
    pictures = []
    for name in "refined.vthb", "refined.vth", "fine.vti":
        expect(0, "picture", "render", name, "-o", "out.png", *look)
        reader = vtkPNGReader()
        reader.SetFileName("out.png")
        reader.Update()
        pictures.append(vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int))
    difference = abs(pictures[0] - pictures[2]).max()
    if difference > 1 or (pictures[0] != pictures[1]).any() or pictures[0].std() < 5:
        fail(f"AMR is {difference} of 255 from its field")
    expect(0, r"kind +AMR: 6 boxes in 3 levels", "info", "refined.vthb")
    expect(0, "picture", "render", "refined.vthb", "-o", "out.png", *look, "--nearest")
    expect(0, "picture", "render", "refined.vthb", "-o", "lit.png", *look, "--shade")
    with open("out.png", "rb") as plain, open("lit.png", "rb") as lit:
        if plain.read() == lit.read():
            fail("light changes no picture of AMR")
    expect(2, "is AMR, which is drawn without others", "render", "refined.vthb", "fine.vti", "-o", "no.png")
    write(vtkXMLUniformGridAMRWriter, Refined(uneven(), cells=False).data(vtkCommonDataModel), "points.vthb")
    expect(1, "nearest interpolation of AMR's values of points", "render", "points.vthb", "-o", "no.png", "--nearest")


def pixels_of_tiff(name):
    """One strip, packed or not, since VTK's reader puts the first row at the bottom."""
    with open(name, "rb") as file:
        data = file.read()
    at = struct.unpack_from("<I", data, 4)[0]
    tags = {}
    for i in range(struct.unpack_from("<H", data, at)[0]):
        tag, kind, _, value = struct.unpack_from("<HHII", data, at + 2 + 12 * i)
        tags[tag] = value & 0xffff if kind == 3 else value
    width, height, strip, bytes_in, runs = tags[256], tags[257], tags[273], tags[279], tags[259] == 32773
    rows, at = bytearray(), strip
    while runs and at < strip + bytes_in:
        count = data[at]
        if count < 128:
            rows += data[at + 1:at + count + 2]
        elif count > 128:
            rows += data[at + 1:at + 2] * (257 - count)
        at += count + 2 if count < 128 else 1 if count == 128 else 2
    if tags[274] != 1:
        fail(f"{name} has its first row elsewhere than at the top")
    rows = bytes(rows) if runs else data[strip:strip + bytes_in]
    return numpy.frombuffer(rows, numpy.uint8).reshape(height, width, 3)[::-1].astype(int)


def test_picture_formats():
    """A picture has the format of its name, by the file's first bytes and its pixels."""
    render = ("render", "image.vti", *LOOK)
    expect(0, "picture", *render, "-o", "out.png")
    sound = pixels("out.png")
    for name, begin, reader, most in (("out.jpg", b"\xff\xd8\xff", vtkJPEGReader, 40), ("OUT.JPEG", b"\xff\xd8\xff", vtkJPEGReader, 40),
                                      ("out.tif", b"II*\0", None, 0), ("out.tiff", b"II*\0", None, 0), ("out.bmp", b"BM", vtkBMPReader, 0),
                                      ("out", b"\x89PNG", vtkPNGReader, 0)):
        expect(0, "picture", *render, "-o", name)
        with open(name, "rb") as file:
            if not file.read(4).startswith(begin):
                fail(f"{name} does not begin with {begin}")
        difference = abs((pixels(name, reader) if reader else pixels_of_tiff(name)) - sound)
        if difference.max() > most or difference.mean() > most / 10:
            fail(f"{name} is up to {difference.max()} of 255 from the PNG")
    for name in "out.webp", "out.gif", "out.pdf", "out.0001":
        output = expect(2, rf"'{name}': pictures can't be written as \{name[3:]}, but as \.png, \.jpg, \.tif, \.bmp", *render, "-o", name)
        if os.path.exists(name):
            fail(f"{name} was written: {output}")
    expect(2, r"'out-%d\.webp': pictures can't be written as \.webp", "render", "image.vti", *LOOK, "--frames", "out-%d.webp")
    for name in "out.jpg", "out.tif", "out.bmp":
        expect(2, rf"'{name}': only .png and .exr pictures can be transparent", *render, "-o", name, "--background", "transparent")
    # Pictures of other formats are compared as they look: VTK's reader of TIFF puts the first row at the bottom.
    for name in "out.tif", "out.bmp":
        expect(0, "", "compare", "out.png", name)
    with open("out.tif", "rb") as file:
        data = file.read()
    at = data.index(struct.pack("<HHIH", 274, 3, 1, 1)) + 8
    for orientation in range(2, 9):
        with open("turned.tif", "wb") as file:
            file.write(data[:at] + bytes([orientation]) + data[at + 1:])
        expect(1, f"the TIFF tag Orientation is {orientation}", "compare", "out.png", "turned.tif")
        expect(1, f"cannot read 'turned.tif': the TIFF tag Orientation is {orientation}", "info", "turned.tif")
    expect(0, "picture", "render", "image.vti", "-o", "cost.bmp", "--size", "48x40", "--device", "host", "--show", "samples")
    pixels("cost.bmp", vtkBMPReader)


def test_scans():
    """A scan's position and values; vtkStratusImageReader's own test has the rest."""
    raw = numpy.arange(4 * 3 * 2, dtype=">i2").tobytes()
    with open("turned.mhd", "w") as file:
        file.write("ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementByteOrderMSB = True\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\n"
                   "Offset = 10 20 30\nElementSpacing = 1 1.5 2\nElementType = MET_SHORT\nElementDataFile = turned.raw\n")
    with open("turned.raw", "wb") as file:
        file.write(raw)
    expect(0, r"bounds +7 \.\. 10, 20 \.\. 23, 30 \.\. 32$", "info", "turned.mhd")
    head = bytearray(352)
    for at, kind, *numbers in ((0, "i", 348), (40, "8h", 3, 4, 3, 2, 1, 1, 1, 1), (70, "h", 4), (76, "8f", 1, 1, 1, 1, 0, 0, 0, 0), (108, "3f", 352, 0.5, -100),
                               (123, "b", 2), (254, "h", 1), (280, "12f", -1, 0, 0, 90, 0, 1.5, 0, -126, 0, 0, 2, -72), (344, "4s", b"n+1")):
        struct.pack_into(">" + kind, head, at, *numbers)
    for name, write_to in (("scan.nii", open), ("scan.nii.gz", gzip.open), ("otherwise", open)):
        with write_to(name, "wb") as file:
            file.write(bytes(head) + raw)
        expect(0, r"range +-100 \.\. -88\.5$", "info", name)
        expect(0, r"bounds +87 \.\. 90, -126 \.\. -123, -72 \.\. -70$", "info", name)
        expect(0, "values are 0.5 \\* stored \\+ -100", "info", name)
        expect(0, "picture", "render", name, "-o", "out.png", "--size", "48x40", "--device", "host", "--axes")
    pair = bytes(head[:344]) + b"ni1\0" + bytes(4)
    with open("scan.hdr", "wb") as file:
        file.write(pair[:108] + bytes(4) + pair[112:])
    with open("scan.img", "wb") as file:
        file.write(raw)
    for name in "scan.hdr", "scan.img":
        expect(0, r"bounds +87 \.\. 90, -126 \.\. -123, -72 \.\. -70$", "info", name)
    with open("signa.MR", "wb") as file:
        file.write(b"IMGF" + bytes(8000))
    expect(1, "cannot read 'signa.MR': VTK's reader of GE Signa files leaves their orientation out", "info", "signa.MR")
    turned = image()
    turned.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
    expect(0, r"bounds +-3 \.\. 0, 0 \.\. 4, 0 \.\. 5$", "info", write(vtkXMLImageDataWriter, turned, "turned.vti"))
    with open("turned.mhd") as file:
        text = file.read()
    with open("turned.mhd", "w") as file:
        file.write(text.replace("4 3 2", "4 3 3"))
    expect(1, "cannot read 'turned.mhd': turned.raw: has 48 bytes, which can't be the 36 values of 2 bytes", "info", "turned.mhd")


def test_limit_of_memory():
    """Values of a .vti file that are more than the limit are read in parts, as the same picture."""
    n = 170
    x, y, z = numpy.meshgrid(*(numpy.linspace(-1, 1, n),) * 3, indexing="ij")
    large = vtkImageData()
    large.SetDimensions(n, n, n)
    array = numpy_to_vtk((30 * numpy.exp(-5 * (x * x + y * y + z * z))).astype(numpy.float32).ravel(order="F"), deep=True)
    array.SetName("rho")
    large.GetPointData().SetScalars(array)
    writer = vtkXMLImageDataWriter()
    writer.SetInputData(large)
    writer.SetFileName("large.vti")
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    for compress in writer.SetCompressorTypeToNone, writer.SetCompressorTypeToLZ4:
        compress()
        writer.Write()
        whole = picture("large.vti")
        if picture("large.vti", "--memory", "16M") != whole:
            fail(f"large.vti is another picture in little memory, by {compress.__name__}")
        expect(0, r"read +\d+ MiB of bricks, +\d+ MiB in memory, limit 16$", "render", "large.vti", "-v", "-o", "out.png", *LOOK,
               "--memory", "16M")


PARTS = {  # within a part, tests read files of those before
    "grids": (test_kinds, test_modes_of_grids, test_bad_grids, test_collections, test_films),
    "memory": (test_memory, test_memory_of_meshes_that_stay),
    "memory_of_cells": (test_memory_of_meshes_that_move,),
    "looks": (test_pictures_of_nothing, test_surfaces_without_opacity, test_exaggeration, test_annotations, test_colors_and_logarithm, test_vectors, test_picture_formats),
    "images": (test_raw_types, test_raw, test_scans, test_refined, test_limit_of_memory),
    "readers": (test_netcdf, test_vdb, test_vtkhdf, test_openfoam, test_ensight),
}

if __name__ == "__main__":
    missing = {value for name, value in globals().items() if name.startswith("test_")} - {test for part in PARTS.values() for test in part}
    if missing:
        sys.exit(f"no part has {missing}")
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(FOLDER)
    os.chdir(FOLDER)
    make_files()
    for test in PARTS[PART]:
        test()
    sys.exit(1 if failures else 0)
