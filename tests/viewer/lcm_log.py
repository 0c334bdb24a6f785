# SPDX-License-Identifier: BSD-3-Clause
"""LCM event logs and the two messages the test compares, read byte by byte from the format's description."""
import struct

SYNC = 0xEDA1DA01


def events(path):
    """(utime, channel, data) of each event."""
    with open(path, "rb") as log:
        while head := log.read(28):
            sync, _, utime, channel_size, data_size = struct.unpack(">IQQII", head)
            assert sync == SYNC
            yield utime, log.read(channel_size).decode(), log.read(data_size)


def cloud_chunk(data):
    """A nodmap.cloud_chunk_t as a dict; points as a flat list."""
    utime, keyframe, index, chunks = struct.unpack_from(">qqii", data, 8)
    position = struct.unpack_from(">3d", data, 32)
    count, = struct.unpack_from(">i", data, 32 + 7 * 8)
    points = struct.unpack_from(f">{3 * count}f", data, 32 + 7 * 8 + 4)
    return {"utime": utime, "keyframe": keyframe, "index": index, "chunks": chunks, "position": position, "points": points}


def grid_chunk(data):
    """A nodmap.grid_chunk_t as a dict."""
    utime, revision, _, chunks = struct.unpack_from(">qqii", data, 8)
    cell_size, origin_x, origin_y = struct.unpack_from(">3d", data, 32)
    width, height, x, y, tile_width, tile_height, count = struct.unpack_from(">7i", data, 56)
    cells = struct.unpack_from(f">{count}b", data, 84)
    return {"utime": utime, "revision": revision, "chunks": chunks, "cell_size": cell_size, "origin": (origin_x, origin_y),
            "size": (width, height), "tile": (x, y, tile_width, tile_height), "cells": cells}
