"""Layouts with the geometry of their targets."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any

import pandas as pd

from .program import call

#: The longest time in which the program shows a layout, even on a busy machine.
SHOW_LIMIT_S = 60.0


@dataclass(frozen=True)
class Target:
    """A key, or a part of another control, that a fingertip can touch."""

    name: str
    label: str
    #: Index of its board.
    board: int
    #: Center in the plane of the board, unrolled if it is curved: x to the right along the rows, y away from the wearer.
    center_m: tuple[float, float]
    #: Width and depth; of a disc, its diameter twice.
    size_m: tuple[float, float]
    is_disc: bool
    #: Counter-clockwise.
    rotation_rad: float
    #: Center of the front from the anchor of the board, in the axes of the world.
    position_m: tuple[float, float, float] | None
    travel_m: float | None
    #: Depth at which it counts as pressed.
    press_depth_m: float | None
    #: Name of the key that is pressed in the base layer.
    key: str | None
    #: The finger that the layout assigns.
    finger: str | None

    @classmethod
    def _from_json(cls, board: int, value: dict[str, Any]) -> Target:
        radius = value.get("radius_m")
        size = value["size_m"] if radius is None else [2 * radius, 2 * radius]
        position = value.get("position_m")
        return cls(
            name=value["name"],
            label=value["label"],
            board=board,
            center_m=(value["center_m"][0], value["center_m"][1]),
            size_m=(size[0], size[1]),
            is_disc=radius is not None,
            rotation_rad=value["rotation_rad"],
            position_m=None if position is None else (position[0], position[1], position[2]),
            travel_m=value.get("travel_m"),
            press_depth_m=value.get("press_depth_m"),
            key=value.get("key"),
            finger=value.get("finger"),
        )


@dataclass(frozen=True)
class Layout:
    """A layout as the program reads it."""

    name: str
    description: str
    layers: list[str]
    targets: list[Target]

    def __getitem__(self, name: str) -> Target:
        """Return the target with this name."""
        for target in self.targets:
            if target.name == name:
                return target
        raise KeyError(name)

    def frame(self) -> pd.DataFrame:
        """Return the targets as a data frame with a row each, indexed by their names."""
        rows = [
            {
                "board": target.board,
                "label": target.label,
                "key": target.key,
                "finger": target.finger,
                "x_m": target.center_m[0],
                "y_m": target.center_m[1],
                "width_m": target.size_m[0],
                "height_m": target.size_m[1],
                "is_disc": target.is_disc,
                "rotation_rad": target.rotation_rad,
                "travel_m": target.travel_m,
                "press_depth_m": target.press_depth_m,
            }
            for target in self.targets
        ]
        return pd.DataFrame(rows, index=pd.Index([target.name for target in self.targets], name="target"))


def read_layout(layout: str | os.PathLike[str]) -> Layout:
    """Read a layout file, or a layout that comes with the program, by its name.

    Raises:
        ProgramError: the program is missing, refuses the layout or does not end within 60 s.
    """
    value = json.loads(call(["layout", "show", layout, "--json", "-"], limit_s=SHOW_LIMIT_S))
    targets = [Target._from_json(index, target) for index, board in enumerate(value["boards"]) for target in board["targets"]]
    return Layout(name=value["name"], description=value["description"], layers=value["layers"], targets=targets)
