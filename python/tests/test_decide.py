"""Ring 1: decisions step by step."""

import doctest
import json
import multiprocessing
import pickle
import sys
import threading

import numpy as np
import pytest

import fga

SCENARIOS = ["first-flight.toml", "fig-16.toml", "sfo.toml"]


def situation(time_s=0.0, obstacles=()):
    mission = fga.Mission([(0, 0, 100), (5000, 0, 100)])
    ownship = fga.Ownship((15 * time_s, 0, 100), 0.0, 15.0)
    return fga.Situation(time_s, ownship, mission, list(obstacles))


@pytest.mark.parametrize("policy", ["turn-aware", "none", "published --start t0"])
@pytest.mark.parametrize("before", [[], [(0, 0, 100), (300, 0, 100)], [(0, 0, 100), (5000, 0, 100)]])
def test_another_mission_is_flown_whatever_was_flown_before(policy, before):
    """After none, after its end and on a leg; the same mission again changes nothing."""
    vehicle = fga.VehicleModel().vehicle
    pilot = fga.Pilot(policy)
    north = [(0, 0, 100), (0, 3000, 100)]
    ownship = fga.Ownship((0, 0, 100), 0.0, vehicle.airspeed_mps)
    for step in range(1200):
        mission = fga.Mission(before if step < 400 else north)
        decision = pilot.step(fga.Situation(0.1 * step, ownship, mission))
        ownship = decision.predicted(vehicle, 0.1)
    assert abs(ownship.position_m[0]) < 1 and ownship.position_m[1] > 100


def test_the_examples_of_the_documentation():
    assert doctest.testmod(fga).failed == 0


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_flight_step_by_step_is_that_of_the_program_to_the_bit(root, name, fga_program, tmp_path):
    file = root / "scenarios" / name
    told = json.loads(fga_program("run", file, "--json", "--out", tmp_path, codes=(0, 2)).stdout)
    flight = fga.Simulation(file)
    avoider = fga.Avoider(flight.model.settings, flight.model.vehicle)
    decided = []
    while (decision := flight.step(avoider)) is not None:
        decided.append((decision.state, decision.reason))
    outcome = flight.outcome()
    for key in ("min_separation_m", "min_margin_m", "start_s", "clear_s", "extra_path_m", "end_s"):
        assert outcome[key] == told[key], key
    assert len(decided) == told["decisions"]
    events = [json.loads(line) for line in (tmp_path / "events.jsonl").read_text().splitlines()]
    changes = [(e["state"], e["reason"]) for e in events if e["event"] == "decision"]
    assert [one for one in dict.fromkeys(changes)] == [
        one for one in dict.fromkeys(d for d in decided if d in set(changes))
    ]


@pytest.mark.parametrize("name", SCENARIOS)
def test_situations_taken_apart_and_put_together_give_the_same_decisions(root, name):
    """Every number of every situation survives the way through Python's classes."""
    file = root / "scenarios" / name
    logged = fga.run(file).decisions
    flight = fga.Simulation(file)
    avoider = fga.Avoider(flight.model.settings, flight.model.vehicle)
    mission = flight.situation.mission
    count = 0
    while (seen := flight.situation) is not None:
        own = seen.ownship
        rebuilt = fga.Situation(
            seen.time_s,
            fga.Ownship(own.position_m, own.course_rad, own.airspeed_mps, own.climb_rad, own.bank_rad),
            mission,
            pickle.loads(pickle.dumps(seen)).obstacles,
            seen.wind_mps,
        )
        decision = avoider.step(rebuilt)
        assert decision == logged[count]
        count += 1
        flight.advance(decision)
    assert count == len(logged)


def test_columns_are_the_same_as_rows():
    rng = np.random.default_rng(1)
    count = 100
    place = rng.uniform(-100, 100, (count, 3)) + [200, 0, 100]
    speed = rng.uniform(-10, 10, (count, 3))
    rows = [fga.Obstacle(i, tuple(place[i]), 10.0, tuple(speed[i])) for i in range(count)]
    columns = fga.Obstacles(
        id=np.arange(count, dtype=np.uint32),
        x_m=place[:, 0], y_m=place[:, 1], z_m=place[:, 2],
        vx_mps=speed[:, 0], vy_mps=speed[:, 1], vz_mps=speed[:, 2],
        radius_m=np.full(count, 10.0),
    )  # fmt: skip
    base = situation()
    by_rows = fga.Avoider().step(fga.Situation(0.0, base.ownship, base.mission, rows))
    by_columns = fga.Avoider().step(fga.Situation(0.0, base.ownship, base.mission, columns))
    assert by_rows == by_columns and by_rows.tracked > 50


