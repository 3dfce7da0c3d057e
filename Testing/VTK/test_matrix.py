# SPDX-License-Identifier: BSD-3-Clause
"""Which grid is drawn in which mode with which feature, on the host and by OpenCL. Each picture is compared with the double-precision
reference, and the table with docs/matrix.md. A combination that was drawn must stay drawn; one more that is drawn must be written down.
Without --all a sample of combinations is drawn, and some of two features."""
import argparse
import os
import random
import sys
import time

import numpy
import vtk

import matrix_reference
import matrix_scenes as scenes

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "matrix.md")
DEVICES = "host", "pthread"
LEAST = 38.0  # decibels from the reference; pictures of a window have 8 bits
LEFT_OUT = {feature: {"composite"} for feature in ("gradient_opacity", "function_2d", "labels")}  # in all modes but these
LEFT_OUT["light"] = {"composite", "isosurface", "first_hit"}
CONTRADICT = {"two_components", "rgba"}, {"mask", "labels"}, {"function_2d", "gradient_opacity"}  # two meanings of one thing
TITLES = {
    "image": "Image",
    "rectilinear": "Rectilinear grid",
    "amr": "AMR",
    "blocks": "Blocks",
    "tetrahedra": "Tetrahedra",
    "several": "Several images",
    "image_and_mesh": "Image and tetrahedra",
}


def decibels(picture, exact):
    """From the root mean square difference where either picture shows something."""
    lit = (picture.max(-1) > 0.5 / 255) | (exact.max(-1) > 0.5 / 255)
    if not lit.any():
        return numpy.inf
    error = numpy.sqrt(((picture - exact)[lit] ** 2).mean())
    return -20 * numpy.log10(max(error, 1e-6))


def judge(grid, mode, features, devices=DEVICES):
    """For each device what it shows: "yes", or why not, and decibels from the reference."""
    results, exact = [], None
    for device in devices:
        picture, why, renderer = scenes.draw(grid, mode, features, device)
        if picture is None:
            results.append((why, None))
            continue
        if exact is None:
            exact = matrix_reference.picture(grid, mode, features, renderer)
        results.append(("yes" if picture.max() > 0 or exact.max() < 0.5 / 255 else "nothing", decibels(picture, exact)))
    return results, exact


def singles():
    return [(grid, mode, (feature,) if feature else ()) for grid in scenes.GRIDS for mode in scenes.MODES for feature in [""] + scenes.FEATURES]


def name_of(grid, mode, features):
    return " ".join([grid, mode, *(features or ["plain"])])


def mark(grid, mode, features, results):
    drawn = [what == "yes" for what, _ in results]
    if not any(drawn):
        return "-"
    if any(f in LEFT_OUT and mode not in LEFT_OUT[f] for f in features) or (grid == "tetrahedra" and "function_2d" in features):
        return "left out"
    return "yes" if all(drawn) else "host" if drawn[0] else "device"


def pairs(seed, count):
    """Random combinations of two features."""
    random_of = random.Random(seed)
    result = []
    while len(result) < count:
        features = tuple(sorted(random_of.sample(scenes.FEATURES, 2), key=scenes.FEATURES.index))
        if not any(set(c) <= set(features) for c in CONTRADICT):
            result.append((random_of.choice(scenes.GRIDS), random_of.choice(scenes.MODES), features))
    return result


INTRODUCTION = """# What is drawn

Every grid, in every blend mode and in first hits, with every feature of a volume's property and mapper. `Testing/VTK/test_matrix.py` draws
each combination, compares it with a reference in double precision, and compares the result with this page.

- **yes**: drawn, on the host and by OpenCL.
- **host**: drawn on the host; the OpenCL device refuses it.
- **left out**: drawn without the feature, which has no meaning in this mode, with one warning a mapper.
- **-**: refused, by an error that names the reason; nothing is drawn.

The grids are `vtkImageData`, `vtkRectilinearGrid`, `vtkOverlappingAMR` of three levels, two blocks of an image, tetrahedra, two images in
`vtkStratusMultiVolume`, and an image and tetrahedra there. Of several volumes, the first has the feature.
"""


