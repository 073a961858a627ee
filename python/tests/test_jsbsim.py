"""A six-degree-of-freedom aircraft that is not of this project flies fga's commands.

FGA_JSBSIM sets the number of encounters; the evidence is made with 200.
"""

import math
import os

import numpy as np
import pytest
from conftest import needed

import fga

needed("jsbsim")
import jsbsim_loop  # noqa: E402

ENCOUNTERS = int(os.environ.get("FGA_JSBSIM", "6"))


class Plane:
    """An aircraft of JSBSim with the encounters that suit its size."""

    def __init__(self, loop, bank_deg, radius_m, speeds_mps, clear_m):
        self.loop, self.bank_deg, self.radius_m, self.speeds_mps, self.clear_m = loop, bank_deg, radius_m, speeds_mps, clear_m
        self.name = loop.model


# Kept from the volume at the start: nobody can keep out of a volume that it begins in.
PLANES = {
    "c172x": Plane(jsbsim_loop.C172X, 30.0, 150.0, (25, 65), 500.0),
    "minisgs": Plane(jsbsim_loop.MINISGS, 30.0, 50.0, (8, 25), 150.0),
}


@pytest.fixture(scope="module", autouse=True)
def elsewhere(tmp_path_factory):
    """JSBSim writes files of its own into the folder that it runs in."""
    before = os.getcwd()
    os.chdir(tmp_path_factory.mktemp("jsbsim-output"))
    yield
    os.chdir(before)


@pytest.fixture(scope="module", params=PLANES)
def plane(request, elsewhere):
    return PLANES[request.param]


@pytest.fixture(scope="module")
def log(elsewhere):
    """Step responses of the c172x."""
    return jsbsim_loop.step_responses(jsbsim_loop.Aircraft(), 30.0)


@pytest.fixture(scope="module")
def model(plane, tmp_path_factory):
    """The aircraft according to its own step responses."""
    responses = jsbsim_loop.step_responses(jsbsim_loop.Aircraft(plane.loop), plane.bank_deg)
    path = tmp_path_factory.mktemp("jsbsim") / "vehicle.toml"
    path.write_text(fga.identify(responses).to_toml(plane.name, plane.radius_m))
    print(path.read_text())
    return fga.VehicleModel.read(path)


def encounter(number, plane, own):
    """An intruder that meets the aircraft on its line after 40 to 60 s, from any side, and begins clear of it."""
    rng = np.random.default_rng(number)
    level_mps = own.airspeed_mps * math.cos(plane.loop.path_rad)
    up_mps = own.airspeed_mps * math.sin(plane.loop.path_rad)
    while True:
        meet_s, course = rng.uniform(40, 60), rng.uniform(-math.pi, math.pi)
        speed, climb = rng.uniform(*plane.speeds_mps), rng.uniform(-1.0, 1.0)
        beside = rng.uniform(-0.8, 0.8) * plane.radius_m
        vx, vy = speed * math.cos(course), speed * math.sin(course)
        place = (level_mps * meet_s - vx * meet_s, beside - vy * meet_s, (up_mps - climb) * meet_s)
        if math.hypot(*place) >= plane.radius_m + plane.clear_m:
            return fga.Obstacle(1, place, plane.radius_m, (vx, vy, climb))


def turned(obstacle, own):
    """The encounter laid along the course of the aircraft."""
    c, s = math.cos(own.course_rad), math.sin(own.course_rad)
    x, y, z = obstacle.position_m
    vx, vy, vz = obstacle.velocity_mps
    own_x, own_y, own_z = own.position_m
    return fga.Obstacle(
        obstacle.id,
        (own_x + c * x - s * y, own_y + s * x + c * y, own_z + z),
        obstacle.radius_m,
        (c * vx - s * vy, s * vx + c * vy, vz),
    )


