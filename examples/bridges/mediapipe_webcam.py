#!/usr/bin/env python3
"""Sends the hands that a webcam sees as lines of JSON, for `protocol=hand-landmarks` of Ademán. With `--holistic` the
lines contain the body too, for `protocol=holistic`, and with `--body` the body alone, for `protocol=body-landmarks`.

Install:  python3 -m pip install mediapipe opencv-python
          where the system manages this Python, as on Debian, in an environment:
          python3 -m venv ~/ademan-python && ~/ademan-python/bin/pip install mediapipe opencv-python
Models:   hand_landmarker.task from https://ai.google.dev/edge/mediapipe/solutions/vision/hand_landmarker
          holistic_landmarker.task from https://ai.google.dev/edge/mediapipe/solutions/vision/holistic_landmarker
          pose_landmarker.task from https://ai.google.dev/edge/mediapipe/solutions/vision/pose_landmarker

Run:      python3 mediapipe_webcam.py hand_landmarker.task | ademan run --source 'stdin:?protocol=hand-landmarks'
          python3 mediapipe_webcam.py hand_landmarker.task --camera 1 --udp 127.0.0.1:9000
          python3 mediapipe_webcam.py hand_landmarker.task --camera film.mp4
          python3 mediapipe_webcam.py --holistic holistic_landmarker.task | ademan run --source 'stdin:?protocol=holistic'
          python3 mediapipe_webcam.py --from results.json

The image is not flipped, so that the options `mirrored` and `swap_hands` keep their defaults. MediaPipe before 0.10.15
labels hands as if it were flipped: use `swap_hands=yes`. `--camera` is the number or path of a camera, a film, or a photo,
which gives one line. `--from` plays a file of results in place of the webcam, such as
test data: {"image_size": [w, h], "samples": [{"label": "Right", "image": [[x, y, z], ...], "world": [...]}, ...]}. A sample
may have a body, "body": [[x, y, z, visibility], ...], and no hand. Films and results are sent as fast as they were taken; `--fast` does not
wait.
"""

import argparse
import itertools
import json
import math
import os
import socket
import sys
import sysconfig
import time

MODELS = "https://ai.google.dev/edge/mediapipe/solutions/vision/"

LANDMARKS = 21
BODY_LANDMARKS = 33

PHOTOS = (".bmp", ".jpeg", ".jpg", ".png", ".webp")


def hand(label, score, image, world):
    """Returns one hand of a line. The lists have three numbers for each landmark."""
    return {"label": label.lower(), "score": score, "image": image, "world": world}


def probabilities(body):
    """Returns the landmarks of a body with visibilities from 0 to 1. Some holistic models give logits instead."""
    if all(0.0 <= point[3] <= 1.0 for point in body):
        return body
    logistic = lambda logit: 1.0 / (1.0 + math.exp(-max(-50.0, min(50.0, logit))))
    return [[*point[:3], logistic(point[3])] for point in body]


def line(time_us, image_size, hands, body=None):
    """Returns a line without its end. Hands and bodies with numbers that are not finite are left out: JSON has none."""
    lists = ("image", "world")
    is_whole = lambda hand: all(
        len(hand[name]) == LANDMARKS and all(map(math.isfinite, sum(hand[name], [])))
        for name in lists
    )
    message = {
        "time_us": time_us,
        "image_size": list(image_size),
        "hands": [hand for hand in hands if is_whole(hand)],
    }
    if body and len(body) == BODY_LANDMARKS and all(map(math.isfinite, sum(body, []))):
        message["pose_world_landmarks"] = probabilities(body)
    return json.dumps(message, separators=(",", ":"), allow_nan=False)


def numbers(points):
    """Returns the coordinates of landmarks of MediaPipe."""
    return [[point.x, point.y, point.z] for point in points]


