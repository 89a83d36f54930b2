#!/usr/bin/env python3
"""Sends the hands that a webcam sees as lines of JSON, for `protocol=hand-landmarks` of Ademán. With `--holistic` the
lines contain the body too, for `protocol=holistic`.

Install:  python3 -m pip install mediapipe opencv-python
Models:   hand_landmarker.task from https://ai.google.dev/edge/mediapipe/solutions/vision/hand_landmarker
          holistic_landmarker.task from https://ai.google.dev/edge/mediapipe/solutions/vision/holistic_landmarker

Run:      python3 mediapipe_webcam.py hand_landmarker.task | ademan run --source 'stdin:?protocol=hand-landmarks'
          python3 mediapipe_webcam.py hand_landmarker.task --udp 127.0.0.1:9000
          python3 mediapipe_webcam.py --holistic holistic_landmarker.task | ademan run --source 'stdin:?protocol=holistic'
          python3 mediapipe_webcam.py --from results.json

The image is not flipped, so that the options `mirrored` and `swap_hands` keep their defaults. MediaPipe before 0.10.15
labels hands as if it were flipped: use `swap_hands=yes`. `--from` plays a file of results in place of the webcam, such as
test data: {"image_size": [w, h], "samples": [{"label": "Right", "image": [[x, y, z], ...], "world": [...]}, ...]}. A sample
may have a body: "body": [[x, y, z, visibility], ...].
"""

import argparse
import json
import math
import os
import socket
import sys
import time

MODELS = "https://ai.google.dev/edge/mediapipe/solutions/vision/"

LANDMARKS = 21
BODY_LANDMARKS = 33


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


def open_landmarker(vision, base_options, is_holistic):
    """Returns a landmarker of MediaPipe, and the function that reads its results."""
    mode = vision.RunningMode.VIDEO
    if is_holistic:
        options = vision.HolisticLandmarkerOptions(base_options=base_options, running_mode=mode)
        return vision.HolisticLandmarker.create_from_options(options), whole_of
    options = vision.HandLandmarkerOptions(base_options=base_options, running_mode=mode, num_hands=2)
    return vision.HandLandmarker.create_from_options(options), hands_of


def check_model(model, is_holistic):
    """Ends the program with a message if there is no model file."""
    if os.path.isfile(model):
        return
    name = "holistic_landmarker" if is_holistic else "hand_landmarker"
    sys.exit(f"there is no model file {model!r}: download {name}.task from {MODELS}{name} and name its path")


def webcam_lines(model, camera, is_holistic):
    """Yields a line for each image of a webcam."""
    try:
        import cv2
        import mediapipe
    except ImportError as error:
        sys.exit(f"{error}; install what is missing: python3 -m pip install mediapipe opencv-python")

    vision = mediapipe.tasks.vision
    base_options = mediapipe.tasks.BaseOptions(model_asset_path=model)
    capture = cv2.VideoCapture(camera)
    if not capture.isOpened():
        sys.exit(f"cannot open camera {camera}: choose another one with --camera")
    start = time.monotonic_ns()
    landmarker, found_in = open_landmarker(vision, base_options, is_holistic)
    with landmarker:
        while True:
            is_read, bgr = capture.read()
            if not is_read:
                sys.exit(f"camera {camera} sends no more images: is it unplugged or in use?")
            time_us = (time.monotonic_ns() - start) // 1000
            rgb = cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB)
            image = mediapipe.Image(image_format=mediapipe.ImageFormat.SRGB, data=rgb)
            result = landmarker.detect_for_video(image, time_us // 1000)
            height, width = bgr.shape[:2]
            yield line(time_us, (width, height), *found_in(result))


def file_lines(path, rate_hz):
    """Yields a line for each result of a file."""
    with open(path, encoding="utf-8") as file:
        results = json.load(file)
    size = results.get("image_size", [640, 480])
    if not isinstance(size, list):
        size = [640, 480]
    for number, sample in enumerate(results["samples"], 1):
        found = hand(sample["label"], sample.get("score", 1.0), sample["image"], sample["world"])
        yield line(round(number * 1e6 / rate_hz), size, [found], sample.get("body"))


def sender(udp):
    """Returns a function that sends a line: to the standard output, or as a datagram."""
    if udp is None:
        return lambda text: print(text, flush=True)
    host, _, port = udp.rpartition(":")
    channel = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    return lambda text: channel.sendto(text.encode(), (host, int(port)))


def main():
    parser = argparse.ArgumentParser(description="Send the hands that a webcam sees as lines of JSON.")
    parser.add_argument("model", nargs="?", help="model file of the hand landmarker of MediaPipe")
    parser.add_argument("--holistic", metavar="MODEL", help="model file of the holistic landmarker: the body too")
    parser.add_argument("--camera", type=int, default=0, help="number of the webcam (default: 0)")
    parser.add_argument("--udp", metavar="HOST:PORT", help="send datagrams in place of the standard output")
    parser.add_argument("--from", dest="file", help="play a file of results in place of the webcam")
    parser.add_argument("--rate-hz", type=float, default=30.0, help="results per second of a file (default: 30)")
    arguments = parser.parse_args()
    given = [arguments.model, arguments.holistic, arguments.file]
    if sum(name is not None for name in given) != 1:
        parser.error("name one model file, hand_landmarker.task or --holistic holistic_landmarker.task, or results with --from")
    if arguments.file is None:
        model = arguments.holistic or arguments.model
        check_model(model, arguments.holistic is not None)
        lines = webcam_lines(model, arguments.camera, arguments.holistic is not None)
    else:
        lines = file_lines(arguments.file, arguments.rate_hz)
    send = sender(arguments.udp)
    try:
        for text in lines:
            send(text)
    except (BrokenPipeError, KeyboardInterrupt):
        # The receiver or the person has ended. Nothing is left to flush.
        sys.stderr.close()


if __name__ == "__main__":
    main()
