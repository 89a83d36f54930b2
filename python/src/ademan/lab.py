"""Scores of layouts with simulated people, computed by `ademan lab`. Every figure is simulated."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from .program import call


@dataclass(frozen=True)
class Score:
    """What simulated people do on a layout."""

    #: The result as `ademan lab verify` reads it.
    result: dict[str, Any]
    #: One row for each figure, with its value and the ends of its 95 % interval; shares are fractions. Figures of a pointer begin with
    #: `pointing_`.
    figures: pd.DataFrame
    #: One row for each person.
    people: pd.DataFrame
    #: One row for each phrase of each person, in the order in which they were typed: a learning curve of what learns.
    phrases: pd.DataFrame
    #: One row for each key: how often it was meant and hit, by all people.
    keys: pd.DataFrame


def score(
    layout: str | os.PathLike[str],
    *,
    people: int = 20,
    tier: str | None = None,
    source: str = "ideal",
    phrases: str = "en",
    count: int = 10,
    seed: int = 0,
) -> Score:
    """Let simulated people type on a layout, or use its controls.

    `tier` replaces their own errors by a scatter: `T0` to `T4`, or `Toff`. `count` is the number of phrases of each person.

    Raises:
        ProgramError: the program is missing or refuses.
    """
    arguments: list[str | os.PathLike[str]] = ["lab", "score", layout, "--people", str(people), "--source", source]
    arguments += ["--phrases", phrases, "--count", str(count), "--seed", str(seed)]
    if tier is not None:
        arguments += ["--tier", tier]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "result.json"
        call([*arguments, "--json", path])
        return _score(json.loads(path.read_text(encoding="utf-8")))


def _score(result: dict[str, Any]) -> Score:
    summary = result["summary"]
    pointing = summary.get("pointing") or {}
    intervals = _intervals(summary) | {f"pointing_{name}": figure for name, figure in _intervals(pointing).items()}
    people = [{name: value for name, value in person.items() if not isinstance(value, list)} for person in result["scores"]]
    phrases = [
        {"person": person["number"], "phrase": number, **phrase}
        for person in result["scores"]
        for number, phrase in enumerate(person.get("by_phrase", []))
    ]
    keys = pd.DataFrame([key for person in result["scores"] for key in person["keys"]])
    if len(keys):
        keys = keys.groupby("name")[["meant", "hit", "nothing"]].sum()
        keys["hit_rate"] = keys["hit"] / keys["meant"]
    return Score(
        result=result,
        figures=pd.DataFrame.from_dict(intervals, orient="index"),
        people=pd.DataFrame(people),
        phrases=pd.DataFrame(phrases, columns=["person", "phrase", "characters", "correct", "errors", "seconds"]),
        keys=keys,
    )


def _intervals(figures: dict[str, Any]) -> dict[str, Any]:
    return {name: figure for name, figure in figures.items() if isinstance(figure, dict) and "value" in figure}
