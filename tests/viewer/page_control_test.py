#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page's controls with the real server, live: every button gets an answer, and without a token there are no buttons.

Environment: NODMAP_VIEWER, NODMAP_KURT, NODMAP_EXPLORER (programs).
"""
import os
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import webdriver  # noqa: E402
from deputy_process import Deputy  # noqa: E402
from page_case import main  # noqa: E402
from viewer_process import Viewer  # noqa: E402
from websocket import PATIENCE_S  # noqa: E402

# A function that sends a pointer event to a place of the canvas, in fractions of width and height.
POINTER = """
  const {canvas} = nodmap.view;
  const box = canvas.getBoundingClientRect();
  const event = (type, [x, y], more) => canvas.dispatchEvent(new PointerEvent(type, {
    clientX: box.left + x * box.width, clientY: box.top + y * box.height, pointerId: 1, isPrimary: true, ...more}));
"""
# Presses the pointer at one place and releases it at another.
POINT = POINTER + """
  event("pointerdown", arguments[0], arguments[2]);
  event("pointerup", arguments[1], arguments[2]);
"""
# Two fingers, of which the first one moves.
PINCH = POINTER + """
  const second = {pointerId: 2, isPrimary: false};
  event("pointerdown", [0.4, 0.6]);
  event("pointerdown", [0.6, 0.6], second);
  event("pointerup", [0.2, 0.6]);
  event("pointerup", [0.6, 0.6], second);
"""
ANSWER = "document.getElementById('answer').textContent"
BANNER = "document.getElementById('banner').textContent"
FACTS = "document.getElementById('facts').innerText"


# A key, with the focus on an element.
KEY = """
  const at = document.querySelector(arguments[1]);
  at.focus();
  at.dispatchEvent(new KeyboardEvent("keydown", {key: arguments[0], code: arguments[2] ?? "", bubbles: true, cancelable: true}));
"""


class Page(unittest.TestCase):
    """A live viewer with control, and its page."""

    def setUp(self):
        self.viewer = Viewer("--control")
        self.addCleanup(self.viewer.stop)
        self.browser = webdriver.shared_browser()

    def open(self, fragment):
        self.browser.open(f"http://127.0.0.1:{self.viewer.port}/{fragment}")
        self.assertIsNotNone(self.browser.wait_for("window.nodmap && document.getElementById('summary').textContent.startsWith('Connected')"))

    def open_with_token(self):
        self.open(f"#token={self.viewer.token}")
        self.assertIsNotNone(self.browser.wait_for("!document.getElementById('control').hidden"))

    def start(self, *command):
        """Starts a process of the robot, which ends with the test."""
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait, PATIENCE_S)
        self.addCleanup(process.terminate)

    def press(self, button):
        """Presses a button; returns the server's answer as soon as there is one."""
        self.browser.run(f"{ANSWER} = ''; document.querySelector(arguments[0]).click()", button)
        self.assertIsNotNone(self.browser.wait_for(f"!['', 'Asked.', 'No answer yet.'].includes({ANSWER})"), button)
        return self.browser.run(f"return {ANSWER}")


