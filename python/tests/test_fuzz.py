"""Wrong input from Python: exceptions, never a crash of the interpreter.

FGA_FUZZ sets the number of cases for each function; the evidence uses 10000.
"""

import os

import numpy as np
import pytest
from conftest import needed

import fga

hypothesis = needed("hypothesis")
from hypothesis import HealthCheck, given, settings, strategies as st  # noqa: E402

CASES = settings(
    max_examples=int(os.environ.get("FGA_FUZZ", "150")),
    deadline=None,
    derandomize="FGA_FUZZ" not in os.environ,
    suppress_health_check=list(HealthCheck),
)
EXPECTED = (ValueError, TypeError, OverflowError, RuntimeError, OSError)

number = st.one_of(
    st.floats(), st.integers(), st.none(), st.text(max_size=3), st.booleans(),
    st.sampled_from([0.0, -0.0, 1e-310, 1e308, float("inf"), 15.0, 30.0]),
)  # fmt: skip
plain = st.floats(-500, 500)
triple = st.one_of(st.tuples(plain, plain, plain), st.tuples(number, number, number), st.lists(number, max_size=4), number)
array = st.one_of(
    st.lists(st.floats(), max_size=5).map(np.array),
    st.lists(plain, min_size=3, max_size=3).map(np.array),
    st.lists(st.integers(-5, 5), max_size=4).map(lambda v: np.array(v, dtype=np.int64)),
    st.lists(st.integers(0, 5), max_size=4).map(lambda v: np.array(v, dtype=np.uint32)),
    st.sampled_from([np.zeros((2, 2)), np.array("x"), np.array([None]), np.array([1j]), np.zeros(3, "M8[s]"), np.zeros(3)[::2]]),
    st.lists(number, max_size=4),
    number,
)


def attempt(call):
    try:
        return call()
    except EXPECTED as error:
        assert str(error)
        return None


@CASES
@given(st.data())
def test_values(data):
    draw = data.draw
    attempt(lambda: fga.Ownship(draw(triple), draw(number), draw(number), draw(number), draw(number)))
    attempt(lambda: fga.Vehicle(*[draw(number) for _ in range(8)]))
    attempt(lambda: fga.Settings(start=draw(st.text(max_size=5)), horizon_s=draw(number), work_limit=draw(number)))
    attempt(lambda: fga.Decision(draw(st.lists(number, max_size=2)), draw(number)))
    attempt(lambda: fga.Mission(draw(st.lists(triple, max_size=4)), draw(st.lists(st.integers(-1, 4), max_size=2))))


@CASES
@given(st.lists(array, min_size=11, max_size=11))
def test_columns(values):
    names = [
        "id", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "radius_m",
        "half_height_m", "position_sigma_m", "velocity_sigma_mps",
    ]  # fmt: skip
    obstacles = attempt(lambda: fga.Obstacles(**dict(zip(names, values, strict=True))))
    if obstacles is not None:
        step(obstacles, (0.0, 0.0, 0.0))


def step(obstacles, wind):
    mission = fga.Mission([(0, 0, 100), (5000, 0, 100)])
    ownship = fga.Ownship((0, 0, 100), 0.0, 15.0)
    situation = attempt(lambda: fga.Situation(0.0, ownship, mission, obstacles, wind))
    if situation is not None:
        decision = fga.Avoider().step(situation)
        assert decision.state in {"cruise", "threatened", "avoiding", "recovering"}
        assert repr(decision) and decision.to_dict()


@CASES
@given(st.data())
def test_steps(data):
    draw = data.draw
    obstacles = []
    for index in range(draw(st.integers(0, 4))):
        made = attempt(
            lambda: fga.Obstacle(
                index, draw(triple), draw(number), draw(triple), draw(st.one_of(st.none(), number)),
                kind=draw(st.sampled_from(["still", "straight", "aircraft", "uas", "x"])),
            )  # fmt: skip
        )
        obstacles.append(made)
    step(draw(st.sampled_from([obstacles, None, 3, [o for o in obstacles if o]])), draw(triple))


@CASES
@given(st.text(max_size=12), st.text(max_size=12), number, number)
def test_names_and_paths(one, two, three, four):
    attempt(lambda: fga.run(one, two))
    attempt(lambda: fga.batch(one, policy=two, horizon_s=three, threads=four))
    attempt(lambda: fga.Campaign.from_json(one))
    attempt(lambda: fga.VehicleModel.read(one))
    attempt(lambda: fga.Simulation(one))
    attempt(lambda: fga.batch(np.zeros(3)))
