"""What a campaign on Ray takes: rates of one and of two workers, lost raylets and drivers, and a driver with empty shards.

    python python/tests/measure_ray.py CAMPAIGN.toml --encounters 200000 --shards 100000
"""

from __future__ import annotations

import argparse
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from raylets import Raylets

import fga
from fga import ray as fga_ray

DRIVER = """
import sys
from fga import ray
ray.run(sys.argv[1], sys.argv[2], encounters=int(sys.argv[3]), address=sys.argv[4],
        progress=lambda done, total: print("done", done, flush=True))
"""


def load() -> str:
    return "load {:.1f}".format(os.getloadavg()[0])


def busy_s(raylets: Raylets) -> float:
    """Processor time of the processes that fly tasks, seconds."""
    ticks = 0
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            name = (folder / "cmdline").read_bytes()
            fields = (folder / "stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if name.startswith(b"ray::"):
            ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def rate(raylets: Raylets, file: str, encounters: int, place: Path) -> float:
    """Encounters per second once the workers have begun, the merge left out."""
    first: list[tuple[float, int, float]] = []
    last: list[tuple[float, int, float]] = []

    def progress(done: int, _total: int) -> None:
        now = (time.monotonic(), done, 0.0)
        if not first:
            first.append((now[0], done, busy_s(raylets)))
        last[:] = [now]

    fga_ray.run(file, place, encounters=encounters, address=raylets.address, progress=progress)
    wall_s, flown = last[0][0] - first[0][0], last[0][1] - first[0][1]
    worked_s = busy_s(raylets) - first[0][2]
    workers = len(raylets.workers)
    print(
        f"{workers} worker(s): {flown / wall_s:.0f} encounters/s by the clock, {flown / worked_s:.0f} for each second of "
        f"a processor, {worked_s / wall_s:.2f} processors had ({load()})",
        flush=True,
    )
    return flown / wall_s


def heard(driver: subprocess.Popen[str]) -> int:
    for line in driver.stdout:
        if line.startswith("done "):
            return int(line.split()[1])
    return 0


def lose(raylets: Raylets, file: str, encounters: int, place: Path) -> str:
    """Kills a raylet at a third, the driver at two thirds, and starts the driver again."""
    command = [sys.executable, "-c", DRIVER, file, str(place), str(encounters), raylets.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as driver:
        for share, process in [(1, raylets.process_of(0)), (2, driver.pid)]:
            while (done := heard(driver)) < encounters * share // 3:
                if done == 0:
                    raise RuntimeError("the driver has ended")
            os.kill(process, signal.SIGKILL)
            print(f"killed {'a raylet' if share == 1 else 'the driver'} after {done} encounters", flush=True)
    kept = len([name for name in os.listdir(place / "blocks") if name.endswith(".parquet")])
    begun = time.monotonic()
    flown = fga_ray.run(file, place, encounters=encounters, address=raylets.address)
    print(f"{kept} blocks were there; the second driver took {time.monotonic() - begun:.0f} s", flush=True)
    return flown.sha256


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", help="the campaign file (.toml)")
    parser.add_argument("--encounters", type=int, default=200_000)
    parser.add_argument("--rate-encounters", type=int, default=20_000, help="encounters of each measurement of the rate")
    parser.add_argument("--shards", type=int, default=100_000, help="empty shards")
    told = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        raylets = Raylets(1)
        try:
            rate(raylets, told.file, told.rate_encounters // 4, here / "warm1")
            one = rate(raylets, told.file, told.rate_encounters, here / "one")
            raylets.add()
            rate(raylets, told.file, told.rate_encounters // 4, here / "warm2")
            two = rate(raylets, told.file, told.rate_encounters, here / "two")
            print(f"two workers against one: {two / one:.2f} x", flush=True)
            print("dry run:", fga_ray.dry_run(told.shards, address=raylets.address), load(), flush=True)
            lost = lose(raylets, told.file, told.encounters, here / "lost")
        finally:
            raylets.stop()
        begun, before = time.monotonic(), resource.getrusage(resource.RUSAGE_SELF).ru_utime
        whole = fga.campaign(told.file, here / "whole", encounters=told.encounters, threads=1)
        took_s, worked_s = time.monotonic() - begun, resource.getrusage(resource.RUSAGE_SELF).ru_utime - before
        size = os.path.getsize(whole.results)
    print(
        f"one process, one thread: {told.encounters / took_s:.0f} encounters/s by the clock, "
        f"{told.encounters / worked_s:.0f} for each second of a processor, {size / told.encounters:.1f} bytes each"
    )
    print("the same bytes" if lost == whole.sha256 else "OTHER BYTES", lost)
    return int(lost != whole.sha256)


if __name__ == "__main__":
    sys.exit(main())
