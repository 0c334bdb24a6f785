#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs what the documents claim and writes their tables between the markers, with the commit they were measured at,
and the images of the maps. With --check only compares, and fails when a number there is not what the programs reach now: by more than the
last digit printed, and by more than 2 %, because the square roots and sines of another processor may round in another way. The simulated
drives, which take minutes, are not checked.

usage: results.py BIN_DIR [--check]

The recordings are looked for in $NODMAP_DATA, else ../shared/data; where they are missing nothing is written, and --check says so.
"""
import argparse
import functools
import json
import os
import pathlib
import re
import shutil
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "bench"))
from programs import call, evaluate
from seeds import ODOMETRY_NOISE, REPORTING
from trial_runs import Trial, results_of, run_all, show_failures
DATA = pathlib.Path(os.environ.get("NODMAP_DATA", ROOT.parent / "shared" / "data"))
DOCUMENTS = [ROOT / "README.md", ROOT / "docs" / "benchmark-2d.md", ROOT / "docs" / "benchmark-3d.md"]
PEERS = json.loads((ROOT / "docs" / "peers.json").read_text())


@functools.cache
def relations(bin_dir, work, log, trajectory):
    """Relative pose errors on a public log, Kuemmerle et al. 2009."""
    out = work / log
    if not out.exists():
        call(bin_dir / "nodmap-convert", "carmen", DATA / "slam2d" / f"{log}.clf", work / f"{log}.lcmlog")
        call(bin_dir / "nodmap-slam2d", "--replay", work / f"{log}.lcmlog", "--out", out)
    errors = evaluate(bin_dir, "relations", out / trajectory, DATA / "slam2d" / f"{log}.relations")
    if errors["missing"]:  # whoever gives no pose where it is difficult must not look better
        raise SystemExit(f"{log}, {trajectory}: {errors['missing']} relations are without a pose")
    return errors


def table_2d(bin_dir, work):
    """The errors of the public logs beside the best of others."""
    rows = ["| log | translation | rotation | best other result (published, or measured by us) |", "|---|---|---|---|"]
    for log, peer in PEERS["2d"].items():
        errors = relations(bin_dir, work, log, "trajectory.tum")
        rows.append(f"| {log} | {errors['trans_mean_m']:.4f} m | {errors['rot_mean_deg']:.2f}° | {peer} |")
    return rows


def table_2d_online(bin_dir, work):
    """The errors of the poses at the end and of those published meanwhile."""
    logs = list(PEERS["2d"])
    rows = ["| nodmap | " + " | ".join(logs) + " |", "|---|" + "---|" * len(logs)]
    for name, trajectory in {"trajectory.tum": "trajectory.tum", "online.tum: each pose as published at its time": "online.tum"}.items():
        errors = [relations(bin_dir, work, log, trajectory) for log in logs]
        rows.append(f"| {name} | " + " | ".join(f"{error['trans_mean_m']:.4f} m, {error['rot_mean_deg']:.3f}°" for error in errors) + " |")
    return rows


def table_kurt3d(bin_dir, work):
    """Distance of each scan's points to the planes of the scan before."""
    log, out = work / "kurt3d.lcmlog", work / "kurt3d"
    call(bin_dir / "nodmap-convert", "uos", DATA / "kurt3d", log)
    call(bin_dir / "nodmap-slam6d", "--replay", log, "--out", out)
    rows = ["| KURT3D, 3 scans | second on first | third on second |", "|---|---|---|"]
    # The recording has the poses by odometry and those by 3DTK.
    for name, poses in {"nodmap-slam6d": out / "trajectory.tum", "odometry alone": "odometry", "3DTK, its result of 2009": "3dtk"}.items():
        first, second = re.findall(r"residual median ([0-9.]+)", call(bin_dir / "nodmap-bench-kurt3d-planes", DATA / "kurt3d", poses))
        rows.append(f"| {name} | {float(first):.2f} cm | {float(second):.2f} cm |")
    return rows


# What is driven, and nodmap-trial's worlds for it.
DRIVES = {
    "random clutter, objects of 3 cm and more": "random:{seed}",
    "an office": "office",
    "a corridor of 30 m": "corridor30",
    "a cellar": "cellar",
}


