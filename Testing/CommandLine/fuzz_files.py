# SPDX-License-Identifier: BSD-3-Clause
"""fuzz_files.py STRATUS FOLDER COUNT SEED: damaged files through the command line, COUNT of them. Each must be drawn, or refused with a sentence and
exit status 1; a signal, a silent failure, an output after a refusal and a file left over are findings. A finding names its file, which stays in
FOLDER; the same seed makes the same files again."""
import gzip
import os
import random
import re
import resource
import struct
import subprocess
import sys

stratus, folder, count, seed = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
os.makedirs(folder, exist_ok=True)
chance = random.Random(seed)
SIDE = 6
CELLS = SIDE - 1
values = [(i * 37 % 101) / 100 for i in range(SIDE**3)]
text = " ".join(map(str, values))
cubes = [[(x + (k & 1)) + SIDE * ((y + (k >> 1 & 1)) + SIDE * (z + (k >> 2))) for k in path]
         for x in range(CELLS) for y in range(CELLS) for z in range(CELLS)
         for path in ((0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7))]
points = [(i % SIDE, i // SIDE % SIDE, i // SIDE**2) for i in range(SIDE**3)]


def lines(rows):
    return "\n".join(" ".join(map(str, row)) for row in rows)


def files():
    """Sound files by name, as bytes."""
    n = SIDE**3
    image = f"# vtk DataFile Version 3.0\nimage\n%s\nDATASET STRUCTURED_POINTS\nDIMENSIONS {SIDE} {SIDE} {SIDE}\nORIGIN 0 0 0\nSPACING 1 1 1\n"
    ghosts = f"CELL_DATA {CELLS**3}\nFIELD f 1\nvtkGhostType 1 {CELLS**3} unsigned_char\n" + " ".join(["0"] * CELLS**3) + "\n"
    yield "ascii.vtk", (image % "ASCII" + ghosts + f"POINT_DATA {n}\nSCALARS density float 1\nLOOKUP_TABLE default\n{text}\n").encode()
    yield "binary.vtk", ((image % "BINARY" + f"POINT_DATA {n}\nSCALARS density float 1\nLOOKUP_TABLE default\n").encode() + struct.pack(f">{n}f", *values))
    yield "image.vti", f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian"><ImageData WholeExtent="0 {CELLS} 0 {CELLS} 0 {CELLS}" Origin="0 0 0" Spacing="1 1 1">
<Piece Extent="0 {CELLS} 0 {CELLS} 0 {CELLS}"><PointData Scalars="density"><DataArray type="Float32" Name="density" format="ascii">{text}</DataArray>
<DataArray type="UInt8" Name="vtkGhostType" format="ascii">{" ".join(["0"] * n)}</DataArray></PointData></Piece></ImageData></VTKFile>
""".encode()
    raw = struct.pack(f"<{n}f", *values)
    yield "image.mha", (f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize = {SIDE} {SIDE} {SIDE}\n"
                        "ElementSpacing = 1 1 1\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n").encode() + raw
    yield "image.nrrd", (f"NRRD0004\ntype: float\ndimension: 3\nsizes: {SIDE} {SIDE} {SIDE}\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
                         "spacings: 1 1 1\n\n").encode() + raw
    yield "ascii.nrrd", f"NRRD0004\ntype: float\ndimension: 3\nsizes: {SIDE} {SIDE} {SIDE}\nkinds: domain domain domain\nencoding: ascii\n\n{text}\n".encode()
    yield "packed.nrrd", (f"NRRD0005\ntype: float\ndimension: 4\nsizes: 1 {SIDE} {SIDE} {SIDE}\nkinds: list domain domain domain\nspace: RAS\n"
                          "space directions: none (0,1,0) (-1,0,0) (0,.2,1)\nendian: little\nencoding: gzip\n\n").encode() + gzip.compress(raw, mtime=0)
    head = bytearray(352)
    for at, kind, *numbers in ((0, "i", 348), (40, "8h", 3, SIDE, SIDE, SIDE, 1, 1, 1, 1), (70, "h", 16), (76, "8f", 1, 1, 1, 1, 0, 0, 0, 0),
                               (108, "3f", 352, 2, 1), (252, "2h", 1, 0), (256, "3f", 0, 0, .6), (344, "4s", b"n+1")):
        struct.pack_into("<" + kind, head, at, *numbers)
    yield "image.nii", bytes(head) + raw
    yield "grid.vtk", (f"# vtk DataFile Version 3.0\ngrid\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {n} float\n{lines(points)}\n"
                       f"CELLS {len(cubes)} {5 * len(cubes)}\n{lines([4, *c] for c in cubes)}\nCELL_TYPES {len(cubes)}\n{lines([10] for _ in cubes)}\n"
                       f"POINT_DATA {n}\nSCALARS density float 1\nLOOKUP_TABLE default\n{text}\n").encode()
    yield "grid.vtu", f"""<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid><Piece NumberOfPoints="{n}" NumberOfCells="{len(cubes)}">
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">{lines(points)}</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">{lines(cubes)}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{" ".join(str(4 * i + 4) for i in range(len(cubes)))}</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">{" ".join(["10"] * len(cubes))}</DataArray></Cells>
<PointData Scalars="density"><DataArray type="Float32" Name="density" format="ascii">{text}</DataArray></PointData></Piece></UnstructuredGrid></VTKFile>
""".encode()
    yield "mesh.ele", (f"{len(cubes)} 4 0\n" + lines([i, *c] for i, c in enumerate(cubes)) + "\n").encode()


node = (f"{SIDE**3} 3 1 0\n" + lines([i, *p, values[i]] for i, p in enumerate(points)) + "\n").encode()
odd = [b"0", b"-1", b"1", b"255", b"65536", b"2147483647", b"-2147483648", b"4294967296", b"9223372036854775807", b"1e30", b"1e308", b"nan", b"inf",
       b"", b"x", b"%n%s", b"1e-320"]


def damage(data):
    """One wound, or up to three."""
    data = bytearray(data)
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        head = min(len(data), 600) if chance.random() < 0.7 else len(data)  # readers believe headers
        kind = chance.randrange(6)
        at = chance.randrange(max(1, head))
        if kind == 0 and data:
            data[at % len(data)] = chance.randrange(256)
        elif kind == 1:
            del data[at:at + chance.randint(1, 1 + len(data) // 3)]
        elif kind == 2:
            data[at:at] = data[at:at + chance.randint(1, 80)]
        elif kind == 3:
            del data[chance.randrange(len(data) + 1):]
        else:  # a number in place of another
            numbers = list(re.finditer(rb"-?\d+(?:\.\d*)?", bytes(data[:head])))
            if numbers:
                number = chance.choice(numbers)
                data[number.start():number.end()] = chance.choice(odd)
    return bytes(data)


def bounded():
    """A header may request any amount of memory."""
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


sound = dict(files())
endings = {0: 0, 1: 0}
findings = 0
for case in range(count):
    name = chance.choice(sorted(sound))
    path = os.path.join(folder, f"case-{name}")
    picture, boxes = os.path.join(folder, "out.png"), os.path.join(folder, "out.vtp")
    mesh = name.startswith(("grid", "mesh"))
    with open(path, "wb") as file:
        file.write(damage(sound[name]))
    if name == "mesh.ele":
        with open(os.path.join(folder, "case-mesh.node"), "wb") as file:
            file.write(damage(node) if chance.random() < 0.5 else node)
    command, output = chance.choice([(["render", path, "-o", picture, "--size", "24x24"], picture), (["info", path], None),
                                     (["sort", path], None) if mesh else (["tree", path, "-o", boxes], boxes)])
    before = set(os.listdir(folder))
    wrong = None
    try:
        ran = subprocess.run([stratus, *command, "--read-timeout", "20"] + (["--device", "host"] if command[0] != "info" else []),
                             capture_output=True, text=True, errors="replace", timeout=120, preexec_fn=bounded)
        if ran.returncode not in endings:
            wrong = f"exit status {ran.returncode}"
        elif ran.returncode and not ran.stderr.strip():
            wrong = "refused without a word"
        elif output and os.path.exists(output) != (ran.returncode == 0):
            wrong = f"exit status {ran.returncode}, and {'an' if ran.returncode else 'no'} output"
        else:
            endings[ran.returncode] += 1
    except subprocess.TimeoutExpired:
        wrong = "no end after 120 s"
    left = set(os.listdir(folder)) - before - {"out.png", "out.vtp"}
    wrong = wrong or (f"{left} left over" if left else None)
    if wrong:
        findings += 1
        kept = os.path.join(folder, f"finding-{seed}-{case}-{name}")
        os.replace(path, kept)
        print(f"FINDING: {' '.join([*command]).replace(path, kept)}: {wrong}\n{ran.stderr[-400:] if 'ran' in dir() else ''}")
    for file in (picture, boxes):
        if os.path.exists(file):
            os.remove(file)
print(f"{count} damaged files: {endings[0]} drawn, {endings[1]} refused, {findings} findings")
sys.exit(1 if findings else 0)
