"""Zones and the ground: what a pilot sees of them, and what a flight keeps."""

import json
import math
import pickle

import numpy as np
import pyarrow as pa
import pytest

import fga

SCENARIOS = ["ridge.toml", "fenced-valley.toml"]
SQUARE = [(0, 0), (100, 0), (100, 100), (0, 100)]


def wall(north):
    """Ground 100 m below the line, and 300 m above it on one side of it."""
    heights = np.full((81, 161), -100.0)
    heights[41:] = 300.0
    if not north:
        heights = heights[::-1]
    return fga.Ground(heights, (-1000, -1000), (25, 25), clearance_m=20, error_m=5)


def side(**around):
    """To which side of a head-on aircraft a flight begins to turn."""
    mission = fga.Mission([(0, 0, 0), (5000, 0, 0)], limits_m=(-5, 5), **around)
    avoider = fga.Avoider()
    for cycle in range(80):
        time_s = 0.1 * cycle
        ownship = fga.Ownship((15 * time_s, 0, 0), 0.0, 15.0)
        place = (400 - 15 * time_s, 0, 0)
        head_on = fga.Obstacle(id=1, position_m=place, velocity_mps=(-15, 0, 0), radius_m=30, kind="aircraft")
        decision = avoider.step(fga.Situation(time_s, ownship, mission, [head_on]))
        if decision.state == "avoiding":
            return math.sin(decision.command[0].course_rad)
    raise AssertionError("no manoeuvre")


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_flight_step_by_step_keeps_ground_and_zones_as_that_of_the_program(root, name, fga_program, tmp_path):
    file = root / "scenarios" / name
    told = json.loads(fga_program("run", file, "--json", "--out", tmp_path, codes=(0, 2)).stdout)
    shown, stepped = fga.Simulation(file), fga.Simulation(file)
    avoiders = [fga.Avoider(shown.model.settings, shown.model.vehicle) for _ in range(2)]
    while (decision := stepped.step(avoiders[0])) is not None:
        if (retuned := shown.take_retuned()) is not None:
            avoiders[1].retune(retuned)
        again = avoiders[1].step(shown.situation)
        assert again == decision
        shown.advance(again)
    for flight in (shown, stepped):
        outcome = flight.outcome()
        for key in ("min_margin_m", "min_terrain_clearance_m", "min_zone_margin_m", "end_s"):
            assert outcome[key] == told.get(key), key


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_policy_of_ones_own_sees_zones_and_ground(root, name):
    seen = []

    def look(situation):
        seen.append((len(situation.mission.zones), situation.mission.ground is not None))

    fga.run(root / "scenarios" / name, policy=look)
    assert set(seen) == {(3, False) if name.startswith("fenced") else (0, True)}
    named = fga.run(root / "scenarios" / name)
    own = fga.run(root / "scenarios" / name, policy=fga.Avoider)
    assert own.track_csv() == named.track_csv()


def test_zones_and_ground_turn_a_manoeuvre_to_the_other_side():
    right = fga.Zone(polygon_m=[(100, -300), (900, -300), (900, -5), (100, -5)])
    left = fga.Zone(polygon_m=[(100, 5), (900, 5), (900, 300), (100, 300)])
    assert side(zones=[right]) > 0 > side(zones=[left])
    assert side(ground=wall(north=False)) > 0 > side(ground=wall(north=True))


def test_zones_and_ground_come_back_from_a_pickle():
    heights = np.array([[1.0, 2.0, math.nan], [4.0, 5.0, 6.0]])
    ground = fga.Ground(heights, (10, 20), (30, 40), clearance_m=50, error_m=6)
    circle = fga.Zone(keep_in=True, center_m=(5, 6), radius_m=70, floor_m=-1)
    for value in (ground, circle, fga.Zone(polygon_m=SQUARE, ceiling_m=120)):
        assert pickle.loads(pickle.dumps(value)) == value
    mission = fga.Mission([(0, 0, 0), (1, 0, 0)], zones=[circle], ground=ground)
    assert pickle.loads(pickle.dumps(mission)) == mission
    assert mission.zones == [circle] and mission.ground == ground
    assert np.array_equal(ground.heights_m, heights, equal_nan=True)
    assert ground.height_m(10, 40) == 2.5 and ground.height_m(55, 40) is None
    assert circle.polygon_m is None and circle.center_m == (5, 6) and circle.ceiling_m == math.inf


@pytest.mark.parametrize(
    ("make", "error", "told"),
    [
        (lambda: fga.Zone(), ValueError, "no outline"),
        (lambda: fga.Zone(center_m=(0, 0), radius_m=-1), ValueError, "no outline"),
        (lambda: fga.Zone(polygon_m=[(0, 0), (1, 1)]), ValueError, "2 corners"),
        (lambda: fga.Zone(polygon_m=[(0, 0), (1, 1), (1, 0), (0, 1)]), ValueError, "crosses itself"),
        (lambda: fga.Zone(polygon_m=SQUARE, floor_m=5, ceiling_m=1), ValueError, "floor"),
        (lambda: fga.Zone(polygon_m=[(0, 0, 0)] * 3), TypeError, "two numbers"),
        (lambda: fga.Ground([1.0, 2.0], (0, 0), (1, 1), 5), TypeError, "two dimensions"),
        (lambda: fga.Ground(np.zeros((1, 5)), (0, 0), (1, 1), 5), ValueError, "heights_m is 5, expected rows of 2"),
        (lambda: fga.Ground(np.zeros((3, 3)), (0, 0), (0, 1), 5), ValueError, "spacing is 0, expected above 0"),
        (lambda: fga.Ground(np.zeros((3, 3)), (0, 0), (1, 1), -5), ValueError, "clearance_m is -5, expected 0 to"),
    ],
)
def test_a_wrong_zone_or_ground_is_refused_in_a_sentence(make, error, told):
    with pytest.raises(error, match=told):
        make()


def test_rows_of_a_campaign_in_valleys_say_what_each_flight_keeps(root, tmp_path):
    done = fga.campaign(root / "campaigns" / "valleys.toml", tmp_path, encounters=12)
    table = pa.table(done.table()).to_pydict()
    for source, above_m, zone_m in zip(table["source"], table["min_terrain_clearance_m"], table["min_zone_margin_m"]):
        if source.startswith("corridor"):
            assert above_m is None and zone_m >= 0
        else:
            assert zone_m is None and above_m >= 25 - 1e-3
