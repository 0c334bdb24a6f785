#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how much 2D SLAM's error depends on its parameters: changes each of them by -10 % and +10 %, one at a time, on the three public logs.

bench/slam2d_stability.py --data DIR [--bin DIR] [--only KEY ...] [--logs NAME ...]

DIR holds NAME.clf and NAME.relations of intel, fr079 and mit-csail (docs/benchmark-2d.md). Only one process runs at a time, so that other work may run
beside it; a row takes as long as mapping the three logs. Prints a table of the translation error of each log, relative to the error with the default
parameters. Ratios above 1.25 are in bold. Whole numbers change by at least one.
"""
import argparse
import math
import pathlib
import tempfile

from programs import BIN, LOGS, call, evaluate

# Parameters that do not affect the trajectory: publishing of the map, its cells, and those that only --localise uses.
WITHOUT_EFFECT = ("grid.", "localise.", "relocalise.")


class Stability:
    def __init__(self, programs, data, logs, folder):
        self.programs, self.data, self.logs, self.folder = programs, data, logs, folder
        for name in logs:
            call(programs / "nodmap-convert", "carmen", data / f"{name}.clf", folder / f"{name}.lcmlog")

    def parameters(self):
        """The numeric parameters by name, with their defaults; int where only whole numbers are allowed."""
        found, sections, kind = {}, [], ""
        for line in call(self.programs / "nodmap-slam2d", "--dump-params").splitlines():
            words = line.strip()
            if words.startswith("#"):
                kind = words[2:]
                continue
            key, _, value = words.partition(":")
            sections = sections[:(len(line) - len(line.lstrip())) // 2] + [key]
            name = ".".join(sections)
            if value.strip() and kind.startswith(("a number", "a whole number")) and not name.startswith(WITHOUT_EFFECT):
                found[name] = (int if kind.startswith("a whole") else float)(value)
        return found

    def errors_m(self, setting=()):
        errors = []
        for name in self.logs:
            with tempfile.TemporaryDirectory() as made:
                out = pathlib.Path(made) / "out"
                call(self.programs / "nodmap-slam2d", "--replay", self.folder / f"{name}.lcmlog", "--out", out, *setting)
                relations = evaluate(self.programs, "relations", out / "trajectory.tum", self.data / f"{name}.relations")
                # Whoever gives no pose where it is difficult must not look better.
                errors.append(math.inf if relations["missing"] else relations["trans_mean_m"])
        return errors


def changed(value, factor):
    if isinstance(value, int):
        return value + (1 if factor > 1.0 else -1) * max(1, round(abs(factor - 1.0) * value))
    return float(f"{factor * value:.6g}")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--data", type=pathlib.Path, required=True)
    options.add_argument("--bin", type=pathlib.Path, default=BIN)
    options.add_argument("--only", nargs="*", help="the parameters to change; default: all numeric ones")
    options.add_argument("--logs", nargs="*", default=LOGS, choices=LOGS)
    options = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bench = Stability(options.bin, options.data, options.logs, pathlib.Path(folder))
        parameters = bench.parameters()
        base_m = bench.errors_m()
        print("| parameter | value | " + " | ".join(options.logs) + " |\n|---|---|" + "---|" * len(options.logs), flush=True)
        print("| defaults | | " + " | ".join(f"{error_m:.4f} m" for error_m in base_m) + " |", flush=True)
        for key in options.only or parameters:
            for factor in (0.9, 1.1):
                value = changed(parameters[key], factor)
                try:
                    ratios = [error_m / reference_m for error_m, reference_m in
                              zip(bench.errors_m(("--set", f"{key}={value}")), base_m)]
                except RuntimeError as error:  # the value is not allowed
                    print(f"| `{key}` | {value} | not allowed |" + " |" * (len(options.logs) - 1), flush=True)
                    if "allowed" not in str(error):
                        raise
                    continue
                cells = [f"**{ratio:.2f}**" if ratio > 1.25 else f"{ratio:.2f}" for ratio in ratios]
                print(f"| `{key}` | {value} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
