# SPDX-License-Identifier: BSD-3-Clause
"""Runs nodmap-trial and reads its results."""
import json
import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))
import programs
from programs import BIN, ROOT
from seeds import ODOMETRY_NOISE, REPORTING  # noqa: F401, for the figures

OUT = ROOT / "logs" / "figures"


def call(program, *arguments):
    """Runs a program and returns what it prints; raises RuntimeError with its error message."""
    return programs.call(BIN / program, *arguments)


def evaluate(*arguments):
    return programs.evaluate(BIN, *arguments)


class Trial:
    """One run in a world of sim/worlds. The same arguments give the same result."""

    def __init__(self, name, world, seed, duration_s, *options, keep_log=True):
        self.name, self.seed, self.keep_log = name, seed, keep_log
        self.world = ROOT / "sim" / "worlds" / f"{world}.yaml"
        self.dir = OUT / name
        self.arguments = ["--seed", seed, "--duration", duration_s, *options]

    def command(self):
        """The command as a person would type it in the project's folder."""
        words = ["nodmap-trial", "--world", self.world.relative_to(ROOT), *self.arguments, "--out", self.dir.relative_to(ROOT)]
        return " ".join(str(word) for word in words)

    def run(self):
        shutil.rmtree(self.dir, ignore_errors=True)
        self.dir.parent.mkdir(parents=True, exist_ok=True)
        call("nodmap-trial", "--world", self.world, *self.arguments, "--out", self.dir)
        if not self.keep_log:
            (self.dir / "trial.lcmlog").unlink()  # 70 MB a minute, and made again by the same command

    @property
    def result(self):
        return json.loads((self.dir / "result.json").read_text())

    def table(self, channel):
        """The CSV file of a channel, which is exported from the log if it does not exist yet."""
        path = self.dir / f"{channel}.csv"
        if not path.exists():
            call("nodmap-convert", "export", self.dir / "trial.lcmlog", path, "--channel", channel)
        return path
