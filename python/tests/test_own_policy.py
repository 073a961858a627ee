"""Policies of one's own in Python: judged as the built-in ones, and a failure stays in its encounter."""

from __future__ import annotations

import math
import pickle
import subprocess
import sys
import time
import warnings

import fga
import numpy as np
import pyarrow
import pytest
from conftest import needed
from fga._own import fingerprint

RUNS = """
policies = ["turn-aware"]
cells = ["threats:2:300:15-30", "threats:3:100-500:45-60,planar"]
encounters = 60
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "campaign.toml"
    path.write_text(RUNS)
    return path


@pytest.fixture
def encounters(tmp_path):
    """Head-on encounters, every third one with a second obstacle."""
    path = tmp_path / "encounters.csv"
    lines = ["encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m"]
    for number in range(30):
        lines.append(f"{number},0,{300 + 5 * number},{number % 7},0,-{15 + number % 5},0,0,30")
        if number % 3 == 0:
            lines.append(f"{number},1,500,60,0,-10,-1,0,30")
    path.write_text("\n".join(lines) + "\n")
    return path


def rows(table):
    return pyarrow.table(table).to_pylist()


class Builtin:
    """The default policy, called from Python."""

    def __init__(self, settings, vehicle):
        self.avoider = fga.Avoider(settings, vehicle)

    def step(self, situation):
        return self.avoider.step(situation)

    def retune(self, vehicle):
        self.avoider.retune(vehicle)


def give_way(situation):
    """30 degrees to the right of what is within 200 m ahead."""
    own = situation.ownship
    x, y, z = own.position_m
    for obstacle in situation.obstacles:
        u, v, w = obstacle.position_m
        ahead = (u - x) * math.cos(own.course_rad) + (v - y) * math.sin(own.course_rad) > 0.0
        if ahead and math.dist((x, y, z), (u, v, w)) < 200.0:
            return own.course_rad - math.radians(30.0), 0.0
    return None


class Counts:
    """A policy with a state, which must not pass from flight to flight."""

    def __init__(self):
        self.steps = 0

    def step(self, situation):
        self.steps += 1
        return (0.5, 0.0) if 20 < self.steps < 60 else None


class Plain:
    """A class without `__init__` is made of nothing."""

    def step(self, situation):
        return give_way(situation)


class GiveWayAll:
    """`give_way` for many flights at once."""

    def __init__(self, settings, vehicle):
        pass

    def step_all(self, flights, obstacles):
        flights, obstacles = pyarrow.table(flights), pyarrow.table(obstacles)
        own = {name: flights[name].to_numpy() for name in ("x_m", "y_m", "z_m", "course_rad")}
        at = obstacles["flight"].to_numpy()
        offset = [obstacles[name].to_numpy() - own[name][at] for name in ("x_m", "y_m", "z_m")]
        course = own["course_rad"][at]
        ahead = offset[0] * np.cos(course) + offset[1] * np.sin(course) > 0.0
        near = offset[0] ** 2 + offset[1] ** 2 + offset[2] ** 2 < 200.0**2
        turns = np.zeros(len(flights), dtype=bool)
        turns[at[ahead & near]] = True
        turned = own["course_rad"] - math.radians(30.0)
        return pyarrow.table(
            {
                "course_rad": pyarrow.array(turned, mask=~turns),
                "climb_rad": pyarrow.array(np.zeros(len(flights)), mask=~turns),
            }
        )


def test_a_policy_that_calls_the_avoider_gives_the_rows_of_the_built_in_one(file, tmp_path):
    built_in = fga.campaign(file, tmp_path / "a", policies=["turn-aware"]).table()
    for number, policy in enumerate([fga.Avoider, Builtin]):
        own = fga.campaign(file, tmp_path / f"own-{number}", policies=[policy], threads=2).table()
        for expected, found in zip(rows(built_in), rows(own), strict=True):
            assert found.pop("policy") == f"python:{policy.__qualname__}"
            expected.pop("policy")
            assert found == expected


def test_a_policy_that_calls_the_avoider_flies_a_scenario_to_the_same_bytes(root):
    scenario = root / "scenarios" / "first-flight.toml"
    assert fga.run(scenario, policy=Builtin).track_csv() == fga.run(scenario).track_csv()


def test_a_policy_that_calls_the_avoider_flies_recordings_as_the_built_in_one(root, tmp_path):
    # The airspeed changes from row to row, and the limits with it.
    lines = ["NAME sx sy sz vx vy vz time", "[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]"]
    for second in range(120):
        speed = 50.0 + 0.1 * second
        lines.append(f"own, 0, {50 * second + 0.05 * second**2}, 600, 0, {speed}, 0, {second}")
        lines.append(f"other, 40, {9000 - 40 * second}, 610, 0, -40, 0, {second}")
    folder = tmp_path / "recordings"
    folder.mkdir()
    (folder / "one.daa").write_text("\n".join([lines[0], lines[1], *lines[2:]]) + "\n")
    campaign = tmp_path / "recorded.toml"
    vehicle = (root / "vehicles" / "general-aviation.toml").as_posix()
    campaign.write_text(f'policies = ["none"]\nvehicle = "{vehicle}"\n')
    flight = fga.Simulation(folder / "one.daa", vehicle=vehicle)
    avoider = Builtin(flight.model.settings, flight.model.vehicle)
    while (situation := flight.situation) is not None:
        if (limits := flight.take_retuned()) is not None:
            avoider.retune(limits)
        flight.advance(avoider.step(situation))
    tables = [
        rows(fga.campaign(campaign, tmp_path / str(number), policies=[policy], recordings=[folder]).table())
        for number, policy in enumerate(["turn-aware", Builtin])
    ]
    for expected, found in zip(*tables, strict=True):
        assert expected["start_s"] is not None
        assert {**found, "policy": ""} == {**expected, "policy": ""}
        # A flight step by step is judged as in a campaign.
        standards = flight.outcome()["standards"]
        assert len(standards) > 20
        assert {name: expected[name] for name in standards} == standards


def test_each_flight_has_a_policy_of_its_own(encounters):
    one = fga.batch(encounters, policy=Counts(), threads=1)
    two = fga.batch(encounters, policy=Counts(), threads=2)
    assert one.to_csv() == two.to_csv()
    assert len({row["start_s"] for row in rows(one)}) == 1


def test_a_policy_for_many_flights_gives_the_rows_of_the_one_for_a_flight(encounters):
    each = fga.batch(encounters, policy=give_way)
    together = fga.batch(encounters, policy=GiveWayAll)
    assert fga.batch(encounters, policy=Plain).to_csv() == each.to_csv()
    assert any(row["start_s"] is not None for row in rows(each))
    assert together.to_csv() == each.to_csv()


def hang(situation):
    while len(situation.obstacles) == 2:
        pass


def sleep(situation):
    if len(situation.obstacles) == 2 and situation.time_s > 0.0:
        time.sleep(1000.0)


class Stubborn:
    def step(self, situation):
        while len(situation.obstacles) == 2 and situation.time_s > 0.0:
            try:
                time.sleep(0.001)
            except Exception:
                pass


def raises(situation):
    if len(situation.obstacles) == 2:
        raise ValueError("two are too many")


def not_a_number(situation):
    return (math.nan, 0.0) if len(situation.obstacles) == 2 else None


def infinite(situation):
    return np.array([0.0, -np.inf]) if len(situation.obstacles) == 2 else None


def three_numbers(situation):
    return (0.0, 0.0, 0.0) if len(situation.obstacles) == 2 else None


def word(situation):
    return "left" if len(situation.obstacles) == 2 else None


def nothing_in_a_list(situation):
    return [] if len(situation.obstacles) == 2 else None


class Unmade:
    def __init__(self, settings, vehicle):
        raise RuntimeError("no such planner")

    def step(self, situation):
        pass


@pytest.mark.parametrize(
    ("policy", "kind"),
    [
        (raises, "raised"),
        (sleep, "timed-out"),
        (Stubborn(), "timed-out"),
        (not_a_number, "not-finite"),
        (infinite, "not-finite"),
        (three_numbers, "wrong-shape"),
        (word, "wrong-shape"),
        (nothing_in_a_list, "wrong-shape"),
    ],
)
def test_a_failure_stays_in_its_encounter(encounters, policy, kind):
    with pytest.warns(RuntimeWarning, match="failed in 10 flights"):
        found = rows(fga.batch(encounters, policy=policy, threads=2, time_limit_s=0.2))
    none = rows(fga.batch(encounters, policy="none"))
    for number, (row, mission) in enumerate(zip(found, none, strict=True)):
        assert row.pop("policy_failure") == (kind if number % 3 == 0 else None)
        # From a failure on the mission is flown.
        assert row == mission


def test_a_policy_that_cannot_be_made_fails_in_every_encounter(file, tmp_path):
    with pytest.warns(RuntimeWarning, match="RuntimeError: no such planner"):
        flown = fga.campaign(file, tmp_path / "out", policies=[Unmade, "none"], encounters=4)
    for row in rows(flown.table()):
        assert row["policy_failure"] == ("raised" if row["policy"] == "python:Unmade" else None)


@pytest.mark.parametrize(
    ("answer", "kind"),
    [
        (lambda flights, obstacles: 1 / 0, "raised"),
        (lambda flights, obstacles: pyarrow.table({"course_rad": [0.1]}), "wrong-shape"),
        (lambda flights, obstacles: pyarrow.table({"course_rad": [0.1], "climb_rad": [0.0]}), "wrong-shape"),
        (lambda flights, obstacles: [0.1], "wrong-shape"),
        (lambda flights, obstacles: time.sleep(1000.0), "timed-out"),
    ],
)
def test_a_policy_for_many_flights_that_fails_fails_in_all_of_them(encounters, answer, kind):
    class All:
        def __init__(self, settings, vehicle):
            self.steps = 0

        def step_all(self, flights, obstacles):
            self.steps += 1
            if self.steps > 3:
                return answer(flights, obstacles)
            return pyarrow.table({"course_rad": pyarrow.nulls(len(flights)), "climb_rad": pyarrow.nulls(len(flights))})

    with pytest.warns(RuntimeWarning, match="failed in 30 flights"):
        found = rows(fga.batch(encounters, policy=All, time_limit_s=0.3))
    assert {row["policy_failure"] for row in found} == {kind}


def test_processes_give_the_bytes_of_threads(file, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        here = fga.campaign(file, tmp_path / "threads", policies=[give_way, "none"])
        there = fga.campaign(file, tmp_path / "processes", policies=[give_way, "none"], processes=2)
    assert here.sha256 == there.sha256


def test_a_campaign_with_a_policy_pickles(file):
    campaign = fga.Campaign(file, policies=[give_way, "none"], encounters=4)
    again = pickle.loads(pickle.dumps(campaign))
    assert again.hash == campaign.hash and again.policies == ["python:give_way", "none"]
    assert again.fly_block(0) == campaign.fly_block(0)


def test_a_campaign_does_not_go_on_with_another_policy(file, tmp_path):
    class Turns:
        def __init__(self, degrees):
            self.degrees = degrees

        def step(self, situation):
            return math.radians(self.degrees), 0.0

    fga.campaign(file, tmp_path / "out", policies=[Turns(10)], encounters=4)
    with pytest.raises(ValueError, match="own_sha256"):
        fga.campaign(file, tmp_path / "out", policies=[Turns(20)], encounters=4)


NOTEBOOK = """
import sys, fga
file, out = sys.argv[1:3]
TURN = {turn}
def turned(course): return course - TURN, 0.0
class Mine:
    def step(self, situation):
        return turned(situation.ownship.course_rad) if situation.obstacles else None
