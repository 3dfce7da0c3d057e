# SPDX-License-Identifier: BSD-3-Clause
"""stratus_volume's calls of the core: contexts, pictures, cameras, errors, cancelling, threads, freed memory."""
import gc
import multiprocessing
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import warnings
import zlib

from checking import ball, check, done, refuse

import numpy

import stratus_volume
from stratus_volume import Context, Volume, render, show

warnings.simplefilter("error")

field = ball((20, 22, 24), (10, 11, 12), 8)
host = dict(device="host", size=(90, 60))


def contexts():
    own = Context("host", 1)
    check("host" in own.device and "1 thread" in own.device, own.device)
    check(stratus_volume._core.context("host", 1) is stratus_volume._core.context("host", 1), "one context for one name")
    check(stratus_volume._core.context(own) is own, "a context of one's own")
    check(isinstance(stratus_volume.devices(), list), "devices can be asked")
    refuse(ValueError, "warp", Context, "warp drive")
    refuse(ValueError, "1024", Context, "host", 5000)
    refuse(TypeError, "threads", Context, "host", "many")
    refuse(TypeError, "device", Context, 3.5)
    refuse(ValueError, "threads", render, field, device=own, threads=2)
    check(tuple(int(part) for part in stratus_volume.__version__.split(".")) >= (0, 1, 0), stratus_volume.__version__)


