#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The whole process with an independent client: it sends the numbers of the LCM messages, and hostile clients do no harm.

Environment: NODMAP_VIEWER, NODMAP_MAKE_ROBOT_LOG (programs).
"""
import base64
import http.client
import json
import os
import resource
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import lcm_log  # noqa: E402
from foxglove_client import Client  # noqa: E402
from viewer_process import Viewer  # noqa: E402
from websocket import PATIENCE_S, Refused, WebSocket  # noqa: E402


def make_log(folder, duration_s=4, points=12000):
    path = os.path.join(folder, f"robot-{duration_s}-{points}.lcmlog")
    subprocess.run([os.environ["NODMAP_MAKE_ROBOT_LOG"], path, str(duration_s), str(points)], check=True)
    return path


def get(port, target, method="GET", host=None):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
    connection.putrequest(method, target, skip_host=host is not None)
    if host is not None:
        connection.putheader("Host", host)
    connection.endheaders()
    answer = connection.getresponse()
    return answer.status, answer.read()


class WithLog(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.log = make_log(cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()


class TheNumbersComeOut(WithLog):
    def test_clouds_and_maps_are_those_of_the_log(self):
        chunks, tiles = {}, {}
        for _, channel, data in lcm_log.events(self.log):
            if channel == "CLOUD":
                chunk = lcm_log.cloud_chunk(data)
                chunks.setdefault(chunk["utime"], []).append(chunk)
            elif channel == "MAP_2D":
                tile = lcm_log.grid_chunk(data)
                tiles.setdefault(tile["utime"], []).append(tile)
        self.assertEqual(len(chunks), 4)
        with Viewer("--replay", self.log, "--set", "cloud_spacing_m=0") as viewer:
            client = Client(viewer.port)
            self.assertEqual(client.info["op"], "serverInfo")
            client.subscribe("CLOUD", "MAP_2D")
            messages = client.collect(lambda m: len(m.get("CLOUD", [])) == 4 and m.get("MAP_2D", [[0]])[-1][0] // 1000 == max(tiles))
            for nanoseconds, cloud in messages["CLOUD"]:
                parts = chunks[nanoseconds // 1000]
                packed = base64.b64decode(cloud["data"])
                expected = [value for part in parts for value in part["points"]]
                self.assertEqual(list(struct.unpack(f"<{len(packed) // 4}f", packed)), expected)
                self.assertEqual([f["name"] for f in cloud["fields"]], ["x", "y", "z"])
                self.assertEqual({f["type"] for f in cloud["fields"]}, {7})
                self.assertEqual(cloud["pose"]["position"]["x"], parts[0]["position"][0])
            for nanoseconds, grid in messages["MAP_2D"]:
                cells = base64.b64decode(grid["data"])
                for tile in tiles[nanoseconds // 1000]:
                    x, y, width, height = tile["tile"]
                    for row in range(height):
                        begin = (y + row) * grid["row_stride"] + x * grid["cell_stride"]
                        self.assertEqual(struct.unpack(f"<{width}b", cells[begin:begin + width]), tile["cells"][row * width:(row + 1) * width])
                    self.assertEqual((grid["pose"]["position"]["x"], grid["pose"]["position"]["y"]), tile["origin"])
                    self.assertEqual(grid["cell_size"]["x"], tile["cell_size"])

    def test_voxels_are_those_of_the_log(self):
        chunks = {}
        for _, channel, data in lcm_log.events(self.log):
            if channel == "OCTOMAP":
                chunk = lcm_log.octomap_chunk(data)
                chunks.setdefault(chunk["utime"], []).append(chunk["bytes"])
        with Viewer("--replay", self.log) as viewer:
            client = Client(viewer.port)
            client.subscribe("OCTOMAP")
            nanoseconds, grid = client.collect(lambda m: "OCTOMAP" in m)["OCTOMAP"][0]
            cells, edge, corner = base64.b64decode(grid["data"]), grid["cell_size"]["x"], grid["pose"]["position"]
            found = set()
            for i, cell in enumerate(cells):
                if cell:  # by the formula of the schema's description
                    place = (i % grid["row_stride"] // grid["cell_stride"], i % grid["slice_stride"] // grid["row_stride"], i // grid["slice_stride"])
                    found.add(tuple(round(corner[axis] / edge) + n for axis, n in zip("xyz", place)))
            voxel, occupied = lcm_log.octomap_voxels(b"".join(chunks[nanoseconds // 1000]))
            self.assertAlmostEqual(edge, voxel)
            self.assertGreater(len(occupied), 1000)
            self.assertEqual(found, occupied)

    def test_every_channel_is_described_and_has_messages(self):
        with Viewer("--replay", self.log) as viewer:
            client = Client(viewer.port, protocols="foxglove.sdk.v1")
            self.assertIn("Sec-WebSocket-Protocol: foxglove.sdk.v1", client.socket.head)
            for channel in client.channels.values():
                self.assertEqual(channel["encoding"], "json")
                self.assertEqual(json.loads(channel["schema"])["type"], "object")
            client.subscribe(*client.channels)
            client.collect(lambda m: set(m) == set(client.channels) and client.time_ns is not None)

    def test_a_late_client_gets_the_whole_cloud(self):
        with Viewer("--replay", self.log) as viewer:
            first = Client(viewer.port)
            first.subscribe("CLOUD")
            first.collect(lambda m: len(m.get("CLOUD", [])) == 4)
            late = Client(viewer.port)
            late.subscribe("CLOUD", "scene/robot", "GOAL")
            messages = late.collect(lambda m: len(m.get("CLOUD", [])) == 4 and "scene/robot" in m and "GOAL" in m)
            self.assertEqual(len({n for n, _ in messages["CLOUD"]}), 4)

    def test_a_playback_is_controlled_by_parameters(self):
        with Viewer("--replay", self.log) as viewer:
            client = Client(viewer.port)
            self.assertIn("parameters", client.info["capabilities"])
            client.subscribe("ODOMETRY")
            client.send(op="setParameters", parameters=[{"name": "playback.paused", "value": True}])
            client.send(op="setParameters", parameters=[{"name": "playback.position_s", "value": 3.0}], id="now")
            answer = client.answer(lambda m: m.get("id") == "now")
            values = {p["name"]: p["value"] for p in answer["parameters"]}
            self.assertTrue(values["playback.paused"])
            self.assertAlmostEqual(values["playback.position_s"], 3.0)
            messages = client.collect(lambda m: m and max(n for n, _ in m["ODOMETRY"]) % 10**10 // 10**9 >= 3)
            self.assertTrue(messages)
            # After a seek back the same odometry is sent again.
            client.send(op="setParameters", parameters=[{"name": "playback.position_s", "value": 1.0}])
            begin = messages["ODOMETRY"][-1][0]
            client.collect(lambda m: m and m["ODOMETRY"][-1][0] < begin - 10**9)

    def test_on_a_busy_machine_clients_get_messages_twice_a_second(self):
        log = make_log(self.folder.name, duration_s=120, points=100)
        busy = [subprocess.Popen(["nice", "-n", "19", sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count())]
        try:
            with Viewer("--replay", log) as viewer:
                client = Client(viewer.port)
                client.subscribe("ODOMETRY")  # 100 a second

                def are_far_apart(messages):
                    """Whether the last five are half a second apart in the recording's time, within one or two turns."""
                    stamps = [nanoseconds for nanoseconds, _ in messages.get("ODOMETRY", [])][-5:]
                    return len(stamps) == 5 and all(b - a > 450e6 for a, b in zip(stamps, stamps[1:]))
                client.collect(are_far_apart, timeout_s=100)
                # Answers are sent at once.
                client.send(op="getParameters", parameterNames=["playback.speed"], id="now")
                self.assertEqual(client.answer(lambda m: m.get("id") == "now")["parameters"][0]["value"], 1.0)
        finally:
            for process in busy:
                process.kill()
                process.wait()

    def test_a_client_from_another_origin_reads_but_does_not_control(self):
        with Viewer("--replay", self.log) as viewer:
            client = Client(viewer.port, headers={"Origin": "https://app.foxglove.dev"})
            client.send(op="setParameters", parameters=[{"name": "playback.paused", "value": True}])
            self.assertIn("may not", client.status()["message"])


