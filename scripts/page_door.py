#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The way to the demo's page: a free port, and a door into a network namespace of our own.

page_door.py port                    prints a free port of this host's loopback: $NODMAP_PORT (8765), or one of the next
page_door.py open COMMAND [ARG...]   opens such a port, then becomes COMMAND, which enters the namespace; it inherits the
                                     open socket: NODMAP_DOOR is its number, NODMAP_PORT the port
page_door.py guard PID               in there: hands what comes to NODMAP_DOOR on to NODMAP_PORT of the namespace's loopback,
                                     until its parent process PID ends, perhaps before the guard has begun
"""
import asyncio
import os
import socket
import sys

WANTED = int(os.environ.get("NODMAP_PORT", 8765))
PARENT_CHECK_S = 1


def open_port():
    """A listening socket on the first free port of ten, or on any."""
    for port in [*range(WANTED, WANTED + 10), 0]:
        try:
            return socket.create_server(("127.0.0.1", port))
        except OSError:
            continue
    sys.exit("page_door: no free port")


async def pass_on(reader, writer):
    try:
        while data := await reader.read(65536):
            writer.write(data)
            await writer.drain()
    except OSError:
        pass  # the other side is gone: so is this one
    finally:
        writer.close()


async def visit(reader, writer):
    try:
        inner_reader, inner_writer = await asyncio.open_connection("127.0.0.1", int(os.environ["NODMAP_PORT"]))
    except OSError:
        writer.close()
        return
    await asyncio.gather(pass_on(reader, inner_writer), pass_on(inner_reader, writer))


async def guard(parent):
    door = socket.socket(fileno=int(os.environ["NODMAP_DOOR"]))
    async with await asyncio.start_server(visit, sock=door):
        while os.getppid() == parent:
            await asyncio.sleep(PARENT_CHECK_S)


def main(what, command):
    if what == "port":
        print(open_port().getsockname()[1])
    elif what == "open":
        door = open_port()
        os.set_inheritable(door.fileno(), True)
        os.environ.update(NODMAP_DOOR=str(door.fileno()), NODMAP_PORT=str(door.getsockname()[1]))
        os.execvp(command[0], command)
    else:
        asyncio.run(guard(int(command[0])))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
