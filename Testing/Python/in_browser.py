# SPDX-License-Identifier: BSD-3-Clause
"""A view in JupyterLab and one of pyvista in a page of trame, which a mouse in headless Chromium turns, zooms and changes by sliders. After each action
the page's pixels differ, and those of the last picture are the ones that `show` or a screenshot draws. in_browser.py FOLDER: for files and screenshots.
`browser` runs it where Chromium, JupyterLab, ipywidgets, ipyevents, playwright, pyvista and trame are installed."""
import contextlib
import io
import json
import os
import pathlib
import shutil
import socket
import statistics
import subprocess
import sys
import time
import urllib.request

from checking import ball, check, done

import numpy

try:
    from PIL import Image
    from playwright.sync_api import sync_playwright
except ImportError as missing:
    print(f"SKIPPED: {missing}")
    sys.exit(77)

CHROMIUM = next((found for found in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if found), None)
LOOK = dict(opacity=[(0, 0), (1, 0.6)], color=[(0, 0.1, 0.3, 1), (1, 1, 0.5, 0.1)], device="host")
SCENE = dict(opacity="linear", show_scalar_bar=False, device="host")
SIZE = (320, 240)
PATIENCE = 30  # seconds; of a machine that does much else


def steps():
    """A series of three steps."""
    return [ball((24, 26, 28), (12, 9 + 4 * n, 14), 7 + n) + 0.7 * ball((24, 26, 28), (5, 20, 22), 5) for n in range(3)]


RANGE = (0, float(steps()[0].max()))  # of the first step, which is the range of all


def logged(path):
    """Writes a line for each frame of this process: how many milliseconds Stratus drew, and what the caller adds."""
    from stratus_volume import Volume
    drawn, begun, render = [], [], Volume.render

    def timed(self, *arguments, **options):
        begun.append(1000 * time.time())
        try:
            return render(self, *arguments, **options)
        finally:
            drawn.append(1000 * time.time() - begun[-1])
    Volume.render = timed

    def log(**more):
        with open(path, "a") as file:
            file.write(json.dumps(dict(drawing=sum(drawn), begin=begun[0] if begun else 0, end=1000 * time.time(), **more)) + "\n")
        drawn.clear()
        begun.clear()
    return log


def notebook():
    """What the notebook's second cell runs: a view whose frames are logged."""
    from stratus_volume import view
    own, log = view(steps(), size=SIZE, **LOOK), logged("frames")
    draw = own.draw

    def logging(draft=False):
        draw(draft)
        log(draft=draft, state=own.state, step=own.step.value)
    own.draw = logging
    return own


def page_of_trame(at):
    """A server of pyvista's page with the series, whose frames are logged."""
    import pyvista
    from stratus_volume.pyvista import _Layer, add_volume
    from trame.app import get_server
    from trame.ui.vuetify3 import VAppLayout
    from trame_pyvista.ui import plotter_ui
    plotter, log, draw = pyvista.Plotter(off_screen=True), logged("frames"), _Layer.draw
    volume = add_volume(plotter, steps(), **SCENE)

    def logging(self, *arguments):
        picture, rate = draw(self, *arguments), plotter.render_window.GetDesiredUpdateRate()
        log(draft=rate >= 1, step=volume.step, extinction=volume.look.get("extinction", 1), camera=[list(point) for point in plotter.camera_position],
            angle=plotter.camera.view_angle)
        return picture
    _Layer.draw = logging
    server = get_server(client_type="vue3")
    with VAppLayout(server):
        plotter_ui(plotter, mode="server", add_menu_items=plotter.stratus.sliders)
    server.start(port=at, host="127.0.0.1", open_browser=False)


