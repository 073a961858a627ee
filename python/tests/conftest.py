"""Common parts of the tests: the repository, the program."""

from __future__ import annotations

import importlib
import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def absent(what: str):
    """Skips the test because something is missing; in continuous integration it fails."""
    if os.environ.get("CI") == "true":
        pytest.fail(f"{what} is missing")
    pytest.skip(f"{what} is missing", allow_module_level=True)


def needed(name: str):
    """The module of that name; without it the test is skipped, in continuous integration it fails."""
    try:
        return importlib.import_module(name)
    except ImportError:
        absent(f"the package {name}")


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def program() -> Path:
    """The program `fga`: FGA_PROGRAM, else the last build."""
    named = os.environ.get("FGA_PROGRAM")
    places = [Path(named)] if named else [ROOT / "target" / kind / "fga" for kind in ("release", "debug")]
    for place in places:
        if place.exists():
            return place
    absent("the program fga")


@pytest.fixture(scope="session")
def fga_program(program):
    """Runs the program and returns its standard output; its exit code must be one of `codes`."""

    def call(*arguments, codes=(0,), cwd=None):
        done = subprocess.run(
            [str(program), *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=300
        )
        assert done.returncode in codes, done.stderr
        return done

    return call
