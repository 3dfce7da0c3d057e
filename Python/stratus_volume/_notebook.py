# SPDX-License-Identifier: BSD-3-Clause
"""A view of a notebook that the mouse turns: pictures in a widget, without a server."""
import asyncio
import math
import time

from ._dimensions import Steps
from ._draw import drawn_of
from ._picture import paint
from ._values import background_color, number, pixels, positive
from ._view import _AROUND
from ._volume import Volume

_REST = 0.3  # seconds without a move after which the full picture is drawn
_LATE = 150  # milliseconds; older events of the mouse are not drawn: if pictures need more time than events, the last events count


def _widgets():
    try:
        import ipywidgets
    except ImportError:
        raise ImportError("view needs ipywidgets: pip install ipywidgets (and ipyevents, with which the mouse turns the picture)") from None
    return ipywidgets


class View:
    """A volume or cells in a notebook, turned by the mouse and by sliders, which `view` makes.

    camera     dict of azimuth, elevation and zoom, which `show` and `render` accept
    state      dict of camera and extinction: `show(data, **view.state)` is the picture from here
    rendering  the Rendering of the picture that shows
    look       dict of the picture's other settings; `set` changes it
    widget     the ipywidgets.VBox of picture, sliders and message; `image`, `azimuth`, `elevation`, `zoom`, `extinction`, `step` (None where the
               data have no steps) and `message` are its parts
    """

    def __init__(self, steps, make, look, extinction, size, camera, background, draft_size, draft_tolerance):
        """steps: the Steps of the data, or None. make: a function that returns a Volume or Tetrahedra of a step, or for None of the data."""
        widgets = _widgets()
        self._steps, self._make, self._shown = steps, make, None if steps is None else 0
        self.drawn, self.look, self.size, self.background = make(self._shown), look, size, background
        self.rendering, self.is_draft = None, False
        self._draft_size, self._draft_tolerance = draft_size, draft_tolerance
        self._rest, self._dragged, self._held, self._events, self._clock, self._now = None, None, False, None, None, None
        self.image = widgets.Image(format="png", width=size[0], height=size[1])
        self.image.layout.max_width = "none"  # as the drafts are smaller pictures in the same place
        wide = dict(continuous_update=True, readout_format=".0f", layout=widgets.Layout(width=f"{max(240, size[0])}px"))
        self.azimuth = widgets.FloatSlider(value=_half_degrees(_turn(camera["azimuth"])), min=-180, max=180, step=0.5, description="azimuth", **wide)
        self.elevation = widgets.FloatSlider(value=_half_degrees(camera["elevation"], 89), min=-89, max=89, step=0.5, description="elevation", **wide)
        wide["readout_format"] = ".2f"
        self.zoom = widgets.FloatLogSlider(value=_log_step(camera["zoom"]), base=10, min=-1, max=1.5, step=0.001, description="zoom", **wide)
        self.extinction = widgets.FloatLogSlider(value=_log_step(extinction), base=10, min=-2, max=2, step=0.001, description="opacity x", **wide)
        self.step = None if steps is None else widgets.SelectionSlider(options=[(label, n) for n, label in enumerate(steps.labels)], value=0,
                                                                       description=steps.name, layout=wide["layout"])
        self.message = widgets.HTML()
        sliders = [self.azimuth, self.elevation, self.zoom, self.extinction, *([] if steps is None else [self.step])]
        self.widget = widgets.VBox([self.image, *sliders, self.message])
        self._listen()
        for slider in sliders:
            slider.observe(lambda change: self._moved(), names="value")
        # Of an array that has to be read, a coarse picture comes first, and the full one as if the view had come to rest.
        loop = _running_loop()
        waits = loop is not None and self._waits()
        self._now = self.state, self._shown
        self.draw(draft=waits)
        if waits:
            self._rest = loop.call_later(_REST, self._rested)

    @property
    def camera(self):
        return dict(azimuth=_half_degrees(self.azimuth.value), elevation=_half_degrees(self.elevation.value, 89), zoom=_log_step(self.zoom.value))

    @property
    def state(self):
        return dict(camera=self.camera, extinction=_log_step(self.extinction.value))

    def set(self, **look):
        """Changes settings of the picture, such as opacity, color or mode, and draws it. A wrong setting raises an error and changes nothing."""
        before, self.look = self.look, dict(self.look, **look)
        try:
            self.draw()
        except Exception:
            self.look = before
            raise

    def draw(self, draft=False):
        """Draws the picture; draft: as while the mouse moves."""
        look, size = self.look, self.size
        if self.step is not None and self.step.value != self._shown:
            self.drawn, self._shown = self._make(self.step.value), self.step.value
        if draft:
            size = self._draft_size
            look = dict(look, tolerance=max(self._draft_tolerance, look.get("tolerance") or 0))
        drawn = self.drawn.draft(look.get("labels")) if draft and isinstance(self.drawn, Volume) else self.drawn
        rendering = drawn.render(size=size, **self.state, **look)
        self.image.value = paint(rendering.rgba, self.background)._repr_png_()
        self.rendering, self.is_draft, self.message.value = rendering, draft, ""

    def _waits(self):
        """Whether a full picture would have to read a lazy array, of which a coarse copy is known."""
        if not isinstance(self.drawn, Volume):
            return False
        self.drawn.settle()
        return self.drawn.draft(self.look.get("labels")) is not self.drawn

    def _ipython_display_(self):
        from IPython.display import display
        display(self.widget)

    # ---- moves

    def _moved(self, late=False):
        """A draft now, unless the move is late, and the full picture once nothing has moved for a while. Without an event loop, as outside of a
        notebook, that is now."""
        now = self.state, self.step and self.step.value
        if self._held or now == self._now:
            return  # of several sliders that change at once, or whose value the browser sends back, rounded in another way
        self._now = now
        if self._rest is not None:
            self._rest.cancel()
            self._rest = None
        loop = _running_loop()
        if not late or loop is None:
            self._try_to_draw(draft=loop is not None)
        if loop is not None:
            self._rest = loop.call_later(_REST, self._rested)

    def _rested(self):
        self._rest = None
        self._try_to_draw(draft=False)

    def _try_to_draw(self, draft):
        """The last picture stays where one fails: an exception would end in a log that nobody sees."""
        try:
            self.draw(draft)
        except Exception as error:
            self.message.value = f"<b>{type(error).__name__}</b>: {_escaped(str(error))}"

    def _place(self, azimuth, elevation, zoom, late):
        self._held = True
        try:
            self.azimuth.value, self.elevation.value = _half_degrees(_turn(azimuth)), _half_degrees(elevation, 89)
            self.zoom.value = _log_step(min(10**1.5, max(0.1, zoom)))
        finally:
            self._held = False
        self._moved(late)

    def _listen(self):
        """The mouse, where ipyevents is there; it is no error where it is not."""
        try:
            import ipyevents
        except ImportError:
            return
        self._events = ipyevents.Event(source=self.image, watched_events=["mousedown", "mousemove", "mouseup", "mouseleave", "wheel"], wait=20,
                                       throttle_or_debounce="throttle", prevent_default_action=True)
        self._events.on_dom_event(self._on_event)

    def _is_late(self, event):
        """Whether an event waited for pictures: the browser's clock and ours are as far apart as they are by the earliest of all events."""
        if event.get("timeStamp") is None:
            return False
        apart = 1000 * time.monotonic() - event["timeStamp"]
        self._clock = apart if self._clock is None else min(self._clock, apart)
        return apart - self._clock > _LATE

    def _on_event(self, event):
        """A drag turns by half a degree a pixel, and the wheel zooms."""
        kind, late = event.get("type"), self._is_late(event)
        at = (event.get("relativeX", 0), event.get("relativeY", 0))
        if kind == "mousedown":
            self._dragged = self.azimuth.value + 0.5 * at[0], self.elevation.value - 0.5 * at[1]
        elif kind == "mousemove" and self._dragged is not None:
            self._place(self._dragged[0] - 0.5 * at[0], self._dragged[1] + 0.5 * at[1], self.zoom.value, late)
        elif kind in ("mouseup", "mouseleave"):
            moved, self._dragged = self._dragged is not None and self.is_draft, None
            if moved:
                if self._rest is not None:
                    self._rest.cancel()
                self._rested()
        elif kind == "wheel":
            self._place(self.azimuth.value, self.elevation.value, self.zoom.value * math.exp(-event.get("deltaY", 0) / 500), late)


