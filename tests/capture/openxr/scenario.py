"""Types through a real OpenXR runtime: scenario.py ROOT LOGS. `run` starts it in a network namespace of its own.

The hand is moved by the protocol of Monado's driver `remote`, so that all of it is real but the person: the runtime, its hand
tracking, the loader, the program.
"""

import math
import os
import signal
import subprocess
import sys
import time

from hands import Hands
from program import Machine, Program, wait_for

# In the order of the driver.
LITTLE, RING, MIDDLE, INDEX, THUMB = range(5)
OPEN, HALF, BENT = 0.1, 0.5, 0.8

# The layout chords-bend.
CHORDS = {
    "T": [MIDDLE],
    "H": [MIDDLE, RING],
    "E": [INDEX],
    "Space": [THUMB],
    "A": [RING],
    "O": [LITTLE],
    "N": [INDEX, MIDDLE],
    "S": [THUMB, MIDDLE],
}

# The layout webcam-qwerty: the origin of its board from the start of the index fingertip, and its keys on it, in metres.
ORIGIN = (-0.040, -0.070, 0.085)
BEARING, TILT = math.radians(10), math.radians(25)
KEYS = {"F": (-0.036, 0.0), "H": (0.012, 0.0), "I": (0.060, 0.024)}

# The remote driver's tip of an open index finger, and of one that is half bent, from the grip.
OPEN_TIP = (-0.043, -0.017, -0.166)
HALF_TIP = (-0.033, -0.060, -0.129)

# A still hand has this position.
START = (0.2, 1.2, -0.35)


def main():
    root, logs = sys.argv[1:]
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    machine = Machine(root, logs)
    row = machine.doctor()
    assert row.startswith("missing headset needed the OpenXR runtime does not answer"), row
    print(f"ok: without the service, doctor says: {row}")
    service = machine.service()
    hands = Hands()
    processes = [service]
    try:
        row = machine.doctor()
        assert row.startswith("ok headset needed Monado"), row
        print(f"ok: doctor says: {row}")
        chords(machine, hands)
        board(machine, hands, processes)
        no_hand(machine, hands)
        end_while_stopped(machine, processes)
    finally:
        hands.close()
        for process in processes:
            process.kill()
            process.wait()


def chords(machine, hands):
    """Bent fingers type, wherever the hand is."""
    program = Program(machine, "chords-bend", "chords")
    try:
        wait_until_armed(program, lambda: chord(hands, "E"))
        expected = ["T", "H", "E", "Space", "T", "O", "N", "E", "S"]
        before = len(program.typed())
        for key in expected:
            chord(hands, key)
        typed = program.typed()[before:]
        assert typed == expected, (typed, program.messages)
        assert program.all_up(), program.events
        print(f"ok: typed {' '.join(typed)} with bent fingers")
    finally:
        program.stop()


def chord(hands, key):
    # The program does not trust a fingertip that is faster than a person's.
    hands.bend(CHORDS[key], BENT, 0.3)
    time.sleep(0.1)
    hands.bend(CHORDS[key], OPEN, 0.3)
    time.sleep(0.25)


def wait_until_armed(program, attempt):
    """A run is armed once the hand was clear of all keys. Its start takes a moment."""
    for _ in range(20):
        attempt()
        if program.typed():
            return
    raise AssertionError(f"nothing was typed: {program.messages}")


def board(machine, hands, processes):
    """The index finger types on a board below the hand, and a held key comes up whatever ends the tracking."""
    program = Program(machine, "webcam-qwerty", "board")
    try:
        # The open hand, held still.
        time.sleep(3)
        for key in ["H", "I"]:
            tap(hands, key)
        assert program.typed() == ["H", "I"], (program.typed(), program.messages)
        assert program.all_up(), program.events
        print("ok: typed H I by moving the hand over a board")
        hand_lost(program, hands)
        service_stopped(program, hands, processes)
        service_killed(machine, program, hands, processes)
    finally:
        program.stop()


def hand_lost(program, hands):
    hold(program, hands, "F")
    hands.show(False)
    late = wait_for("F comes up without a hand", lambda: not program.is_down("F"), 2)
    print(f"ok: F came up {late * 1000:.0f} ms after the hand was lost")
    hands.show(True)
    lift(hands, "F")
    tap_until_typed(program, hands, "H")


