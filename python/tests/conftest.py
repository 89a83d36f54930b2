"""Recordings that the program writes: skipped where the program has not been built."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def program() -> Path:
    named = Path(os.environ.get("ADEMAN", ROOT / "target" / "debug" / "ademan"))
    if not named.is_file():
        pytest.skip("SKIPPED the program has not been built: cargo build")
    os.environ["ADEMAN"] = str(named)
    return named


@pytest.fixture(scope="session")
def recorded(program, tmp_path_factory):
    """Return a function that records one of the recordings in tests/recordings again, in the present format."""
    folder = tmp_path_factory.mktemp("recordings")

    def record(name: str) -> Path:
        path = folder / f"{name}.mcap"
        if not path.exists():
            source = ROOT / "tests" / "recordings" / f"{name}.mcap"
            command = [program, "record", path, "--source", f"recording:{source}"]
            subprocess.run(command, check=True, capture_output=True, timeout=60)
        return path

    return record
