"""Recordings, layouts and layout scores of Ademán as data frames.

Lengths are in metres, angles in radians and times in seconds unless a name says otherwise. In the world, x points to the
right of the wearer, y up and z backward.
"""

from . import lab
from .layouts import Layout, Target, read_layout
from .program import ProgramError, find_program
from .recordings import Recording, read

__all__ = [
    "Layout",
    "ProgramError",
    "Recording",
    "Target",
    "find_program",
    "lab",
    "read",
    "read_layout",
]
