"""Prints results of a hand tracker for a hand that moves in front of a webcam, as JSON for the bridge of the webcam.

    webcam_hand.py mouse     holds the open hand still, moves right, clicks, drags down, and closes while it moves back
    webcam_hand.py type XY   holds the open hand still, then taps keys at these places on the board: X,Y in mm for each key
    webcam_hand.py away      holds the open hand still and then only moves

A model of its own: lengths of a hand in metres, a pinhole camera of 60°, and noise. It knows the board from its layout file.
"""

import json
import math
import random
import sys

RATE_HZ = 30
SIZE = (640, 480)
FOCAL = 0.5 / math.tan(math.radians(30))
NOISE = 0.0005

# Of each finger: the knuckle (to the little finger's side, along the fingers), and the lengths of its bones.
FINGERS = {
    "index": ((-0.025, 0.090), (0.042, 0.026, 0.020)),
    "middle": ((-0.003, 0.094), (0.046, 0.030, 0.021)),
    "ring": ((0.018, 0.088), (0.042, 0.028, 0.021)),
    "little": ((0.037, 0.078), (0.034, 0.021, 0.019)),
}
OPEN_THUMB = [(-0.028, 0.025, -0.006), (-0.052, 0.050, -0.014), (-0.070, 0.074, -0.020), (-0.084, 0.096, -0.024)]


def finger(name, bends):
    """Returns four points: to the side, along the straight fingers, and out of the back of the hand."""
    (side, along), bones = FINGERS[name]
    points, angle, out = [(side, along, 0.0)], 0.0, 0.0
    for bone, bend in zip(bones, bends):
        angle += math.radians(bend)
        along, out = along + bone * math.cos(angle), out - bone * math.sin(angle)
        points.append((side, along, out))
    return points


def between(one, other, fraction):
    return tuple(a + (b - a) * fraction for a, b in zip(one, other))


def hand(curl, pinch, index_bend=8.0):
    """Returns the 21 landmarks of a right hand. `curl` bends three fingers, `pinch` brings thumb and index finger together."""
    curled = (70 * curl + 4, 90 * curl + 6, 40 * curl + 3)
    bends = {name: curled for name in ("middle", "ring", "little")}
    straight = (index_bend / 2, index_bend, index_bend / 2)
    bends["index"] = between(straight, (42.0, 52.0, 18.0), pinch)
    if curl > 0.9 and index_bend > 60:
        bends["index"] = (72.0, 95.0, 45.0)
    fingers = {name: finger(name, bends[name]) for name in FINGERS}
    tip = fingers["index"][3]
    touching = [OPEN_THUMB[0], (-0.045, 0.052, -0.024), (-0.042, 0.084, -0.040), (tip[0] - 0.006, tip[1] - 0.006, tip[2] - 0.006)]
    crossed = [OPEN_THUMB[0], (-0.046, 0.050, -0.026), (-0.034, 0.072, -0.044), (-0.012, 0.080, -0.058)]
    is_fist = curl > 0.9 and index_bend > 60
    thumb = crossed if is_fist else [between(a, b, pinch) for a, b in zip(OPEN_THUMB, touching)]
    return [(0.0, 0.0, 0.0), *thumb, *fingers["index"], *fingers["middle"], *fingers["ring"], *fingers["little"]]


# The landmarks of the index finger that a film moves.
KNUCKLE, TIP = 5, 8


def placed(landmarks, turn, place, point):
    """Turns a hand that points up and shows its palm to the camera forwards by `turn` degrees, with the landmark `point` at `place`."""
    sin, cos = math.sin(math.radians(turn)), math.cos(math.radians(turn))
    # To the right, up and towards the person, who looks at the camera.
    turned = [(side, along * cos + out * sin, out * cos - along * sin) for side, along, out in landmarks]
    offset = [goal - own for goal, own in zip(place, turned[point])]
    return [tuple(a + b for a, b in zip(point, offset)) for point in turned]


