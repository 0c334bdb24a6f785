# SPDX-License-Identifier: BSD-3-Clause
"""A running nodmap-viewer, and what it takes of the processor."""
import os
import re
import subprocess
import tempfile

from websocket import PATIENCE_S


class Viewer:
    """A context manager. `port` is a free one unless asked otherwise."""

    def __init__(self, *arguments):
        self.log = tempfile.TemporaryFile("w+")
        # Tests bound its memory, in which AddressSanitizer would keep up to 256 MB that are free.
        environment = {**os.environ, "ASAN_OPTIONS": "quarantine_size_mb=4:thread_local_quarantine_size_kb=64"}
        port = [] if "--port" in arguments else ["--port", "0"]
        self.process = subprocess.Popen([os.environ["NODMAP_VIEWER"], *port, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        text=True, env=environment)
        for line in self.process.stderr:
            self.log.write(line)
            found = re.search(r"page on http://[^:]+:(\d+)/", line)
            if found:
                self.port = int(found.group(1))
                break
        else:
            raise RuntimeError("nodmap-viewer did not start:\n" + self.said())
        self.token = None
        if "--control" in arguments:
            self.token = re.search(r"#token=(\w+)", self.process.stdout.readline()).group(1)

    def said(self):
        """What it has written to stderr; all of it once it has ended."""
        self.log.seek(0)
        return self.log.read()

    def cpu_s(self):
        """Processor time used so far, seconds."""
        with open(f"/proc/{self.process.pid}/stat") as stat:
            fields = stat.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory_kb(self):
        with open(f"/proc/{self.process.pid}/status") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read()).group(1))

    def is_alive(self):
        return self.process.poll() is None

    def stop(self):
        """Ends it by SIGTERM; its exit code."""
        if self.is_alive():
            self.process.terminate()
        rest = self.process.communicate(timeout=PATIENCE_S)[1]
        self.log.write(rest)
        return self.process.returncode

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()