class Page:
    """A page of Chromium with a picture, and the log of the frames that its server drew."""

    def __init__(self, page, picture, log, folder, top=0):
        """top: rows that a toolbar covers."""
        self.page, self.picture, self.log, self.folder, self.top = page, picture, log, folder, top
        picture.wait_for(timeout=1000 * PATIENCE)
        # The times of pictures that differ from the ones before: servers send some twice.
        picture.evaluate("""picture => { window.seen = []; window.acted = []; let last = "";
            const small = new OffscreenCanvas(64, 48).getContext("2d", {willReadFrequently: true});
            picture.addEventListener("load", () => requestAnimationFrame(() => {
              const now = performance.timeOrigin + performance.now();
              small.drawImage(picture, 0, 0, 64, 48);
              const pixels = small.getImageData(0, 0, 64, 48).data.join();
              if (pixels != last) window.seen.push(now);
              last = pixels; }));
            for (const kind of ["mousedown", "mousemove", "mouseup", "wheel", "pointermove"])
              document.addEventListener(kind, event => { window.acted.push(performance.timeOrigin + event.timeStamp); }, true); }""")

    def frames(self):
        return [json.loads(line) for line in self.log.read_text().splitlines()] if self.log.exists() else []

    def pixels(self, name=None):
        image = self.picture.screenshot()
        if name:
            (self.folder / f"{name}.png").write_bytes(image)
        return numpy.asarray(Image.open(io.BytesIO(image)).convert("RGB")).astype(int)[self.top:]

    def rest(self):
        """Waits until no frame comes any more, and returns the last one's pixels."""
        before = None
        for _ in range(4 * PATIENCE):
            time.sleep(1)
            now = self.frames(), self.page.evaluate("window.seen.length")
            if now == before:
                break
            before = now
        return self.pixels()

    def drag(self, x, y, dx, dy, moves=60):
        """Presses the mouse at x, y, moves it as a hand does and releases it. Returns the milliseconds of each picture from the last event before it was
        drawn until the page shows it, without the time in which Stratus drew."""
        mouse = self.page.mouse
        mouse.move(x, y)
        mouse.down()
        seen, frames = self.page.evaluate("window.seen.length"), len(self.frames())
        for n in range(1, moves + 1):
            mouse.move(x + dx * n / moves, y + dy * n / moves)
            time.sleep(0.01)
        (times, events), drawn = self.page.evaluate(f"[window.seen.slice({seen}), window.acted]"), self.frames()[frames:]
        mouse.up()
        costs, drawn = [], [frame for frame in drawn if frame["drawing"]]
        for time_seen, before in zip(times[1:], times):
            shown = [frame for frame in drawn if before - frame["drawing"] < frame["end"] < time_seen][-1:]
            costs += [time_seen - max(event for event in events if event < frame["begin"]) - frame["drawing"] for frame in shown]
        return costs

    def drag_handle(self, handle, dx):
        box = handle.bounding_box()
        return self.drag(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, dx, 0)

    def acts(self, expected, opacity, step, names):
        """Turns, zooms, and moves both sliders; expected: the exact picture of a logged frame, and how far pixels may differ from it."""
        before = self.rest()
        box = self.picture.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

        def zoom():
            self.page.mouse.move(x, y)
            self.page.mouse.wheel(0, -200)
        for name, act in (("turn", lambda: self.drag(x, y, 60, 30)), ("zoom", zoom), ("opacity", lambda: self.drag_handle(opacity, 40)),
                          ("step", lambda: self.drag_handle(step, 100))):
            frames = len(self.frames())
            cost = act()
            if name in ("turn", "opacity"):
                print(f"{names}, {name}: {len(cost)} pictures" + (f", in the median {statistics.median(cost):.0f} ms beside drawing" if cost else ""))
            after, last = self.rest(), self.frames()[-1]
            self.pixels(f"{names}-{name}")
            check(len(self.frames()) > frames and numpy.abs(after - before).max() > 20, f"{names}: {name} changes the picture")
            picture, most = expected(last)
            apart = numpy.abs(after - picture).max() if after.shape == picture.shape else f"{after.shape} and {picture.shape}"
            check(not last["draft"] and not isinstance(apart, str) and apart <= most, f"{names}: after {name} the last picture is exact: {apart} of 255, {last}")
            before = after


def port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@contextlib.contextmanager
def serving(command, url, folder):
    """A server that has answered. It ends with the context."""
    with open(folder / "server.log", "w") as log, subprocess.Popen(command, cwd=folder, stdout=log, stderr=log) as server:
        try:
            for _ in range(2 * PATIENCE):
                with contextlib.suppress(OSError):
                    urllib.request.urlopen(url).close()
                    break
                time.sleep(0.5)
            yield
        finally:
            server.terminate()