def test_values_read_well_and_come_back_from_their_repr():
    values = [
        fga.Ownship((1, 2, 3), 0.5, 15.0),
        fga.Obstacle(1, (120, 5, 100), 30, half_height_m=20, kind="uas", nature="passengers"),
        fga.Settings(start="Cs=0.5", horizon_s=30.0),
        fga.Vehicle(15.0, 30.0),
        fga.Mission([(0, 0, 0), (1, 0, 0)], [1]),
        fga.Stage(1.0),
    ]
    for value in values:
        assert eval(repr(value), {**vars(fga), "inf": float("inf")}) == value
        assert pickle.loads(pickle.dumps(value)) == value


@pytest.mark.parametrize("name", SCENARIOS)
def test_what_a_flight_sees_and_decides_comes_back_from_a_pickle(root, name):
    flight = fga.Simulation(root / "scenarios" / name)
    avoider = fga.Avoider(flight.model.settings, flight.model.vehicle)
    states = set()
    while (seen := flight.situation) is not None:
        assert pickle.loads(pickle.dumps(seen)) == seen
        decision = avoider.step(seen)
        back = pickle.loads(pickle.dumps(decision))
        # A proof does not come back: only the core makes one.
        shown = {**decision.to_dict(), "proof": None}
        assert back == decision and back.text == decision.text and back.to_dict() == shown
        assert back.predicted(flight.model.vehicle, 10.0) == decision.predicted(flight.model.vehicle, 10.0)
        for part in (decision.threat, decision.chosen, decision.alternative):
            assert pickle.loads(pickle.dumps(part)) == part
        states.add(decision.state)
        flight.advance(decision)
    assert {"cruise", "avoiding"} <= states


def test_columns_come_back_from_a_pickle():
    base = situation()
    for more in ({}, {"half_height_m": [5.0, 6.0, 1e-300]}, {"velocity_sigma_mps": [0.1, 0.2, 1 / 3]}):
        seen = columns(x_m=[0.1, 1e9, -0.7], **more)
        assert pickle.loads(pickle.dumps(seen)) == seen
        assert pickle.loads(pickle.dumps(seen)) != columns(x_m=[0.1, 1e9, -0.6], **more)
        whole = fga.Situation(0.0, base.ownship, base.mission, seen, (1.0, 2.0, 3.0))
        assert pickle.loads(pickle.dumps(whole)) == whole
        assert whole != fga.Situation(0.0, base.ownship, base.mission, seen)
        # The same obstacles as rows are the same situation.
        assert whole == fga.Situation(0.0, base.ownship, base.mission, whole.obstacles, (1.0, 2.0, 3.0))


def decided(job):
    settings, vehicle, seen = job
    return fga.Avoider(settings, vehicle).step(seen)


def test_processes_exchange_situations_and_decisions():
    seen = [situation(0.0, [fga.Obstacle(1, (120.0 + at, 5.0, 100.0), 30.0)]) for at in range(4)]
    jobs = [(fga.Settings(), fga.Vehicle(15.0, 30.0), one) for one in seen]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map(decided, jobs) == [decided(job) for job in jobs]


def test_what_does_not_pickle_says_what_to_send_instead(root, tmp_path):
    file = tmp_path / "e.csv"
    file.write_text("encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n0,0,150,0,0,0,0,0,30\n")
    scenario = root / "scenarios" / "fig-16.toml"
    model = fga.VehicleModel.read(root / "vehicles" / "rascal-110.toml")
    values = [fga.Avoider(), fga.Pilot(), fga.batch(file), fga.Simulation(scenario), fga.run(scenario), model]
    for value in values:
        with pytest.raises(TypeError, match="cannot be pickled: (make|send) "):
            pickle.dumps(value)


def test_an_identifier_that_is_used_twice_is_refused_as_in_a_scenario(root, tmp_path):
    sentence = "obstacle number 7 is used twice, expected a number of its own for each"
    twice = [fga.Obstacle(number, (200.0, 50.0 * at, 100.0), 10.0) for at, number in enumerate([7, 3, 7])]
    with pytest.raises(ValueError, match=f"^{sentence}$"):
        situation(obstacles=twice)
    with pytest.raises(ValueError, match=f"^{sentence}$"):
        columns(id=[7, 3, 7])
    text = (root / "scenarios" / "fig-16.toml").read_text().replace("../vehicles", str(root / "vehicles"))
    file = tmp_path / "twice.toml"
    file.write_text(text + 2 * "\n[[obstacle]]\nid = 7\nposition_m = [900, 900, 100]\nradius_m = 30\n")
    with pytest.raises(ValueError, match=sentence):
        fga.run(file)


