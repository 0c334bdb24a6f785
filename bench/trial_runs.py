# SPDX-License-Identifier: BSD-3-Clause
"""Runs of nodmap-trial, several at a time, and the options of the scripts that make them."""
import concurrent.futures
import contextlib
import json
import pathlib
import sys
import tempfile

from programs import BIN, ROOT, call
from seeds import CHOOSING, REPORTING

WORLDS = ROOT / "sim" / "worlds"


class Pool(concurrent.futures.ThreadPoolExecutor):
    """Runs programs side by side; starts nothing more when its block is left by an exception, such as by Ctrl-C."""

    def __exit__(self, kind, error, traceback):
        self.shutdown(cancel_futures=kind is not None)
        return False


class Trial:
    """One run of nodmap-trial and its result. The same arguments give the same result."""

    def __init__(self, name, world, seed, duration_s, *options, keep_log=False):
        """`world`: the name of a file in sim/worlds, or a world with a colon, as nodmap-trial takes it. `duration_s`: None leaves it to the world."""
        self.name, self.seed, self.options, self.keep_log = name, seed, options, keep_log
        self.world = world if ":" in world else WORLDS / f"{world}.yaml"
        self.duration = [] if duration_s is None else ["--duration", duration_s]
        self.result, self.dir, self.error = None, None, ""

    def arguments(self):
        return ["--world", self.world, "--seed", self.seed, *self.duration, *self.options, "--out", self.dir]

    def run(self, bin_dir, out):
        """Runs it into its folder in `out`; the result stays None, and `error` says why, if it fails."""
        self.dir = out / self.name
        try:
            call(bin_dir / "nodmap-trial", *self.arguments())
        except RuntimeError as error:
            self.error = str(error)
            return self
        self.result = json.loads((self.dir / "result.json").read_text())
        if not self.keep_log:
            for log in self.dir.glob("*.lcmlog"):  # 20 to 70 MB a minute, and made again by the same command
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
    parser.add_argument("--out", type=pathlib.Path, help="new folder in which the results are kept; default: a temporary one")
    parser.add_argument("--bin", type=pathlib.Path, default=BIN)


def add_set_option(parser):
    parser.add_argument("--set", action="append", default=[], help="a parameter, as for nodmap-trial --set")


def add_seed_options(parser, number, first=REPORTING[0]):
    """Adds --seeds and --first, with these defaults; seeds_of() gives the seeds."""
    parser.add_argument("--seeds", type=int, default=number, help="number of seeds in each scenario")
    parser.add_argument("--first", type=int, default=first, help=f"first seed; from {CHOOSING[0]} on for choosing parameters")


def seeds_of(arguments):
    return range(arguments.first, arguments.first + arguments.seeds)


@contextlib.contextmanager
def result_folder(out, may_contain=False):
    """The folder of --out, or a temporary one for this block. `may_contain`: it may contain drives of an earlier run, which are then used again."""
    if out:
        out.mkdir(parents=True, exist_ok=True)
        if not may_contain and any(out.iterdir()):
            raise SystemExit(f"{out}: is not empty, and results are never overwritten; name another --out")
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


def show_table(head, rows):
    """Prints a Markdown table, to be copied into a document."""
    for cells in (head, *rows):
        print("| " + " | ".join(map(str, cells)) + " |")
        if cells is head:
            print("|" + "---|" * len(head))
