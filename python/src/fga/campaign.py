"""Campaigns: drawn encounters by the million, each flown by several policies.

`fga.campaign(file, out)` flies one on this machine, as `fga campaign run` does; `python -m fga.campaign`
flies one on a Ray cluster.
"""

from __future__ import annotations

import os
import sys
import types
from typing import Callable, Sequence

from ._fga import Campaign, Table


class Flown:
    """A flown campaign: the path of its results, and their checksum."""

    def __init__(self, campaign: Campaign, folder: str, sha256: str) -> None:
        self.campaign = campaign
        self.folder = folder
        self.sha256 = sha256

    @property
    def results(self) -> str:
        """The path of results.parquet."""
        return os.path.join(self.folder, "results.parquet")

    def table(self) -> Table:
        """The rows of results.parquet."""
        return self.campaign.read(self.results)

    def __repr__(self) -> str:
        return f"Flown({self.campaign!r}, folder={self.folder!r}, sha256={self.sha256!r})"


def campaign(
    file: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    encounters: int | None = None,
    policies: Sequence[str] = (),
    vehicle: str | os.PathLike[str] | None = None,
    oracle: bool = False,
    threads: int | None = None,
    resume: bool = True,
    csv: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Flown:
    """Flies a campaign file into a folder: `fga campaign run`.

    It continues with finished blocks in the folder; Ctrl-C keeps them. The files equal the program's, to
    the byte. Raises ValueError for a wrong file and OSError for an unwritable folder.
    """
    told = Campaign(
        file,
        encounters=encounters,
        policies=list(policies),
        vehicle=vehicle,
        oracle=oracle,
    )
    folder = os.fspath(out)
    sha256 = told.run(folder, threads=threads, resume=resume, csv=csv, progress=progress)
    return Flown(told, folder, sha256)


class _Callable(types.ModuleType):
    """`fga.campaign` is this module and, called, its function of the same name."""

    __call__ = staticmethod(campaign)


sys.modules[__name__].__class__ = _Callable


if __name__ == "__main__":
    from .ray import main

    sys.exit(main())
