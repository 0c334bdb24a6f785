# SPDX-License-Identifier: BSD-3-Clause
"""A client of foxglove.websocket.v1, written from the specification alone; it shares no code with the server or the page."""
import json
import math
import struct
import time

from websocket import BINARY, PATIENCE_S, TEXT, WebSocket


class Client:
    def __init__(self, port, **options):
        self.socket = WebSocket(port, **options)
        self.info = self._text()
        self.channels = {c["topic"]: c for c in self._text()["channels"]}
        self.topics = {}
        self.time_ns = None
        self.calls = 0
        self.others = []  # text messages that receive() has read

    def _text(self):
        kind, payload = self.socket.receive()
        assert kind == TEXT, "expected a text frame"
        return json.loads(payload)

    def send(self, **message):
        self.socket.send(json.dumps(message))

    def subscribe(self, *topics):
        first = len(self.topics)
        wishes = [{"id": first + i, "channelId": self.channels[t]["id"]} for i, t in enumerate(topics)]
        self.topics.update({first + i: t for i, t in enumerate(topics)})
        self.send(op="subscribe", subscriptions=wishes)

    def receive(self, end=math.inf):
        """The next data message: (topic, nanoseconds, decoded payload). TimeoutError if none has come by `end`, a time of time.monotonic()."""
        while True:
            if time.monotonic() > end:
                raise TimeoutError("no data message")
            kind, payload = self.socket.receive()
            if kind == TEXT:
                self.others.append(json.loads(payload))
            elif payload[0] == 1:
                subscription, nanoseconds = struct.unpack_from("<IQ", payload, 1)
                return self.topics[subscription], nanoseconds, json.loads(payload[13:])
            elif payload[0] == 2:
                self.time_ns, = struct.unpack_from("<Q", payload, 1)

    def collect(self, wanted, timeout_s=PATIENCE_S):
        """Collects messages, by topic, until wanted(messages) is true."""
        messages, end = {}, time.monotonic() + timeout_s
        while not wanted(messages):
            try:
                topic, nanoseconds, message = self.receive(end)
            except TimeoutError as late:
                raise AssertionError(f"only {({t: len(m) for t, m in messages.items()})} after {timeout_s} s") from late
            messages.setdefault(topic, []).append((nanoseconds, message))
        return messages

    def answer(self, wanted, timeout_s=PATIENCE_S):
        """The next text message for which wanted(message) is true."""
        end = time.monotonic() + timeout_s
        while time.monotonic() < end:
            for message in self.others:
                if wanted(message):
                    self.others.remove(message)
                    return message
            kind, payload = self.socket.receive()
            if kind == TEXT:
                self.others.append(json.loads(payload))
        raise AssertionError("no such answer")

    def status(self):
        """The next status message."""
        return self.answer(lambda m: m["op"] == "status")

    def call(self, request, service=1, encoding=b"json"):
        """Calls a service; returns its answer, or the failure message."""
        self.calls += 1
        self.socket.send(struct.pack("<BIII", 2, service, self.calls, len(encoding)) + encoding + json.dumps(request).encode(), BINARY)
        while True:
            kind, payload = self.socket.receive()
            if kind == TEXT:
                message = json.loads(payload)
                if message["op"] == "serviceCallFailure":
                    assert message["callId"] == self.calls
                    return message
                self.others.append(message)
            elif payload[0] == 3:
                _, call, size = struct.unpack_from("<III", payload, 1)
                assert call == self.calls and payload[13:13 + size] == b"json"
                return json.loads(payload[13 + size:])

    def close(self):
        self.socket.close()