class Control(Page):
    def test_without_a_token_there_is_nothing_to_press(self):
        self.open("")
        self.assertIsNone(self.browser.wait_for("!document.getElementById('control').hidden", 1))

    def test_the_robot_counts_as_stopped_when_its_base_driver_says_so(self):
        self.open_with_token()
        self.assertIn("STOP is sent", self.press("#stop"))
        self.assertIsNotNone(self.browser.wait_for(f"{BANNER}.includes('STOP not confirmed')"))
        self.assertEqual(self.browser.run("return document.getElementById('banner').dataset.level"), "error")
        self.assertNotIn("STOPPED", self.browser.run(f"return {BANNER}"))
        # Without a base it is FAILED, and stopped as after each start.
        self.start(os.environ["NODMAP_KURT"], "--set", "device=/dev/nothing")
        self.assertIsNotNone(self.browser.wait_for(f"{BANNER}.includes('STOPPED: by nodmap-kurt, for nodmap-viewer')"))
        self.assertNotIn("STOP not confirmed", self.browser.run(f"return {BANNER}"))
        # Announced once, not five times a second.
        self.assertIn("STOPPED", self.browser.run("return document.getElementById('announcement').textContent"))
        self.assertFalse(self.press("#go").startswith("Refused"))
        self.assertIsNotNone(self.browser.wait_for(f"!{BANNER}.includes('STOP')"))
        # Nor does the base driver say a second later that it is stopped.
        self.assertIsNone(self.browser.wait_for(f"{BANNER}.includes('STOP')", 2))

    def test_a_goal_is_given_by_numbers_or_by_a_click(self):
        self.open_with_token()
        self.browser.run("document.getElementById('goal-x').value = 2.5; document.getElementById('goal-y').value = -1")
        said = self.press("#control [type=submit]")
        self.assertIn("2.50", said)
        self.assertIn("-1.00", said)
        self.assertIn("no nodmap-navigator reports", said)
        self.assertIsNotNone(self.browser.wait_for("nodmap.layers.get('scene/goal').layer.group.children.length > 0"))
        self.assertIsNotNone(self.browser.wait_for(f"{FACTS}.includes('x 2.50 m, y -1.00 m, not taken')"))
        # While no goal is being chosen, a click does nothing. While one is, a drag turns the camera and a click is the goal; the next click does
        # nothing again.
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

    def test_home_is_the_origin_of_the_map(self):
        self.open_with_token()
        said = self.press("#home")
        self.assertTrue(said.startswith("Goal: home"), said)
        self.assertIsNotNone(self.browser.wait_for(f"{FACTS}.includes('x 0.00 m, y 0.00 m, not taken')"))

    def test_only_the_main_button_and_a_single_finger_give_a_goal(self):
        self.open_with_token()
        self.browser.run(f"{ANSWER} = ''; document.getElementById('pick').click()")
        place = [0.5, 0.6]
        self.browser.run(POINT, place, place, {"button": 2})  # a pan that was broken off
        self.browser.run(PINCH)
        self.assertEqual(self.browser.run(f"return {ANSWER}"), "")
        self.assertEqual(self.browser.run("return document.getElementById('pick').getAttribute('aria-pressed')"), "true")
        self.browser.run(POINT, place, place)
        self.assertIsNotNone(self.browser.wait_for(f"{ANSWER}.startsWith('Goal')"))

    def test_an_exploration_is_started_and_ended(self):
        self.open_with_token()
        self.assertIn("no nodmap-explorer reports", self.press("#explore"))
        self.start(os.environ["NODMAP_EXPLORER"])
        self.assertIsNotNone(self.browser.wait_for("document.getElementById('processes').innerText.includes('explorer')"))
        self.assertNotIn("reports", self.press("#explore"))
        self.assertIsNotNone(self.browser.wait_for(f"{FACTS}.includes('EXPLORING')"))
        self.assertIn("stays", self.press("#explore-end"))

    def test_an_empty_field_gives_no_goal(self):
        self.open_with_token()
        for x, y in (("", "1"), ("1", ""), ("", "")):
            self.browser.run("document.getElementById('goal-x').value = arguments[0]; document.getElementById('goal-y').value = arguments[1]", x, y)
            self.assertTrue(self.press("#control [type=submit]").startswith("Not sent"), (x, y))
        self.browser.run("document.getElementById('goal-x').value = 1e9; document.getElementById('goal-y').value = 0")
        self.assertIn("10000 m", self.press("#control [type=submit]"))
        self.assertEqual(self.browser.run("return nodmap.layers.get('scene/goal').layer.group.children.length"), 0)

    def test_escape_ends_the_choice_of_a_goal(self):
        self.open_with_token()
        self.browser.run("document.getElementById('pick').click()")
        self.assertEqual(self.browser.run("return document.getElementById('pick').getAttribute('aria-pressed')"), "true")
        self.browser.run(KEY, "Escape", "#pick")
        self.assertEqual(self.browser.run("return document.getElementById('pick').getAttribute('aria-pressed')"), "false")

    def test_a_click_that_measures_is_no_goal(self):
        self.open_with_token()
        for first, then in (("pick", "measure"), ("measure", "pick")):
            self.browser.run(f"document.getElementById('{first}').click(); document.getElementById('{then}').click()")
            self.assertEqual(self.browser.run(f"return document.getElementById('{first}').getAttribute('aria-pressed')"), "false")
            self.assertEqual(self.browser.run(f"return document.getElementById('{then}').getAttribute('aria-pressed')"), "true")
            self.browser.run("nodmap.view.setClickMode('none')")
        self.browser.run(f"{ANSWER} = ''; document.getElementById('pick').click(); document.getElementById('measure').click()")
        self.browser.run(POINT, [0.5, 0.6], [0.5, 0.6])
        self.assertIn("other end", self.browser.run("return document.getElementById('measured').value"))
        self.assertEqual(self.browser.run(f"return {ANSWER}"), "")

    def test_stop_has_a_key_wherever_the_focus_is(self):
        self.open_with_token()
        for focus in ("#canvas", "#goal-x", "#save"):
            self.browser.run(f"{ANSWER} = ''")
            self.browser.run(KEY, "s", focus)
            self.assertIsNotNone(self.browser.wait_for(f"{ANSWER}.startsWith('STOP is sent')"), focus)
        self.assertFalse(self.press("#go").startswith("Refused"))

    def test_the_key_of_stop_is_found_by_its_place_on_a_keyboard_without_latin_letters(self):
        self.open_with_token()
        self.browser.run(f"{ANSWER} = ''")
        for key, code in (("o", "KeyS"), ("ö", "Semicolon"), ("ы", "KeyA")):  # Dvorak; German; not its place
            self.browser.run(KEY, key, "#canvas", code)
        self.assertEqual(self.browser.run(f"return {ANSWER}"), "")
        for key, code in (("ы", "KeyS"), ("σ", "KeyS"), ("S", "Semicolon")):
            self.browser.run(KEY, key, "#canvas", code)
            self.assertIsNotNone(self.browser.wait_for(f"{ANSWER}.startsWith('STOP is sent')"), key)
            self.browser.run(f"{ANSWER} = ''")

    def test_the_stop_button_stays_in_place(self):
        self.open_with_token()
        place = "const box = document.getElementById('stop').getBoundingClientRect(); return [box.left, box.top, box.right, box.bottom]"
        for width, height in ((1920, 1080), (1280, 720), (390, 844)):
            self.browser.resize(width, height)
            self.browser.run("document.getElementById('banner').hidden = true")
            at_first = self.browser.run(place)
            self.assertLessEqual(at_first[3], height)
            self.assertGreaterEqual(at_first[1], 0)
            self.browser.run("document.getElementById('banner').textContent = 'Much is wrong. '.repeat(60); document.getElementById('banner').hidden = false")
            self.assertEqual(self.browser.run(place), at_first, "with a long banner")
            self.browser.run("window.scrollTo(0, document.documentElement.scrollHeight); document.querySelector('aside').scrollTo(0, 1e4)")
            self.assertEqual(self.browser.run(place), at_first, "scrolled to the end")
            self.browser.run("window.scrollTo(0, 0)")

    def test_an_old_token_is_reported_and_the_page_can_be_read(self):
        self.browser.open(f"http://127.0.0.1:{self.viewer.port}/#token={'0' * 32}")
        self.assertIsNotNone(self.browser.wait_for("window.nodmap && !document.getElementById('token-refused').hidden"))
        self.browser.run("document.getElementById('read-only').click()")
        self.assertIsNotNone(self.browser.wait_for("document.getElementById('summary').textContent.startsWith('Connected')"))
        self.assertTrue(self.browser.run("return document.getElementById('token-refused').hidden"))
        self.assertTrue(self.browser.run("return document.getElementById('stop-bar').hidden"))

    def test_a_token_with_which_the_page_connects_is_valid(self):
        self.open_with_token()
        # As after an attempt to connect that a weak link broke off.
        self.browser.run("nodmap.connection.handlers.tokenRefused(); nodmap.connection.socket.close()")
        self.assertFalse(self.browser.run("return document.getElementById('token-refused').hidden"))
        self.assertIsNotNone(self.browser.wait_for("document.getElementById('token-refused').hidden"))
        self.assertFalse(self.browser.run("return document.getElementById('control').hidden"))

    def test_a_new_token_in_the_address_is_used(self):
        self.browser.open(f"http://127.0.0.1:{self.viewer.port}/#token={'0' * 32}")
        self.assertIsNotNone(self.browser.wait_for("window.nodmap && !document.getElementById('token-refused').hidden"))
        self.browser.run("location.hash = arguments[0]", f"token={self.viewer.token}")
        self.assertIsNotNone(self.browser.wait_for("window.nodmap && !document.getElementById('control').hidden"))
        # A link has no token; the page keeps its own.
        self.browser.run("window.isSame = true; location.hash = 'camera=1,-5,3,1,0,0'")
        self.assertIsNotNone(self.browser.wait_for("nodmap.view.mode === 'free'"))
        self.assertTrue(self.browser.run("return window.isSame && !document.getElementById('control').hidden"))

    def test_what_is_asked_while_the_link_is_down_is_not_done_except_stop(self):
        """A stopped viewer is like a link that is down: the connection stays, and requests wait in it."""
        self.open_with_token()
        for button, meanwhile, answer in (("explore", "No answer yet.", "Refused: Too old: not done."), ("stop", "STOP has no answer yet", "STOP is sent")):
            self.viewer.process.send_signal(signal.SIGSTOP)
            self.addCleanup(self.viewer.process.send_signal, signal.SIGCONT)
            self.browser.run("document.getElementById(arguments[0]).click()", button)
            self.assertIsNotNone(self.browser.wait_for(f"{ANSWER}.startsWith('{meanwhile}')"), button)
            self.viewer.process.send_signal(signal.SIGCONT)
            self.assertIsNotNone(self.browser.wait_for(f"{ANSWER}.startsWith('{answer}')"), button)

    def test_a_stop_is_sent_again_until_it_is_answered(self):
        """A connection whose link was away for long is dead at the server's end; the browser learns of it late, and loses what is sent until then."""
        self.open_with_token()
        for link in ("nodmap.connection.socket.send = () => {}", "nodmap.connection.socket.close()", "nodmap.connection.renew()"):
            said = self.browser.run(f"{link}; document.getElementById('stop').click(); document.getElementById('go').click(); return {ANSWER}")
            self.assertIn("STOP has no answer yet", said)  # "Release" must not overtake it
            self.assertIsNotNone(self.browser.wait_for(f"{ANSWER}.startsWith('STOP is sent')"), link)
            self.assertIsNotNone(self.browser.wait_for(f"{BANNER}.includes('STOP')"), link)
            self.assertFalse(self.press("#go").startswith("Refused"))
            self.assertIsNotNone(self.browser.wait_for(f"!{BANNER}.includes('STOP')"))

    def test_a_connection_that_brings_nothing_is_replaced(self):
        self.open_with_token()
        self.browser.run("window.former = nodmap.connection.socket; window.former.onmessage = null")
        self.assertIsNotNone(self.browser.wait_for("nodmap.connection.socket !== window.former && nodmap.connection.services.size > 0", 40))

    def test_saving_the_maps_is_requested(self):
        self.open_with_token()
        self.assertFalse(self.press("#save").startswith("Refused"))

    def test_without_a_configuration_no_process_can_be_controlled(self):
        self.open_with_token()
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('.process-control, .buttons')].filter((b) => !b.hidden).length"), 0)

    def test_every_control_has_a_name(self):
        self.open_with_token()
        nameless = self.browser.run("""return [...document.querySelectorAll('#stop-bar button, #control button, #control input')]
            .filter((e) => !(e.textContent.trim() || e.labels?.[0]?.textContent.trim())).map((e) => e.outerHTML)""")
        self.assertEqual(nameless, [])