@pytest.mark.parametrize(
    ("wrong", "error", "sentence"),
    [
        (lambda: fga.Vehicle(float("nan"), 30), ValueError, "airspeed_mps is NaN, expected 1 to 1,000"),
        (lambda: fga.Mission([(0, 0, 0)]), ValueError, "1 waypoint"),
        (lambda: fga.Mission([(0, 0), (1, 0)]), TypeError, "three numbers"),
        (lambda: fga.Obstacle(1, (0, 0, 0), -1.0), ValueError, "radius_m is -1"),
        (lambda: fga.Obstacle(1, (0, 0, float("inf")), 1.0), ValueError, "position_m"),
        (lambda: fga.Obstacle(1, (0, 0, 0), 1.0, kind="bird"), ValueError, "still, straight"),
        (lambda: fga.Obstacle(1, (0, 0, 0), 1.0, (-20, 0, 0), kind="still"), ValueError, r"\(-20.0, 0.0, 0.0\) of kind still, expected zeros"),
        (lambda: fga.Obstacle(1, (0, 0, 0), 1.0, nature="bird"), ValueError, "nature is \"bird\", expected unknown"),
        (lambda: fga.Settings(work_limit=5), ValueError, "work_limit is 5"),
        (lambda: fga.Settings(work_limit=-5), ValueError, "work_limit is -5, expected 10,000"),
        (lambda: fga.Settings(start="soon"), ValueError, "unknown start"),
        (lambda: fga.Pilot("nobody"), ValueError, "unknown policy"),
        (lambda: fga.VehicleModel.read("none.toml"), FileNotFoundError, "none.toml"),
        (lambda: fga.Avoider().step(None), TypeError, "Situation"),
        (lambda: fga.Decision([fga.Stage(0.0)] * 41), ValueError, "at most 40"),
        (lambda: situation(float("nan")), ValueError, "NaN"),
        (lambda: situation(obstacles=[3]), TypeError, "sequence of Obstacle"),
        (lambda: pickle.dumps(fga.Avoider()), TypeError, "cannot be pickled"),
    ],
)
def test_wrong_input_is_said_in_a_sentence(wrong, error, sentence):
    with pytest.raises(error, match=sentence):
        wrong()


def columns(**changed):
    names = ["id", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "radius_m"]
    ids = {"id": np.arange(3, dtype=np.uint32)}
    return fga.Obstacles(**{name: np.zeros(3) for name in names} | ids | changed)


@pytest.mark.parametrize(
    ("changed", "error", "sentence"),
    [
        ({"x_m": np.zeros(2)}, ValueError, "column x_m has 2 values, expected 3"),
        ({"x_m": np.zeros(3, dtype=complex)}, TypeError, "column x_m"),
        ({"x_m": np.zeros((3, 1))}, TypeError, "2 dimensions"),
        ({"x_m": np.array(["a", "b", "c"])}, TypeError, "column x_m"),
        ({"y_m": np.array([0, np.nan, 0])}, ValueError, "column y_m holds NaN at 1"),
        ({"radius_m": np.array([0, 0, -1.0])}, ValueError, "column radius_m holds -1 at 2"),
        ({"id": np.array([0, 1, -1])}, ValueError, "column id holds -1 at 2, expected whole numbers"),
        ({"id": [0, 1, 2**32]}, ValueError, "column id holds 4294967296 at 2"),
        ({"id": np.zeros(3)}, TypeError, "column id is an array of float64"),
        ({"id": [0, "1", 2]}, TypeError, "column id holds 1 at 1"),
        ({"id": 7}, TypeError, "column id is <class 'int'>"),
        ({"half_height_m": np.zeros(4)}, ValueError, "half_height_m has 4"),
    ],
)
def test_wrong_columns_are_said_in_a_sentence(changed, error, sentence):
    with pytest.raises(error, match=sentence):
        columns(**changed)


def test_a_second_thread_on_one_avoider_gets_an_exception_or_waits_its_turn():
    avoider = fga.Avoider()
    near = [fga.Obstacle(i, (200.0, 3.0 * i, 100.0), 20.0) for i in range(60)]
    errors, wrong = [], []

    def step():
        for number in range(150):
            try:
                avoider.step(situation(float(number), near))
            except RuntimeError as error:
                errors.append(str(error))
            except BaseException as error:  # noqa: BLE001
                wrong.append(error)

    threads = [threading.Thread(target=step) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
    assert all("another thread" in error for error in errors)
    assert avoider.step(situation(1e4)).state == "cruise"


def forked(avoider, queue):
    queue.put((avoider.step(situation(1.0)).state, len(fga.batch(CSV, threads=2))))


CSV = None


@pytest.mark.skipif(sys.platform == "win32", reason="there is no fork")
def test_a_process_may_fork_between_calls(tmp_path):
    global CSV
    CSV = tmp_path / "e.csv"
    CSV.write_text("encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m\n0,0,150,0,0,0,0,0,30\n")
    avoider = fga.Avoider()
    avoider.step(situation())
    fga.batch(CSV, threads=2)
    context = multiprocessing.get_context("fork")
    queue = context.SimpleQueue()
    child = context.Process(target=forked, args=(avoider, queue))
    child.start()
    child.join(60)
    assert child.exitcode == 0 and queue.get() == ("cruise", 1)
    assert avoider.step(situation(1.0)).state == "cruise"
