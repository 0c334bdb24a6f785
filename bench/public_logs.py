# SPDX-License-Identifier: BSD-3-Clause
"""The public logs of 2D SLAM (docs/benchmark-2d.md)."""
from programs import call

LOGS = ("intel", "fr079", "mit-csail")


def map_log(bin_dir, clf, out, *options):
    """Maps a CARMEN log into the folder `out`; leaves the converted log beside it."""
    log = clf.with_suffix(".lcmlog")
    call(bin_dir / "nodmap-convert", "carmen", clf, log)
    call(bin_dir / "nodmap-slam2d", "--replay", log, "--out", out, *options)
