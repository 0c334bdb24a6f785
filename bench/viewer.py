#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures what nodmap-viewer costs while the whole simulated robot runs live, and what its clients and its end do to the robot.

  tests/support/private_network.sh python3 bench/viewer.py [--window S] [--soak S] [--bin DIR] [--world WORLD.yaml]

Prints one JSON object. It holds for each window the viewer's share of one core, its memory, and the rates and latencies that the robot's processes report in
STATUS. A second viewer, which runs all the time, receives the STATUS messages.
"""
import argparse
import json
import os
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time

from programs import BIN, ROOT

sys.path.insert(0, os.path.join(ROOT, "tests", "viewer"))
import webdriver  # noqa: E402
from foxglove_client import Client  # noqa: E402
from viewer_process import Viewer  # noqa: E402
from websocket import PONG, WebSocket  # noqa: E402

ROBOT = ("nodmap-laser3d", "nodmap-map-server", "nodmap-navigator", "nodmap-slam2d")


class Robot:
    """The processes of procman/sim.pmd, started by the process manager."""

    def __init__(self, programs, world, folder):
        environment = {**os.environ, "NODMAP_WORLD": world, "NODMAP_RUN": folder, "NODMAP_PORT": "0", "PATH": programs + os.pathsep + os.environ["PATH"]}
        config = os.path.join(ROOT, "procman", "sim.pmd")
        self.deputy = subprocess.Popen([f"{programs}/nodmap-deputy", config], env=environment, cwd=ROOT,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            subprocess.run([f"{programs}/nodmap-sheriff", config, "--script", "start_robot", "--on-script-complete", "exit", "--timeout", "60"],
                           check=True, env=environment, cwd=ROOT, stdout=subprocess.DEVNULL)
            subprocess.run([f"{programs}/nodmap-stop", "--go"], check=True, env=environment)
        except (OSError, subprocess.CalledProcessError):
            self.stop()
            raise

    def stop(self):
        self.deputy.terminate()
        self.deputy.wait(timeout=60)


class Reader(threading.Thread):
    """A client that subscribes to every topic and counts the bytes it receives."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.client = Client(port)
        self.client.subscribe(*self.client.channels)
        self.bytes = 0
        self.ends = False
        self.start()

    def run(self):
        alive = time.monotonic()
        while not self.ends:
            try:
                self.bytes += len(self.client.socket.socket.recv(1 << 20))
            except OSError:
                return
            if time.monotonic() - alive > 5:  # keeps the connection from being closed as idle
                self.client.socket.send(b"", PONG)
                alive = time.monotonic()

    def stop(self):
        self.ends = True
        self.join()
        self.client.close()


class Gaps(threading.Thread):
    """A client that measures the times between messages of PITCH_STATE."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.client = Client(port)
        self.client.subscribe("PITCH_STATE")
        self.client.receive()
        self.gaps_ms = []
        self.ends = False
        self.start()

    def run(self):
        last = time.monotonic()
        while not self.ends:
            self.client.receive()
            now = time.monotonic()
            self.gaps_ms.append(1e3 * (now - last))
            last = now

    def stop(self):
        self.ends = True
        self.join()
        self.client.close()
        return {"median_ms": round(statistics.median(self.gaps_ms), 1), "max_ms": round(max(self.gaps_ms), 1)}


def robot_status(observer, duration_s):
    """The medians of the rates and latencies in STATUS of the robot's processes over this time."""
    client = Client(observer.port)
    client.subscribe("STATUS")
    rows, end = {}, time.monotonic() + duration_s
    while time.monotonic() < end:
        for process in client.receive()[2]["processes"]:
            if process["process_name"] in ROBOT:
                rows.setdefault(process["process_name"], {})[process["utime"]] = (process["handled_per_s"], process["latency_p99_us"])
    client.close()
    return {name: {"handled_per_s": round(statistics.median(r for r, _ in told.values())),
                   "p99_us": round(statistics.median(p for _, p in told.values()))} for name, told in sorted(rows.items())}


def window(viewer, observer, duration_s):
    cpu_s, begin = viewer.cpu_s(), time.monotonic()
    robot = robot_status(observer, duration_s)
    share = (viewer.cpu_s() - cpu_s) / (time.monotonic() - begin)
    return {"viewer_cpu_percent": round(100 * share, 1), "viewer_memory_mb": round(viewer.memory_kb() / 1024, 1), "robot": robot}


# Waits until the page first draws the robot and its cloud: seconds since it was opened.
FIRST_IMAGE = """
return new Promise((done) => {
  const render = nodmap.view.render.bind(nodmap.view);
  nodmap.view.render = () => {
    render();
    if (nodmap.cloud.total > 0) {
      done(performance.now() / 1000);
    }
  };
});
"""


def first_image_s(port, times=5):
    """How long the page takes until its first image, in headless Chromium without a graphics card; None without Chromium."""
    if not webdriver.is_installed():
        return None
    waited_s = []
    with webdriver.Browser() as browser:
        for _ in range(times):
            browser.open(f"http://127.0.0.1:{port}/")
            waited_s.append(round(browser.run(FIRST_IMAGE), 2))
            browser.open("about:blank")
    return waited_s


def first_data_s(port):
    """The time from the connection until a client has body, pose, map and the whole cloud so far."""
    begin = time.monotonic()
    client = Client(port)
    client.subscribe("scene/robot", "tf/base", "MAP_2D", "CLOUD", "OCTOMAP")
    client.collect(lambda m: {"scene/robot", "tf/base", "MAP_2D", "CLOUD", "OCTOMAP"} <= set(m), timeout_s=60)
    client.close()
    return round(time.monotonic() - begin, 3)


