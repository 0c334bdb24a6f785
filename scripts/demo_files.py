# SPDX-License-Identifier: BSD-3-Clause
"""The files that a demo leaves."""


def show_files(out, files):
    """Prints these files, pairs of a path in the folder `out` and what it is; returns the paths of those that are missing or empty."""
    missing = []
    for file, what in files:
        path = out / file
        here = path.exists() and path.stat().st_size > 0
        print(f"  {path}{'' if here else '  MISSING'}  {what}")
        missing += [] if here else [file]
    return missing
