"""Rates of policies of one's own: `python python/tests/measure_own_policy.py`, steps a second with one thread."""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import fga
import numpy as np
import pyarrow

IDLE = """
import sys
for line in sys.stdin:
    print("{}", flush=True)
"""


class Trivial:
    steps = 0

    def __init__(self, settings, vehicle):
        pass

    def step(self, situation):
        Trivial.steps += 1
        return None if situation.ownship.course_rad < 1.0 else (0.0, 0.0)


class TrivialAll:
    steps = 0

    def __init__(self, settings, vehicle):
        pass

    def step_all(self, flights, obstacles):
        flights = pyarrow.table(flights)
        TrivialAll.steps += len(flights)
        course = flights["course_rad"].to_numpy()
        return pyarrow.table(
            {
                "course_rad": pyarrow.array(np.zeros(len(flights)), mask=course < 1.0),
                "climb_rad": np.zeros(len(flights)),
            }
        )


def main() -> None:
    folder = Path(tempfile.mkdtemp())
    path = folder / "encounters.csv"
    with open(path, "w") as file:
        file.write("encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n")
        for number in range(4096):
            file.write(f"{number},0,{900 + number % 50},{number % 40},0,-15,0,0,30\n")
    few = folder / "few.csv"
    few.write_text("".join(open(path).readlines()[:101]))
    for policy, encounters in ((Trivial, few), (TrivialAll, path)):
        best = 0.0
        for _ in range(3):
            policy.steps, begun = 0, time.perf_counter()
            fga.batch(encounters, policy=policy, threads=1)
            best = max(best, policy.steps / (time.perf_counter() - begun))
        print(f"{policy.__name__}: {best:,.0f} steps/s")
    program = folder / "idle.py"
    program.write_text(IDLE)
    begun = time.perf_counter()
    fga.batch(few, policy=f"pipe:{sys.executable} {program}", threads=1)
    # It flies the mission, whose steps are known: as many as those of Trivial.
    print(f"pipe: {Trivial.steps / (time.perf_counter() - begun):,.0f} steps/s")


if __name__ == "__main__":
    main()
