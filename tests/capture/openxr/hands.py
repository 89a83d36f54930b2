"""The hands of Monado's driver `remote`, moved over its TCP connection."""

import math
import socket
import struct
import threading
import time

ADDRESS = ("127.0.0.1", 4242)

# Rates beyond the display's would only repeat themselves.
RATE_HZ = 120


class Hand:
    """What the driver knows of one hand: the grip of its controller, the bend of its fingers, and whether it is tracked."""

    def __init__(self, position):
        self.position = list(position)
        # From the little finger to the thumb: 0 is straight, 1 is bent.
        self.curl = [0.1] * 5
        self.is_tracked = True

    def packed(self):
        """`r_remote_controller_data` of the driver's r_interface.h."""
        pose = struct.pack("<4f3f", 0, 0, 0, 1, *self.position)
        velocities = struct.pack("<6f", *[0] * 6)
        axes = struct.pack("<8f", *[0] * 8)
        flags = struct.pack("<16B", self.is_tracked, 1, *[0] * 14)
        return pose + velocities + struct.pack("<5f", *self.curl) + axes + flags


class Hands:
    """Both hands. A thread of its own sends them until `close`."""

    def __init__(self):
        self.left = Hand((-0.2, 1.2, -0.35))
        self.right = Hand((0.2, 1.2, -0.35))
        self.lock = threading.Lock()
        self.is_open = True
        self.socket = None
        self.thread = threading.Thread(target=self._send_all, daemon=True)
        self.thread.start()

    def close(self):
        self.is_open = False
        self.thread.join()

    def bend(self, fingers, curl, seconds=0.15):
        """Bends fingers of the right hand, as a person does: from where they are, in this time."""
        start = list(self.right.curl)

        def at(t):
            for finger in fingers:
                self.right.curl[finger] = start[finger] + (curl - start[finger]) * t

        self._move(at, seconds)

    def move(self, target, seconds=0.4):
        """Moves the right hand to a position in metres."""
        start = list(self.right.position)

        def at(t):
            self.right.position = [a + (b - a) * t for a, b in zip(start, target)]

        self._move(at, seconds)

    def show(self, is_tracked):
        """Shows or hides both hands."""
        with self.lock:
            self.left.is_tracked = self.right.is_tracked = is_tracked

    def _move(self, at, seconds):
        began = time.monotonic()
        t = 0.0
        while t < 1:
            t = min(1.0, (time.monotonic() - began) / seconds)
            with self.lock:
                at(0.5 - 0.5 * math.cos(math.pi * t))
            time.sleep(1 / RATE_HZ)

    def _send_all(self):
        while self.is_open:
            try:
                if self.socket is None:
                    self.socket = socket.create_connection(ADDRESS, timeout=1)
                with self.lock:
                    packet = self._packet()
                self.socket.sendall(packet)
            except OSError:
                # The service is being stopped or started.
                self.socket = None
                time.sleep(0.1)
            time.sleep(1 / RATE_HZ)

    def _packet(self):
        """`r_remote_data` of the driver's r_interface.h, version 3."""
        view = struct.pack("<4f", -0.7, 0.7, 0.7, -0.7) + struct.pack("<4f3f", 0, 0, 0, 1, 0, 0, 0)
        head = 2 * (view + struct.pack("<I", 0))
        head += struct.pack("<4f3f", 0, 0, 0, 1, 0, 1.6, 0) + struct.pack("<4B", 0, 0, 0, 0)
        return b"mndrmt3\0" + head + self.left.packed() + self.right.packed()
