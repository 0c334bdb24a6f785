#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how many images a second the viewer's page draws of a large cloud, in headless Chromium with software rendering.

viewer_frames.py [--points N] [--seconds S] [--width W] [--height H]

Plays a generated recording of N points (default 10^6). The camera circles around the robot, first while the recording is paused and then while it plays.
Finally the camera stops, and the time until the image shows every point is measured. The environment variables NODMAP_VIEWER and NODMAP_MAKE_ROBOT_LOG name
the programs; the default is those in build/release.
"""
import argparse
import os
import subprocess
import sys
import tempfile

from programs import BIN, ROOT

os.environ.setdefault("NODMAP_VIEWER", str(BIN / "nodmap-viewer"))
os.environ.setdefault("NODMAP_MAKE_ROBOT_LOG", str(ROOT / "build/release/tests/make_robot_log"))
sys.path.insert(0, str(ROOT / "tests/viewer"))
import webdriver  # noqa: E402
from viewer_process import Viewer  # noqa: E402

KEYFRAMES = 20  # one a second
WARM_UP_S = 5   # until the level of detail is constant
# Rotates the camera a little before each image and counts the images: [images a second, points drawn, the longest gap in ms].
CIRCLE = """
return new Promise((done) => {
  const {view, cloud} = nodmap;
  view.setMode("free");
  let begin = null, last = null, images = 0, longest = 0;
  const step = (now) => {
    if (begin === null && now - start > 1000 * arguments[0]) {
      begin = last = now;
    }
    if (begin !== null && now > begin) {
      ++images;
      longest = Math.max(longest, now - last);
      last = now;
      if (now - begin > 1000 * arguments[1]) {
        done([1000 * images / (now - begin), cloud.drawn, longest]);
        return;
      }
    }
    const offset = view.camera.position.clone().sub(view.controls.target);
    offset.applyAxisAngle(view.camera.up, 0.02);
    view.camera.position.copy(view.controls.target).add(offset);
    view.touch();
    requestAnimationFrame(step);
  };
  const start = performance.now();
  requestAnimationFrame(step);
});
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=10**6)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--height", type=int, default=720)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        log = f"{folder}/robot.lcmlog"
        subprocess.run([os.environ["NODMAP_MAKE_ROBOT_LOG"], log, str(KEYFRAMES), str(options.points // KEYFRAMES)], check=True)
        with Viewer("--replay", log, "--set", "cloud_spacing_m=0") as viewer, webdriver.Browser(options.width, options.height) as browser:
            browser.open(f"http://127.0.0.1:{viewer.port}/")
            parameter = "nodmap.connection.setParameter(arguments[0], arguments[1])"
            browser.wait_for("window.nodmap && nodmap.received() > 100")
            if browser.wait_for(f"nodmap.cloud.total >= {options.points}", 120) is None:
                sys.exit("viewer_frames: the cloud did not arrive within 120 s")
            browser.run(parameter, "playback.paused", True)
            width, height = browser.run("return [nodmap.view.canvas.width, nodmap.view.canvas.height]")
            print(f"{browser.run('return nodmap.cloud.total')} points, page {options.width} x {options.height}, scene {width} x {height}")
            for what, playing in (("paused", False), ("playing", True)):
                if playing:
                    # The recording plays slowly near its end: messages come all the time, and a keyframe now and then.
                    browser.run(parameter, "playback.speed", 0.25)
                    browser.run(parameter, "playback.position_s", KEYFRAMES - 0.3 * (WARM_UP_S + options.seconds))
                    browser.run(parameter, "playback.paused", False)
                    browser.wait_for(f"nodmap.cloud.total > {0.6 * options.points}", 60)
                rate, drawn, longest = browser.run(CIRCLE, WARM_UP_S, options.seconds)
                print(f"camera circles, {what}: {rate:.1f} images/s, {drawn} points drawn, longest gap {longest:.0f} ms")
            browser.run(parameter, "playback.paused", True)
            fine = browser.wait_for("nodmap.cloud.drawn === nodmap.cloud.total", 60)
            if fine is None:
                sys.exit("viewer_frames: not all points were drawn within 60 s after the camera stopped")
            print(f"camera stopped: all {browser.run('return nodmap.cloud.total')} points are drawn after {fine:.1f} s")


if __name__ == "__main__":
    main()
