# SPDX-License-Identifier: BSD-3-Clause
"""Headless Chromium by the WebDriver protocol of chromedriver, with the standard library alone.

Source: https://www.w3.org/TR/webdriver2/
"""
import atexit
import base64
import functools
import json
import re
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.request

# A browser without a graphics card, a sandbox or anything to say to the world outside.
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic",
         "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage"]


def is_installed():
    return bool(shutil.which("chromium") and shutil.which("chromedriver"))


def free_port():
    """A port that is free for IPv4 and IPv6. chromedriver needs both, and ends when the one it has chosen itself is free for IPv4 alone."""
    if socket.has_dualstack_ipv6():
        with socket.create_server(("", 0), family=socket.AF_INET6, dualstack_ipv6=True) as server:
            return server.getsockname()[1]
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


class Browser:
    """One window of one browser; a context manager. `more_flags`: besides those that all have; `settings`: of the user, by Chromium's names."""

    def __init__(self, width=1280, height=720, more_flags=(), settings=None):
        self.profile = tempfile.TemporaryDirectory(prefix="nodmap-chromium-")
        self.driver = subprocess.Popen(["chromedriver", f"--port={free_port()}"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.base = f"http://127.0.0.1:{self._port()}"
        self.session = ""
        flags = [*FLAGS, *more_flags, f"--user-data-dir={self.profile.name}"]
        answer = self._call("POST", "", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "goog:loggingPrefs": {"browser": "ALL"},
            "goog:chromeOptions": {"binary": shutil.which("chromium"), "args": flags, "prefs": settings or {}}}}})
        self.session = "/" + answer["sessionId"]
        self.resize(width, height)

    def _port(self):
        said = []
        for line in self.driver.stdout:
            said.append(line)
            found = re.search(r"started successfully on port (\d+)", line)
            if found:
                return int(found.group(1))
        raise RuntimeError("chromedriver did not start: " + "".join(said))

    def _call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"{self.base}/session{self.session}{path}", data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=600) as answer:
            return json.load(answer)["value"]

    def open(self, url):
        self._call("POST", "/url", {"url": url})

    def resize(self, width, height):
        """The size of the page itself, without the window around it, which has a least size besides."""
        self._call("POST", "/goog/cdp/execute", {"cmd": "Emulation.setDeviceMetricsOverride", "params": {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}})

    def run(self, script, *args):
        """The value of a JavaScript function body."""
        return self._call("POST", "/execute/sync", {"script": script, "args": list(args)})

    def wait_for(self, condition, timeout_s=600):
        """Until a JavaScript expression is true; returns the seconds it took, or None. A busy machine takes its time."""
        begin = time.monotonic()
        while time.monotonic() - begin < timeout_s:
            if self.run(f"return Boolean({condition})"):
                return time.monotonic() - begin
            time.sleep(0.05)
        return None

    def screenshot(self):
        """PNG bytes of the window."""
        return base64.b64decode(self._call("GET", "/screenshot"))

    def console(self):
        """What the page has written to the console since the last call: a list of {level, message}."""
        return self._call("POST", "/se/log", {"type": "browser"})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self._call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()
            shutil.rmtree(self.profile.name, ignore_errors=True)


@functools.cache
def _kept_browser(more_flags):
    browser = Browser(more_flags=more_flags)
    atexit.register(browser.__exit__)
    return browser


def shared_browser(width=1280, height=720, more_flags=()):
    """The browser of this process, on an empty page of that size, as if it had just been started, which would take longer than most tests.

    What a page stores stays apart by the port of its viewer.
    """
    browser = _kept_browser(tuple(more_flags))
    browser.open("about:blank")
    browser.console()
    browser.resize(width, height)
    return browser