def _running_loop():
    """The event loop of a notebook, or None outside of one."""
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None


def _turn(degrees):
    """The same azimuth within -180..180."""
    return (degrees + 180) % 360 - 180


def _half_degrees(degrees, most=180):
    """The nearest angle of a slider. The browser rounds to its slider's steps, too, and sends the result back: a value between steps would cost
    a second frame."""
    return min(most, max(-most, round(2 * degrees) / 2))


def _log_step(value):
    """The nearest value of a logarithmic slider."""
    return 10 ** round(math.log10(value), 3)


def _escaped(text):
    return text.replace("&", "&amp;").replace("<", "&lt;")


def view(data, opacity=None, color=None, size=(480, 360), camera=None, background=(0.08, 0.1, 0.14), draft=0.5, draft_tolerance=0.02, spacing=None,
         origin=None, axes=None, scalars=None, component=None, device=None, threads=None, matrix=None, memory=None, globe=False,
         exaggerate=None, **options):
    """Returns a View: a picture in a notebook that the mouse turns (where ipyevents is installed) and sliders turn. Needs ipywidgets.

    data             as in `render`; or an xarray.DataArray with a time besides three dimensions of space, an xarray.Dataset whose variable has a
                     time, or a list of data: a slider chooses the step. Functions that follow from values are each step's own: give points of
                     opacity and color to compare steps
    camera           dict of azimuth and elevation, in half degrees, and zoom, where the view begins
    draft            while the view moves, pictures have this part of the width and height, above 0 and at most 1
    draft_tolerance  while the view moves, pictures have this tolerance, or the look's if it is larger. 0.3 seconds after the last move the
                     full picture follows. Of a lazy array whose last picture had to read, they show a coarse copy, and so does the first picture
    Everything else is as in `render` and `show`. Structures are built once for each step that shows. A drag turns by half a
    degree a pixel, the wheel zooms. The slider "opacity x" is `extinction`, 0.01..100.

    The pictures are drawn in the notebook's own process and sent as PNG: no server runs. `show` accepts `view(data).camera`.
    """
    _widgets()
    size, background = pixels(size), background_color(background)
    if not 0 < number(draft, "draft") <= 1:
        raise ValueError(f"draft is {draft!r}, it must be above 0 and at most 1")
    positive(draft_tolerance, "draft_tolerance")
    if camera is not None and (not isinstance(camera, dict) or set(camera) - set(_AROUND)):
        raise ValueError(f"camera is {camera!r}, a view begins by a dict of azimuth, elevation (degrees) and zoom")
    begins = dict(_AROUND, **{name: number(value, f"camera's {name}") for name, value in (camera or {}).items()})
    if not 0.1 <= begins["zoom"] <= 10**1.5:
        raise ValueError(f"camera's zoom is {begins['zoom']}, a view's must be in 0.1..31.6")
    for name in "opaque_depth", "audit":
        if name in options:
            raise TypeError(f"a view has no {name}")
    small = tuple(max(1, round(side * draft)) for side in size)
    steps, extinction = None if axes is not None else Steps.of(data, scalars), options.pop("extinction", 1.0)
    if not 0.01 <= number(extinction, "extinction") <= 100:
        raise ValueError(f"extinction is {extinction!r}, a view's must be in 0.01..100")

    def make(step):
        return drawn_of(data if step is None else steps[step], spacing, origin, axes, scalars, component, device, threads, matrix, exaggerate, globe,
                        memory)
    return View(steps, make, dict(options, opacity=opacity, color=color), extinction, size, begins, background, small, draft_tolerance)
