"""The program `ademan`, which this package calls for what only the program computes."""

from __future__ import annotations

import os
import shlex
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


def call(arguments: Sequence[str | os.PathLike[str]], *, limit_s: float | None = None) -> str:
    """Run the program and return its standard output.

    After `limit_s` the program is ended. A call whose work has no usual length has no limit.

    Raises:
        ProgramError: the program is missing, ends with an error or does not end within the limit.
    """
    command = [os.fspath(find_program()), *(os.fspath(argument) for argument in arguments)]
    try:
        ended = subprocess.run(
            command, capture_output=True, encoding="utf-8", stdin=subprocess.DEVNULL, check=False, timeout=limit_s
        )
    except subprocess.TimeoutExpired:
        raise ProgramError(
            f"{command[0]} did not end within {limit_s:g} s; check that it is the program, and run it in a terminal: "
            f"{shlex.join(command)}"
        ) from None
    if ended.returncode != 0:
        raise ProgramError(ended.stderr.strip() or f"ademan ended with code {ended.returncode}")
    return ended.stdout
