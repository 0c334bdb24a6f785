#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Parts of the page by themselves: what explains the scene, links, keys.

Environment: NODMAP_VIEWER, NODMAP_MAKE_ROBOT_LOG (programs).
"""
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_case import PageCase, main  # noqa: E402


class SceneExplainsItself(PageCase):
    def test_each_layer_has_its_colour_beside_its_name(self):
        browser = self.browse(self.play())
        self.assertGreater(browser.run("return document.querySelectorAll('#layers label').length"), 0)
        without = browser.run("""return [...document.querySelectorAll('#layers label')].filter((label) => {
            const style = getComputedStyle(label.querySelector('.swatch'));
            return style.backgroundImage === 'none' && style.backgroundColor === 'rgba(0, 0, 0, 0)';
        }).map((label) => label.innerText)""")
        self.assertEqual(without, [])

    def test_the_scale_bar_is_as_long_as_it_says(self):
        browser = self.browse(self.play())
        self.pause(browser)
        browser.run("document.querySelector('[data-camera=top]').click()")
        browser.run("nodmap.view.touch()")
        self.settle(browser)
        # Two places on the floor, as far apart as the bar is wide, seen from the top.
        text, apart = browser.run("""
            const bar = document.getElementById('scale-bar');
            const box = nodmap.view.canvas.getBoundingClientRect();
            const at = (x) => nodmap.view.floorAt({clientX: box.left + x, clientY: box.top + box.height / 2});
            const middle = box.width / 2;
            return [bar.textContent, at(middle).distanceTo(at(middle + bar.getBoundingClientRect().width))]""")
        value, unit = text.split()
        metres = float(value) / (100 if unit == "cm" else 1)
        self.assertAlmostEqual(apart / metres, 1, delta=0.1)  # the bar's border is 4 of about 100 pixels
        browser.run("nodmap.view.camera.position.z *= 4; nodmap.view.touch()")
        self.assertIsNotNone(browser.wait_for(f"document.getElementById('scale-bar').textContent !== '{text}'"))

    def test_two_clicks_measure_a_distance(self):
        browser = self.browse(self.play())
        self.pause(browser)
        browser.run("document.querySelector('[data-camera=top]').click(); document.getElementById('measure').click()")
        self.settle(browser)
        expected = browser.run("""
            const {canvas} = nodmap.view;
            const box = canvas.getBoundingClientRect();
            const ends = [[0.4, 0.5], [0.6, 0.6]].map(([x, y]) => ({clientX: box.left + x * box.width, clientY: box.top + y * box.height}));
            for (const end of ends) {
              canvas.dispatchEvent(new PointerEvent('pointerdown', {...end, pointerId: 1, isPrimary: true, bubbles: true}));
              canvas.dispatchEvent(new PointerEvent('pointerup', {...end, pointerId: 1, isPrimary: true, bubbles: true}));
            }
            const [a, b] = ends.map((end) => nodmap.view.floorAt(end));
            return a.distanceTo(b)""")
        self.assertEqual(browser.run("return document.getElementById('measured').value"), f"{expected:.2f} m on the floor")
        browser.run("document.dispatchEvent(new KeyboardEvent('keydown', {key: 'Escape'}))")
        self.assertEqual(browser.run("return document.getElementById('measured').value"), "")
        self.assertEqual(browser.run("return document.getElementById('measure').getAttribute('aria-pressed')"), "false")

    def test_a_click_shows_what_a_point_is_and_when_it_was_seen(self):
        browser = self.browse(self.play())
        self.pause(browser)
        self.show_only(browser, "CLOUD")
        # Clicks on a point of the cloud in the left half of the image, whose place is computed with the page's own matrices.
        place, point, seen = browser.run("""
            const {view, cloud, playback} = nodmap;
            view.scene.updateMatrixWorld(true);
            const box = view.canvas.getBoundingClientRect();
            for (const object of cloud.keyframes.values()) {
              for (let i = 0; i < object.geometry.attributes.position.count; ++i) {
                const at = view.robot.clone().fromBufferAttribute(object.geometry.attributes.position, i).applyMatrix4(object.matrixWorld);
                const on = at.clone().project(view.camera);
                if (Math.abs(on.x + 0.3) < 0.1 && Math.abs(on.y) < 0.2 && on.z < 1 && at.z < 2) {
                  return [[box.left + (on.x + 1) / 2 * box.width, box.top + (1 - on.y) / 2 * box.height], at.toArray(), object.timeS - playback.beginS];
                }
              }
            }""")
        self.click(browser, *place)
        words = re.fullmatch(r"point cloud: x (\S+), y (\S+), z (\S+) m, seen at (\d+):(\d\d)", browser.run("return document.getElementById('told').value"))
        self.assertIsNotNone(words)
        # Another point on nearly the same line of sight may be in front of it: the walls are 2 m away.
        told = [float(words[i]) for i in (1, 2, 3)]
        self.assertLess(sum((a - b) ** 2 for a, b in zip(told, point)) ** 0.5, 1)
        self.assertLessEqual(60 * int(words[4]) + int(words[5]), browser.run("return nodmap.playback.positionS"))
        self.assertGreaterEqual(seen, 0)
        self.show_only(browser)
        self.click(browser, *place)
        self.assertTrue(browser.run("return document.getElementById('told').value").startswith("floor: "))
        # A click that measures a distance shows nothing about the point.
        browser.run("document.getElementById('told').value = ''; document.getElementById('measure').click()")
        self.click(browser, *place)
        self.assertEqual(browser.run("return document.getElementById('told').value"), "")
        self.assert_quiet(browser)

    def click(self, browser, x, y):
        browser.run("""
            for (const type of ['pointerdown', 'pointerup']) {
              nodmap.view.canvas.dispatchEvent(new PointerEvent(type, {clientX: arguments[0], clientY: arguments[1], pointerId: 1, isPrimary: true, bubbles: true}));
            }""", x, y)

    def test_yes_answers_only_the_question_that_is_shown(self):
        browser = self.browse(self.play())
        answers = browser.run("""return import("./confirm.js").then(({confirmed}) => {
            const dialog = document.getElementById("confirm");
            const asked = [confirmed(dialog, "Stop?"), confirmed(dialog, "Restart?")];
            dialog.querySelector("[value=yes]").click();
            return Promise.all(asked);
          });""")
        self.assertEqual(answers, [False, True])

    def test_help_names_every_key(self):
        browser = self.browse(self.play())
        browser.run("document.body.dispatchEvent(new KeyboardEvent('keydown', {key: '?', bubbles: true}))")
        self.assertIsNotNone(browser.wait_for("document.getElementById('help').open"))
        named = browser.run("return [...document.querySelectorAll('#help kbd')].map((key) => key.textContent)")
        for key in ("S", "Space", ",", ".", "F", "T", "R", "M", "Esc", "+", "-", "?"):
            self.assertIn(key, named)
        browser.run("document.getElementById('help').close()")
        browser.run("document.body.dispatchEvent(new KeyboardEvent('keydown', {key: 't', bubbles: true}))")
        self.assertEqual(browser.run("return document.querySelector('[data-camera=top]').getAttribute('aria-pressed')"), "true")
        self.assert_quiet(browser)

    def test_light_theme_is_light_everywhere(self):
        browser = self.browse(self.play())
        self.choose_theme(browser, "light")
        self.assertGreater(self.lightness(browser, "body"), 200)
        self.assertLess(self.lightness(browser, "body", "color"), 60)
        self.assertGreater(browser.run("return nodmap.view.scene.background.g"), 0.8)
        self.save_image(browser, "page-light.png")
        self.choose_theme(browser, "dark")
        self.assertLess(self.lightness(browser, "body"), 60)
        self.assertLess(browser.run("return nodmap.view.scene.background.g"), 0.2)
        self.assert_quiet(browser)

    def choose_theme(self, browser, theme):
        browser.run("const s = document.getElementById('theme'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", theme)

    def lightness(self, browser, selector, which="backgroundColor"):
        """The green part of a colour, 0 to 255."""
        return int(browser.run("return getComputedStyle(document.querySelector(arguments[0]))[arguments[1]]", selector, which).split(",")[1])

    def test_no_box_covers_another(self):
        viewer = self.play()
        for width, height in ((390, 844), (1280, 800), (1920, 1080)):
            browser = self.browse(viewer, width, height)
            self.save_image(browser, f"page-{width}.png")
            over = browser.run("""
                const boxes = ['#view nav', '#layers-menu', '#legend', '#scale', '#playback']
                  .map((name) => [name, document.querySelector(name).getBoundingClientRect()]);
                const outside = boxes.filter(([, box]) => box.left < 0 || box.right > innerWidth).map(([name]) => name);
                const pairs = boxes.flatMap(([a, p], i) => boxes.slice(i + 1).map(([b, q]) => [a, b, p, q]));
                return outside.concat(pairs.filter(([, , p, q]) => p.left < q.right && q.left < p.right && p.top < q.bottom && q.top < p.bottom)
                  .map(([a, b]) => `${a} and ${b}`))""")
            self.assertEqual(over, [], f"at {width} px")


class Links(PageCase):
    def test_a_link_shows_the_same_view_at_the_same_time(self):
        viewer = self.play()
        browser = self.browse(viewer)
        self.pause(browser)
        browser.run("nodmap.view.setMode('free'); nodmap.view.camera.position.set(1, -5, 3); nodmap.view.controls.target.set(1, 0, 0); nodmap.playback.seek(12.5)")
        self.assertIsNotNone(browser.wait_for("Math.abs(nodmap.playback.positionS - 12.5) < 0.004"))
        browser.run("document.getElementById('link').click()")
        link = browser.run("return location.href")
        self.assertIn("t=12.50", link)
        browser.run("nodmap.playback.seek(40)")
        browser.open("about:blank")
        browser.open(link)
        self.assertIsNotNone(browser.wait_for("window.nodmap && Math.abs(nodmap.playback.positionS - 12.5) < 0.05 && nodmap.playback.paused"))
        self.assertEqual(browser.run("return nodmap.view.camera.position.toArray().map(Math.round)"), [1, -5, 3])

    def test_a_link_never_holds_the_token(self):
        browser = self.browse(self.play())
        self.assertNotIn("token", browser.run("""return import('/link.js').then(({makeLink}) =>
            makeLink({origin: 'http://h', pathname: '/', hash: '#token=secret'}, nodmap.view, 1))"""))


class Keys(PageCase):
    def test_arrows_turn_the_camera_and_plus_comes_nearer(self):
        browser = self.browse(self.play())
        self.pause(browser)
        press = "nodmap.view.canvas.dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0], cancelable: true}))"
        offset = "return nodmap.view.camera.position.clone().sub(nodmap.view.controls.target).toArray()"

        def length(vector):
            return sum(x * x for x in vector) ** 0.5
        before = browser.run(offset)
        browser.run(press, "ArrowLeft")
        turned = browser.run(offset)
        self.assertGreater(length([a - b for a, b in zip(before, turned)]), 0.1)
        self.assertAlmostEqual(turned[2], before[2], places=6)  # around the vertical
        self.assertAlmostEqual(length(turned), length(before), places=6)
        browser.run(press, "ArrowUp")
        self.assertGreater(browser.run(offset)[2], turned[2] + 0.1)
        browser.run(press, "+")
        self.assertLess(length(browser.run(offset)), 0.95 * length(before))


class OutputDialog(PageCase):
    def test_it_shows_the_output_of_the_process_pressed_last(self):
        browser = self.browse(self.play())
        # The first answer comes when the second process is shown already.
        browser.run("""return import("/output.js").then(({Output}) => {
          window.asked = [];
          let answer;
          const late = new Promise((done) => { answer = done; });
          const output = new Output(document.getElementById("output"), (command) => {
            asked.push(command);
            return command === "first" ? late : Promise.resolve({text: "said by the second"});
          });
          output.show("first");
          output.show("second");
          answer({text: "said by the first"});
        })""")
        self.assertIsNotNone(browser.wait_for("asked.filter((command) => command === 'second').length >= 3"))
        self.assertEqual(browser.run("return document.querySelector('#output pre').textContent"), "said by the second")
        self.assertEqual(browser.run("return asked.filter((command) => command === 'first').length"), 1)


class PlotsOverTime(PageCase):
    def test_they_begin_again_when_the_clock_was_set_back(self):
        browser = self.browse(self.play())
        samples = """return import("/plots.js").then(({Plots}) => {
          const plots = new Plots(document.createElement("div"));
          plots.gaps = nodmap.plots.gaps;
          arguments[0].forEach(([topic, timeS]) => plots.add(topic, {forward_mps: timeS, max_forward_mps: timeS}, timeS));
          return plots.plots[0].samples.map((line) => line.map(([timeS]) => timeS));
        })"""
        before = [("NAVIGATION", 1000), ("ODOMETRY", 1000), ("ODOMETRY", 1000.5), ("ODOMETRY", 1000.25)]  # the last one came by a longer way
        self.assertEqual(browser.run(samples, before), [[1000, 1000.5], [1000]])
        self.assertEqual(browser.run(samples, [*before, ("ODOMETRY", 400), ("ODOMETRY", 400.5)]), [[400, 400.5], []])


class WordsAboutTheRobot(PageCase):
    def test_a_stop_is_not_called_confirmed_before_it_is(self):
        browser = self.browse(self.play())
        faults = browser.run("""return import("/state.js").then(({stopFault}) => ["RELEASED", "SENT", "STOPPED", "NOT_CONFIRMED"].map((state) => {
            const fault = stopFault({state, by: "me"});
            return fault ? [fault.level, fault.what, fault.why.includes("by me")] : null;
        }))""")
        self.assertEqual(faults, [None, [1, "STOP sent", True], [1, "STOPPED", True], [2, "STOP not confirmed", True]])

    def test_a_goal_counts_as_taken_when_the_navigator_reports_on_it(self):
        browser = self.browse(self.play())
        texts = browser.run("""return import("/state.js").then(({goalText}) => arguments[0].map(([goal, navigation]) => goalText(goal, navigation)))""",
                            [[goal, navigation] for goal in ({"is_active": True, "utime": 7, "position_m": [1, -2]}, {"is_active": False, "utime": 7})
                             for navigation in (None, {"goal_utime": 0}, {"goal_utime": 7, "behaviour_name": "HALT"}, {"goal_utime": 7, "behaviour_name": "ARRIVED"})])
        place, late = "x 1.00 m, y -2.00 m, ", "cancelled, not taken"
        missed = place + "not taken"
        self.assertEqual(texts, [missed, missed, place + "taken", place + "reached", late, "none: the robot roams", late, late])


class EventsOnTheTimeLine(PageCase):
    def test_a_text_of_several_lines_is_one_event(self):
        browser = self.browse(self.play())
        titles = browser.run("""nodmap.playback.showEvents(arguments[0]);
            return [...document.querySelectorAll('#marks button')].map((mark) => mark.title)""",
                             ["1.000 stop by me", "2.000 fault nodmap-kurt: no\nanswer", "nonsense"])
        self.assertEqual(titles, ["0:01 stop by me", "0:02 fault nodmap-kurt: no\nanswer"])
        self.assert_quiet(browser)


if __name__ == "__main__":
    main()
