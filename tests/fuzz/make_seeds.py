#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the corpus seeds for the fuzz targets: every golden frame in the unit tests, one file each."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SLCAN_LINE = re.compile(r'"([tTrR][0-9A-F]{4,30})"')


def slcan_lines():
    """The golden lines of the SLCAN test, each with its end, and what an adapter answers."""
    text = (ROOT / "drivers" / "kurt" / "test" / "slcan_test.cpp").read_text()
    lines = [line.encode() + b"\r" for line in SLCAN_LINE.findall(text)]
    # The base's other sensors: ranges, tilt, gyro.
    lines += [b"t0068012C01F400640064\r", b"t00D88000780000000000\r", b"t00E8004C2DFF00002710\r"]
    return lines + [b"\r\az\rZ\rF85\rV1013\r"]


def write_seeds(directory, seeds):
    directory.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(seeds):
        (directory / f"seed_{number:03d}").write_bytes(seed)


def main():
    out = pathlib.Path(sys.argv[1])
    write_seeds(out / "slcan", slcan_lines())


if __name__ == "__main__":
    main()
