# SPDX-License-Identifier: BSD-3-Clause
"""A small WebSocket client on the standard library, written from RFC 6455; it can also misbehave on purpose."""
import base64
import os
import socket
import struct

# How long an event is waited for that comes at once when the machine has nothing else to do.
PATIENCE_S = 120

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10


class Refused(Exception):
    """The handshake was answered with another status than 101; args: status, head."""


class WebSocket:
    def __init__(self, port, target="/", protocols="foxglove.websocket.v1", headers=None, host=None, receive_buffer=None):
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(PATIENCE_S)
        self.socket.connect(("127.0.0.1", port))
        lines = {"Host": host or f"127.0.0.1:{port}", "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
                 "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(), **(headers or {})}
        if protocols is not None:
            lines["Sec-WebSocket-Protocol"] = protocols
        self.socket.sendall((f"GET {target} HTTP/1.1\r\n" + "".join(f"{k}: {v}\r\n" for k, v in lines.items()) + "\r\n").encode())
        self.input = b""
        self.answers_pings = True
        while b"\r\n\r\n" not in self.input:
            self._more()
        head, self.input = self.input.split(b"\r\n\r\n", 1)
        status = int(head.split()[1])
        if status != 101:
            raise Refused(status, head.decode())
        self.head = head.decode()

    def _more(self):
        piece = self.socket.recv(1 << 20)
        if not piece:
            raise ConnectionError("closed by the server")
        self.input += piece

    def _take(self, count):
        while len(self.input) < count:
            self._more()
        taken, self.input = self.input[:count], self.input[count:]
        return taken

    def send(self, payload, opcode=TEXT, masked=True):
        data = payload.encode() if isinstance(payload, str) else payload
        size = len(data)
        head = bytes([0x80 | opcode])
        mask_bit = 0x80 if masked else 0
        if size < 126:
            head += bytes([mask_bit | size])
        elif size < 65536:
            head += struct.pack(">BH", mask_bit | 126, size)
        else:
            head += struct.pack(">BQ", mask_bit | 127, size)
        if not masked:
            self.socket.sendall(head + data)
            return
        mask = os.urandom(4)
        stretched = (mask * (size // 4 + 1))[:size]
        masked_data = (int.from_bytes(data, "big") ^ int.from_bytes(stretched, "big")).to_bytes(size, "big")
        self.socket.sendall(head + mask + masked_data)

    def receive(self):
        """The next text or binary message: (opcode, payload). Answers pings; ConnectionError at the end."""
        message, kind = b"", None
        while True:
            first, second = self._take(2)
            size = second & 0x7F
            if second & 0x80:
                raise ConnectionError("a server does not mask")
            if size == 126:
                size, = struct.unpack(">H", self._take(2))
            elif size == 127:
                size, = struct.unpack(">Q", self._take(8))
            payload = self._take(size)
            opcode = first & 0x0F
            if opcode == PING:
                if self.answers_pings:
                    self.send(payload, PONG)
            elif opcode == CLOSE:
                raise ConnectionError(f"closed with code {int.from_bytes(payload[:2], 'big')}")
            elif opcode != PONG:
                kind = kind or opcode
                message += payload
                if first & 0x80:
                    return kind, message

    def close(self):
        self.socket.close()
