# SPDX-License-Identifier: BSD-3-Clause
"""The trials of the figures, of which each leaves its folder in logs/figures."""
import pathlib

import programs
import trial_runs
from programs import BIN, ROOT
from seeds import ODOMETRY_NOISE, REPORTING  # noqa: F401, for the figures

OUT = ROOT / "logs" / "figures"


def call(program, *arguments):
    """Runs a program and returns what it prints; raises RuntimeError with its error message."""
    return programs.call(BIN / program, *arguments)


def evaluate(*arguments):
    return programs.evaluate(BIN, *arguments)


class Trial(trial_runs.Trial):
    """A trial that a person can repeat, and whose channels can be read as tables."""

    def __init__(self, *arguments, keep_log=True):
        super().__init__(*arguments, keep_log=keep_log)
        self.dir = OUT / self.name

    def command(self):
        """The command as a person would type it in the project's folder."""
        words = (word.relative_to(ROOT) if isinstance(word, pathlib.Path) else word for word in self.arguments())
        return " ".join(map(str, ["nodmap-trial", *words]))

    def table(self, channel):
        """The CSV file of a channel, which is exported from the log if it does not exist yet."""
        path = self.dir / f"{channel}.csv"
        if not path.exists():
            call("nodmap-convert", "export", self.dir / "trial.lcmlog", path, "--channel", channel)
        return path
