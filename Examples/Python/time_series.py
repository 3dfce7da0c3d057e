# SPDX-License-Identifier: BSD-3-Clause
# A puff of smoke that drifts and thins, step by step in one array, played to frames: time_series.py [FOLDER]
import sys, numpy, stratus

folder = sys.argv[1] if len(sys.argv) > 1 else "."
z, y, x = numpy.meshgrid(*[numpy.linspace(-1, 1, n, dtype=numpy.float32) for n in (48, 64, 128)], indexing="ij", sparse=True)
smoke, mapper = numpy.empty((48, 64, 128), numpy.float32), stratus.vtkStratusVolumeMapper()
volume = stratus.as_image(smoke, spacing=(1, 1, 1))  # over the array's own memory: each step writes into it
for step in range(12):
    time, wide = step / 11, 0.25 + 0.35 * step / 11
    ripple = numpy.sin(16 * x - 6 * time) * numpy.cos(12 * y + 3 * time) + numpy.sin(10 * z + 14 * x) * numpy.cos(21 * y - 5 * time)
    far = (x - 1.3 * time + 0.65) ** 2 + (y - 0.2 * numpy.sin(4 * time)) ** 2 + (z + 0.4 - 0.5 * time) ** 2
    smoke[:] = numpy.maximum(0, (1 + 0.5 * ripple - far / wide**2) * (1 - 0.6 * time))
    volume.GetPointData().GetScalars().Modified()  # VTK does not watch NumPy
    picture = stratus.show(volume, opacity=[(0.02, 0), (1, 0.4)], color=[(0, 0.5, 0.55, 0.65), (1, 1, 0.97, 0.9)], unit_distance=2, mapper=mapper,
                           camera=dict(azimuth=15, elevation=15, zoom=1.9))
    picture.save(f"{folder}/smoke-{step:02d}.png")
    update_ms = mapper.GetRangeTime() + mapper.GetTableTime() + mapper.GetOccupancyTime() + mapper.GetStructureTime()
    print(f"step {step:2d}: update_ms {update_ms:.2f}, cast_ms {mapper.GetCastTime():.2f},",
          f"{mapper.GetOccupiedBlocks()} of {mapper.GetBlocks()} blocks show")
