#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page in a real browser: headless Chromium with software rendering, with a recording.

Environment: NODMAP_VIEWER, NODMAP_MAKE_ROBOT_LOG (programs); NODMAP_SCREENSHOTS (a folder, if images are wanted).
"""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import webdriver  # noqa: E402
from page_case import COUNT_DRAWN, PageCase, main  # noqa: E402
from viewer_process import Viewer  # noqa: E402

# Everything comes from this host: no image, script or style is fetched from elsewhere.
HOSTS = "return [...new Set(performance.getEntriesByType('resource').map((e) => new URL(e.name).host))]"


class Page(PageCase):
    def test_it_shows_the_robot_and_its_maps(self):
        viewer = self.play()
        browser = self.browse(viewer)
        # The cloud alone covers thousands of pixels of this window; an empty scene has none.
        self.assertGreater(browser.run(COUNT_DRAWN), 5000)
        for topic in ("scene/robot", "SCAN", "CLOUD", "MAP_2D", "OBSTACLE_MAP", "STRUCTURE_MAP", "scene/corridor", "scene/area_of_interest",
                      "trail/odometry", "trail/2d", "trail/6d", "keyframes", "scene/goal", "scene/people"):
            self.assertIsNotNone(browser.wait_for(f"nodmap.layers.get('{topic}').layer.group.children.length > 0"), topic)
        self.assertIsNotNone(browser.wait_for("document.getElementById('processes').innerText.includes('slam2d')"))
        self.assertIsNotNone(browser.wait_for("document.getElementById('facts').innerText.includes('0.50 m/s')"))
        # A busy machine may stall for two seconds: then the banner is shown, and disappears again.
        self.assertIsNotNone(browser.wait_for("document.getElementById('banner').hidden"))
        self.assertTrue(browser.run("return document.getElementById('control').hidden"))
        self.assertEqual(browser.run(HOSTS), [f"127.0.0.1:{viewer.port}"])
        self.save_image(browser, "page.png")
        self.assert_quiet(browser)

    def test_it_keeps_as_many_points_as_the_viewer(self):
        browser = self.browse(self.play("--set", "max_cloud_points=36000"))
        # A keyframe of 12000 points comes every second.
        self.assertIsNotNone(browser.wait_for("nodmap.playback.positionS > 5"))
        self.assertEqual(browser.run("return nodmap.cloud.total"), 36000)

    def test_layers_can_be_hidden_and_shown(self):
        browser = self.browse(self.play())
        self.pause(browser)
        boxes = "[...document.querySelectorAll('#layers input')]"
        with_all = browser.run(COUNT_DRAWN)
        browser.run(f"{boxes}.find((b) => b.dataset.topic === 'CLOUD').click()")
        without_cloud = browser.run(COUNT_DRAWN)
        self.assertLess(without_cloud, with_all)
        browser.run(f"{boxes}.filter((b) => b.checked).forEach((b) => b.click())")
        self.assertEqual(browser.run(COUNT_DRAWN), 0)
        browser.run(f"{boxes}.forEach((b) => b.click())")
        self.assertGreater(browser.run(COUNT_DRAWN), without_cloud)
        self.assert_quiet(browser)

    def test_each_camera_shows_its_view(self):
        browser = self.browse(self.play())
        for mode in ("top", "free", "follow"):
            browser.run(f"document.querySelector('[data-camera={mode}]').click()")
            self.assertEqual(browser.run("return nodmap.view.mode"), mode)
            self.assertEqual(browser.run("return [...document.querySelectorAll('[aria-pressed=true]')].map((b) => b.dataset.camera)"), [mode])
        browser.run("document.querySelector('[data-camera=top]').click()")
        self.assertGreater(browser.run("const v = nodmap.view; return v.camera.position.z - v.robot.z"), 10)
        self.save_image(browser, "top.png")

    def test_the_time_line_seeks_and_pauses(self):
        browser = self.browse(self.play())
        self.pause(browser)
        move = "const p = document.getElementById('position'); p.value = arguments[0]; p.dispatchEvent(new Event('change'))"
        browser.run(move, 18)
        self.assertIsNotNone(browser.wait_for("nodmap.cloud.keyframes.size === 19"))
        browser.run(move, 2)
        # After a seek back, what has not happened yet is no longer shown.
        self.assertIsNotNone(browser.wait_for("nodmap.cloud.keyframes.size === 3"))
        # A pause does not count as a loss of data.
        self.assertIsNone(browser.wait_for("!document.getElementById('banner').hidden", 4))
        self.assert_quiet(browser)

    def seek(self, browser, position_s):
        browser.run("const p = document.getElementById('position'); p.value = arguments[0]; p.dispatchEvent(new Event('change'))", position_s)

    def test_the_clock_is_right_after_a_seek(self):
        browser = self.browse(self.play())
        # Checked at every message, so that no moment is missed.
        browser.run("""
          window.clocks = [];
          const {show} = nodmap.playback.constructor.prototype;
          nodmap.playback.show = function (positionS) { show.call(this, positionS); window.clocks.push(positionS); };""")
        for position_s in (50, 10, 55, 5):
            self.seek(browser, position_s)
            self.assertIsNotNone(browser.wait_for(f"Math.abs(nodmap.playback.positionS - {position_s}) < 3"))
        self.assertGreater(browser.run("return window.clocks.length"), 0)
        self.assertTrue(browser.run("return window.clocks.every((s) => s >= -0.001 && s <= nodmap.playback.durationS + 0.001)"))
        self.assertRegex(browser.run("return document.getElementById('clock').textContent"), r"^0:\d\d / (0:\d\d|1:00)$")

    def test_the_slider_moves_on_while_it_has_the_focus(self):
        browser = self.browse(self.play())
        browser.run("document.getElementById('position').focus()")
        begin = float(browser.run("return document.getElementById('position').value"))
        self.assertIsNotNone(browser.wait_for(f"Number(document.getElementById('position').value) > {begin} + 0.5"))

    def test_marks_name_events_and_seek_to_them(self):
        browser = self.browse(self.play())
        self.assertIsNotNone(browser.wait_for("document.querySelectorAll('#marks > *').length > 0"))
        kinds = browser.run("return [...new Set([...document.querySelectorAll('#marks > *')].map((mark) => mark.dataset.kind))]")
        self.assertIn("keyframe", kinds)
        # Each mark is where the slider's knob is at that time.
        self.pause(browser)
        browser.run("nodmap.playback.marks.replaceChildren(); nodmap.playback.showEvents(['30.000 stop by me'])")
        mark = "document.querySelector('#marks [data-kind=stop]')"
        self.assertEqual(browser.run(f"return {mark}.title"), "0:30 stop by me")
        share = browser.run("return 30 / nodmap.playback.durationS")
        at = browser.run(f"const m = {mark}.getBoundingClientRect(); return m.left + m.width / 2")
        left, right = browser.run("const r = document.getElementById('position').getBoundingClientRect(); return [r.left, r.right]")
        self.assertAlmostEqual(at, left + 8 + share * (right - left - 16), delta=3)
        browser.run(f"{mark}.click()")
        self.assertIsNotNone(browser.wait_for("Math.abs(nodmap.playback.positionS - 29) < 0.05"))
        self.assert_quiet(browser)

    def test_plots_show_the_whole_recording_with_a_cursor(self):
        browser = self.browse(self.play())
        self.pause(browser)
        speed = "nodmap.plots.plots[0]"
        self.assertIsNotNone(browser.wait_for(f"{speed}.graph && {speed}.window"))
        begin, end = browser.run(f"return {speed}.graph.xAxisRange()")
        self.assertAlmostEqual((end - begin) / 1000, browser.run("return nodmap.playback.durationS"), delta=1e-3)
        # The samples reach to the end although only the first seconds have been played, and they stay after a seek back.
        last = f"return {speed}.samples[0][{speed}.samples[0].length - 1]"
        for position_s in (50, 3):
            self.seek(browser, position_s)
            self.assertIsNotNone(browser.wait_for(f"Math.abs(nodmap.playback.positionS - {position_s}) < 0.01"))
            time_s, speed_mps = browser.run(last)
            self.assertAlmostEqual(time_s, end / 1000, delta=0.2)
            self.assertEqual(speed_mps, 0.5)
            # The cursor is at its fraction of the time axis, which begins to the right of the numbers.
            area = f"{speed}.graph.getArea()"
            self.assertIsNotNone(browser.wait_for(
                f"Math.abs(parseFloat({speed}.cursor.style.left) - {area}.x - {position_s} / nodmap.playback.durationS * {area}.w) < 1"))
        self.assert_quiet(browser)

    def test_gaps_in_the_data_are_gaps_in_the_plots(self):
        browser = self.browse(self.play())
        live, recorded = browser.run("""
            return import("./plots.js").then(({Plots}) => {
              const rows = (fill) => {
                const box = document.createElement("div");
                document.body.append(box);
                const plots = new Plots(box);
                plots.gaps = nodmap.plots.gaps;
                fill(plots);
                plots.draw();
                const {graph} = plots.plots[0];
                const lines = [...Array(graph.numRows()).keys()].map((row) => [graph.getValue(row, 0) / 1000, String(graph.getValue(row, 1))]);
                box.remove();
                return lines;
              };
              return [rows((plots) => [1, 1.5, 4, 4.5].forEach((timeS) => plots.add("ODOMETRY", {forward_mps: 0.5}, timeS))),
                      rows((plots) => plots.showHistory({forward_mps: [[1, 0.5], [1.5, 0.25], [1.5, null], [4, 0.5]]}, 0, 10))];
            });""")
        self.assertEqual(live, [[1, "0.5"], [1.5, "0.5"], [1.5, "NaN"], [4, "0.5"], [4.5, "0.5"]])
        self.assertEqual(recorded, [[1, "0.5"], [1.5, "0.25"], [1.5, "NaN"], [4, "0.5"]])

    def test_play_at_the_end_starts_from_the_beginning(self):
        browser = self.browse(self.play(duration_s=20))
        self.seek(browser, 19.9)
        self.assertIsNotNone(browser.wait_for("nodmap.playback.isAtEnd"))
        self.assertEqual(browser.run("return document.getElementById('pause').textContent"), "Play")
        browser.run("document.getElementById('pause').click()")
        self.assertIsNotNone(browser.wait_for("!nodmap.playback.isAtEnd && document.getElementById('pause').textContent === 'Pause'"))

    def test_keys_pause_and_step(self):
        browser = self.browse(self.play())
        press = "document.querySelector(arguments[1]).dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0], bubbles: true, cancelable: true}))"
        browser.run(press, " ", "#canvas")
        self.assertIsNotNone(browser.wait_for("nodmap.playback.paused"))
        self.seek(browser, 10)
        self.assertIsNotNone(browser.wait_for("Math.abs(nodmap.playback.positionS - 10) < 1e-3"))
        for _ in range(3):
            browser.run(press, ".", "#canvas")
        self.assertIsNotNone(browser.wait_for("Math.abs(nodmap.playback.positionS - 10.3) < 1e-3"))
        browser.run(press, ",", "#canvas")
        self.assertIsNotNone(browser.wait_for("Math.abs(nodmap.playback.positionS - 10.2) < 1e-3"))
        browser.run(press, " ", "#canvas")
        self.assertIsNotNone(browser.wait_for("!nodmap.playback.paused"))
        # Where Space presses a control, it does not pause as well.
        browser.run(press, " ", "#speed")
        self.assertFalse(browser.run("return nodmap.playback.paused"))

    def test_the_banner_is_shown_when_no_messages_arrive(self):
        viewer = self.play()
        browser = self.browse(viewer)
        # A busy machine may stall for two seconds: then the banner is shown, and disappears again.
        self.assertIsNotNone(browser.wait_for("document.getElementById('banner').hidden"))
        viewer.stop()
        self.assertIsNotNone(browser.wait_for("document.getElementById('banner').textContent.includes('No connection')"))
        self.assertFalse(browser.run("return document.getElementById('banner').hidden"))

    def test_after_a_paused_recording_a_live_viewer_without_data_is_a_fault(self):
        viewer = self.play()
        browser = self.browse(viewer)
        self.assertIsNotNone(browser.wait_for("document.querySelectorAll('#marks > *').length > 0"))
        self.pause(browser)
        viewer.stop()
        with Viewer("--port", str(viewer.port)):
            self.assertIsNotNone(browser.wait_for("document.getElementById('banner').textContent.startsWith('No data')"))
            self.assertTrue(browser.run("return document.getElementById('playback').hidden"))
            self.assertEqual(browser.run("return document.querySelectorAll('#marks > *').length"), 0)

    def test_the_banner_names_the_time_of_the_last_message(self):
        browser = self.browse(self.play())
        self.assertIsNotNone(browser.wait_for("document.getElementById('banner').hidden"))
        # Still connected, but every message is lost.
        browser.run("nodmap.connection.handlers.message = () => {}")
        self.assertIsNotNone(browser.wait_for("document.getElementById('banner').textContent.includes('since')"))
        self.assertFalse(browser.run("return document.getElementById('banner').hidden"))

    def test_two_commands_of_one_program_are_two_rows(self):
        browser = self.browse(self.play())
        rows = browser.run("""
            const said = [{process_name: "nodmap-logger", utime: 1e6, age_s: 0, health: 0, health_reason: ""},
                          {process_name: "nodmap-slam2d", utime: 1e6, age_s: 1, health: 1, health_reason: "lost"}];
            const commands = [{command: "logger-a", host: "a", process_name: "nodmap-logger", state: "running", end: ""},
                              {command: "logger-b", host: "b", process_name: "nodmap-logger", state: "failed", end: "exit code 1"}];
            return import("./processes.js").then(
              ({processList}) => processList(said, commands).map(({name, state, level}) => [name, state, level]));""")
        self.assertEqual(rows, [["logger-a on a", "OK", 0], ["logger-b on b", "failed", 2], ["nodmap-slam2d", "DEGRADED", 1]])

    def test_a_process_is_silent_by_the_age_of_its_status_whatever_its_hosts_clock(self):
        browser = self.browse(self.play())
        states = browser.run("""
            const said = [{process_name: "late", utime: 1e6, age_s: 0, health: 0}, {process_name: "early", utime: 11e6, age_s: 0, health: 0},
                          {process_name: "ended", utime: 11e6, age_s: 4, health: 0}];
            return import("./processes.js").then(({processList}) => processList(said, []).map(({state}) => state));""")
        self.assertEqual(states, ["OK", "OK", "silent"])

    def test_the_page_fits_on_a_phone(self):
        browser = self.browse(self.play(), 400, 800)
        # Nothing is wider than the screen.
        self.assertLessEqual(browser.run("return document.documentElement.scrollWidth - document.documentElement.clientWidth"), 0)
        self.save_image(browser, "phone.png")

    def test_every_control_has_a_name(self):
        browser = self.browse(self.play())
        nameless = browser.run("""return [...document.querySelectorAll('button, input, select, #canvas, [role=img]')]
            .filter((e) => !e.closest('.plot') || e.matches('.plot'))  // what dygraphs makes inside is hidden
            .filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.labels?.[0]?.textContent.trim()))
            .map((e) => e.outerHTML)""")
        self.assertEqual(nameless, [])


class LiveWithoutData(unittest.TestCase):
    def test_the_banner_says_that_there_is_no_robot(self):
        browser = webdriver.shared_browser()
        with Viewer() as viewer:
            browser.open(f"http://127.0.0.1:{viewer.port}/")
            self.assertIsNotNone(browser.wait_for("document.getElementById('banner').textContent.startsWith('No data')"))
            # The viewer's own STATUS does not count as a robot's.
            self.assertIsNotNone(browser.wait_for("document.getElementById('processes').innerText.includes('viewer')"))
            self.assertIsNone(browser.wait_for("document.getElementById('banner').hidden", 2))


if __name__ == "__main__":
    main()