def pictures():
    rendering = render(field, opacity=[(0, 0), (0.5, 0.9)], color=(1, 0.5, 0), **host)
    rgba, depth, counters = rendering
    check(rgba.shape == (60, 90, 4) and rgba.dtype == numpy.float32 and depth.shape == (60, 90) and depth.dtype == numpy.float32, "shapes")
    check(rgba[30, 45, 3] > 0.8 and rgba[2, 2].max() == 0, f"opaque in the middle, nothing in the corner: {rgba[30, 45]}")
    check(abs(rgba[30, 45, 1] - 0.5 * rgba[30, 45, 0]) < 1e-3, "colours are premultiplied")
    check(numpy.isinf(depth[2, 2]) and numpy.isfinite(depth[30, 45]), "depth where something shows")
    check(numpy.array_equal(numpy.isfinite(depth), rgba[..., 3] > 0), "depth and alpha show the same pixels")
    check(counters["samples"] > 1000 and counters["rays"] > 100 and counters["structure"] in ("none", "block", "distance", "octant", "hybrid"),
          f"counters: {counters}")
    picture = rendering.picture(background=(0, 0, 1))
    check(tuple(picture[0, 0]) == (0, 0, 255, 255) and picture.dtype == numpy.uint8, "over a background")
    check(picture._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n" and picture[0]._repr_png_() is None, "notebooks get PNG only of pictures")
    high = ball((20, 20, 20), (16, 10, 10), 3)
    up = show(high, opacity=[(0, 0), (0.5, 0.9)], background=None, camera=dict(elevation=0, zoom=1), size=(60, 60), device="host")[..., 3]
    check((up.astype(float).sum(1) * numpy.arange(60)).sum() / up.sum() < 25, "z points up, the first row is the top one")
    whole = show(high, size=(60, 40), device="host")
    check("Picture of 60 x 40 pixels" in repr(whole) and "Picture([" in repr(whole[0]), "a picture's text is its size")
    for option in dict(mode="maximum"), dict(mode="minimum", opacity=[(0, 0.5), (1, 0)]), dict(mode="first-hit"), dict(mode="isosurface", contours=[0.3, 0.6]), dict(shade=True), \
            dict(mode="additive"), dict(mode="average"), dict(interpolation="nearest"), dict(crop=(0, 12, 0, 22, 0, 20)), \
            dict(clip_planes=[(1, 0, 0, -12)]), dict(gradient_opacity=[(0, 0), (0.2, 1)]), dict(unit_distance=20), dict(shade=dict(specular=1)), \
            dict(camera=dict(azimuth=70)), dict(camera=dict(zoom=2)), dict(spacing=(1, 1, 2)), dict(color=[(0, 1, 0, 0), (1, 0, 1, 0)]), \
            dict(jitter=True, sample_distance=2), dict(average_range=(0.5, 1), mode="average"), dict(opacity=0.9):
        changed = render(field, **{**host, **option})
        check(not numpy.array_equal(changed.rgba, render(field, **host).rgba), f"{option} changes the picture")
    places = numpy.stack(numpy.meshgrid(*(numpy.arange(n, dtype=float) for n in field.shape), indexing="ij"), axis=3)
    for drawn in stratus_volume.Volume(field, device="host"), stratus_volume.Tetrahedra(places, None, field, device="host"):
        denser = drawn.render(size=host["size"], extinction=2.5, unit_distance=10).rgba
        check(numpy.array_equal(denser, drawn.render(size=host["size"], unit_distance=4).rgba), "extinction multiplies optical depths")
        count = " x ".join(map(str, field.shape)) if isinstance(drawn, stratus_volume.Volume) else f"{field.size} points"
        check(f"{type(drawn).__name__} of {count}" in repr(drawn), repr(drawn))
        refuse(TypeError, "has no argument 'metod'", stratus_volume.render, drawn, metod="auto")
    refuse(TypeError, "show() has no argument 'sampling' for a Tetrahedra", show, drawn, sampling="cells")
    low, high = float(field.min()), float(field.max())
    ends, mapped = [(low, 0, 0.25, 1), (high, 1, 0.75, 0)], lambda place: (place, 0.25 + 0.5 * place, 1 - place, 1.0)  # as matplotlib's, with an alpha
    apart = numpy.abs(render(field, color=mapped, **host).rgba - render(field, color=ends, **host).rgba).max()
    check(apart < 1e-3, f"a colour map from the smallest value to the largest: {apart}")
    twice = render(numpy.stack([field, field], axis=3), color=[mapped, mapped], **host).rgba
    check(numpy.abs(twice - render(numpy.stack([field, field], axis=3), color=[ends, ends], **host).rgba).max() < 1e-3, "for each component")
    for structure in "none", "block", "distance", "octant", "hybrid":
        same = render(field, structure=structure, audit=True, sampling="midpoint", sample_distance=0.5, **host)
        check(same.counters["structure"] == structure and same.counters["differing_pixels"] == 0, f"{structure} skips what shows nothing")


def planes_and_crops():
    half = render(field, clip_planes=[(1, 0, 0, -12)], **host).rgba
    crop = render(field, crop=(12, 23, 0, 21, 0, 19), **host).rgba
    check(numpy.abs(half - crop).max() < 0.02, f"a plane at x = 12 and a crop from it: {numpy.abs(half - crop).max()}")
    moved = render(field, crop=(112, 123, 0, 21, 0, 19), origin=(100, 0, 0), **host).rgba
    check(numpy.abs(moved - crop).max() < 0.02, f"crop is in the world's lengths: {numpy.abs(moved - crop).max()}")
    turned = numpy.ascontiguousarray(field.transpose(2, 1, 0))
    same = render(turned, axes="xyz", crop=(112, 123, 0, 21, 0, 19), origin=(100, 0, 0), **host).rgba
    check(numpy.abs(same - crop).max() < 0.02, f"whatever the order of axes: {numpy.abs(same - crop).max()}")


def cameras():
    far = dict(position=(11.5, -60, 9.5), focal_point=(11.5, 10.5, 9.5), view_up=(0, 0, 1))
    seen = render(field, camera=far, **host)
    check(abs(seen.depth[30, 45] - 63) < 3, f"the ball begins 63 before the eye: {seen.depth[30, 45]}")
    listed = render(field, camera=[far["position"], far["focal_point"], far["view_up"]], **host)
    check(numpy.array_equal(seen.rgba, listed.rgba), "three points")
    wide = render(field, camera=dict(far, parallel_scale=10), **host).rgba[..., 3] > 0.01
    close = render(field, camera=dict(far, parallel_scale=20), **host).rgba[..., 3] > 0.01
    check(abs(wide.sum() / close.sum() - 4) < 0.4, f"twice the scale, a quarter of the pixels: {wide.sum()} {close.sum()}")
    for size in (90, 60), (60, 90):
        corners = render(numpy.ones((9, 9, 9), numpy.uint8), opacity=1, size=size, camera=dict(zoom=1), device="host").rgba[..., 3]
        check(corners[0].max() == corners[-1].max() == corners[:, 0].max() == corners[:, -1].max() == 0 < corners.max(), f"all is in the window {size}")
    refuse(TypeError, "camera", render, field, camera=3)
    refuse(ValueError, "roll", render, field, camera=dict(roll=3))
    refuse(ValueError, "zoom", render, field, camera=dict(zoom=0))
    refuse(ValueError, "focal_point", render, field, camera=dict(position=(0, 0, 9)))
    refuse(ValueError, "180", render, field, camera=dict(far, view_angle=200), device="host")


def kept():
    volume = Volume(field, device="host")
    check(volume.bounds == (0, 23, 0, 21, 0, 19), f"bounds: {volume.bounds}")
    first = volume.render(size=(60, 60))
    second = volume.render(size=(60, 60), camera=dict(azimuth=100))
    check(first.counters["range_builds"] == second.counters["range_builds"] == 1, "a camera's move builds no ranges anew")
    check(numpy.array_equal(render(volume, size=(60, 60)).rgba, first.rgba), "and draws again what it drew")
    own = numpy.array(field)
    volume = Volume(own, device="host")
    before = volume.render(size=(60, 60))
    own[:, :, :12] = 0
    volume.modified()
    check(not numpy.array_equal(volume.render(size=(60, 60)).rgba, before.rgba), "values that changed in place, after modified()")
    refuse(ValueError, "spacing", render, volume, spacing=(1, 1, 1))


def refusals():
    for words, options in [("mode", dict(mode="glow")), ("structure", dict(structure="tree")), ("sampling", dict(sampling="local")),
                           ("interpolation", dict(interpolation="cubic")), ("crop", dict(crop=(5, 4, 0, 1, 0, 1))), ("crop", dict(crop=(0, 1))),
                           ("clip_planes", dict(clip_planes=[(1, 0, 0, 0)] * 7)), ("contours", dict(contours=range(17), mode="isosurface")),
                           ("unit_distance", dict(unit_distance=0)), ("extinction", dict(extinction=0)), ("diagonal", dict(unit_distance=1e-300)), ("tolerance", dict(tolerance=-1)),
                           ("size", dict(size=(0, 10))), ("diagonal", dict(extinction=1e40)),
                           ("shade", dict(shade=dict(glow=1))), ("opaque_depth", dict(opaque_depth=numpy.zeros((3, 3)))),
                           ("gradient_opacity", dict(gradient_opacity=[(0, 2)])), ("average_range", dict(average_range=(2, 1), mode="average")),
                           ("ambient", dict(shade=dict(ambient=-1))), ("contour", dict(mode="isosurface")),
                           ("sample_distance", dict(sample_distance=-1)), ("opacity", dict(opacity=10**400)), ("spacing", dict(spacing=(10**400, 1, 1))),
                           ("background", dict(background=(2, 0, 0))), ("color", dict(color="no such colour")), ("color", dict(color=lambda place: (2, 0, 0)))]:
        refuse(ValueError, words.split("_")[0], show, field, device="host", **options)
    for options in dict(unit_distance="x"), dict(tolerance="x"), dict(size=5), dict(opacity="x"), dict(color=3), dict(crop=3), \
            dict(clip_planes=3), dict(contours=1j), dict(average_range=3):
        refuse(TypeError, next(iter(options)), show, field, device="host", **options)
    refuse(stratus_volume.Unsupported, "nearest", render, field, mode="isosurface", contours=[0.5], interpolation="nearest", device="host")


def cancelled():
    calls = []
    render(field, progress=lambda stage, fraction: calls.append((stage, fraction)), **host)
    check(calls and all(isinstance(stage, str) and 0 <= fraction <= 1 for stage, fraction in calls), f"progress: {calls[:3]}")
    refuse(stratus_volume.Cancelled, "", render, field, progress=lambda stage, fraction: True, **host)

    def interrupt(stage, fraction):
        raise KeyboardInterrupt("as by Ctrl+C")
    refuse(KeyboardInterrupt, "Ctrl", render, field, progress=interrupt, **host)
    refuse(RuntimeError, "progress function", render, field, progress=lambda stage, fraction: render(field, **host), **host)
    check(render(field, **host).rgba.max() > 0, "the next call draws")


class Bar:
    """What is used of a bar of tqdm's."""

    def __init__(self, total):
        self.total, self.n, self.stages = total, 0.0, []

    def update(self, step):
        check(step > 0, f"a bar goes forward: {step}")
        self.n += step

    def set_description(self, text, refresh):
        self.stages.append(text)


def films():
    bar = Bar(50)
    film = stratus_volume.turn(field, frames=5, size=(30, 20), progress=bar, device="host")
    check(len(film) == 5 and all(picture.shape == (20, 30, 4) for picture in film), "five pictures")
    check(abs(bar.n - 50) < 1e-9 and bar.stages, f"a bar to its end: {bar.n} of 50, {bar.stages[:3]}")
    check(numpy.array_equal(film[1], show(field, size=(30, 20), camera=dict(azimuth=102), device="host")), "a fifth of a turn")
    content, frames, at = film._repr_png_(), [], 8
    while at < len(content):
        length, kind = struct.unpack(">I", content[at:at + 4])[0], content[at + 4:at + 8]
        part = content[at + 8:at + 8 + length]
        check(zlib.crc32(kind + part) == struct.unpack(">I", content[at + 8 + length:at + 12 + length])[0], f"the sum of {kind}")
        if kind in (b"IDAT", b"fdAT"):
            rows = numpy.frombuffer(zlib.decompress(part if kind == b"IDAT" else part[4:]), numpy.uint8).reshape(20, 121)
            frames.append(rows[:, 1:].reshape(20, 30, 4))
        at += 12 + length
    check(len(frames) == 5 and all(numpy.array_equal(*both) for both in zip(film, frames)), "the animated PNG holds them")
    check(stratus_volume.Film()._repr_png_() is None, "no pictures, no film")
    with tempfile.TemporaryDirectory() as folder:
        film.save(os.path.join(folder, "turn.png"))
        check(os.path.getsize(os.path.join(folder, "turn.png")) == len(content), "and is saved")
    bar = Bar(1)
    render(field, progress=bar, **host)
    check(0.5 < bar.n <= 1, f"a bar of one picture: {bar.n}")
    refuse(TypeError, "tqdm", render, field, progress=3, **host)
    refuse(ValueError, "frames", stratus_volume.turn, field, frames=0)
    refuse(ValueError, "film", stratus_volume.Film().save, "nowhere.png")


def threads():
    wanted = render(field, **host).rgba
    results = []

    def draw():
        for _ in range(5):
            results.append(numpy.array_equal(render(field, **host).rgba, wanted))
    several = [threading.Thread(target=draw) for _ in range(4)]
    for each in several:
        each.start()
    for each in several:
        each.join()
    check(results == [True] * 20, f"four threads draw the same: {results}")


def freed():
    def resident():
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1])
    if not sys.platform.startswith("linux"):
        return
    large = ball((64, 64, 64), (32, 32, 32), 30)
    for n in range(20):
        render(large, size=(30, 20), device="host")
        if n == 4:
            gc.collect()
            before = resident()
    gc.collect()
    pages = resident() - before
    check(pages * 4 < 8 * 1024, f"15 volumes of 1 MiB with their structures leave {pages * 4} KiB")
    for _ in range(3):
        cycle = [Volume(field, device=Context("host", 1))]
        cycle.append(cycle)
        del cycle
    gc.collect()