def service_stopped(program, hands, processes):
    """A runtime that stands still gives no pose of the past when it goes on."""
    hold(program, hands, "F")
    os.kill(processes[-1].pid, signal.SIGSTOP)
    late = wait_for("F comes up while the service stands still", lambda: not program.is_down("F"), 2)
    print(f"ok: F came up {late * 1000:.0f} ms after the service was stopped")
    time.sleep(1)
    before = len(program.typed())
    os.kill(processes[-1].pid, signal.SIGCONT)
    time.sleep(1)
    assert len(program.typed()) == before, "a key went down when the service went on"
    lift(hands, "F")
    tap_until_typed(program, hands, "H")


def service_killed(machine, program, hands, processes):
    hold(program, hands, "F")
    processes[-1].kill()
    late = wait_for("F comes up without the service", lambda: not program.is_down("F"), 2)
    processes[-1].wait()
    wait_for("the loss is said", lambda: program.said("lost openxr:"), 2)
    print(f"ok: F came up {late * 1000:.0f} ms after the service was killed: {line(program, 'lost openxr:')}")
    processes.append(machine.service())
    wait_for("it reconnects", lambda: program.said("reconnected to openxr:"), 20)
    print(f"ok: {line(program, 'reconnected to openxr:')}")
    before = len(program.typed())
    time.sleep(1)
    assert len(program.typed()) == before, "a key went down when the hand came back on it"
    lift(hands, "F")
    tap_until_typed(program, hands, "H")
    print("ok: it types again after the service was started again")


def no_hand(machine, hands):
    """A person who sees nothing happen is told why."""
    hands.show(False)
    program = Program(machine, "chords-bend", "no-hand")
    try:
        wait_for("the absence of hands is said", lambda: program.said("no hand was tracked for 5 s"), 15)
        print(f"ok: {line(program, 'no hand was tracked')}")
    finally:
        program.stop()
        hands.show(True)


def end_while_stopped(machine, processes):
    """A runtime that stands still does not keep the program from ending."""
    program = Program(machine, "chords-bend", "end")
    wait_for("it listens", lambda: program.said("listening to openxr:"), 20)
    time.sleep(1)
    os.kill(processes[-1].pid, signal.SIGSTOP)
    time.sleep(0.5)
    began = time.monotonic()
    program.stop()
    print(f"ok: it ended {time.monotonic() - began:.1f} s after Ctrl-C while the service stands still")


def line(program, text):
    return next(message for message in program.messages if text in message)


def above(key, height):
    """The grip at which the half-bent index finger is at a height above a key, in metres along the normal of the board."""
    x, y = KEYS[key]
    # Board axes in the world: +X along the rows, +Y away from the person, +Z out of the board.
    along = (math.cos(BEARING), 0, math.sin(BEARING))
    ahead = (math.sin(BEARING), 0, -math.cos(BEARING))
    away = tuple(math.cos(TILT) * a + (math.sin(TILT) if i == 1 else 0) for i, a in enumerate(ahead))
    out = tuple((math.cos(TILT) if i == 1 else 0) - math.sin(TILT) * a for i, a in enumerate(ahead))
    shift = tuple(ORIGIN[0] * along[i] - ORIGIN[2] * ahead[i] + (ORIGIN[1] if i == 1 else 0) for i in range(3))
    start = tuple(s + t for s, t in zip(START, OPEN_TIP))
    target = tuple(start[i] + shift[i] + x * along[i] + y * away[i] + height * out[i] for i in range(3))
    return tuple(p - t for p, t in zip(target, HALF_TIP))


def hover(hands, key):
    hands.bend([INDEX], HALF)
    hands.move(above(key, 0.03))


def tap(hands, key):
    hover(hands, key)
    hands.move(above(key, -0.012), 0.15)
    time.sleep(0.05)
    hands.move(above(key, 0.03), 0.15)
    time.sleep(0.1)


def lift(hands, key):
    hands.move(above(key, 0.03), 0.15)
    # The keys count again once the hand was seen off them.
    time.sleep(0.6)


def hold(program, hands, key):
    hover(hands, key)
    hands.move(above(key, -0.012), 0.15)
    wait_for(f"{key} goes down", lambda: program.is_down(key), 2)


def tap_until_typed(program, hands, key):
    before = len(program.typed())
    for _ in range(10):
        tap(hands, key)
        if len(program.typed()) > before:
            assert program.typed()[before:] == [key], program.typed()
            return
    raise AssertionError(f"{key} was not typed: {program.messages}")


main()