class ProcessOutput(Page):
    """With a process manager, one of whose commands writes some output and then ends."""

    def setUp(self):
        super().setUp()
        self.viewer.stop()
        self.deputy = Deputy('cmd "talker" { exec = "sh -c \'echo the laser is warm; sleep 1; echo farther; sleep 1000\'"; host = "here"; stop_signal = 15; }')
        self.addCleanup(self.deputy.stop)
        self.viewer = Viewer("--control", "--procman", self.deputy.config)
        self.addCleanup(self.viewer.stop)

    def test_the_output_of_a_process_is_shown_on_a_click(self):
        self.open_with_token()
        row = "document.querySelector('#processes tr[data-command=talker]')"
        self.assertIsNotNone(self.browser.wait_for(f"{row} && !{row}.querySelector('.buttons').hidden && !{row}.querySelector('[data-do=start]').disabled"))
        self.assertEqual(self.press("#processes tr[data-command=talker] [data-do=start]"), "talker: start asked.")
        self.browser.run(f"{row}.querySelector('[data-do=output]').click()")
        text = "document.querySelector('#output pre').textContent"
        self.assertIsNotNone(self.browser.wait_for(f"document.getElementById('output').open && {text}.includes('the laser is warm')"))
        self.assertIn("talker", self.browser.run("return document.getElementById('output-title').textContent"))
        # It shows new output as long as it is open.
        self.assertIsNotNone(self.browser.wait_for(f"{text}.includes('farther')"))
        # STOP can still be reached.
        self.assertTrue(self.browser.run("""const box = document.getElementById('stop').getBoundingClientRect();
            return document.elementFromPoint((box.left + box.right) / 2, (box.top + box.bottom) / 2).id === 'stop'"""))
        self.browser.run(KEY, "Escape", "#output pre")
        self.assertIsNotNone(self.browser.wait_for("!document.getElementById('output').open"))


