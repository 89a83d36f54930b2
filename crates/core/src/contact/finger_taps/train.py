#!/usr/bin/env python3
"""Trains the model of finger taps: writes `weights.bin`, which stands beside this file.

    pip install numpy torch
    python train.py train.json weights.bin

The clips come from `finger-taps`: 15 pictures of 21 landmarks of a hand, with the fingers that tapped. Networks see the movement of the hand in
breadths of its palm around the moment at which the fingers press, x and y only, as `features.rs` computes it. They tell 32 sets of
fingers apart: three networks with convolutions over time, and one without. Each step sees other clips: turned, stretched in space and
time, moved, with noise. Inputs are whitened by their covariance within the sets; the whitening is part of the first weights in the file.

The seeds are fixed, but another version of PyTorch gives other weights of about the same quality.
"""

import json
import struct
import sys

import numpy as np
import torch
from torch.nn.functional import cross_entropy, dropout, pad

SETS = 32
TIPS = [4, 8, 12, 16, 20]
LAST = 14  # the last picture
BATCH = 64


def load(path):
    """Returns the landmarks of clips, and their sets of fingers as bits."""
    clips = json.load(open(path))
    points = np.array([clip["x"] for clip in clips], float)[..., :2]
    sets = [sum(1 << finger for finger in clip["y"] if finger >= 0) for clip in clips]
    return points, np.array(sets)


def normalize(points):
    """Returns clips in breadths of the palm, and the moment of the press of each clip."""
    direction = (points[:, :3, 9] - points[:, :3, 0]).mean(1)
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    along = ((points[:, :, TIPS] - points[:, :, :1]) * direction[:, None, None]).sum(-1)
    energy = (np.maximum(np.diff(along, axis=1), 0) ** 2).sum(2) + 1e-9
    spent = np.cumsum(energy, 1) / energy.sum(1, keepdims=True)
    spent = np.concatenate([np.zeros((len(points), 1)), spent], 1)
    moments = [np.interp(0.5, one, np.arange(LAST + 1)) for one in spent]
    breadth = np.linalg.norm((points[:, :3, 5] - points[:, :3, 17]).mean(1), axis=-1)
    start = points[:, :3, 0].mean(1)[:, None, None]
    normal = (points - start) / breadth[:, None, None, None]
    return torch.tensor(normal, dtype=torch.float32), torch.tensor(np.array(moments), dtype=torch.float32)


def numbers(points, times):
    """Returns the 42 numbers of each moment: 20 points from the wrist, then the wrist."""
    times = times.clamp(0, LAST)
    first = times.floor().clamp(max=LAST - 1).long()
    part = (times - first)[..., None, None]
    clips = torch.arange(len(points))[:, None]
    at = points[clips, first] * (1 - part) + points[clips, first + 1] * part
    return torch.cat([(at[:, :, 1:] - at[:, :, :1]).flatten(2), at[:, :, 0]], 2)


def varied(points, moments, sets, steps):
    """Returns other clips of the same taps, and their moments."""
    count = len(points)
    even = lambda *shape: 2 * torch.rand(*shape) - 1
    angle = 0.05 * torch.randn(count)
    x = 1 + 0.08 * even(count)
    y = x * (1 + 0.07 * even(count))
    cos, sin = angle.cos(), angle.sin()
    turn = torch.stack([torch.stack([cos * x, -sin * y], 1), torch.stack([sin * x, cos * y], 1)], 1)
    points = torch.einsum("ntpx,nyx->ntpy", points, turn) + 0.01 * torch.randn(points.shape)
    times = moments[:, None] + 0.8 * torch.randn(count, 1) + steps * (1 + 0.25 * even(count, 1))
    # The moment of a clip without a tap means nothing.
    return points, times + (sets == 0)[:, None] * 6 * even(count, 1)


class Layer:
    def __init__(self, networks, inputs, outputs, gain=1.0):
        weights = torch.randn(networks, inputs, outputs) * gain * (2 / inputs) ** 0.5
        self.weights = weights.requires_grad_()
        self.offsets = torch.zeros(networks, 1, outputs, requires_grad=True)

    def __call__(self, values):
        return torch.baddbmm(self.offsets, values, self.weights)


class Convolved:
    """Networks with three convolutions over 15 pictures, the last two beside what they are applied to."""

    steps, shrinkage, rounds, seed = torch.arange(-6, 9), 0.02, 1700, 11

    def __init__(self, networks, width=48):
        self.convolutions = [Layer(networks, 3 * inputs, width) for inputs in (42, width, width)]
        self.layers = self.convolutions + [Layer(networks, 7 * width, 64), Layer(networks, 64, SETS, 0.3)]

    def whitened(self, values):
        """What belongs together: the numbers of a picture."""
        return values.reshape(-1, 42)

    def __call__(self, values, drop):
        networks, clips, pictures, _ = values.shape
        values = drop(values, 0.1)
        for index, layer in enumerate(self.convolutions):
            padded = pad(values, (0, 0, 1, 1))
            inputs = torch.cat([padded[:, :, step : step + pictures] for step in range(3)], 3)
            outputs = torch.relu(layer(inputs.flatten(1, 2))).reshape(networks, clips, pictures, -1)
            values = drop(outputs if index == 0 else values + outputs, 0.2)
        pairs = values[:, :, :14].reshape(networks, clips, 7, 2, -1).amax(3).flatten(2)
        return self.layers[4](drop(torch.relu(self.layers[3](pairs)), 0.2))

    def folded(self, network, whitening):
        """Returns the first weights with the whitening in them."""
        return torch.cat([whitening @ part for part in self.layers[0].weights[network].split(42)])


