# SPDX-License-Identifier: BSD-3-Clause
"""Sliders of opacity and steps in a page of trame that shows a plotter of pyvista."""
from ._notebook import _REST, _running_loop


class Sliders:
    """Sliders in the layout of trame that is being made: of the opacity of all of the plotter's volumes, and of the steps of those that have some.
    While they move, frames may be drafts. 0.3 seconds later the whole frame follows."""

    def __init__(self, plotter):
        from trame.widgets import vuetify3
        from trame_pyvista.ui import get_viewer
        self.plotter, self.viewer, self._rest, self._level = plotter, get_viewer(plotter), None, 0.0
        plotter.render_window.GetInteractor().EnableRenderOff()  # trame draws after each event, and would draw each frame twice
        series = [volume for volume in plotter.stratus.volumes if volume.steps is not None]
        with vuetify3.VRow(classes="pa-0 ma-0 align-center", style="flex-wrap: nowrap"):
            self._add("opacity", self._level, self._thicken, label="opacity", min=-2, max=2, step=0.01)
            if series:
                longest = max((volume.steps for volume in series), key=lambda each: len(each.labels))
                self._add("step", max(volume.step for volume in series), self._choose, label=longest.name, min=0, max=len(longest.labels) - 1, step=1)

    def _add(self, name, value, change, **more):
        from trame.widgets import vuetify3
        state, name = self.viewer.server.state, f"{self.plotter._id_name}_stratus_{name}"
        state[name] = value
        state.change(name)(lambda **changed: change(changed[name]))  # trame calls it once at first
        vuetify3.VSlider(v_model=(name,), hide_details=True, density="compact", style="width: 180px", classes="mx-3 flex-grow-0", **more)

    def _thicken(self, level):
        """level: the power of 10 of `extinction`."""
        if level != self._level:
            self._level = level
            for volume in self.plotter.stratus.volumes:
                volume.look["extinction"] = 10**level
            self._moved()

    def _choose(self, step):
        own = [(volume, min(step, len(volume.steps.labels) - 1)) for volume in self.plotter.stratus.volumes if volume.steps is not None]
        if any(volume.step != n for volume, n in own):
            for volume, n in own:
                volume.choose(n)
            self._moved()

    def _moved(self):
        loop, window = _running_loop(), self.plotter.render_window
        if self._rest is not None:
            self._rest.cancel()
        if loop is None:
            self.viewer.update()
            return
        window.SetDesiredUpdateRate(window.GetInteractor().GetDesiredUpdateRate())
        for view in self.viewer.views:  # trame looks for a single picture half a second after its threads begin to encode it
            view.start_animation()
        window.Render()
        self._rest = loop.call_later(_REST, self._rested)

    def _rested(self):
        window, self._rest = self.plotter.render_window, None
        if window is not None:  # of a plotter that is not closed
            window.SetDesiredUpdateRate(window.GetInteractor().GetStillUpdateRate())
        for view in self.viewer.views:
            view.stop_animation()
