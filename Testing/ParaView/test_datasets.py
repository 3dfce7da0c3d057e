# SPDX-License-Identifier: BSD-3-Clause
"""pvbatch with the plugin: each kind of data set looks as `stratus render` draws it: rectilinear, unstructured and structured grids, blocks
of composite data, vectors by magnitude and component, projections, light, a crop box.
pvbatch test_datasets.py PLUGIN STRATUS COMPARE-PICTURES FOLDER, in the repository's root."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from beside import draw, folder, leave, load
from grids import COLORS, OPACITY, axes, write_all

MATERIAL = {"Ambient": 0.1, "Diffuse": 0.9, "Specular": 0}  # of `stratus render`

load()
levels, hills, cells, parts = write_all(folder)
draw(parts, "hill", OPACITY, COLORS, 1.0, 53, judge=levels, representation="UniformGridRepresentation")
for path in levels, hills, cells:
    draw(path, "hill", OPACITY, COLORS, 1.0, 55)
    draw(path, "wind", OPACITY, COLORS, 1.0, 55, component="Magnitude", judged="wind_alone")
    draw(path, "wind", OPACITY, COLORS, 1.0, 55, component="Z", judged="wind_third")
    projection = "StratusProjection" if path == levels else "StratusCellsBlendMode"
    draw(path, "hill", OPACITY, COLORS, 1.0, 55, settings={projection: "Maximum Intensity"}, options=("--mode", "maximum"))
for path, shade in (levels, "StratusShade"), (hills, "StratusCellsShade"), (cells, "StratusCellsShade"):
    draw(path, "hill", OPACITY, COLORS, 1.0, 55, settings={shade: 1, **MATERIAL}, options=("--shade",), headlight=True)
for path in levels, parts:
    draw(path, "hill", OPACITY, COLORS, 1.0, 53, judge=levels, representation="UniformGridRepresentation",
         settings={"BlendMode": "Slice", "StratusSliceFunction": {"Origin": [121, 3, 16], "Normal": [1, 0.5, 0.3]}},
         options=("--mode", "slice", "--slice", "121,3,16,1,0.5,0.3"))
draw(levels, "hill", OPACITY, COLORS, 1.0, 55, settings={"UseCropping": 1, "CroppingScale": [1, 1, 0.5]},
     options=("--crop", ",".join(str(edge) for axis, scale in zip(axes(), (1, 1, 0.5)) for edge in (axis[0] * scale, axis[-1] * scale))))
leave()
