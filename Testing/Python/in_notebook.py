# SPDX-License-Identifier: BSD-3-Clause
"""A view that is turned as a notebook turns it: by the traits of its widgets, by the events of a mouse, with and without an event loop. `wheel`
runs it where ipywidgets and ipyevents are installed."""
import asyncio
import os
import sys

from checking import Chunks, ball, check, done, refuse

import numpy
import xarray

from stratus_volume import Volume, show, view
from stratus_volume._notebook import View

field = ball((20, 22, 24), (10, 8, 12), 7)
host = dict(opacity=[(0, 0), (1, 0.8)], size=(120, 90), device="host")


def same(own, camera, data=field, **more):
    return own.image.value == show(data, camera=camera, **host, **more)._repr_png_()


def by_sliders():
    own = view(field, camera=dict(azimuth=200), **host)
    check(isinstance(own, View) and own.azimuth.value == -160 and own.image.value[:8] == b"\x89PNG\r\n\x1a\n", "a picture at once")
    check(same(own, own.camera) and not own.is_draft and own.rendering.rgba.shape == (90, 120, 4), "that is show's")
    own.azimuth.value = 45
    check(own.camera["azimuth"] == 45 and same(own, own.camera), "a slider turns it: without an event loop by a full picture")
    own.elevation.value, own.zoom.value = -30, 2
    check(same(own, dict(azimuth=45, elevation=-30, zoom=10**0.301)), "and lifts it, and comes nearer, by a slider's steps")
    builds = own.rendering.counters["range_builds"]
    own.azimuth.value = 50
    check(builds == own.rendering.counters["range_builds"] == 1, "a move builds nothing anew")
    before = own.image.value
    own.set(mode="maximum")
    check(own.image.value != before and own.look["mode"] == "maximum", "the look is changed")
    before = own.image.value
    refuse(ValueError, "mode", own.set, mode="glow")
    check(own.look["mode"] == "maximum" and own.image.value == before, "what is wrong is raised, and the picture stays")
    own.look["mode"] = "glow"
    own.azimuth.value = 10
    check(own.image.value == before and "glow" in own.message.value, f"within a move the error is below the picture, which stays: {own.message.value}")
    own.look["mode"] = "composite"
    own.azimuth.value = 20
    check(own.message.value == "" and own.image.value != before, "and the next picture takes the message away")
    own.extinction.value = 3
    check(same(own, **own.state) and own.state["extinction"] == 10**0.477, "a slider makes it denser")
    before, own.rendering = own.rendering, None
    own.azimuth.value += 1e-12
    check(own.rendering is None and own.camera["azimuth"] == 20, "a slider's value that comes back in another rounding draws nothing")
    own.rendering = before
    check(len(own.widget.children) == 6 and "image" in str(own.widget.children[0]).lower(), "one box for the notebook")


def by_steps():
    places = {name: numpy.arange(n, dtype=float) for name, n in zip("zyx", field.shape)}
    days = numpy.array(["2026-07-01", "2026-07-02", "2026-07-03"], "datetime64[ns]")
    series = xarray.DataArray(numpy.stack([field, field[::-1] ** 2, 0.5 * field]), dict(time=days, **places), ("time", *"zyx"))
    own = view(series, **host)
    check(own.step.description == "time" and own.step.options[1] == ("2026-07-02", 1), f"a slider of the days: {own.step.options}")
    first = own.image.value
    check(same(own, own.camera, series[0]), "the first step is drawn first")
    own.step.value = 1
    check(own.image.value != first and same(own, own.camera, series[1]), "the slider chooses another")
    own.azimuth.value, own.step.value = 99, 2
    check(same(own, own.camera, series[2]), "from all sides")
    members = view(series.rename(time="member").drop_vars("member").transpose("z", "y", "member", "x"), **host)
    check(members.step.description == "member" and members.image.value == first, "of a dimension of which nothing is known")
    several = view([field, field[::-1]], **host)
    several.step.value = 1
    check(several.step.options == (("0", 0), ("1", 1)) and same(several, several.camera, field[::-1]), "a list has steps")
    broken = view([field, "field"], **host)
    before, broken.step.value = broken.image.value, 1
    check(broken.image.value == before and "must be one of" in broken.message.value, f"a step that is no data is a message: {broken.message.value}")
    broken.step.value = 0
    check(broken.message.value == "" and broken.image.value == before, "which the next picture takes away")
    check(view(field, **host).step is None, "one volume has none")
    refuse(ValueError, "three", view, xarray.DataArray(numpy.zeros((2, 2, 2, 2, 2))), **host)