def hands_of(result):
    """Returns the hands of a result of MediaPipe's hand landmarker, and no body."""
    found = zip(result.handedness, result.hand_landmarks, result.hand_world_landmarks)
    hands = [
        hand(side[0].category_name, side[0].score, numbers(image), numbers(world))
        for side, image, world in found
    ]
    return hands, None


def whole_of(result):
    """Returns the hands and the body of a result of MediaPipe's holistic landmarker."""
    found = [
        ("left", result.left_hand_landmarks, result.left_hand_world_landmarks),
        ("right", result.right_hand_landmarks, result.right_hand_world_landmarks),
    ]
    hands = [hand(side, 1.0, numbers(image), numbers(world)) for side, image, world in found]
    body = [[p.x, p.y, p.z, p.visibility or 0.0] for p in result.pose_world_landmarks]
    return hands, body


def body_of(result):
    """Returns no hands, and the body of a result of MediaPipe's pose landmarker."""
    bodies = [[[p.x, p.y, p.z, p.visibility or 0.0] for p in body] for body in result.pose_world_landmarks]
    return [], bodies[0] if bodies else None


def open_landmarker(vision, base_options, kind):
    """Returns a landmarker of MediaPipe, and the function that reads its results."""
    mode = vision.RunningMode.VIDEO
    if kind == "holistic_landmarker":
        options = vision.HolisticLandmarkerOptions(base_options=base_options, running_mode=mode)
        return vision.HolisticLandmarker.create_from_options(options), whole_of
    if kind == "pose_landmarker":
        options = vision.PoseLandmarkerOptions(base_options=base_options, running_mode=mode)
        return vision.PoseLandmarker.create_from_options(options), body_of
    options = vision.HandLandmarkerOptions(base_options=base_options, running_mode=mode, num_hands=2)
    return vision.HandLandmarker.create_from_options(options), hands_of


def check_model(model, kind):
    """Ends the program with a message if there is no model file."""
    if not os.path.isfile(model):
        sys.exit(f"there is no model file {model!r}: download {kind}.task from {MODELS}{kind} and name its path")


def check_camera(camera):
    """Ends the program with a message if a path names nothing."""
    if not camera.isdigit() and not os.path.exists(camera):
        sys.exit(f"there is no camera, film or photo {camera!r}: name a number, such as 0, or a path")


def images(cv2, camera):
    """Yields the images of a camera, a film or a photo, with their times in microseconds."""
    is_file = os.path.isfile(camera)
    photo = cv2.imread(camera) if is_file and camera.lower().endswith(PHOTOS) else None
    if photo is not None:
        yield 0, photo
        return
    capture = cv2.VideoCapture(int(camera) if camera.isdigit() else camera)
    if not capture.isOpened():
        sys.exit(f"cannot open camera {camera}: is it in use? Choose another one with --camera")
    rate_hz = capture.get(cv2.CAP_PROP_FPS) or 30.0
    start = time.monotonic_ns()
    for number in itertools.count():
        is_read, bgr = capture.read()
        if not is_read and is_file:
            return
        if not is_read:
            sys.exit(f"camera {camera} sends no more images: is it unplugged or in use?")
        yield round(number * 1e6 / rate_hz) if is_file else (time.monotonic_ns() - start) // 1000, bgr


def install_command():
    """Returns the command that installs the packages: into an environment where the system manages this Python."""
    packages = "mediapipe opencv-python"
    marker = os.path.join(sysconfig.get_path("stdlib"), "EXTERNALLY-MANAGED")
    if sys.prefix != sys.base_prefix or not os.path.exists(marker):
        return f"{sys.executable} -m pip install {packages}"
    folder = "~/ademan-python"
    return (
        f"{sys.executable} -m venv {folder} && {folder}/bin/pip install {packages}, "
        f"and use its Python: --python {folder}/bin/python3"
    )


