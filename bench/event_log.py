# SPDX-License-Identifier: BSD-3-Clause
"""Reads and writes LCM event logs."""
import struct
import typing

from poses import yaw_of

SYNC = 0xEDA1DA01
HEADER = struct.Struct(">IqqII")  # sync, number, time (us), lengths of channel and data


class Event(typing.NamedTuple):
    utime: int
    channel: str
    data: bytes


def events(path):
    """Yields the events of a log; raises ValueError if it is none."""
    with open(path, "rb") as log:
        while len(head := log.read(HEADER.size)) == HEADER.size:
            sync, _, utime, channel_size, size = HEADER.unpack(head)
            if sync != SYNC:
                raise ValueError(f"{path}: not an event log")
            channel = log.read(channel_size).decode()
            yield Event(utime, channel, log.read(size))


# The fields of a pose message after its fingerprint: time, position, orientation; its last byte is the state.
POSE = struct.Struct(">8xq3d4d")


def poses_of(path, channel):
    """Yields each POSE_2D or POSE_6D: time in seconds, (x, y, yaw), state."""
    for event in events(path):
        if event.channel == channel:
            utime, x, y, _, *orientation = POSE.unpack_from(event.data)
            yield 1e-6 * utime, (x, y, yaw_of(*orientation)), event.data[-1]


def heights_of(path, channel):
    """Yields the height (m) of each POSE_2D or POSE_6D."""
    for event in events(path):
        if event.channel == channel:
            yield POSE.unpack_from(event.data)[3]


class Writer:
    """A log that is written, in a with block."""

    def __init__(self, path):
        self.log, self.num_events = open(path, "wb"), 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.log.close()

    def write(self, event):
        channel = event.channel.encode()
        self.log.write(HEADER.pack(SYNC, self.num_events, event.utime, len(channel), len(event.data)) + channel + event.data)
        self.num_events += 1