class WhatThisPageDependsOn(Page):
    """With a process manager that has a logger and another viewer."""

    def setUp(self):
        super().setUp()
        self.viewer.stop()
        self.deputy = Deputy('''
            cmd "viewer" { exec = "nodmap-viewer --port 0"; host = "here"; stop_signal = 15; }
            cmd "logger" { exec = "nodmap-logger --out OUT"; host = "here"; stop_signal = 15; }''')
        self.addCleanup(self.deputy.stop)
        self.viewer = Viewer("--control", "--procman", self.deputy.config)
        self.addCleanup(self.viewer.stop)

    def start_command(self, command):
        row = f"document.querySelector('#processes tr[data-command={command}]')"
        self.assertIsNotNone(self.browser.wait_for(f"{row} && !{row}.querySelector('.buttons').hidden && !{row}.querySelector('[data-do=start]').disabled"))
        self.press(f"#processes tr[data-command={command}] [data-do=start]")
        self.assertIsNotNone(self.browser.wait_for(f"!{row}.querySelector('[data-do=stop]').disabled"))

    def test_stopping_the_viewer_needs_a_confirmation(self):
        self.open_with_token()
        self.start_command("viewer")
        stop = "document.querySelector('#processes tr[data-command=viewer] [data-do=stop]')"
        question = "document.getElementById('confirm')"
        self.browser.run(f"{ANSWER} = ''; {stop}.click()")
        self.assertIsNotNone(self.browser.wait_for(f"{question}.open"))
        self.assertIn("STOP", self.browser.run(f"return {question}.querySelector('p').textContent"))
        # STOP can still be reached; with No the viewer gets no request.
        self.assertTrue(self.browser.run("""const box = document.getElementById('stop').getBoundingClientRect();
            return document.elementFromPoint((box.left + box.right) / 2, (box.top + box.bottom) / 2).id === 'stop'"""))
        self.browser.run(f"{question}.querySelector('[value=no]').click()")
        self.assertIsNone(self.browser.wait_for(ANSWER, 1))
        self.browser.run(f"{stop}.click(); {question}.querySelector('[value=yes]').click()")
        self.assertIsNotNone(self.browser.wait_for(f"{ANSWER} === 'viewer: stop asked.'"))
        self.assertIsNotNone(self.browser.wait_for(f"{stop}.disabled"))

    def test_recording_shows_state_path_and_result(self):
        self.open_with_token()
        results = "document.getElementById('results').textContent"
        self.assertIsNotNone(self.browser.wait_for(f"{results}.startsWith('logger ')"))
        self.assertIsNotNone(self.browser.wait_for("!document.querySelector('#processes tr[data-command=logger] [data-do=start]').disabled"))
        self.assertEqual(self.press("#record"), "logger: start asked.")
        self.assertIsNotNone(self.browser.wait_for(f"{results}.includes('recording into {self.deputy.logs}')"))
        self.assertEqual(self.press("#record-end"), "logger: stop asked.")
        self.assertIsNotNone(self.browser.wait_for(f"/^logger stopped: \\d+ events in 1 files/.test({results})"))

    def test_the_last_message_about_a_saved_map_is_shown(self):
        self.open_with_token()
        said = self.browser.run("""return import("./results.js").then(({lastTold}) => [
            lastTold("nodmap-slam2d", ["12:00 info: nodmap-viewer asked to save the map", "12:00 info: map saved in logs/slam2d", "later"]),
            lastTold("nodmap-slam6d", ["map saved in a", "12:01 warn: a: map not saved: no space"]),
            lastTold("nodmap-kurt", ["map saved in a"]), lastTold("nodmap-logger", [""])])""")
        self.assertEqual(said, ["map saved in logs/slam2d", "map not saved: no space", "", ""])


class WithoutStorage(Page):
    def test_the_page_works_where_the_browser_may_not_store_anything(self):
        with webdriver.Browser(settings={"profile.default_content_setting_values.cookies": 2}) as self.browser:
            self.browser.open(f"http://127.0.0.1:{self.viewer.port}/#token={self.viewer.token}")
            self.assertIsNotNone(self.browser.wait_for("window.nodmap && !document.getElementById('control').hidden"))
            self.browser.run("document.querySelector('#layers input').click()")
            self.assertIn("STOP is sent", self.press("#stop"))


class WithoutWebGl(Control):
    """The same page in a browser without 3D graphics."""

    def setUp(self):
        self.viewer = Viewer("--control")
        self.addCleanup(self.viewer.stop)
        self.browser = webdriver.shared_browser(more_flags=["--disable-3d-apis"])

    def test_it_says_that_the_browser_has_no_webgl(self):
        self.open_with_token()
        self.assertFalse(self.browser.run("return document.getElementById('no-webgl').hidden"))
        # three.js reports this itself; there must be no other errors.
        errors = [line for line in self.browser.console() if line["level"] == "SEVERE" and "Error creating WebGL context" not in line["message"]]
        self.assertEqual(errors, [])


if __name__ == "__main__":
    main()
