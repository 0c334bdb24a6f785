# SPDX-License-Identifier: BSD-3-Clause
"""Reads LCM event logs and the messages that the test compares, byte by byte, by the description of the format."""
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


def octomap_chunk(data):
    """A nodmap.octomap_chunk_t as a dict."""
    utime, revision, index, chunks, size = struct.unpack_from(">qqiii", data, 8)
    return {"utime": utime, "revision": revision, "index": index, "chunks": chunks, "bytes": data[36:36 + size]}


def octomap_voxels(file):
    """The size of a voxel and the occupied voxels (indices from the origin) of an OctoMap file whose leaves are all single voxels."""
    head, nodes = file.split(b"\ndata\n", 1)
    edge = next(float(line.split()[1]) for line in head.split(b"\n") if line.startswith(b"res "))
    voxels, at = set(), 0

    def walk(corner, size):
        nonlocal at
        states, = struct.unpack_from("<H", nodes, at)
        at += 2
        children = [(states >> 2 * i & 3, tuple(c + (size // 2) * (i >> axis & 1) for axis, c in enumerate(corner))) for i in range(8)]
        for state, child in children:
            if state == 2:
                assert size == 2, "a leaf of more than one voxel"
                voxels.add(child)
        for state, child in children:
            if state == 3:
                walk(child, size // 2)

    walk((-32768, -32768, -32768), 65536)
    return edge, voxels
