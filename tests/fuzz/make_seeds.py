#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the first inputs of the fuzz targets: one file for each golden frame in the unit tests."""
import math
import pathlib
import re
import struct
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SLCAN_LINE = re.compile(r'"([tTrR][0-9A-F]{4,30})"')
TESTS = ROOT / "drivers" / "laser3d" / "test"
LITERAL = re.compile(r'hex\(\s*((?:"[0-9A-Fx ]+"\s*)+)\)')

# Attributes that none of our configurations uses.
PMD = [b'cmd { exec = "A=1 x"; deputy = "d"; group = "a/b"; }', b'group "a" { group "b" { cmd "x" { exec = "\\n\\""; } } }',
       b'script "s" { restart everything wait "stopped"; wait cmd "x" status "running"; run_script "s"; }']

OCTOMAP_HEAD = b"# Octomap OcTree binary file\nid OcTree\nsize 17\nres 0.05\ndata\n"
# A branch to a single voxel, one that ends in large leaves, and an empty tree.
OCTOMAP = [OCTOMAP_HEAD + b"\x03\x00" * 15 + b"\x02\x00", OCTOMAP_HEAD + b"\x0F\xA6" + b"\xAA\x56" * 2, OCTOMAP_HEAD]
CALL = b"\x02\x01\0\0\0\x07\0\0\0\x04\0\0\0json"
VIEWER_SESSION = [b'T{"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]}\nT{"op":"unsubscribe","subscriptionIds":[0]}',
                  b'T{"op":"getParameters","parameterNames":[],"id":"x"}\nT{"op":"subscribeParameterUpdates","parameterNames":[]}',
                  b'T{"op":"setParameters","parameters":[{"name":"playback.speed","value":2}],"id":"y"}', CALL + b'{"do":"stop"}', CALL + b"[]"]


# Kinds of messages_fuzz.cpp: what a robot that drives receives in a period; a GOAL and the rest; values that are hard to compute with.
PERIOD = bytes([10, 1, 2, 0, 3, 4])
WILD = [struct.pack(">d", value) for value in (math.nan, math.inf, -math.inf, 1e300, -1e9, 5e8)]
MESSAGES = [PERIOD * 20, PERIOD * 5 + bytes([5, 11, 6, 11]) + PERIOD * 20, PERIOD * 10 + bytes([7, 8, 9, 9]) + PERIOD * 3]
MESSAGES += [PERIOD * 3 + b"".join(bytes([0x10 | kind]) + offset.to_bytes(2, "big") + value for offset in range(16, 120, 8)) + PERIOD * 2
             for kind in range(12) for value in WILD]

WHOLE, FRAGMENT = b"LC02\0\0\0\1", b"LC03\0\0\0\1"


def datagrams(*parts):
    """The datagrams, each behind its length, all from one sender."""
    return b"".join(len(part).to_bytes(2, "big") + part for part in parts)


def fragment(size, offset, number, count, payload):
    return FRAGMENT + size.to_bytes(4, "big") + offset.to_bytes(4, "big") + number.to_bytes(2, "big") + count.to_bytes(2, "big") + payload


LCM = [datagrams(WHOLE + b"SCAN\0data", WHOLE + b"SCAN"), datagrams(fragment(8, 0, 0, 2, b"SCAN\0data"), fragment(8, 4, 1, 2, b"data")),
       datagrams(fragment(1000, 0, 0, 2, b"SCAN\0"), fragment(1000, 2**32 - 256, 1, 2, b"x" * 260))]
EVENT = (0xEDA1DA01).to_bytes(4, "big") + (0).to_bytes(8, "big") + (1).to_bytes(8, "big") + (4).to_bytes(4, "big") + (4).to_bytes(4, "big") + b"SCANdata"
EVENT_LOG = [EVENT * 3, EVENT + b"noise" + EVENT, EVENT[:-2]]
PLY_HEAD = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
PLY = [PLY_HEAD + b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
       b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\nproperty float y\nproperty uchar z\nend_header\n" + b"\0" * 13,
       b"ply\nformat ascii 1.0\nelement vertex 9223372036854775808\nend_header\n"]
CLF = b"PARAM robot_front_laser_max 80.0\nODOM 0 0 0 0 0 0 1.0 host 1.0\nFLASER 3 1.0 2.0 3.0 0 0 0 0 0 0 1.0 host 1.0\n"
UOS = b"\x02" + b"10 0 100\n20 0 100\n30 10 100\nP1 2 3 0 90 0\n"
# Kinds of saved_map_fuzz.cpp: values that are hard to compute with in all parts of both saved maps; maps of ROS.
SAVED_MAP = [bytes([kind]) + b"".join(offset.to_bytes(2, "big") + value for offset in offsets)
             for kind, size in ((0, 3400), (1, 4400)) for value in WILD for offsets in ([], [30], [60], [100], range(200, size, 400))]
