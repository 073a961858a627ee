"""Campaigns on a Ray cluster: any number of machines, the same bytes as one.

A task flies one block and writes it into a folder that all machines share, or to a URL that fsspec knows.
Blocks are seeded and named after their bytes, so a task that runs twice writes the same file twice. The driver
keeps a number of tasks in flight, gets (block, rows, name) from each, and merges the blocks at the end. It does
not fly finished blocks again: after a kill, start the driver again.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time
from typing import Any, Callable, Sequence

from ._fga import Campaign, _league_campaigns
from ._fga import league as _league
from ._progress import progress_bar
from ._store import RESULTS, finished_blocks, store_of
from .campaign import Flown, fly_block, pickled

def _ray() -> Any:
    try:
        import ray
    except ImportError as error:
        raise ValueError("the package ray is missing, expected it installed: pip install 'fga-daa[ray]'") from error
    return ray


def _empty(_campaign: bytes, _place: str, block: int) -> tuple[int, int, str]:
    return block, 0, ""


def _schedule(
    ray: Any,
    task: Callable[[bytes, str, int], tuple[int, int, str]],
    arguments: tuple[bytes, str],
    blocks: Sequence[int],
    in_flight: int,
    done: Callable[[int, int, str], None],
) -> None:
    """Runs a task for every block, never more than `in_flight` at once.

    After the loss of a node its tasks run again, without limit; an exception of a task is raised here and
    cancels the running tasks.
    """
    remote = ray.remote(num_cpus=1, max_retries=-1, retry_exceptions=False)(task)
    waiting = iter(blocks)
    running: list[Any] = []
    try:
        while True:
            while len(running) < in_flight:
                block = next(waiting, None)
                if block is None:
                    break
                running.append(remote.remote(*arguments, block))
            if not running:
                return
            # All ready ones, so that the driver's work does not grow with the tasks in flight.
            ready, running = ray.wait(running, num_returns=len(running), timeout=0.0)
            if not ready:
                ready, running = ray.wait(running, num_returns=1, timeout=1.0)
            for result in ray.get(ready):
                done(*result)
    except BaseException:
        for reference in running:
            ray.cancel(reference, force=False)
        raise


def _connected(ray: Any, address: str) -> None:
    if ray.is_initialized():
        return
    try:
        ray.init(address=address, include_dashboard=False, log_to_driver=False, logging_level="ERROR")
    except OSError:
        raise
    except Exception as error:
        # Ray raises a plain Exception when a raylet takes longer than 30 s to start.
        raise ConnectionError(f"the Ray cluster {address} does not answer: {error}") from error


def _checked(in_flight: int | None) -> None:
    if in_flight is not None and in_flight < 1:
        raise ValueError(f"in_flight is {in_flight}, expected at least 1")


def _in_flight(ray: Any, in_flight: int | None) -> int:
    return in_flight or max(4, 4 * int(ray.cluster_resources().get("CPU", 1)))


def run(
    file: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    encounters: int | None = None,
    policies: Sequence[Any] = (),
    vehicle: str | os.PathLike[str] | None = None,
    oracle: bool = False,
    time_limit_s: float = 1.0,
    csv: bool = False,
    address: str = "auto",
    in_flight: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Flown:
    """Flies a campaign on a Ray cluster and merges its results.

    `out` is a folder that every machine sees under the same path, or a URL that fsspec knows. `address` is
    the cluster's: `auto` for the running one, `local` for one on this machine. `in_flight` bounds the
    tasks that wait or run, four for each processor without it. `progress(done, total)` counts encounters.

    Raises ValueError for a wrong file or a folder of another campaign, OSError for an unwritable path or a
    cluster that does not answer;
    finished blocks stay, and the next call continues with them.
    """
    _checked(in_flight)
    campaign = Campaign(
        file,
        encounters=encounters,
        policies=policies,
        vehicle=vehicle,
        oracle=oracle,
        time_limit_s=time_limit_s,
    )
    store = store_of(out)
    if _fly(campaign, store, address, in_flight, progress):
        sha256 = store.merge(campaign, csv)
    else:
        sha256 = _sha256(store)
    return Flown(campaign, store.place, sha256)


def _fly(
    campaign: Campaign,
    store: Any,
    address: str,
    in_flight: int | None,
    progress: Callable[[int, int], None] | None,
) -> bool:
    """Flies the missing blocks of a campaign; whether there is anything to merge."""
    store.open(campaign)
    if store.results():
        return False
    finished = finished_blocks(campaign, store.names(), store.place)
    missing = [block for block in range(campaign.blocks) if block not in finished]
    flown = 0
    for block in finished:
        first, end = campaign.range_of(block)
        flown += end - first

    def done(block: int, _rows: int, _name: str) -> None:
        nonlocal flown
        first, end = campaign.range_of(block)
        flown += end - first
        if progress is not None:
            progress(flown, campaign.encounters)

    if missing:
        ray = _ray()
        _connected(ray, address)
        limit = _in_flight(ray, in_flight)
        _schedule(ray, fly_block, (pickled(campaign), store.place), missing, limit, done)
    return True


def league(
    out: str | os.PathLike[str],
    *,
    policies: Sequence[Any] = (),
    sets: Sequence[str] = (),
    data: str | os.PathLike[str] | None = None,
    encounters: int | None = None,
    intruders: Sequence[Any] = (),
    worst: int = 3,
    time_limit_s: float = 1.0,
    address: str = "auto",
    in_flight: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[dict[str, Any]]:
    """Flies a league on a Ray cluster, campaign by campaign, and writes its page here: the bytes of `fga.league`.

    `out`, and the data, are folders that every machine sees under the same path. The rest is that of `fga.league` and of `run`.
    """
    _checked(in_flight)
    out = os.path.abspath(os.fspath(out))
    given = {
        "policies": policies,
        "sets": sets,
        "data": data,
        "encounters": encounters,
        "intruders": intruders,
        "time_limit_s": time_limit_s,
    }
    for place, campaign in _league_campaigns(out, **given):
        _fly(campaign, store_of(os.path.join(out, place)), address, in_flight, progress)
    return _league(out, worst=worst, **given)


def _sha256(store: Any) -> str:
    import hashlib

    digest = hashlib.sha256()
    if hasattr(store, "_connect"):
        fs, _ = store._connect()
        opened = fs.open(store._path(RESULTS), "rb")
    else:
        opened = open(os.path.join(store.place, RESULTS), "rb")
    with opened as file:
        while chunk := file.read(1 << 20):
            digest.update(chunk)
    return digest.hexdigest()


def dry_run(shards: int, *, address: str = "auto", in_flight: int | None = None) -> dict[str, float]:
    """Schedules empty blocks to measure the driver alone. Returns seconds, tasks per second, memory in MB."""
    if shards < 1:
        raise ValueError(f"shards is {shards}, expected at least 1")
    _checked(in_flight)
    ray = _ray()
    _connected(ray, address)
    heard = 0

    def done(_block: int, _rows: int, _name: str) -> None:
        nonlocal heard
        heard += 1

    before_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    begun = time.monotonic()
    _schedule(ray, _empty, (b"", ""), range(shards), _in_flight(ray, in_flight), done)
    took_s = time.monotonic() - begun
    after_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {
        "shards": heard,
        "seconds": took_s,
        "shards_per_s": heard / took_s,
        "driver_mb": after_mb,
        "driver_grew_mb": after_mb - before_mb,
    }


def _arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m fga.campaign", description="Fly a campaign on a Ray cluster."
    )
    parser.add_argument("file", help="the campaign file (.toml)")
    parser.add_argument("--encounters", type=int, help="number of encounters; without it the file's number")
    parser.add_argument("--out", help="a folder that every machine sees, or a URL; out/<name of the file> without it")
    parser.add_argument("--address", default="auto", help="auto for the running cluster, local for this machine")
    parser.add_argument("--policy", action="append", default=[], help="a policy instead of the file's")
    parser.add_argument("--vehicle", help="a vehicle file instead of the one in the campaign file")
    parser.add_argument("--oracle", action="store_true", help="ask the oracle which encounters any manoeuvre can save")
    parser.add_argument("--csv", action="store_true", help="also write results.csv")
    parser.add_argument("--in-flight", type=int, help="most tasks that wait or run")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """`python -m fga.campaign`."""
    told = _arguments().parse_args(arguments)
    name = os.path.splitext(os.path.basename(told.file))[0]
    try:
        flown = run(
            told.file,
            told.out or os.path.join("out", name),
            encounters=told.encounters,
            policies=told.policy,
            vehicle=told.vehicle,
            oracle=told.oracle,
            csv=told.csv,
            address=told.address,
            in_flight=told.in_flight,
            progress=progress_bar(),
        )
    except (ValueError, OSError) as error:
        cause = getattr(error, "cause", None) or error
        print(f"fga: {cause}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("fga: stopped; finished blocks stay, the same command continues", file=sys.stderr)
        return 130
    print(f"{flown.campaign.encounters} encounters; results in {flown.results}, SHA-256 {flown.sha256}")
    return 0
