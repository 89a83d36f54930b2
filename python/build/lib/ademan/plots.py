"""Drawings of layouts and recordings with matplotlib (`pip install ademan[plots]`)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from .layouts import Layout
from .recordings import Recording


def board(layout: Layout, values: Mapping[str, float] | None = None, board: int = 0, axes: Any = None) -> Any:
    """Draw the targets of a board in millimetres, colored by a value for each target, and return the axes.

    Targets without a value stay white.
    """
    import matplotlib.pyplot as plt
    from matplotlib.patches import Ellipse, Rectangle

    if axes is None:
        _, axes = plt.subplots(figsize=(9, 3.5))
    colors = plt.get_cmap("YlOrRd")
    largest = max(values.values(), default=0.0) if values else 0.0
    targets = [target for target in layout.targets if target.board == board]
    for target in targets:
        x, y = (1000 * value for value in target.center_m)
        width, height = (1000 * value for value in target.size_m)
        value = values.get(target.name) if values else None
        color = "white" if value is None or largest == 0 else colors(0.8 * value / largest)
        turn = math.degrees(target.rotation_rad)
        if target.is_disc:
            patch: Any = Ellipse((x, y), width, height, facecolor=color, edgecolor="gray")
        else:
            corner = (x - width / 2, y - height / 2)
            patch = Rectangle(corner, width, height, angle=turn, rotation_point="center", facecolor=color, edgecolor="gray")
        axes.add_patch(patch)
        axes.text(x, y, target.label, ha="center", va="center", fontsize=7)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_xlabel("x in mm")
    axes.set_ylabel("y in mm")
    axes.set_title(layout.name)
    return axes


def presses(recording: Recording, layout: Layout, index: int = 0, axes: Any = None) -> Any:
    """Draw where the fingertips were at each press on a board, and return the axes."""
    axes = board(layout, board=index, axes=axes)
    names = {target.name for target in layout.targets if target.board == index}
    points = recording.presses
    if len(points):
        points = points[points["target"].isin(names)]
        axes.scatter(1000 * points["x_m"], 1000 * points["y_m"], s=12, color="tab:blue", zorder=3)
    return axes
