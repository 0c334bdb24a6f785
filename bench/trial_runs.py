# SPDX-License-Identifier: BSD-3-Clause
"""Runs of nodmap-trial, several at a time, and the options of the scripts that make them."""
import concurrent.futures
import contextlib
import json
import pathlib
import sys
import tempfile

from pool import Pool
from programs import BIN, ROOT, call

WORLDS = ROOT / "sim" / "worlds"


class Trial:
    """One run of nodmap-trial and its result."""

    def __init__(self, name, world, seed, duration_s, *options, keep_log=False):
        self.name, self.world, self.seed, self.duration_s, self.options = name, world, seed, duration_s, options
        self.keep_log = keep_log
        self.result, self.dir, self.error = None, None, ""

    def run(self, bin_dir, out):
        self.dir = out / self.name
        world = self.world if ":" in self.world else str(WORLDS / f"{self.world}.yaml")
        try:
            call(bin_dir / "nodmap-trial", "--world", world, "--seed", self.seed, "--duration", self.duration_s, "--out", self.dir, *self.options)
        except RuntimeError as error:
            self.error = str(error)
            return self
        self.result = json.loads((self.dir / "result.json").read_text())
        if not self.keep_log:
            for log in self.dir.glob("*.lcmlog"):  # 20 MB a minute, and made again by the same command
                log.unlink()
        return self


def with_result(trials):
    return [trial for trial in trials if trial.result]


def results_of(trials):
    return [trial.result for trial in with_result(trials)]


def run_all(trials, bin_dir, out, jobs):
    show = sys.stderr.isatty()
    with Pool(jobs) as pool:
        futures = [pool.submit(trial.run, bin_dir, out) for trial in trials]
        for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
            future.result()
            if show:
                print(f"\r{done} of {len(trials)} trials", end="", file=sys.stderr, flush=True)
    if show:
        print(file=sys.stderr)


def add_options(parser, jobs=2):
    """Adds the options of every script that runs trials."""
    parser.add_argument("--jobs", type=int, default=jobs, help="how many trials run at the same time")
    parser.add_argument("--out", type=pathlib.Path, help="folder in which the results are kept; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)


@contextlib.contextmanager
def result_folder(out):
    """The folder of --out, or a temporary one for this block."""
    if out:
        out.mkdir(parents=True, exist_ok=True)
        yield out
    else:
        with tempfile.TemporaryDirectory(prefix="nodmap-trials-") as made:
            yield pathlib.Path(made)


def show_failures(trials):
    """Prints why trials have failed; returns how many have."""
    failed = [trial for trial in trials if not trial.result]
    for trial in failed:
        print(f"{trial.name}: {trial.error[-200:]}", file=sys.stderr)
    return len(failed)
