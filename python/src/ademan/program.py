"""The program `ademan`, which this package calls for what only the program computes."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path


class ProgramError(RuntimeError):
    """The program is missing or has refused; the text is the message of the program."""


def find_program() -> Path:
    """Return the program: the file in the environment variable `ADEMAN`, or `ademan` in the search path.

    Raises:
        ProgramError: there is none.
    """
    named = os.environ.get("ADEMAN")
    if named:
        path = Path(named)
        if not path.is_file():
            raise ProgramError(f"ADEMAN names {named}, which does not exist; set it to the program or unset it")
        return path
    found = shutil.which("ademan")
    if found is None:
        raise ProgramError("cannot find the program ademan; install it, or name it in the environment variable ADEMAN")
    return Path(found)


def call(arguments: Sequence[str | os.PathLike[str]]) -> str:
    """Run the program and return its standard output.

    Raises:
        ProgramError: the program is missing or ends with an error.
    """
    command = [os.fspath(find_program()), *(os.fspath(argument) for argument in arguments)]
    ended = subprocess.run(command, capture_output=True, encoding="utf-8", stdin=subprocess.DEVNULL, check=False)
    if ended.returncode != 0:
        raise ProgramError(ended.stderr.strip() or f"ademan ended with code {ended.returncode}")
    return ended.stdout