class HostileClients(WithLog):
    def setUp(self):
        self.viewer = Viewer("--replay", self.log, "--set", "max_clients=40")
        self.addCleanup(self.viewer.stop)

    def refusals(self):
        """Ends the viewer; returns how much it refused, by cause."""
        self.assertEqual(self.viewer.stop(), 0)
        lines = [line.split("refused to clients: ")[1].split() for line in self.viewer.said().splitlines() if "refused to clients" in line]
        return {cause: int(count) for count, cause in lines}

    def still_serves(self):
        client = Client(self.viewer.port)
        client.subscribe("scene/robot", "CLOUD")
        client.collect(lambda m: "scene/robot" in m)
        client.close()

    def test_paths_outside_the_page_are_not_found(self):
        for target in ("/../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/three/../../etc/passwd", "//etc/passwd", "/three/", "/.git/config"):
            self.assertEqual(get(self.viewer.port, target)[0], 404, target)
        self.assertEqual(get(self.viewer.port, "/")[0], 200)
        self.assertEqual(get(self.viewer.port, "/", "DELETE")[0], 405)
        self.assertEqual(get(self.viewer.port, "/", host="evil.example")[0], 403)
        causes = self.refusals()
        self.assertEqual((causes["no_such_file"], causes["method_not_allowed"], causes["foreign_host"]), (6, 1, 1))

    def test_invalid_handshakes_are_refused(self):
        for options, status in (({"protocols": None}, 400), ({"protocols": "chat"}, 400), ({"host": "evil.example"}, 403),
                                ({"target": "/?token=guess"}, 403)):
            with self.assertRaises(Refused) as refused:
                WebSocket(self.viewer.port, **options)
            self.assertEqual(refused.exception.args[0], status, options)
        self.still_serves()
        causes = self.refusals()
        self.assertEqual((causes["unknown_subprotocol"], causes["foreign_host"], causes["wrong_token"]), (2, 1, 1))

    def test_a_huge_message_ends_only_its_own_connection(self):
        memory_kb = self.viewer.memory_kb()
        client = WebSocket(self.viewer.port)
        # 100 MB are announced, and sent as long as they are taken.
        client.socket.sendall(struct.pack(">BBQ", 0x82, 0x80 | 127, 100_000_000) + b"mask")
        with self.assertRaises(OSError):
            for _ in range(1000):
                client.socket.sendall(bytes(100_000))
        self.still_serves()
        # Generous: the frame must not have been stored, the rest is the log's own traffic.
        self.assertLess(self.viewer.memory_kb() - memory_kb, 30_000)
        self.assertEqual(self.refusals()["message_too_big"], 1)

    def test_malformed_frames_end_their_connection(self):
        for frame in (b"\x83\x80mask", b"\xF1\x80mask", b"\x81\x05hello", b"\x89\xFE\x01\x00mask" + bytes(256), b"\x80\x80mask"):
            client = WebSocket(self.viewer.port)
            client.socket.sendall(frame)
            with self.assertRaises(ConnectionError):
                while True:
                    client.receive()
            client.close()  # only then has the server done with it
        self.still_serves()
        self.assertEqual(self.refusals()["malformed_frame"], 5)

    def test_invalid_requests_are_answered_and_counted(self):
        client = Client(self.viewer.port)
        for text in ("nonsense", "[]", '{"op":"explode"}', '{"op":"subscribe","subscriptions":[{"id":1,"channelId":9999}]}', "[" * 60000):
            client.socket.send(text)
            self.assertEqual(client.status()["level"], 2)
        self.assertIn("only read", client.call({"do": "stop"})["message"])
        self.still_serves()
        self.assertEqual(self.refusals()["request_not_allowed"], 6)

    def test_many_messages_at_once_are_all_read(self):
        client = Client(self.viewer.port)
        for _ in range(1000):  # several times as many as the server reads at once
            client.send(op="unsubscribe", subscriptionIds=[])
        client.send(op="explode")
        self.assertEqual(client.status()["level"], 2)

    def test_bytes_that_are_not_http_are_refused(self):
        for noise in (b"\x00\xFF" * 100 + b"\r\n\r\n", b"GET / HTTP/1.1\r\n" + b"X: " + b"y" * 20000 + b"\r\n\r\n"):
            with socket.create_connection(("127.0.0.1", self.viewer.port), timeout=PATIENCE_S) as raw:
                raw.sendall(noise)
                self.assertTrue(raw.recv(4096).startswith(b"HTTP/1.1 400"))
        self.still_serves()
        self.assertEqual(self.refusals()["bad_request"], 2)

    def test_incomplete_requests_do_not_keep_others_out(self):
        halves = []
        for _ in range(300):
            half = socket.create_connection(("127.0.0.1", self.viewer.port), timeout=PATIENCE_S)
            half.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n")
            halves.append(half)
        self.assertEqual(get(self.viewer.port, "/")[0], 200)
        # The page took the place of the oldest, and did not wait until the ten seconds of the newest were over: it is still open.
        halves[-1].setblocking(False)
        with self.assertRaises(BlockingIOError):
            halves[-1].recv(1)
        for half in halves:
            half.close()

    def test_many_readers_do_not_keep_the_token_out(self):
        with Viewer("--control", "--set", "max_clients=20") as viewer:
            readers = [Client(viewer.port, headers={"Origin": "http://evil.example"}) for _ in range(20)]
            self.assertEqual(get(viewer.port, "/")[0], 200)
            driver = Client(viewer.port, target=f"/?token={viewer.token}")
            self.assertTrue(driver.call({"do": "stop"})["ok"])
            # A page or a reader that comes now replaces the oldest, and the one with the token stays.
            readers += [Client(viewer.port, headers={"Origin": "http://evil.example"}) for _ in range(30)]
            self.assertTrue(driver.call({"do": "stop"})["ok"])
            with self.assertRaises(OSError):
                while True:
                    readers[0].socket.receive()
            readers[-1].subscribe("STOP")
            readers[-1].collect(bool)
            for reader in readers:
                reader.close()

    def test_those_with_the_token_keep_their_places(self):
        with Viewer("--control", "--set", "max_clients=5") as viewer:
            drivers = [Client(viewer.port, target=f"/?token={viewer.token}") for _ in range(5)]
            with self.assertRaises(OSError):
                Client(viewer.port, target=f"/?token={viewer.token}")
            for driver in drivers:
                self.assertTrue(driver.call({"do": "stop"})["ok"])
            drivers.pop().close()
            viewer.stop()
            self.assertIn("refused to clients: 1 too_many_connections", viewer.said())

    def test_ten_thousand_connections_do_no_harm(self):
        """All 10^4 are held open by this side; the viewer serves 40 of them at a time, closes the others, and stays able to serve."""
        needed = 10_000 + 100
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        if hard != resource.RLIM_INFINITY and hard < needed:
            self.skipTest(f"this machine gives a process {hard} descriptors, fewer than {needed}")
        resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, needed), hard))
        held = [socket.create_connection(("127.0.0.1", self.viewer.port), timeout=PATIENCE_S) for _ in range(10_000)]
        descriptors = len(os.listdir(f"/proc/{self.viewer.process.pid}/fd"))
        self.assertLess(descriptors, 40 + 60, "the viewer holds no more connections than it serves, besides its own files")
        # One that sends nothing keeps its place until a newcomer wants it. Newcomers may still wait in the kernel; closed there, they would not count.
        for raw in held[:-40]:
            self.assertEqual(raw.recv(1), b"")
        for raw in held:
            raw.close()
        end = time.monotonic() + PATIENCE_S
        while True:  # until the viewer has seen that those it served are closed
            try:
                self.still_serves()
                break
            except (OSError, Refused):
                self.assertLess(time.monotonic(), end)
        self.assertEqual(self.refusals()["slow_request"], 10_000 - 40)

    def test_a_client_that_does_not_read_delays_no_other(self):
        # So long that it is not over soon, as a viewer on a busy machine sends only twice a second.
        log = make_log(self.folder.name, duration_s=60, points=1000)
        with Viewer("--replay", log) as viewer:
            stuck = [Client(viewer.port, receive_buffer=4096) for _ in range(5)]
            for client in stuck:
                client.subscribe(*client.channels)
            memory_kb = viewer.memory_kb()
            quick = Client(viewer.port)
            quick.subscribe("PITCH_STATE", "CLOUD")
            messages = quick.collect(lambda m: len(m.get("PITCH_STATE", [])) >= 20 and len(m.get("CLOUD", [])) >= 4)
            self.assertTrue(messages)
            self.assertLess(viewer.memory_kb() - memory_kb, 20_000)
            self.assertEqual(viewer.stop(), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2, warnings="ignore")