def write_page(marks):
    lines = [INTRODUCTION]
    counts = {}
    for grid in scenes.GRIDS:
        lines.append(f"## {TITLES[grid]}\n")
        lines.append("| mode | plain | " + " | ".join(f.replace("_", " ") for f in scenes.FEATURES) + " |")
        lines.append("|---" * (len(scenes.FEATURES) + 2) + "|")
        for mode in scenes.MODES:
            row = [marks[grid, mode, (f,) if f else ()] for f in [""] + scenes.FEATURES]
            lines.append(f"| {mode.replace('_', ' ')} | " + " | ".join(row) + " |")
            for m in row:
                counts[m] = counts.get(m, 0) + 1
        lines.append("")
    drawn = 2 * (counts.get("yes", 0) + counts.get("left out", 0)) + counts.get("host", 0) + counts.get("device", 0)
    lines.append(f"## In all\n\n{drawn} of {2 * sum(counts.values())} combinations of grid, mode, feature and device are drawn.")
    with open(PAGE, "w", encoding="utf-8") as page:
        page.write("\n".join(lines) + "\n")


def read_page():
    marks, grid = {}, None
    with open(PAGE, encoding="utf-8") as page:
        for line in page:
            cells = [c.strip() for c in line.strip().strip("|").split("|")]
            if line.startswith("## "):
                grid = next((g for g, t in TITLES.items() if t == line[3:].strip()), None)
            elif grid and line.startswith("| ") and cells[0] != "mode":
                for feature, found in zip([""] + scenes.FEATURES, cells[1:]):
                    marks[grid, cells[0].replace(" ", "_"), (feature,) if feature else ()] = found
    return marks


def main():
    options = argparse.ArgumentParser()
    options.add_argument("folder", nargs="?")
    options.add_argument("--write", action="store_true", help="write the page")
    options.add_argument("--only", default="", help="combinations whose name has this text")
    options.add_argument("--all", action="store_true", help="all combinations of a feature, and 200 of two")
    options.add_argument("--host", action="store_true", help="on the host only")
    options.add_argument("--seed", type=int, default=1, help="of the sample, and of combinations of two features")
    options = options.parse_args()
    vtk.vtkObject.GlobalWarningDisplayOff()
    everything = options.all or options.write or bool(options.only)
    combinations = singles() if everything else random.Random(options.seed).sample(singles(), 24)
    combinations += [] if options.write or options.only else pairs(options.seed, 200 if options.all else 10)
    page = {} if options.write else read_page()
    devices = DEVICES[: 1 if options.host else 2]
    failed, marks, began = 0, {}, time.time()
    for number, (grid, mode, features) in enumerate(combinations):
        name = name_of(grid, mode, features)
        if options.only not in name:
            continue
        # The sample's device compiles few kernels.
        here = devices if everything or number % 16 == 0 else devices[:1]
        results, exact = judge(grid, mode, features, here)
        marks[grid, mode, features] = mark(grid, mode, features, results)
        for device, (what, error) in zip(here, results):
            bad = what == "nothing" or (error is not None and error < LEAST)
            failed += bad
            print(f"{name}, {device}: {what if error is None else f'{what} {error:.1f} dB'}{' FAILED' if bad else ''}", flush=True)
        expected = page.get((grid, mode, features))
        if expected and (results[0][0] == "yes") != (expected not in ("-", "device")) or expected and len(here) == 2 and marks[grid, mode, features] != expected:
            failed += 1
            print(f"{name}: docs/matrix.md says {expected}; test_matrix.py --write writes it anew. FAILED", flush=True)
    if options.write:
        write_page(marks)
    print(f"{len(marks)} combinations, {failed} failed, {time.time() - began:.0f} s")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