def huge_message(port):
    """Announces a message of 100 MB and sends until the connection is closed; returns how much the viewer took, in MB."""
    client = WebSocket(port)
    sent = 0
    try:
        client.socket.sendall(struct.pack(">BBQ", 0x82, 0x80 | 127, 100_000_000) + b"mask")
        while sent < 100_000_000:
            client.socket.sendall(bytes(100_000))
            sent += 100_000
    except OSError:
        pass
    client.close()
    return sent / 1e6


def many_connections(port, count):
    """Opens this number of connections, keeping the newest 400 open; returns the seconds it took."""
    begin, held = time.monotonic(), []
    for _ in range(count):
        held.append(socket.create_connection(("127.0.0.1", port), timeout=30))
        if len(held) > 400:
            held.pop(0).close()
    for raw in held:
        raw.close()
    return round(time.monotonic() - begin, 1)


def hostile(viewer):
    gaps, memory_kb = Gaps(viewer.port), viewer.memory_kb()
    result = {"huge_message_mb_taken": huge_message(viewer.port), "seconds_for_10000_connections": many_connections(viewer.port, 10_000)}
    result["others_meanwhile"] = gaps.stop()
    result["memory_growth_mb"] = round((viewer.memory_kb() - memory_kb) / 1024, 1)
    return result


def fastest_mps(client, duration_s):
    """The robot's highest speed over this time, by TRUTH."""
    end, fastest = time.monotonic() + duration_s, 0.0
    while time.monotonic() < end:
        fastest = max(fastest, abs(client.receive()[2]["forward_mps"]))
    return fastest


def stop_and_go(observer):
    """Stops the driving robot, kills the viewer that stopped it, and releases the robot by another viewer."""
    truth = Client(observer.port)
    truth.subscribe("TRUTH")
    truth.collect(lambda m: m and m["TRUTH"][-1][1]["forward_mps"] > 0.3, timeout_s=120)
    with Viewer("--control") as first:
        driver = Client(first.port, target=f"/?token={first.token}")
        begin = time.monotonic()
        assert driver.call({"do": "stop"})["ok"]
        truth.collect(lambda m: m and abs(m["TRUTH"][-1][1]["forward_mps"]) < 0.01)
        result = {"stationary_after_s": round(time.monotonic() - begin, 2), "fastest_mps_in_5_s_after": round(fastest_mps(truth, 5), 3)}
        first.process.kill()
    result["fastest_mps_in_5_s_after_the_viewer_died"] = round(fastest_mps(truth, 5), 3)
    with Viewer("--control") as second:
        assert Client(second.port, target=f"/?token={second.token}").call({"do": "go"})["ok"]
        truth.collect(lambda m: m and m["TRUTH"][-1][1]["forward_mps"] > 0.3, timeout_s=60)
    truth.close()
    return result


def soak(viewer, duration_s):
    """Runs one client for this time; returns the viewer's memory at five moments."""
    reader, memory_mb = Reader(viewer.port), []
    for moment in range(5):
        time.sleep(duration_s / 4 if moment else 0)
        memory_mb.append(round(viewer.memory_kb() / 1024, 1))
    reader.stop()
    return {"seconds": duration_s, "memory_mb": memory_mb}


def measure(arguments):
    result = {}
    with Viewer() as observer, Viewer() as viewer:
        result["stop"] = stop_and_go(observer)
        time.sleep(20)  # until there are keyframes and maps
        result["no client"] = window(viewer, observer, arguments.window)
        result["first_data_s"] = first_data_s(viewer.port)
        result["first_image_s"] = first_image_s(viewer.port)
        readers = [Reader(viewer.port)]
        time.sleep(5)  # it first receives the history: cloud, maps and trails
        history = readers[0].bytes
        result["1 client"] = window(viewer, observer, arguments.window)
        result["1 client"]["mb_per_s"] = round((readers[0].bytes - history) / arguments.window / 1e6, 2)
        result["1 client"]["history_mb"] = round(history / 1e6, 2)
        readers += [Reader(viewer.port) for _ in range(19)]
        result["20 clients"] = window(viewer, observer, arguments.window)
        stuck = [Client(viewer.port, receive_buffer=4096) for _ in range(5)]
        for client in stuck:
            client.subscribe(*client.channels)
        gaps = Gaps(viewer.port)
        result["20 clients and 5 that do not read"] = {**window(viewer, observer, arguments.window), "another": gaps.stop()}
        for reader in readers:
            reader.stop()
        for client in stuck:
            client.close()
        result["hostile"] = hostile(viewer)
        if arguments.soak:
            result["soak"] = soak(viewer, arguments.soak)
        viewer.process.kill()
        result["viewer killed"] = robot_status(observer, arguments.window)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--window", type=float, default=20.0, help="length of each window, seconds")
    parser.add_argument("--soak", type=float, default=0.0, help="how long the growth of memory with one client is measured, seconds")
    parser.add_argument("--bin", default=str(BIN))
    parser.add_argument("--world", default=os.path.join(ROOT, "sim", "worlds", "cellar.yaml"))
    arguments = parser.parse_args()
    os.environ["NODMAP_VIEWER"] = os.path.join(arguments.bin, "nodmap-viewer")
    with tempfile.TemporaryDirectory(prefix="nodmap-bench-viewer-") as folder:
        robot = Robot(arguments.bin, arguments.world, folder)
        try:
            print(json.dumps(measure(arguments), indent=1))
        finally:
            robot.stop()


if __name__ == "__main__":
    main()
