"""Campaigns: drawn encounters by the million, each flown by several policies.

`fga.campaign(file, out)` flies one on this machine, as `fga campaign run` does; `python -m fga.campaign`
flies one on a Ray cluster.
"""

from __future__ import annotations

import concurrent.futures
import multiprocessing
import os
import pickle
import sys
import types
from typing import Any, Callable, Sequence

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
    policies: Sequence[Any] = (),
    vehicle: str | os.PathLike[str] | None = None,
    oracle: bool = False,
    recordings: Sequence[str | os.PathLike[str]] = (),
    model: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    processes: int | None = None,
    time_limit_s: float = 1.0,
    resume: bool = True,
    csv: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Flown:
    """Flies a campaign file into a folder: `fga campaign run`.

    `policies` are names or policies of your own: a class that is made as `fga.Avoider` is (settings, vehicle), an object with
    `step(situation)`, which each flight copies, or a function of the situation. They return None to fly the mission, a pair
    (course_rad, climb_rad), a Stage, a list of stages, or a Decision. One that raises, takes longer than `time_limit_s` for a
    step, or returns something else flies the rest of that encounter on the mission, and the column `policy_failure` says
    so. `processes` flies blocks in processes, for policies whose Python code needs more than one core; they must pickle.

    It continues with finished blocks in the folder; Ctrl-C keeps them. The files equal the program's, to
    the byte. Raises ValueError for a wrong file and OSError for an unwritable folder.
    """
    told = Campaign(
        file,
        encounters=encounters,
        policies=policies,
        vehicle=vehicle,
        oracle=oracle,
        recordings=recordings,
        model=model,
        time_limit_s=time_limit_s,
    )
    folder = os.fspath(out)
    if processes is not None and not (resume and os.path.exists(os.path.join(folder, "results.parquet"))):
        if processes < 1:
            raise ValueError(f"processes is {processes}, expected at least 1")
        _fly_blocks(told, folder, processes, resume, progress)
        sha256 = told.merge(folder, csv=csv)
    else:
        sha256 = told.run(folder, threads=threads, resume=resume, csv=csv, progress=progress)
    return Flown(told, folder, sha256)


def pickled(campaign: Campaign) -> bytes:
    """A campaign for other processes, with the functions and classes of a notebook where cloudpickle or Ray is installed."""
    try:
        import cloudpickle as pickler
    except ImportError:
        try:
            from ray import cloudpickle as pickler
        except ImportError:
            pickler = pickle
    return pickler.dumps(campaign)


_known: dict[bytes, Campaign] = {}


def fly_block(campaign: bytes, place: str, block: int) -> tuple[int, int, str]:
    """Flies a block of a pickled campaign and puts it into a store."""
    from ._store import store_of

    told = _known.get(campaign)
    if told is None:
        _known.clear()
        told = _known[campaign] = pickle.loads(campaign)
    name, rows, data = told.fly_block(block, threads=1)
    store_of(place).put(name, data)
    return block, rows, name


def _fly_blocks(
    campaign: Campaign,
    folder: str,
    processes: int,
    resume: bool,
    progress: Callable[[int, int], None] | None,
) -> None:
    """Flies the missing blocks in processes of their own."""
    from ._store import finished_blocks, store_of

    store = store_of(folder)
    if not resume and os.path.exists(os.path.join(folder, "campaign.json")):
        raise ValueError(f"{folder}: holds a campaign already, expected an empty folder without resume")
    store.open(campaign)
    finished = finished_blocks(campaign, store.names(), store.place)
    missing = [block for block in range(campaign.blocks) if block not in finished]
    data = pickled(campaign)
    context = multiprocessing.get_context("spawn")
    done = sum(end - first for first, end in map(campaign.range_of, finished))
    with concurrent.futures.ProcessPoolExecutor(processes, mp_context=context) as pool:
        futures = [pool.submit(fly_block, data, store.place, block) for block in missing]
        try:
            for future in concurrent.futures.as_completed(futures):
                first, end = campaign.range_of(future.result()[0])
                done += end - first
                if progress is not None:
                    progress(done, campaign.encounters)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


class _Callable(types.ModuleType):
    """`fga.campaign` is this module and, called, its function of the same name."""

    __call__ = staticmethod(campaign)


sys.modules[__name__].__class__ = _Callable


if __name__ == "__main__":
    from .ray import main

    sys.exit(main())