def test_encounters_are_kept_and_paths_are_as_predicted(plane, model):
    errors = {5.0: [], 12.0: [], 30.0: []}
    least, without = [], []
    for number in range(ENCOUNTERS):
        aircraft = jsbsim_loop.Aircraft(plane.loop, airspeed_mps=model.vehicle.airspeed_mps)
        flight = jsbsim_loop.Flight(aircraft, model)
        start = aircraft.ownship
        intruder = turned(encounter(number, plane, start), start)
        path_rad = plane.loop.path_rad
        level_mps = start.airspeed_mps * math.cos(path_rad)
        along = (
            level_mps * math.cos(start.course_rad),
            level_mps * math.sin(start.course_rad),
            start.airspeed_mps * math.sin(path_rad),
        )
        wanted = []
        held = []

        def seen(decision, own, time_s, start=start, along=along, wanted=wanted, held=held, intruder=intruder):
            # The flown positions at the times of the predictions.
            for due in [due for due in wanted if time_s >= due[0] - 1e-6]:
                wanted.remove(due)
                errors[due[1]].append(math.dist(due[2].position_m, own.position_m))
            # A prediction is of the manoeuvre that was chosen, as long as it is flown.
            if decision.reason not in ("maneuver-chosen", "maneuver-kept"):
                wanted.clear()
            if decision.reason == "maneuver-chosen":
                for after_s in errors:
                    wanted.append((time_s + after_s, after_s, decision.predicted(model.vehicle, after_s)))
            straight = [
                p + v * time_s
                for p, v in zip(
                    start.position_m,
                    along,
                    strict=True,
                )
            ]
            there = [p + v * time_s for p, v in zip(intruder.position_m, intruder.velocity_mps, strict=True)]
            held.append(math.dist(straight, there) - plane.radius_m)

        least.append(flight.fly([intruder], 100.0, seen))
        without.append(min(held))
    print(plane.name, "kept", sum(m >= 0 for m in least), "of", ENCOUNTERS, "entered without", sum(m < 0 for m in without))
    print("least margins", np.round(np.percentile(least, [0, 5, 50]), 1), "lost:", [n for n, m in enumerate(least) if m < 0])
    for after_s, found in errors.items():
        print(f"{after_s:.0f} s: {len(found)} predictions, median, 90 %, most:", np.round(np.percentile(found, [50, 90, 100]), 1))
    assert sum(m < 0 for m in without) >= 0.9 * ENCOUNTERS, "they would meet"
    assert sum(m >= 0 for m in least) >= 0.9 * ENCOUNTERS
    assert len(errors[5.0]) >= ENCOUNTERS / 4
    assert np.median(errors[5.0]) < 0.5 * start.airspeed_mps


def test_identification_finds_a_known_vehicle():
    """A plant of a few lines, with noise, and the figures that were put in."""
    rng = np.random.default_rng(3)
    period_s, dead_s, constant_s, factor, speed = 0.05, 0.3, 0.6, 0.9, 20.0
    command = np.repeat(np.radians([0, 30, 0, -30, 0, 20, -20, 30, -30, 0]), 120)
    bank, course = np.zeros(len(command)), np.zeros(len(command))
    for k in range(1, len(command)):
        late = command[max(0, k - 1 - round(dead_s / period_s))]
        bank[k] = bank[k - 1] + (late - bank[k - 1]) * (1 - math.exp(-period_s / constant_s))
        course[k] = course[k - 1] + factor * 9.80665 * math.tan(bank[k]) / speed * period_s
    time_s = np.arange(len(command)) * period_s
    found = fga.identify(
        {
            "t_s": time_s,
            "airspeed_mps": speed + rng.normal(0, 0.2, len(command)),
            "bank_command_rad": command,
            "bank_rad": bank + rng.normal(0, math.radians(0.3), len(command)),
            "course_rad": course,
            "climb_rad": np.radians(8) * np.sin(time_s / 10),
        }
    )
    for estimate, true, within in [
        (found.airspeed_mps, speed, 0.1),
        (found.max_bank_deg, 30.0, 0.5),
        (found.dead_time_s, dead_s, 0.08),
        (found.bank_time_constant_s, constant_s, 0.08),
        (found.turn_rate_factor, factor, 0.02),
        (found.climb_max_deg, 8.0, 0.2),
        (found.climb_min_deg, -8.0, 0.2),
    ]:
        assert abs(estimate.value - true) < within, (estimate, true)
        assert estimate.low <= estimate.value <= estimate.high


def test_a_wrong_log_is_said_in_a_sentence(log, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t_s,airspeed_mps\n0,1\n")
    with pytest.raises(ValueError, match="line 1: the column bank_command_rad is missing"):
        fga.identify(path)
    with pytest.raises(FileNotFoundError, match="no such file"):
        fga.identify(tmp_path / "none.tlog")
    with pytest.raises(ValueError, match="the column climb_rad is missing"):
        fga.identify({name: column for name, column in log.items() if name != "climb_rad"})
    with pytest.raises(ValueError, match="expected one length"):
        fga.identify({**log, "climb_rad": log["climb_rad"][1:]})
    with pytest.raises(ValueError, match="climb_rad is not finite in row 3"):
        climb = np.array(log["climb_rad"])
        climb[3] = math.nan
        fga.identify({**log, "climb_rad": climb})
    with pytest.raises(TypeError, match="a mapping of its columns"):
        fga.identify(3)


def test_the_command_writes_the_same_vehicle_file(log, tmp_path, fga_program):
    path = tmp_path / "log.csv"
    rows = np.column_stack([log[name] for name in jsbsim_loop.COLUMNS])
    np.savetxt(path, rows, delimiter=",", header=",".join(jsbsim_loop.COLUMNS), comments="", fmt="%.17g")
    fga_program("identify", path, "--out", tmp_path / "v.toml", "--name", "c172x")
    assert (tmp_path / "v.toml").read_text() == fga.identify(path).to_toml("c172x", 150.0)
    fga_program("check", tmp_path / "v.toml")
