"""What a decision costs from Python more than in Rust, and whether a batch is as fast: the same compiled code on both sides.

    python python/tests/measure_step.py [--batch-encounters 10000] [--program target/release/fga]
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import fga

ROOT = Path(__file__).resolve().parents[2]
SCENARIO = ROOT / "scenarios" / "first-flight.toml"


def steps_us() -> tuple[list[float], list[float]]:
    """Times of the decisions of a flight from Python: of the step alone, and with the situation built first."""
    flight = fga.Simulation(SCENARIO)
    avoider = fga.Avoider(flight.model.settings, flight.model.vehicle)
    step, built = [], []
    now = time.perf_counter_ns
    while (seen := flight.situation) is not None:
        own, mission, obstacles = seen.ownship, seen.mission, seen.obstacles
        position, course, speed, climb, bank = own.position_m, own.course_rad, own.airspeed_mps, own.climb_rad, own.bank_rad
        begun = now()
        situation = fga.Situation(seen.time_s, fga.Ownship(position, course, speed, climb, bank), mission, obstacles)
        ready = now()
        decision = avoider.step(situation)
        done = now()
        step.append((done - ready) / 1e3)
        built.append((done - begun) / 1e3)
        flight.advance(decision)
    return step, built


def encounters(path: Path, count: int) -> None:
    """Straight-flying spheres around an aircraft at the origin that flies along +x."""
    rng = np.random.default_rng(7)
    meet_s = rng.uniform(5, 15, count)
    velocity = rng.uniform(-20, 20, (count, 3)) * (1, 1, 0.1)
    beside = rng.uniform(-40, 40, (count, 3))
    place = np.c_[15.0 * meet_s, np.zeros(count), np.zeros(count)] + beside - velocity * meet_s[:, None]
    rows = ["encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m,kind"]
    rows += [f"{k},0,{','.join(repr(float(v)) for v in (*place[k], *velocity[k]))},30,straight" for k in range(count)]
    path.write_text("\n".join(rows) + "\n")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--batch-encounters", type=int, default=10_000)
    parser.add_argument("--program", default=str(ROOT / "target" / "release" / "fga"))
    told = parser.parse_args()
    # A busy machine disturbs single times: of each decision the quickest of the repeats counts.
    in_rust, step, built = [], [], []
    for _ in range(told.repeats):
        in_rust.append(fga.run(SCENARIO).summary["decision_median_us"])
        one, two = steps_us()
        step.append(one)
        built.append(two)
    quickest = [statistics.median(map(min, zip(*times, strict=True))) for times in (step, built)]
    print(
        f"median decision of {SCENARIO.stem}: {min(in_rust):.2f} us in Rust, {quickest[0]:.2f} us from Python, "
        f"{quickest[1]:.2f} us with the situation built from numbers (load {os.getloadavg()[0]:.1f})"
    )
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        encounters(here / "encounters.csv", told.batch_encounters)
        ratios, rates = [], []
        for _ in range(told.repeats):
            begun, before = time.monotonic(), os.times()
            table = fga.batch(here / "encounters.csv", threads=1).to_csv()
            took_s, after = time.monotonic() - begun, os.times()
            own_s = after.user - before.user
            command = [os.path.abspath(told.program), "batch", "encounters.csv", "--threads", "1", "--out", "out"]
            subprocess.run(command, cwd=here, capture_output=True, check=False)
            program_s = os.times().children_user - after.children_user
            ratios.append(program_s / own_s)
            rates.append((told.batch_encounters / own_s, told.batch_encounters / took_s))
        same = table == (here / "out" / "results.csv").read_bytes()
    best = max(rates)
    print(
        f"batch of {told.batch_encounters}: {best[0]:.0f} encounters for each second of a processor, the program's "
        f"rate x {statistics.median(ratios):.3f} (median of {told.repeats}); {'the same bytes' if same else 'OTHER BYTES'}"
    )
    return int(not same)


if __name__ == "__main__":
    sys.exit(main())