def in_jupyter(browser, folder):
    from stratus_volume import show
    here = str(pathlib.Path(__file__).parent)
    sources = [f"import sys; sys.path.insert(0, {here!r}); import in_browser; import stratus_volume as sv; sv.show(in_browser.steps()[0], size=in_browser.SIZE, "
               "**in_browser.LOOK)", "in_browser.notebook()"]
    cells = [dict(cell_type="code", execution_count=None, id=f"cell{n}", metadata={}, outputs=[], source=source) for n, source in enumerate(sources)]
    kernel = dict(kernelspec=dict(name="python3", display_name="Python 3 (ipykernel)", language="python"))
    (folder / "view.ipynb").write_text(json.dumps(dict(cells=cells, metadata=kernel, nbformat=4, nbformat_minor=5)))
    at = f"http://127.0.0.1:{port()}"
    command = [sys.executable, "-m", "jupyter", "lab", "--no-browser", "--allow-root", "--ServerApp.ip=127.0.0.1", f"--ServerApp.port={at.split(':')[-1]}",
               "--IdentityProvider.token=", "--ServerApp.password="]
    with serving(command, f"{at}/api", folder):
        page = browser.new_page(viewport=dict(width=1100, height=1000))
        try:
            page.goto(f"{at}/doc/tree/view.ipynb?reset")
            page.get_by_text("Python 3 (ipykernel) | Idle").wait_for(timeout=1000 * PATIENCE)
            page.locator(".jp-Cell .cm-content").first.click()
            page.keyboard.press("Shift+Enter")
            page.keyboard.press("Shift+Enter")
            inline = Page(page, page.locator(".jp-RenderedImage img"), folder / "none", folder)
            check(numpy.array_equal(inline.pixels("jupyter-inline"), show(steps()[0], size=SIZE, **LOOK)[..., :3]), "show's picture is inline, to the bit")
            own = Page(page, page.locator("img.widget-image"), folder / "frames", folder)

            def expected(frame):
                return show(steps()[frame["step"]], size=SIZE, **LOOK, **frame["state"])[..., :3].astype(int), 0
            opacity, step = (page.locator(".widget-inline-hbox", has_text=name).locator(".noUi-handle") for name in ("opacity", "step"))
            own.acts(expected, opacity, step, "JupyterLab")
        finally:
            page.screenshot(path=folder / "jupyter.png")
            page.close()


def in_trame(browser, folder):
    import pyvista
    from stratus_volume.pyvista import add_volume
    at = port()
    with serving([sys.executable, __file__, "page", str(at)], f"http://127.0.0.1:{at}", folder):
        page = browser.new_page(viewport=dict(width=960, height=480))
        try:
            page.goto(f"http://127.0.0.1:{at}")
            own = Page(page, page.locator("img[src^=blob]"), folder / "frames", folder, 60)

            def expected(frame):
                plotter = pyvista.Plotter(off_screen=True, window_size=(960, 480))
                add_volume(plotter, steps()[frame["step"]], **SCENE, clim=RANGE, extinction=frame["extinction"])
                plotter.camera_position, plotter.camera.view_angle = frame["camera"], frame["angle"]
                plotter.renderer.reset_camera_clipping_range()
                picture = plotter.screenshot(return_img=True)[..., :3].astype(int)
                plotter.close()
                return picture[60:], 8  # it comes as JPEG of the highest quality
            opacity, step = (page.locator(".v-slider", has_text=name).locator(".v-slider-thumb") for name in ("opacity", "step"))
            own.acts(expected, opacity, step, "trame")
        finally:
            page.screenshot(path=folder / "trame.png")
            page.close()


if __name__ == "__main__":
    if sys.argv[1] == "page":
        page_of_trame(int(sys.argv[2]))
        sys.exit()
    if CHROMIUM is None:
        print("SKIPPED: no chromium (Debian: chromium)")
        sys.exit(77)
    where = pathlib.Path(sys.argv[1]).resolve()
    where.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--force-color-profile=srgb", "--disable-gpu"])
        print("Chromium", chromium.version)
        for test in [in_jupyter, in_trame]:
            if len(sys.argv) < 3 or sys.argv[2] == test.__name__:
                folder = where / test.__name__
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir()
                test(chromium, folder)
        chromium.close()
    done()
