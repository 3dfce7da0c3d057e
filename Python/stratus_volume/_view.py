# SPDX-License-Identifier: BSD-3-Clause
"""Cameras, as dicts, as pyvista's lists or as VTK's objects."""
import ctypes
import math

from . import _declarations as c
from ._core import library
from ._values import dot, length_of, number, numbers

_AROUND = dict(azimuth=30.0, elevation=25.0, zoom=1.15)
_EARTH, _MARGIN = dict(azimuth=20.0, elevation=35.0, zoom=1.0), 1.02
_PLACED = dict(position=None, focal_point=None, view_up=(0.0, 0.0, 1.0), view_angle=30.0, parallel_scale=None)
_WANTED = ("a dict of azimuth, elevation (degrees) and zoom, or of position, focal_point, view_up, view_angle (degrees) and parallel_scale, "
           "or three points (position, focal point, view up), or a vtkCamera")


def _turned(vector, axis, degrees):
    """The vector turned about an axis of length 1 (Rodrigues)."""
    angle = math.radians(degrees)
    cosine, sine = math.cos(angle), math.sin(angle)
    along = dot(vector, axis)
    cross = _cross(axis, vector)
    return tuple(v * cosine + x * sine + a * along * (1 - cosine) for v, x, a in zip(vector, cross, axis))


def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _scaled_to_1(vector):
    length = length_of(vector)
    return tuple(part / length for part in vector)


def _around(camera, bounds, aspect):
    """A camera that looks at the middle of bounds from so far that all of them are in the window, as vtkRenderer.ResetCamera() does."""
    wishes = dict(_AROUND)
    wishes.update({name: number(value, f"camera's {name}") for name, value in camera.items()})
    if wishes["zoom"] <= 0:
        raise ValueError(f"camera's zoom is {wishes['zoom']}, it must be above 0")
    middle = [0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]) for axis in range(3)]
    radius = 0.5 * length_of([bounds[2 * axis + 1] - bounds[2 * axis] for axis in range(3)]) or 0.5
    outward = _turned((0.0, -1.0, 0.0), (0.0, 0.0, 1.0), wishes["azimuth"])
    side = _cross((0.0, 0.0, 1.0), outward)
    outward = _turned(outward, side, -max(-89.9, min(89.9, wishes["elevation"])))
    angle = math.radians(30)
    if aspect < 1:
        angle = 2 * math.atan(math.tan(angle / 2) * aspect)
    distance = radius / math.sin(angle / 2)
    position = [m + distance * o for m, o in zip(middle, outward)]
    return dict(position=position, focal_point=middle, view_up=(0.0, 0.0, 1.0), view_angle=30 / wishes["zoom"], parallel_scale=None)


def _placed(camera):
    wishes = dict(_PLACED)
    wishes.update(camera)
    for name in "position", "focal_point", "view_up":
        if wishes[name] is None:
            raise ValueError(f"camera has no {name}; it must be {_WANTED}")
        wishes[name] = numbers(wishes[name], 3, f"camera's {name}")
    wishes["view_angle"] = number(wishes["view_angle"], "camera's view_angle")
    if wishes["parallel_scale"] is not None:
        wishes["parallel_scale"] = number(wishes["parallel_scale"], "camera's parallel_scale")
    return wishes


def _as_placed(camera, bounds, aspect):
    if camera is None:
        return _around({}, bounds, aspect)
    if hasattr(camera, "GetFocalPoint"):
        return dict(position=camera.GetPosition(), focal_point=camera.GetFocalPoint(), view_up=camera.GetViewUp(), view_angle=camera.GetViewAngle(),
                    parallel_scale=camera.GetParallelScale() if camera.GetParallelProjection() else None)
    if isinstance(camera, dict):
        if set(camera) <= set(_AROUND):
            return _around(camera, bounds, aspect)
        unknown = set(camera) - set(_PLACED)
        if unknown:
            raise ValueError(f"camera has {sorted(unknown)}, it must be {_WANTED}")
        return _placed(camera)
    try:
        points = list(camera)
        if len(points) == 3 and all(len(point) == 3 for point in points):
            return _placed(dict(zip(("position", "focal_point", "view_up"), points)))
    except TypeError:
        pass
    raise TypeError(f"camera is {camera!r}, it must be {_WANTED}")


def _filling(bounds, aspect):
    """A camera that looks from the south, a little from the east, and from above, and whose window the corners of bounds fill."""
    wishes = _around(_EARTH, bounds, aspect)
    forward = _scaled_to_1([f - p for f, p in zip(wishes["focal_point"], wishes["position"])])
    right = _scaled_to_1(_cross(forward, (0.0, 0.0, 1.0)))
    up = _cross(right, forward)
    corners = [[bounds[2 * axis + (n >> axis & 1)] for axis in range(3)] for n in range(8)]
    for last in False, False, False, True:  # moves the middle of what is seen to the middle of the window, to first order
        seen = []
        for corner in corners:
            place = [a - b for a, b in zip(corner, wishes["position"])]
            seen.append((dot(place, right) / dot(place, forward), dot(place, up) / dot(place, forward)))
        across, along = ((min(each), max(each)) for each in zip(*seen))
        if last:
            half = max(across[1] / aspect, -across[0] / aspect, along[1], -along[0])
            wishes["view_angle"] = 2 * math.degrees(math.atan(_MARGIN * half))
        else:
            away = length_of([f - p for f, p in zip(wishes["focal_point"], wishes["position"])])
            for name in "position", "focal_point":
                wishes[name] = [place + 0.5 * away * (sum(across) * r + sum(along) * u) for place, r, u in zip(wishes[name], right, up)]
    return wishes


def is_placed(camera):
    """Whether a camera has a place of its own, instead of one from which all of the data are seen."""
    return not (camera is None or (isinstance(camera, dict) and set(camera) <= set(_AROUND)))


def make(context, camera, bounds, size, earth=False, room=None):
    """Returns the core's camera. Call it with the context's lock held.

    earth  of data on the Earth, the default camera is another one
    room   left, right, bottom and top of the picture's part for the data, in pixels, of a camera that is not placed; None: all of it
    """
    if isinstance(camera, c.stratus_camera):
        return camera
    aspect = size[0] / size[1] if room is None else (room[1] - room[0]) / (room[3] - room[2])
    wishes, result = _filling(bounds, aspect) if earth and camera is None else _as_placed(camera, bounds, aspect), c.stratus_camera()
    three = ctypes.c_double * 3
    places = [three(*wishes[name]) for name in ("position", "focal_point", "view_up")]
    if wishes["parallel_scale"] is None:
        context.call(library.stratus_camera_perspective, context.pointer, *places, wishes["view_angle"], aspect, ctypes.byref(result))
    else:
        context.call(library.stratus_camera_parallel, context.pointer, *places, wishes["parallel_scale"], aspect, ctypes.byref(result))
    if room is not None:
        context.call(library.stratus_camera_in_room, context.pointer, ctypes.byref(result), *size, room, ctypes.byref(result))
    return result
