# SPDX-License-Identifier: BSD-3-Clause
"""A running nodmap-deputy with a configuration of its own."""
import os
import subprocess
import tempfile

from websocket import PATIENCE_S


class Deputy:
    """The deputy "here". `commands` is the text of a .pmd file, in which OUT means the folder `logs`."""

    def __init__(self, commands):
        self.folder = tempfile.TemporaryDirectory()
        self.config = os.path.join(self.folder.name, "test.pmd")
        self.logs = os.path.join(self.folder.name, "logs")
        self.rewrite(commands)
        path = os.pathsep.join([os.path.dirname(os.environ["NODMAP_DEPUTY"]), os.environ["PATH"]])
        self.process = subprocess.Popen([os.environ["NODMAP_DEPUTY"], self.config, "--id", "here"], stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL, env={**os.environ, "PATH": path})

    def rewrite(self, commands):
        """Writes the file anew, which deputy and viewer notice."""
        with open(self.config, "w", encoding="ascii") as out:
            out.write(commands.replace("OUT", self.logs))

    def stop(self):
        self.process.terminate()
        self.process.wait(timeout=PATIENCE_S)
        self.folder.cleanup()