print(fga.campaign(file, out, policies=[Mine], encounters=300, processes={processes}).sha256)
"""


def test_a_class_without_a_file_flies_in_processes_and_is_known_by_its_code(file, tmp_path):
    """As in a notebook: what `python -c` defines has no file from which to take a fingerprint."""
    needed("cloudpickle")

    def flown(out, turn, processes=None):
        script = NOTEBOOK.format(turn=turn, processes=processes)
        command = [sys.executable, "-c", script, str(file), str(tmp_path / out)]
        done = subprocess.run(command, capture_output=True, text=True)
        return done.stdout or done.stderr.splitlines()[-1]

    here = flown("here", 0.5)
    assert here == flown("here", 0.5), "goes on"
    assert here == flown("processes", 0.5, processes=2)
    # The class is the same; a value that its function names is another one.
    assert "own_sha256" in flown("here", 0.4)
    assert flown("another", 0.4) != here


def test_a_policy_with_a_file_is_looked_at_where_it_arrives(file):
    """A module of another version on another machine is noticed."""
    campaign = fga.Campaign(file, policies=[give_way], encounters=4)
    assert fga.Campaign.from_json(campaign.to_json(), [(give_way, "0" * 64)]).hash == campaign.hash
    with pytest.raises(ValueError, match="begun with another program for python:give_way"):
        fga.Campaign.from_json(campaign.to_json().replace(fingerprint(give_way), "0" * 64), [(give_way, "0" * 64)])


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"policies": [3]}, TypeError, "expected a name, a class or an object with step"),
        ({"policies": [give_way, give_way]}, ValueError, "named twice"),
        ({"policies": "none"}, TypeError, "Can't extract `str` to `Vec`"),
        ({"policies": ["none"], "recordings": "flights"}, TypeError, "Can't extract `str` to `Vec`"),
        ({"policies": [give_way], "time_limit_s": 0.0}, ValueError, "time_limit_s is 0"),
        ({"policies": ["python:give_way"]}, ValueError, "is an object of a Python program"),
        ({"policies": ["none"], "processes": 0}, ValueError, "processes is 0"),
    ],
)
def test_wrong_arguments_are_one_sentence(file, tmp_path, arguments, error, words):
    with pytest.raises(error, match=words):
        fga.campaign(file, tmp_path / "out", encounters=4, **arguments)


class LooksLeftOnly:
    """The default policy with a planted fault: it does not see what is to its right."""

    def __init__(self, settings, vehicle):
        self.avoider = fga.Avoider(settings, vehicle)

    def step(self, situation):
        own = situation.ownship
        x, y, _ = own.position_m

        def is_left(obstacle):
            u, v, _ = obstacle.position_m
            return (v - y) * math.cos(own.course_rad) - (u - x) * math.sin(own.course_rad) >= 0.0

        seen = [obstacle for obstacle in situation.obstacles if is_left(obstacle)]
        return self.avoider.step(
            fga.Situation(situation.time_s, own, situation.mission, seen, situation.wind_mps)
        )


def test_stress_finds_a_planted_fault_and_the_same_again(tmp_path):
    found = fga.stress(tmp_path / "one", policy=LooksLeftOnly, flights=300, seed=39)
    assert found["first"] <= 2000 and found["failures"][0]["avoidable"]
    assert fga.stress(tmp_path / "two", policy=LooksLeftOnly, flights=300, seed=39) == found
    page = (tmp_path / "one" / "stress.html").read_text()
    assert "LooksLeftOnly" in page and (tmp_path / "one" / "replay" / "1.html").exists()
    with pytest.raises(ValueError, match="expected uas or aircraft"):
        fga.stress(tmp_path / "no", kind="still")
    with pytest.raises(ValueError, match="flights is 0"):
        fga.stress(tmp_path / "no", flights=0)