def drawn_in_child(number):
    return float(render(field, camera=dict(azimuth=number), size=(30, 20)).rgba.sum())


def forked():
    """A forked process has none of OpenMP's threads: it draws by one of its own, and does not wait for ever."""
    if "fork" not in multiprocessing.get_all_start_methods():
        return
    wanted = [drawn_in_child(number) for number in range(3)]
    fork = multiprocessing.get_context("fork")
    with fork.Pool(2) as pool:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.12, that there are threads
            found = pool.map_async(drawn_in_child, range(3))
        try:
            check(numpy.allclose(found.get(120), wanted, rtol=1e-3), "children draw what the parent draws")
        except multiprocessing.TimeoutError:
            check(False, "children end")
        for task, words in (draw_of_parent, "before the process was forked"), (ask_for_threads, "spawn"):
            try:
                pool.apply_async(task).get(120)
            except (RuntimeError, ValueError) as error:
                check(words in str(error), f"'{words}' in the error: {error}")
            else:
                check(False, f"{task} is refused in a child")


of_parent = Volume(field, device="host")


def draw_of_parent():
    of_parent.render()


def ask_for_threads():
    Context("host", 2)


def missing():
    """Where libOpenCL or libgomp is missing: names of libraries that do not exist replace them in a copy of the package."""
    own = os.path.dirname(os.path.abspath(stratus_volume.__file__))
    code = "import numpy, stratus_volume as s; print(s.devices(), s.render(numpy.eye(4) * numpy.ones((4, 4, 4)), size=(9, 9)).rgba.max() > 0)"
    with tempfile.TemporaryDirectory() as folder:
        for name, other in ("libOpenCL", "libOpenCX"), ("libgomp", "libgomX"):
            copy = os.path.join(folder, other, "stratus_volume")
            linked = False
            shutil.copytree(own, copy, ignore=shutil.ignore_patterns("__pycache__"))
            if os.path.isdir(own + ".libs"):  # libraries that auditwheel added next to it
                shutil.copytree(own + ".libs", copy + ".libs")
            for part in "_core.py", "libstratus-core.so", os.path.join("no_opencl", "libOpenCL.so.1"):
                path = os.path.join(copy, part)
                with open(path, "rb") as file:
                    content = file.read()
                linked = linked or (part.endswith("core.so") and name.encode() in content)
                ends = ('"', '":') if part.endswith(".py") and name == "libgomp" else ("", "")
                content = content.replace(name.join(ends).encode(), other.join(ends).encode())
                os.remove(path)
                with open(path.replace(name, other), "wb") as file:
                    file.write(content)
            ended = subprocess.run([sys.executable, "-c", code], env=dict(os.environ, PYTHONPATH=os.path.dirname(copy)), cwd=folder,
                                   capture_output=True, text=True)
            if name == "libOpenCL":
                check(ended.returncode == 0 and ended.stdout.split() == ["[]", "True"], f"without OpenCL the host draws: {ended.stdout} {ended.stderr}")
                refused = subprocess.run([sys.executable, "-c", "import stratus_volume as s; s.Context('0')"], cwd=folder, capture_output=True,
                                         env=dict(os.environ, PYTHONPATH=os.path.dirname(copy)), text=True)
                check("ocl-icd" in refused.stderr and "ValueError" in refused.stderr, f"and a device is refused with the reason: {refused.stderr}")
            elif linked:  # clang's core has another runtime
                check("ImportError" in ended.stderr and "libgomp1" in ended.stderr, f"without OpenMP's runtime, its package: {ended.stderr}")


def notebooks():
    """What a view says where ipywidgets is missing; in_notebook.py turns one."""
    found = sys.modules.get("ipywidgets")
    sys.modules["ipywidgets"] = None  # stands for one that is not installed
    refuse(ImportError, "pip install ipywidgets", stratus_volume.view, field)
    del sys.modules["ipywidgets"]
    if found:
        sys.modules["ipywidgets"] = found


contexts()
notebooks()
pictures()
planes_and_crops()
cameras()
kept()
refusals()
cancelled()
films()
threads()
freed()
forked()
missing()
done()