def table_drives(bin_dir, work):
    """Contacts, speed and the errors of both maps in simulated drives with the errors of odometry that mapping is reported with."""
    seeds = REPORTING[200:205]
    drives = {name: [Trial(f"{name}-{seed}", world.format(seed=seed), seed, 60, *ODOMETRY_NOISE) for seed in seeds] for name, world in DRIVES.items()}
    every = [trial for trials in drives.values() for trial in trials]
    run_all(every, bin_dir, work, os.cpu_count())
    if show_failures(every):
        raise SystemExit("a drive has failed")
    rows = [f"| simulated drives of 60 s, {len(seeds)} each | contacts | speed | 2D SLAM | 6D SLAM | odometry |", "|---|---|---|---|---|---|"]

    def mean(values):
        return sum(values) / len(seeds)

    for name, trials in drives.items():
        results = results_of(trials)
        errors = (100 * mean(result[key]["ate_rmse_m"] for result in results) for key in ("slam2d", "slam6d", "odometry"))
        rows.append(f"| {name} | {sum(result['collisions'] for result in results)} | {mean(result['mean_speed_mps'] for result in results):.2f} m/s | "
                    + " | ".join(f"{error:.1f} cm" for error in errors) + " |")
    return rows


# The images in docs/pictures/maps, and of which run above each is.
MAPS = {
    "intel": "intel/map.png",
    "fr079": "fr079/map.png",
    "mit-csail": "mit-csail/map.png",
    "office-3d": f"an office-{REPORTING[200]}/slam6d/map.png",
    "cellar-3d": f"a cellar-{REPORTING[200]}/slam6d/map.png",
}


def copy_maps(work):
    pictures = ROOT / "docs" / "pictures" / "maps"
    pictures.mkdir(exist_ok=True)
    for name, file in MAPS.items():
        shutil.copyfile(work / file, pictures / f"{name}.png")


QUICK_TABLES = {"2d": table_2d, "2d_online": table_2d_online, "kurt3d": table_kurt3d}
TABLES = QUICK_TABLES | {"drives": table_drives}


def block(name):
    return re.compile(rf"<!-- results: {name} -->\n(.*?)<!-- /results -->", re.S)


def numbers(text):
    return re.findall(r"\d+\.\d+", "\n".join(line for line in text.splitlines() if line.startswith("|")))


def is_near(a, b):
    """Whether two numbers, as printed, are the same within rounding."""
    last_digit = 10.0 ** -len(a.split(".")[1])
    return abs(float(a) - float(b)) <= max(1.001 * last_digit, 0.02 * abs(float(b)))


def difference(old, new):
    """What differs between two tables, as text; empty if nothing does."""
    if len(numbers(old)) != len(numbers(new)):
        return "other rows"
    changed = sum(not is_near(a, b) for a, b in zip(numbers(old), numbers(new)))
    return f"{changed} of {len(numbers(new))} numbers" if changed else ""


def commit_of(table):
    """The commit at which a table was written."""
    found = re.search(r"at commit (\w+)", table)
    return found.group(1) if found else "an unknown commit"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0], allow_abbrev=False)
    parser.add_argument("bin_dir", type=pathlib.Path)
    parser.add_argument("--check", action="store_true", help="only compare; the documents are not written")
    arguments = parser.parse_args()
    bin_dir, check = arguments.bin_dir, arguments.check
    if not (DATA / "slam2d").exists():
        print("results: skipped, no recordings (set NODMAP_DATA)")
        return 0
    commit = call("git", "-C", ROOT, "rev-parse", "--short", "HEAD").strip()
    texts = {document: document.read_text() for document in DOCUMENTS}
    stale = []
    with tempfile.TemporaryDirectory() as work:
        for name, make in (QUICK_TABLES if check else TABLES).items():
            rows = make(bin_dir, pathlib.Path(work))
            print("\n".join(rows))
            fresh = "\n".join(rows) + f"\n\nWritten by `./nodmap results` at commit {commit}.\n"
            if not any(block(name).search(text) for text in texts.values()):
                stale.append(f"{name}, which no document has a place for")
            for document, text in texts.items():
                for table in block(name).findall(text):
                    if changed := difference(table, fresh):
                        stale.append(f"{name} in {document.name}: {changed} since {commit_of(table)}")
                texts[document] = block(name).sub(lambda _: f"<!-- results: {name} -->\n{fresh}<!-- /results -->", text)
        if not check:
            copy_maps(pathlib.Path(work))
    if check:
        print(f"documents are stale ({'; '.join(stale)}): run ./nodmap results" if stale else "the documents agree")
        return 1 if stale else 0
    for document, text in texts.items():
        document.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