def webcam_lines(model, camera, kind):
    """Yields the time and the line of each image of a webcam."""
    try:
        import cv2
        import mediapipe
    except ImportError as error:
        sys.exit(f"{error}; install what is missing: {install_command()}")

    vision = mediapipe.tasks.vision
    base_options = mediapipe.tasks.BaseOptions(model_asset_path=model)
    try:
        landmarker, found_in = open_landmarker(vision, base_options, kind)
    except (RuntimeError, ValueError) as error:
        sys.exit(f"MediaPipe cannot read {model!r} as a {kind}: {error}")
    with landmarker:
        for time_us, bgr in images(cv2, camera):
            rgb = cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB)
            image = mediapipe.Image(image_format=mediapipe.ImageFormat.SRGB, data=rgb)
            result = landmarker.detect_for_video(image, time_us // 1000)
            height, width = bgr.shape[:2]
            yield time_us, line(time_us, (width, height), *found_in(result))


def file_lines(path, rate_hz):
    """Yields the time and the line of each result of a file."""
    try:
        with open(path, encoding="utf-8") as file:
            results = json.load(file)
        samples = results["samples"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        sys.exit(f"cannot read results from {path!r}: {error}")
    size = results.get("image_size", [640, 480])
    if not isinstance(size, list):
        size = [640, 480]
    for number, sample in enumerate(samples, 1):
        found = [hand(sample["label"], sample.get("score", 1.0), sample["image"], sample["world"])] if "label" in sample else []
        time_us = round(number * 1e6 / rate_hz)
        yield time_us, line(time_us, size, found, sample.get("body"))


def paced(lines):
    """Yields lines at their times after the first one."""
    start = None
    for time_us, text in lines:
        now = time.monotonic() - time_us / 1e6
        start = now if start is None else start
        time.sleep(max(0.0, start - now))
        yield time_us, text


def sender(udp):
    """Returns a function that sends a line: to the standard output, or as a datagram."""
    if udp is None:
        return lambda text: print(text, flush=True)
    host, _, port = udp.rpartition(":")
    channel = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    return lambda text: channel.sendto(text.encode(), (host, int(port)))


def main():
    parser = argparse.ArgumentParser(prog="mediapipe_webcam.py", description="Send the hands that a webcam sees as lines of JSON.")
    parser.add_argument("model", nargs="?", help="model file of the hand landmarker of MediaPipe")
    parser.add_argument("--holistic", metavar="MODEL", help="model file of the holistic landmarker: the body too")
    parser.add_argument("--body", metavar="MODEL", help="model file of the pose landmarker: the body alone")
    parser.add_argument("--camera", default="0", help="number or path of the webcam, or a film or photo (default: 0)")
    parser.add_argument("--udp", metavar="HOST:PORT", help="send datagrams in place of the standard output")
    parser.add_argument("--from", dest="file", help="play a file of results in place of the webcam")
    parser.add_argument("--rate-hz", type=float, default=30.0, help="results per second of a file (default: 30)")
    parser.add_argument("--fast", action="store_true", help="send films and results at once")
    arguments = parser.parse_args()
    models = {"hand_landmarker": arguments.model, "holistic_landmarker": arguments.holistic, "pose_landmarker": arguments.body}
    given = [(kind, model) for kind, model in models.items() if model is not None]
    if len(given) + (arguments.file is not None) != 1:
        parser.error("name one model file, hand_landmarker.task or --holistic holistic_landmarker.task, or results with --from")
    if arguments.file is None:
        [(kind, model)] = given
        check_model(model, kind)
        check_camera(arguments.camera)
        lines = webcam_lines(model, arguments.camera, kind)
    else:
        lines = file_lines(arguments.file, arguments.rate_hz)
    is_file = arguments.file is not None or os.path.isfile(arguments.camera)
    lines = paced(lines) if is_file and not arguments.fast else lines
    send = sender(arguments.udp)
    try:
        for _, text in lines:
            send(text)
    except (BrokenPipeError, KeyboardInterrupt):
        # The receiver or the person has ended. Nothing is left to flush.
        sys.stderr.close()


if __name__ == "__main__":
    main()
