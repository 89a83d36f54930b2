# SPDX-License-Identifier: MIT OR Apache-2.0
"""Moves bones and properties in Blender by a hand that Ademán shares, and bakes the movement to key frames.

Start:    ademan run --source serial:/dev/ttyUSB0 --share pose:127.0.0.1:10003
Install:  Edit > Preferences > Add-ons > Install: this file. The panel is in the sidebar (N) of the 3D view, tab Ademán.

The table of mappings is a JSON file; STARTING_TABLE is one, and docs/blender.md of Ademán describes the format.

A thread of its own reads the lines and puts them into a queue with an end, and a timer of Blender applies the latest one: neither waits for
the other.
"""

import collections
import json
import math
import socket
import threading
import time

import bpy
from mathutils import Matrix, Quaternion, Vector

bl_info = {
    "name": "Ademán",
    "description": "Moves bones and properties by a captured hand, and bakes the movement",
    "author": "The authors of Ademán",
    "version": (0, 1, 0),
    "blender": (2, 93, 0),
    "location": "3D View > Sidebar > Ademán",
    "category": "Animation",
}

QUEUE_LINES = 4096
MAX_LINE = 1 << 20
RETRY_S = (0.25, 4.0)
SILENT_S = 3.0
TICK_S = 1 / 60
BAKE_S = 0.02


class Receiver(threading.Thread):
    """Reads lines of `--share pose` until it is stopped, and connects again whenever the connection is lost."""

    def __init__(self, host, port):
        super().__init__(daemon=True, name="Ademán")
        self.address = (host, port)
        self.lines = collections.deque(maxlen=QUEUE_LINES)
        self.state = f"connecting to {host}:{port}"
        self.received = 0
        self.invalid = 0
        self.connections = 0
        self.stopped = threading.Event()

    def run(self):
        retry = RETRY_S[0]
        while not self.stopped.is_set():
            before = self.received
            try:
                with socket.create_connection(self.address, timeout=3) as stream:
                    self.connections += 1
                    self.say("connected; no hand has been received yet")
                    self.read(stream)
                reason = "the program has closed the connection"
            except OSError as error:
                reason = error.strerror or str(error)
            if self.stopped.is_set():
                return
            retry = RETRY_S[0] if self.received > before else min(2 * retry, RETRY_S[1])
            host, port = self.address
            self.say(f"no connection to {host}:{port}: {reason}; connecting again")
            self.stopped.wait(retry)

    def read(self, stream):
        stream.settimeout(0.25)
        rest, last = b"", time.monotonic()
        while not self.stopped.is_set():
            try:
                data = stream.recv(65536)
            except socket.timeout:
                if time.monotonic() - last > SILENT_S:
                    self.say("connected, but no hand is received")
                continue
            if not data:
                return
            last = time.monotonic()
            *lines, rest = (rest + data).split(b"\n")
            rest = b"" if len(rest) > MAX_LINE else rest
            for line in lines:
                self.add(line)

    def add(self, line):
        try:
            self.lines.append(Hand(json.loads(line)))
        except (KeyError, TypeError, ValueError):
            self.invalid += 1
            return
        self.received += 1
        if not self.state.startswith("receiving"):
            self.say("receiving")

    def say(self, state):
        if state != self.state:
            self.state = state
            print("Ademán:", state, flush=True)