def on_globe():
    sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Examples", "Python"))
    from geodesic import icosphere, mpas
    points, triangles = icosphere(2)
    parts = dict(mpas(points, triangles)[1], zgrid=("nCells levels", numpy.tile([0.0, 4000, 9000], (len(points), 1)), {"units": "m"}),
                 q=("Time nCells layers", numpy.stack([points[:, [0, 1]], points[:, [1, 2]]]), {}))
    data = xarray.Dataset({name: (dims.split(), values, attrs) for name, (dims, values, attrs) in parts.items()})
    own = view(data, scalars="q", globe=True, exaggerate=30, **host)
    own.step.value, own.azimuth.value = 1, 70
    check(own.step.description == "Time" and len(own.step.options) == 2, f"a Dataset has steps: {own.step.options}")
    check(same(own, own.camera, data.isel(Time=1), scalars="q", globe=True, exaggerate=30, caption=""), "a mesh on the globe is turned as show draws it")


async def while_it_moves():
    own = view(field, **host)
    full = own.rendering.counters["samples"]
    own.azimuth.value = 100
    own.extinction.value = 10
    check(own.is_draft and own.rendering.rgba.shape == (45, 60, 4) and own.rendering.counters["samples"] < full, "a draft while it moves")
    await asyncio.sleep(0.1)
    own.azimuth.value = 101
    check(own.is_draft, "and as long as it moves")
    await asyncio.sleep(0.5)
    check(not own.is_draft and same(own, own.camera, extinction=10), "the full picture when it rests")
    own.extinction.value = 1
    send = own._events._dom_handlers.callbacks[0]
    send(dict(type="mousemove", relativeX=9, relativeY=9))
    check(own.camera["azimuth"] == 101, "a mouse that is not pressed turns nothing")
    send(dict(type="mousedown", relativeX=50, relativeY=40))
    send(dict(type="mousemove", relativeX=70, relativeY=30))
    check(own.is_draft and own.camera["azimuth"] == 91 and own.camera["elevation"] == 20, f"a drag turns: {own.camera}")
    send(dict(type="mouseup", relativeX=70, relativeY=30))
    check(not own.is_draft and same(own, own.camera), "the full picture as soon as the mouse is up")
    zoom = own.camera["zoom"]
    for _ in range(50):
        send(dict(type="wheel", deltaY=-100))
    check(own.is_draft and own.camera["zoom"] > 5 * zoom and own.camera["zoom"] <= 10**1.5, "the wheel comes nearer, to an end")
    send(dict(type="mousedown", relativeX=0, relativeY=0))
    send(dict(type="mousemove", relativeX=1000, relativeY=5000))
    check(-180 <= own.camera["azimuth"] <= 180 and own.camera["elevation"] == 89, f"turns end at the poles: {own.camera}")
    await asyncio.sleep(0.5)
    check(not own.is_draft, "and rest")
    send(dict(type="mousedown", relativeX=0, relativeY=0, timeStamp=0))
    send(dict(type="mousemove", relativeX=20, relativeY=-60, timeStamp=10))
    draft, seen = own.image.value, own.camera
    check(own.is_draft, "an event in time is drawn")
    await asyncio.sleep(0.25)
    send(dict(type="mousemove", relativeX=30, relativeY=-60, timeStamp=20))
    check(own.image.value == draft and own.camera["azimuth"] == seen["azimuth"] - 5, "one that waited turns the view, and leaves its picture to the next")
    send(dict(type="mousemove", relativeX=40, relativeY=-60, timeStamp=270))
    check(own.image.value != draft and own.is_draft, "which is drawn where it is in time")
    await asyncio.sleep(0.5)
    check(not own.is_draft and same(own, own.camera), "and the full picture is the last one's")


async def lazily():
    own = view(Chunks(field, (8, 8, 8)), memory="16M", **host)
    check(own.is_draft, "a coarse picture comes before the values are read")
    await asyncio.sleep(0.5)
    check(not own.is_draft and same(own, own.camera), "and the full one follows by itself")
    check(not view(Chunks(field, (8, 8, 8)), **host).is_draft, "values in memory have a full picture at once")


def refusals():
    for words, options in [("draft", dict(draft=0)), ("draft_tolerance", dict(draft_tolerance=-1)), ("camera", dict(camera=dict(position=(1, 2, 3)))),
                           ("zoom", dict(camera=dict(zoom=100))), ("extinction", dict(extinction=0)), ("size", dict(size=(0, 1))), ("mode", dict(mode="glow")),
                           ("spacing", dict(data=Volume(field), spacing=(1, 1, 1), device=None))]:
        refuse(ValueError, words, view, **{**dict(data=field), **host, **options})
    refuse(TypeError, "audit", view, field, audit=True)
    found = sys.modules["ipyevents"]
    sys.modules["ipyevents"] = None
    check(view(field, **host)._events is None, "only sliders if ipyevents is missing")
    sys.modules["ipyevents"] = found
    sys.modules["ipywidgets"] = None
    refuse(ImportError, "pip install ipywidgets", view, field)


by_sliders()
by_steps()
on_globe()
asyncio.run(while_it_moves())
asyncio.run(lazily())
refusals()
done()