def sample(points, noise):
    """Returns what a tracker reports of points in the world of the person, whose origin is the camera."""
    seen = [(-x + noise.gauss(0, NOISE), -y + noise.gauss(0, NOISE), z) for x, y, z in points]
    ratio = SIZE[0] / SIZE[1]
    image = [(0.5 + FOCAL * x / z, 0.5 + FOCAL * y / z * ratio, 0.0) for x, y, z in seen]
    middle = [sum(axis) / len(seen) for axis in zip(*seen)]
    world = [[a - b for a, b in zip(point, middle)] for point in seen]
    return {"label": "Right", "score": 0.98, "image": image, "world": world}


class Film:
    def __init__(self, turn, place, point=TIP):
        self.turn, self.place, self.point, self.state, self.samples = turn, place, point, (0.0, 0.0, 8.0), []
        self.noise = random.Random(7)

    def go(self, seconds, place=None, state=None):
        """Moves smoothly to a place of the landmark and a posture (curl, pinch, bend of the index finger)."""
        place, state = place or self.place, state or self.state
        count = max(1, round(seconds * RATE_HZ))
        for number in range(1, count + 1):
            fraction = 0.5 - 0.5 * math.cos(math.pi * number / count)
            points = hand(*between(self.state, state, fraction))
            at = between(self.place, place, fraction)
            self.samples.append(sample(placed(points, self.turn, at, self.point), self.noise))
        self.place, self.state = place, state

    def hide(self, seconds):
        self.samples += [{}] * round(seconds * RATE_HZ)

    def print(self):
        print(json.dumps({"image_size": SIZE, "samples": self.samples}))


def moved(place, x=0.0, y=0.0, z=0.0):
    return (place[0] + x, place[1] + y, place[2] + z)


def mouse():
    # The palm rests while the fingers pinch and close.
    film = Film(10, (0.02, -0.01, 0.5), KNUCKLE)
    film.go(3.5)
    film.go(1.0, moved(film.place, x=0.12))
    film.go(0.6)
    for _ in range(2):
        film.go(0.4, state=(0.0, 1.0, 8.0))
        film.go(0.3)
        film.go(0.4, state=(0.0, 0.0, 8.0))
        film.go(0.6)
    film.go(0.4, state=(0.0, 1.0, 8.0))
    film.go(0.3)
    film.go(0.8, moved(film.place, y=-0.08))
    film.go(0.4, state=(0.0, 0.0, 8.0))
    film.go(0.6)
    # A fist, the way back, and the hand leaves the picture.
    film.go(0.4, state=(1.0, 0.0, 80.0))
    film.go(0.3)
    film.go(0.8, moved(film.place, x=-0.15))
    film.hide(0.7)
    film.go(0.5, state=(0.0, 0.0, 8.0))
    film.print()


def typed(places):
    tilt, bearing = math.radians(25), math.radians(10)
    film = Film(100, (0.0, 0.02, 0.5))
    start = film.place
    film.go(3.5)
    for place in places:
        x, y = (float(number) / 1000 for number in place.split(","))

        def above(height):
            right = x - 0.040
            up = height * math.cos(tilt) + y * math.sin(tilt) - 0.070
            forward = y * math.cos(tilt) - height * math.sin(tilt) - 0.085
            sin, cos = math.sin(bearing), math.cos(bearing)
            return moved(start, x=right * cos + forward * sin, y=up, z=right * sin - forward * cos)

        film.go(0.7, above(0.035), (1.0, 0.0, 12.0))
        film.go(0.3)
        film.go(0.3, above(-0.006))
        film.go(0.15)
        film.go(0.3, above(0.035))
    film.go(1.0, start, (0.0, 0.0, 8.0))
    film.print()


def away():
    film = Film(10, (0.02, 0.05, 0.5))
    film.go(1.5)
    for _ in range(8):
        film.go(0.5, moved(film.place, x=0.08))
        film.go(0.5, moved(film.place, x=-0.08))
    film.print()


if sys.argv[1] == "mouse":
    mouse()
elif sys.argv[1] == "type":
    typed(sys.argv[2:])
else:
    away()
