# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the page have in common: a recording, a viewer, a browser."""
import functools
import os
import sys
import tempfile
import unittest

import webdriver
from protocol_test import make_log
from viewer_process import Viewer

# The pixels of an image that is drawn for this.
PIXELS = """
  const {view, layers} = window.nodmap;
  const pixels = () => {
    view.renderer.render(view.scene, view.camera);
    const gl = view.renderer.getContext();
    const bytes = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return new Uint32Array(bytes.buffer);
  };
"""
# How many pixels of the canvas differ from an empty scene with the same camera: all layers are hidden for one image.
COUNT_DRAWN = PIXELS + """
  const full = pixels();
  const shown = [...layers.values()].map(({layer}) => layer.group.visible);
  layers.forEach(({layer}) => { layer.group.visible = false; });
  const bare = pixels();
  [...layers.values()].forEach(({layer}, i) => { layer.group.visible = shown[i]; });
  return full.reduce((count, pixel, i) => count + (pixel !== bare[i]), 0);
"""


LOGS = tempfile.TemporaryDirectory()


@functools.cache
def kept_log(duration_s, points):
    """A recording that all tests of this process read."""
    return make_log(LOGS.name, duration_s, points)


class PageCase(unittest.TestCase):
    def play(self, *arguments, duration_s=60, points=12000):
        """A viewer that plays a recording, long enough that it does not end too soon on a slow machine."""
        viewer = Viewer("--replay", kept_log(duration_s, points), "--set", "cloud_spacing_m=0", *arguments)
        self.addCleanup(viewer.stop)
        return viewer

    def browse(self, viewer, width=1280, height=800):
        browser = webdriver.shared_browser(width, height)
        browser.open(f"http://127.0.0.1:{viewer.port}/")
        self.assertIsNotNone(browser.wait_for("window.nodmap && nodmap.cloud.total > 30000 && nodmap.received() > 100"))
        return browser

    def assert_quiet(self, browser):
        errors = [line for line in browser.console() if line["level"] == "SEVERE"]
        self.assertEqual(errors, [])

    def save_image(self, browser, name):
        folder = os.environ.get("NODMAP_SCREENSHOTS")
        if folder:
            with open(os.path.join(folder, name), "wb") as out:
                out.write(browser.screenshot())

    def pause(self, browser):
        browser.run("document.getElementById('pause').click()")
        self.assertIsNotNone(browser.wait_for("document.getElementById('pause').textContent === 'Play'"))
        self.settle(browser)

    def settle(self, browser):
        """Waits until all messages have come and the still image is refined: from then on it does not change."""
        self.assertIsNotNone(browser.wait_for(
            "!nodmap.view.isTouched && performance.now() - nodmap.detail.changedMs > 1000 && nodmap.cloud.drawn === nodmap.cloud.total"))

    def show_only(self, browser, *topics):
        """Shows these topics only; the playback must be paused."""
        browser.run("""document.querySelectorAll('#layers input').forEach((box) => {
            if (box.checked !== arguments[0].includes(box.dataset.topic)) { box.click(); }
        })""", topics)
        self.settle(browser)


def main():
    """Runs the tests of the script; exits 77 (CTest: skipped) without a browser."""
    if not webdriver.is_installed():
        print("skipped: chromium and chromium-driver are not installed")
        sys.exit(77)
    unittest.main(verbosity=2, warnings="ignore")