PGM = b"P5\n8 8\n255\n" + b"\x00" * 8 + b"\xfe" * 48 + b"\x00" * 8
ROS_MAP = b"\x02image: map.pgm\nresolution: %b\norigin: [%b, -1, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n\0"
SAVED_MAP += [ROS_MAP % (b"0.05", b"-1") + PGM, ROS_MAP % (b"1", b"1e6") + PGM, ROS_MAP % (b"0.005", b"0") + b"P2\n# x\n2 2\n9\n0 9 9 0\n"]
# Kinds of table_fuzz.cpp: trajectory, relations, BARN, pedestrians.
TABLE = [b"\x00# time\n1.5 1 2 0 0 0 0 1\n2.5 1e9 -2 0 0 0 0.7071 0.7071\n", b"\x011.5 2.5 1 0 0 0 0 3.14\n2.5 3.5 1e300 0 0 0 0 0\n",
         b"\x02W 0 1\n1 2\nW 1 2\n0.5 4\nC 0.5 4.0 3 x\n0 1 2\n2 3 4\n4.0 1 2\n", b"\x02W 1 1\nC 0.5 4.0 2 x\n0 1 2\n99999 3 4\n",
         b"\x030 1 1.0 2.0\n0 2 3.0 2.0\n10 1.0 1.5 2.0\n10 2 3.0 2.5\n", b"\x03-1e9 1 1 2\n1e9 1 1 2\n"]
HELLO = b"\x00GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
FRAMES = [HELLO, b"\x01\x81\x82\0\0\0\0{}", b"\x01\x89\x80\0\0\0\0", b"\x01\x88\x82\0\0\0\0\x03\xe8", b"\x01\x82\xff" + b"\xff" * 12]


def slcan_lines():
    """The golden lines of the SLCAN test with their line ends, and the answers of an adapter."""
    text = (ROOT / "drivers" / "kurt" / "test" / "slcan_test.cpp").read_text()
    lines = [line.encode() + b"\r" for line in SLCAN_LINE.findall(text)]
    # The base's other sensors: ranges, tilt, gyro.
    lines += [b"t0068012C01F400640064\r", b"t00D88000780000000000\r", b"t00E8004C2DFF00002710\r"]
    return lines + [b"\r\az\rZ\rF85\rV1013\r"]


def frames(source):
    """The bytes of each hex("...") literal in a test file."""
    for match in LITERAL.finditer(source.read_text()):
        data = bytearray()
        for word in "".join(re.findall(r'"([^"]*)"', match.group(1))).split():
            data += bytes([int(word[:2], 16)]) * (int(word[3:]) if len(word) > 3 else 1)
        yield bytes(data)


def write_seeds(directory, seeds):
    directory.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(seeds):
        (directory / f"seed_{number:03d}").write_bytes(seed)


def sick_scan(count, first, step):
    """A telegram of measured values as the sensor sends it; built without the driver's code."""
    body = bytes([0xB0]) + (0x4000 | count).to_bytes(2, "little")
    body += b"".join((first + i * step).to_bytes(2, "little") for i in range(count)) + b"\x10"
    frame = b"\x02\x80" + len(body).to_bytes(2, "little") + body
    crc = previous = 0
    for byte in frame:
        crc = (((crc & 0x7FFF) << 1) ^ 0x8005) if crc & 0x8000 else crc << 1
        crc ^= (previous << 8) | byte
        previous = byte
    return frame + crc.to_bytes(2, "little")


def main():
    out = pathlib.Path(sys.argv[1])
    write_seeds(out / "slcan", slcan_lines())
    sick = [f for name in ("golden.hpp", "sick/telegram_test.cpp", "sick/command_test.cpp") for f in frames(TESTS / name)]
    sick += [sick_scan(181, 1000, 1), sick_scan(361, 1000, 0), sick_scan(401, 8000, 1)]
    write_seeds(out / "sick", sick)
    write_seeds(out / "pmd", [file.read_bytes() for file in sorted((ROOT / "procman").glob("*.pmd"))] + PMD)
    write_seeds(out / "octomap", OCTOMAP)
    write_seeds(out / "saved_map", SAVED_MAP)
    write_seeds(out / "table", TABLE)
    write_seeds(out / "lcm", LCM)
    write_seeds(out / "messages", MESSAGES)
    write_seeds(out / "event_log", EVENT_LOG)
    write_seeds(out / "ply", PLY)
    worlds = sorted((ROOT / "sim" / "worlds").glob("*.yaml"))[:5]
    write_seeds(out / "yaml", [file.read_bytes() for file in worlds + sorted((ROOT / "config").rglob("*.yaml"))] + [b"a: &a\n  b: *a\n"])
    nod = [b"\x01" + line.encode() for line in re.findall(r'"([^"\\]{20,})\\n"', (ROOT / "tools" / "convert" / "test" / "nod_test.cpp").read_text())]
    write_seeds(out / "recording", [b"\x00" + CLF, UOS] + nod)
    write_seeds(out / "websocket", FRAMES)
    write_seeds(out / "viewer_session", VIEWER_SESSION)
    write_seeds(out / "dynamixel", [f for f in frames(TESTS / "servo" / "dynamixel_test.cpp")])


if __name__ == "__main__":
    main()