class Dense:
    """Networks that see twelve pictures at once."""

    steps, shrinkage, rounds, seed = torch.arange(-4, 8), 0.05, 1000, 12

    def __init__(self, networks, width=64):
        self.layers = [Layer(networks, 12 * 42, width), Layer(networks, width, width), Layer(networks, width, SETS, 0.3)]

    def whitened(self, values):
        return values.flatten(1)

    def __call__(self, values, drop):
        values = drop(values.flatten(2), 0.1)
        for layer in self.layers[:2]:
            values = drop(torch.relu(layer(values)), 0.2)
        return self.layers[2](values)

    def folded(self, network, whitening):
        return whitening @ self.layers[0].weights[network]


def whitening(kind, points, moments, sets):
    """Returns the means of the inputs, and the matrix that makes their covariance within the sets the unit matrix."""
    values, means = [], []
    for _ in range(6):
        values.append(numbers(*varied(points, moments, sets, kind.steps)))
    values, sets = torch.cat(values).double(), sets.repeat(6)
    means = torch.stack([values[sets == one].mean(0) for one in range(SETS)])
    inside = kind.whitened(kind, values - means[sets])
    covariance = inside.T @ inside / len(inside)
    size = len(covariance)
    even = covariance.trace() / size * torch.eye(size, dtype=torch.double)
    scales, axes = torch.linalg.eigh((1 - kind.shrinkage) * covariance + kind.shrinkage * even)
    return kind.whitened(kind, values).mean(0).float(), (axes / scales.sqrt()).float()


def train(kind, count, points, moments, sets):
    """Trains `count` networks at once. Returns them with the means and the whitening of their inputs."""
    torch.manual_seed(kind.seed)
    random = np.random.default_rng(kind.seed)
    means, matrix = whitening(kind, points, moments, sets)
    networks = kind(count)
    numbers_to_learn = [it for layer in networks.layers for it in (layer.weights, layer.offsets)]
    optimizer = torch.optim.AdamW(numbers_to_learn, lr=2e-3, weight_decay=0.02, betas=(0.9, 0.98))
    orders = [np.empty(0, int)] * count
    for step in range(kind.rounds):
        rate = 2e-3 * min(1, step / 50) * (0.5 + 0.5 * np.cos(np.pi * step / kind.rounds))
        optimizer.param_groups[0]["lr"] = rate
        for network in range(count):
            if len(orders[network]) < BATCH:
                orders[network] = np.concatenate([orders[network], random.permutation(len(points))])
        chosen = torch.tensor(np.concatenate([order[:BATCH] for order in orders]))
        orders = [order[BATCH:] for order in orders]
        values = numbers(*varied(points[chosen], moments[chosen], sets[chosen], kind.steps))
        shape = (count, BATCH, len(kind.steps), 42)
        white = ((kind.whitened(kind, values) - means) @ matrix).reshape(shape)
        scores = networks(white, dropout)
        loss = count * cross_entropy(scores.flatten(0, 1), sets[chosen], label_smoothing=0.05)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        if step % 200 == 0:
            print(f"{kind.__name__}, step {step}: loss {loss.item() / count:.3f}", flush=True)
    return networks, means, matrix


def written(weights, offsets):
    """Returns the bytes of a layer: weights of 8 bits with a scale for each output."""
    rows = weights.detach().numpy().T
    offsets = offsets.detach().numpy().ravel()
    result = struct.pack("<II", rows.shape[1], rows.shape[0])
    for row, offset in zip(rows, offsets):
        scale = np.float32(max(np.abs(row).max(), 1e-30) / 127)
        result += struct.pack("<ff", offset, scale) + np.round(row / scale).astype(np.int8).tobytes()
    return result


def main(source, target):
    torch.set_num_threads(1)
    points, sets = load(source)
    points, moments = normalize(points)
    sets = torch.tensor(sets)
    counts = {Convolved: 3, Dense: 1}
    result = b"ademtap2" + struct.pack("<II", *counts.values())
    for kind, count in counts.items():
        networks, means, matrix = train(kind, count, points, moments, sets)
        for network in range(count):
            result += struct.pack("<I", len(means)) + means.numpy().astype("<f4").tobytes()
            result += written(networks.folded(network, matrix), networks.layers[0].offsets[network])
            for layer in networks.layers[1:]:
                result += written(layer.weights[network], layer.offsets[network])
    open(target, "wb").write(result)


if __name__ == "__main__":
    main(*sys.argv[1:])
