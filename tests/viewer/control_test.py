#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Control through a live viewer: only with the token, each request is answered, and a real deputy controls processes.

Environment: NODMAP_VIEWER, NODMAP_DEPUTY, NODMAP_SHERIFF (programs).
"""
import os
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from deputy_process import Deputy  # noqa: E402
from foxglove_client import Client  # noqa: E402
from viewer_process import Viewer  # noqa: E402
from websocket import PATIENCE_S, Refused, WebSocket  # noqa: E402

CONFIG = """
cmd "sleeper" { exec = "sleep 1000"; host = "here"; stop_signal = 15; stop_time_allowed = 2; }
cmd "other" { exec = "sleep 1001"; host = "here"; stop_signal = 15; stop_time_allowed = 2; }
cmd "logger" { exec = "nodmap-logger --out OUT"; host = "here"; stop_signal = 15; stop_time_allowed = 2; }
script "begin" { start cmd "sleeper"; }
"""
REQUESTS = [{"do": "goal", "x_m": 1, "y_m": 1}, {"do": "home"}, {"do": "roam"}, {"do": "explore"}, {"do": "end_exploration"}, {"do": "stop"}, {"do": "go"}, {"do": "save_maps"},
            {"do": "start_process", "command": "sleeper"}, {"do": "stop_process", "command": "sleeper"},
            {"do": "restart_process", "command": "sleeper"}, {"do": "start_recording"}, {"do": "stop_recording"},
            {"do": "process_output", "command": "sleeper"}]


def master(viewer):
    """A client with the token."""
    return Client(viewer.port, target=f"/?token={viewer.token}")


class TheToken(unittest.TestCase):
    def test_a_wrong_token_is_refused_counted_and_logged(self):
        with Viewer("--control") as viewer:
            for options in ({"target": "/?token=0123456789abcdef0123456789abcdef"}, {"target": f"/?token={viewer.token[:-1]}"},
                            {"target": f"/?token={viewer.token}", "headers": {"Origin": "http://evil.example"}}):
                with self.assertRaises(Refused) as refused:
                    WebSocket(viewer.port, **options)
                self.assertEqual(refused.exception.args[0], 403)
            viewer.stop()
            self.assertIn("refused a client: wrong_token", viewer.said())
            self.assertIn("refused to clients: 3 wrong_token", viewer.said())

    def test_without_a_token_no_request_is_carried_out(self):
        with Viewer("--control") as viewer:
            reader, watcher = Client(viewer.port), Client(viewer.port)
            self.assertNotIn("services", reader.info["capabilities"])
            watcher.subscribe("GOAL", "STOP")
            for request in REQUESTS:
                self.assertEqual(reader.call(request)["message"], "this connection may only read", request)
            # The first messages are those for which the token's owner asks afterwards.
            driver = master(viewer)
            self.assertTrue(driver.call({"do": "goal", "x_m": 2.5, "y_m": -1.0})["ok"])
            messages = watcher.collect(lambda m: "GOAL" in m)
            self.assertEqual(set(messages), {"GOAL"})
            self.assertEqual((messages["GOAL"][0][1]["goal_seq"], messages["GOAL"][0][1]["position_m"]), (0, [2.5, -1.0]))
            viewer.stop()
            self.assertIn(f"refused to clients: {len(REQUESTS)} request_not_allowed", viewer.said())

    def test_without_control_a_token_is_refused(self):
        with Viewer() as viewer, self.assertRaises(Refused):
            WebSocket(viewer.port, target="/?token=0123456789abcdef0123456789abcdef")


class Requests(unittest.TestCase):
    def test_stop_is_repeated_until_the_robot_is_released(self):
        with Viewer("--control") as viewer:
            driver = master(viewer)
            self.assertIn("services", driver.info["capabilities"])
            driver.subscribe("STOP")
            self.assertTrue(driver.call({"do": "stop"})["ok"])
            # Four messages are three repetitions.
            stops = driver.collect(lambda m: len(m.get("STOP", [])) >= 4)["STOP"]
            self.assertTrue(all(stop["is_stopped"] for _, stop in stops))
            self.assertTrue(driver.call({"do": "go"})["ok"])
            driver.collect(lambda m: m and not m["STOP"][-1][1]["is_stopped"])

    def test_a_request_that_may_be_old_is_refused_unless_it_is_a_stop(self):
        with Viewer("--control") as viewer:
            driver, watcher = master(viewer), Client(viewer.port)
            self.assertTrue(driver.call({"do": "explore"})["ok"])
            driver.socket.answers_pings = False  # as while the link is down
            driver.subscribe("STATUS")
            end = time.monotonic() + PATIENCE_S
            while driver.call({"do": "end_exploration"})["ok"]:
                self.assertLess(time.monotonic(), end)
                driver.collect(bool)  # the viewer's next STATUS, once a second
            watcher.subscribe("GOAL", "STOP")
            for request in ({"do": "go"}, {"do": "home"}, {"do": "roam"}, {"do": "explore"}, {"do": "goal", "x_m": 1, "y_m": 1}):
                self.assertEqual(driver.call(request), {"ok": False, "text": "Too old: not done."})
            self.assertTrue(driver.call({"do": "stop"})["ok"])
            messages = watcher.collect(bool)
            self.assertTrue(messages["STOP"][0][1]["is_stopped"], "and nothing before it")

    def test_an_impossible_request_is_answered_with_the_reason(self):
        with Viewer("--control") as viewer:
            driver = master(viewer)
            for request in ({"do": "goal", "x_m": "far"}, {"do": "fly"}, {}, {"do": "start_process", "command": "slam2d"}):
                answer = driver.call(request)
                self.assertFalse(answer["ok"], request)
                self.assertTrue(answer["text"])
            self.assertIn("no such service", driver.call({"do": "stop"}, service=2)["message"])
            self.assertIn("JSON", driver.call({"do": "stop"}, encoding=b"cdr")["message"])
            viewer.stop()
            self.assertIn("refused to clients: 6 request_not_allowed", viewer.said())


class Processes(unittest.TestCase):
    def setUp(self):
        self.deputy = Deputy(CONFIG)
        self.addCleanup(self.deputy.stop)
        self.viewer = Viewer("--control", "--procman", self.deputy.config)
        self.addCleanup(self.viewer.stop)
        self.driver = master(self.viewer)
        self.assertEqual(self.driver.info["metadata"]["process_control"], "true")
        self.driver.subscribe("PM_INFO")
        # A message of the deputy has been received; before that it cannot be asked for anything.
        self.driver.collect(lambda m: m and m["PM_INFO"][-1][1]["hosts"])

    def ask(self, **request):
        answer = self.driver.call(request)
        self.assertTrue(answer["ok"], answer["text"])

    def await_command(self, name, wanted):
        """The row of a command, as soon as it fulfils the condition."""
        def command(messages):
            rows = messages["PM_INFO"][-1][1]["commands"] if messages else []
            return next((row for row in rows if row["command"] == name), None)

        found = self.driver.collect(lambda m: command(m) is not None and wanted(command(m)))
        return command(found)

    def test_a_process_is_started_restarted_and_stopped(self):
        self.await_command("sleeper", lambda row: row["state"] == "stopped")
        self.ask(do="start_process", command="sleeper")
        first = self.await_command("sleeper", lambda row: row["state"] == "running")
        self.assertEqual(first["process_name"], "sleep")
        self.ask(do="start_process", command="other")
        other = self.await_command("other", lambda row: row["state"] == "running")
        self.ask(do="restart_process", command="sleeper")
        self.await_command("sleeper", lambda row: row["pid"] not in (0, first["pid"]))
        self.ask(do="stop_process", command="sleeper")
        self.await_command("sleeper", lambda row: row["state"] == "stopped" and row["pid"] == 0)
        # Neither the other command nor the viewer's end is affected by this.
        self.viewer.stop()
        os.kill(other["pid"], 0)

    def test_an_edited_configuration_is_used(self):
        self.ask(do="start_process", command="sleeper")
        first = self.await_command("sleeper", lambda row: row["state"] == "running")
        self.deputy.rewrite(CONFIG.replace('"sleeper"', '"dozer"').replace("sleep 1000", "sleep 1002"))
        self.await_command("dozer", lambda row: row["state"] == "stopped")
        self.ask(do="start_process", command="dozer")
        self.await_command("dozer", lambda row: row["state"] == "running")
        os.kill(first["pid"], 0)  # goes on, though nobody configures it any more

    def test_what_a_process_writes_is_not_written_to_the_log_of_the_viewer(self):
        self.ask(do="process_output", command="sleeper")
        self.ask(do="save_maps")
        self.viewer.stop()
        self.assertIn("save_maps", self.viewer.said())
        self.assertNotIn("process_output", self.viewer.said())

    def test_a_recording_is_started_and_stopped(self):
        self.ask(do="start_recording")
        self.driver.subscribe("STATUS")
        # The logger's first STATUS comes when its files are open.
        self.driver.collect(lambda m: any(p["process_name"] == "nodmap-logger" for p in m.get("STATUS", [[0, {"processes": []}]])[-1][1]["processes"]))
        self.ask(do="save_maps")
        self.ask(do="stop_recording")
        self.await_command("logger", lambda row: row["state"] == "stopped" and row["pid"] == 0)
        self.assertTrue(os.listdir(self.deputy.logs))

    def test_another_sheriff_has_precedence(self):
        sheriff = subprocess.Popen([os.environ["NODMAP_SHERIFF"], self.deputy.config, "--script", "begin", "--on-script-complete", "stay"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(sheriff.wait, PATIENCE_S)
        self.addCleanup(sheriff.terminate)
        self.await_command("sleeper", lambda row: row["state"] == "running")  # so it gives orders
        answer = self.driver.call({"do": "stop_process", "command": "sleeper"})
        self.assertFalse(answer["ok"])
        self.assertIn("is running", answer["text"])


if __name__ == "__main__":
    unittest.main(verbosity=2, warnings="ignore")
