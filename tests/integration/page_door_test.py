#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The demo's page can be reached from outside although the demo runs in a network namespace of its own.

page_door_test.py SCRIPTS_DIR
"""
import os
import socket
import subprocess
import sys
import unittest

DOOR = [sys.executable, os.path.join(sys.argv.pop(), "page_door.py")]
# Inside: a server behind the guard, which answers with its name for the network. It ends when its standard input is closed.
INSIDE = """
ip link set lo up
"$1" "$2" guard $$ &
exec "$1" -c '
import os, socketserver, sys, threading
class Answer(socketserver.BaseRequestHandler):
    def handle(self):
        self.request.sendall(self.request.recv(100) + os.readlink("/proc/self/ns/net").encode())
server = socketserver.ThreadingTCPServer(("127.0.0.1", int(os.environ["NODMAP_PORT"])), Answer)
threading.Thread(target=server.serve_forever, daemon=True).start()
print(os.environ["NODMAP_PORT"], flush=True)
sys.stdin.read()
os._exit(0)
'
"""


class PageDoor(unittest.TestCase):
    def test_a_taken_port_is_left_alone(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            said = subprocess.run([*DOOR, "port"], env={**os.environ, "NODMAP_PORT": str(port)}, stdout=subprocess.PIPE, check=True)
            self.assertNotEqual(int(said.stdout), port)

    def test_it_leads_into_the_other_network(self):
        with subprocess.Popen([*DOOR, "open", "unshare", "-rn", "sh", "-c", INSIDE, "sh", *DOOR], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, text=True) as inside:
            port = int(inside.stdout.readline())
            # The door was open before the guard was in it: this only waits for the guard, so it is no race.
            for _ in range(3):
                with socket.create_connection(("127.0.0.1", port), timeout=20) as visitor:
                    visitor.sendall(b"from outside: ")
                    said = b""
                    while part := visitor.recv(100):
                        said += part
                self.assertTrue(said.startswith(b"from outside: net:["), said)
                self.assertNotIn(os.readlink("/proc/self/ns/net").encode(), said)
            inside.stdin.close()
            self.assertEqual(inside.wait(timeout=20), 0)

    def test_a_guard_whose_demo_has_ended_before_it_began_ends(self):
        with subprocess.Popen(["true"]) as demo:
            demo.wait()
        with socket.create_server(("127.0.0.1", 0)) as door:
            guard = subprocess.run([*DOOR, "guard", str(demo.pid)], env={**os.environ, "NODMAP_DOOR": str(door.fileno())},
                                   pass_fds=[door.fileno()], timeout=20)
        self.assertEqual(guard.returncode, 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
