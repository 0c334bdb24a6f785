#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page's controls against the real server, live: every button is answered, and nothing is shown to who has no token.

Environment: NODMAP_VIEWER (program).
"""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import webdriver  # noqa: E402
from page_case import main  # noqa: E402
from viewer_process import Viewer  # noqa: E402

# Presses at one place of the canvas and lets go at another; shares of its width and height.
POINT = """
  const {canvas} = nodmap.view;
  const box = canvas.getBoundingClientRect();
  const event = (type, [x, y]) => canvas.dispatchEvent(new PointerEvent(type, {
    clientX: box.left + x * box.width, clientY: box.top + y * box.height}));
  event("pointerdown", arguments[0]);
  event("pointerup", arguments[1]);
"""
ANSWER = "document.getElementById('answer').textContent"
BANNER = "document.getElementById('banner').textContent"


class Control(unittest.TestCase):
    def setUp(self):
        self.viewer = Viewer("--control")
        self.addCleanup(self.viewer.stop)
        self.browser = webdriver.Browser()
        self.addCleanup(self.browser.__exit__)

    def open(self, fragment):
        self.browser.open(f"http://127.0.0.1:{self.viewer.port}/{fragment}")
        self.assertIsNotNone(self.browser.wait_for("window.nodmap && document.getElementById('summary').textContent.startsWith('Connected')"))

    def open_with_token(self):
        self.open(f"#token={self.viewer.token}")
        self.assertIsNotNone(self.browser.wait_for("!document.getElementById('control').hidden"))

    def press(self, button):
        """Presses a button; the answer, as soon as there is one."""
        self.browser.run(f"{ANSWER} = ''; document.querySelector(arguments[0]).click()", button)
        self.assertIsNotNone(self.browser.wait_for(f"{ANSWER} && {ANSWER} !== 'Asked.'"), button)
        return self.browser.run(f"return {ANSWER}")

    def test_without_a_token_there_is_nothing_to_press(self):
        self.open("")
        self.assertIsNone(self.browser.wait_for("!document.getElementById('control').hidden", 1))

    def test_stop_and_go(self):
        self.open_with_token()
        self.assertFalse(self.press("#stop").startswith("Refused"))
        self.assertIsNotNone(self.browser.wait_for(f"{BANNER}.includes('STOPPED')"))
        # Told once, not five times a second.
        self.assertIn("STOPPED", self.browser.run("return document.getElementById('announcement').textContent"))
        self.assertFalse(self.press("#go").startswith("Refused"))
        self.assertIsNotNone(self.browser.wait_for(f"!{BANNER}.includes('STOPPED')"))

    def test_goals_by_numbers_and_by_a_click(self):
        self.open_with_token()
        self.browser.run("document.getElementById('goal-x').value = 2.5; document.getElementById('goal-y').value = -1")
        said = self.press("#control [type=submit]")
        self.assertIn("2.50", said)
        self.assertIn("-1.00", said)
        self.assertIsNotNone(self.browser.wait_for("nodmap.layers.get('scene/goal').layer.group.children.length > 0"))
        # Not picking: a click is nothing. Picking: a drag turns the camera, a click is the goal, and the next one nothing again.
        self.browser.run(f"{ANSWER} = ''")
        middle, aside = [0.5, 0.6], [0.7, 0.6]
        self.browser.run(POINT, middle, middle)
        self.browser.run("document.getElementById('pick').click()")
        self.browser.run(POINT, middle, aside)
        self.assertEqual(self.browser.run(f"return {ANSWER}"), "")
        self.browser.run(POINT, middle, middle)
        self.assertIsNotNone(self.browser.wait_for(f"{ANSWER}.startsWith('Goal')"))
        self.assertEqual(self.browser.run("return document.getElementById('pick').getAttribute('aria-pressed')"), "false")
        self.assertFalse(self.press("#roam").startswith("Refused"))
        self.assertIsNotNone(self.browser.wait_for("nodmap.layers.get('scene/goal').layer.group.children.length === 0"))

    def test_maps_are_asked_for(self):
        self.open_with_token()
        self.assertFalse(self.press("#save").startswith("Refused"))

    def test_without_a_configuration_no_process_can_be_controlled(self):
        self.open_with_token()
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('.process-control, .buttons')].filter((b) => !b.hidden).length"), 0)

    def test_what_can_be_pressed_has_a_name(self):
        self.open_with_token()
        nameless = self.browser.run("""return [...document.querySelectorAll('#control button, #control input')]
            .filter((e) => !(e.textContent.trim() || e.labels?.[0]?.textContent.trim())).map((e) => e.outerHTML)""")
        self.assertEqual(nameless, [])


if __name__ == "__main__":
    main()
