"""Wrong input from Python: exceptions, never a crash of the interpreter.

FGA_FUZZ sets the number of cases for each function, 10000 for a long run.
"""

import copy
import functools
import io
import json
import os
import pickle
import tempfile
import threading

import numpy as np
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
# What the module pickle raises for bytes that are no pickle.
DAMAGED = (*EXPECTED, pickle.UnpicklingError, EOFError, AttributeError, KeyError, IndexError, ImportError, MemoryError)

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


def attempt(call, expected=EXPECTED):
    try:
        return call()
    except expected as error:
        assert str(error) or expected is DAMAGED
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


@CASES
@given(st.data())
def test_logs_and_monitors(data):
    draw = data.draw
    names = ["t_s", "airspeed_mps", "bank_command_rad", "bank_rad", "course_rad", "climb_rad"]
    log = {name: draw(array) for name in names[: draw(st.integers(0, 6))]}
    attempt(lambda: fga.identify(draw(st.sampled_from([log, list(log), None, 3, "", b"x", object()]))))
    attempt(lambda: fga.Monitor(draw(st.text(max_size=5))))
    attempt(lambda: fga.alerts(draw(st.text(max_size=5)), draw(number)))
    attempt(lambda: fga.bands(draw(number), draw(st.text(max_size=5))))


def situation(time_s, ids):
    near = [fga.Obstacle(i, (150.0 + 10 * i, 3.0 * i, 100.0), 20.0) for i in ids]
    ownship = fga.Ownship((0, 0, 100), 0.0, 15.0)
    return fga.Situation(time_s, ownship, fga.Mission([(0, 0, 100), (5000, 0, 100)]), near)


@CASES
@given(st.lists(st.tuples(number, st.lists(st.integers(0, 4), max_size=3)), min_size=1, max_size=3))
def test_two_threads_step_one_avoider(steps):
    """Any order of times and identifiers, from two threads at once: a decision or an exception in each."""
    avoider, wrong = fga.Avoider(), []

    def fly():
        for time_s, ids in steps:
            try:
                attempt(lambda: avoider.step(situation(time_s, ids)))
            except BaseException as error:  # noqa: BLE001
                wrong.append(error)

    other = threading.Thread(target=fly)
    other.start()
    fly()
    other.join()
    assert not wrong


COLUMNS = ["encounter", "obstacle", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "radius_m", "kind"]


def right(name):
    """A column that every table may have, four rows long."""
    import pyarrow as pa

    return pa.array({
        "encounter": [0, 0, 1, 2], "obstacle": [0, 1, 0, 0], "x_m": [200.0, 260.0, 300.0, 1e4],
        "vx_mps": [-5.0, 0.0, 3.0, 0.0], "radius_m": [20.0, 30.0, 5.0, 1.0], "kind": ["straight", "uas", "aircraft", "still"],
    }.get(name, [0.0, 3.0, -4.0, 0.0]))  # fmt: skip


def wrong(draw):
    """A column of any type and length."""
    import pyarrow as pa

    rows = draw(st.sampled_from([4, 4, 4, 0, 3]))
    values = draw(st.lists(st.one_of(st.floats(), st.integers(-3, 2**63 - 1), st.none()), min_size=rows, max_size=rows))
    kind = draw(
        st.sampled_from([
            pa.float64(), pa.float32(), pa.float16(), pa.int64(), pa.uint64(), pa.int8(), pa.bool_(), pa.string(), pa.large_string(),
            pa.string_view(), pa.binary(), pa.null(), pa.timestamp("s"), pa.list_(pa.float64()), pa.dictionary(pa.int8(), pa.float64()),
        ])  # fmt: skip
    )
    try:
        return pa.array(values, kind)
    except (pa.ArrowException, ValueError, TypeError, OverflowError):
        return pa.nulls(rows, kind)


class NoStream:
    """Claims to be a table."""

    def __init__(self, given):
        self.given = given

    def __arrow_c_stream__(self, requested_schema=None):
        if self.given is None:
            raise ValueError("refused")
        return self.given


@CASES
@given(st.data())
def test_tables(data):
    pa = needed("pyarrow")
    draw = data.draw
    changed = draw(st.sets(st.sampled_from(COLUMNS), max_size=2))
    left_out = draw(st.sets(st.sampled_from(COLUMNS), max_size=1))
    columns = {name: wrong(draw) if name in changed else right(name) for name in COLUMNS if name not in left_out}
    rows = min(len(column) for column in columns.values())
    table = pa.table({name: column[:rows] for name, column in columns.items()})
    cut = draw(st.integers(0, rows))
    given = draw(
        st.sampled_from([
            table, table.slice(cut), pa.concat_tables([table.slice(cut), table.slice(0, cut)]), pa.chunked_array([right("x_m")]),
            NoStream(3), NoStream(None), NoStream(pa.array([1]).__arrow_c_array__()[0]),
        ])  # fmt: skip
    )
    # Short flights: what is fuzzed is the way in.
    horizon_s = draw(st.sampled_from([0.5, 2.0, 0.0, -1.0, float("nan"), float("inf"), None, "x"]))
    attempt(lambda: fga.batch(given, policy=draw(st.sampled_from(["turn-aware", "none", "mvp", ""])), horizon_s=horizon_s, threads=1))
    attempt(lambda: fga.oracle(given, horizon_s=horizon_s, threads=draw(st.sampled_from([1, 0, -1, 2**40, None]))))


@CASES
@given(st.data())
def test_worlds_and_shields(data):
    draw = data.draw
    cell = draw(st.sampled_from(["threats:2:300:5-20", "threats:0:300:5-20", "threats:2:nan:5-20", "threats", "", "x:1"]))
    worlds = attempt(
        lambda: fga.Worlds(
            cell, draw(st.integers(-1, 3)), seed=draw(st.integers(-1, 2**64)), horizon_s=draw(number),
            seen=draw(st.integers(-1, 5)), shielded=draw(st.booleans()),
        )  # fmt: skip
    )
    if worlds is not None:
        attempt(lambda: worlds.reset(draw(st.lists(st.integers(-1, 3), max_size=2)), draw(st.lists(st.integers(0, 2**64), max_size=2))))
        actions = draw(st.one_of(array, st.lists(st.tuples(st.floats(), st.floats()), max_size=3).map(lambda v: np.array(v).reshape(-1, 2))))
        attempt(lambda: worlds.step(actions, draw(st.one_of(st.none(), st.lists(st.booleans(), max_size=3)))))
        assert worlds.observe().shape == (len(worlds), worlds.observed)
    for most in ({"count": 100_000, "seen": 1000}, {"count": 2**62}, {"seen": 2**62}):
        assert attempt(lambda: fga.Worlds(**{"cell": "threats:2:300:5-20", "count": 1, **most})) is None
    wish = attempt(lambda: fga.Decision(draw(st.lists(number, max_size=2))))
    attempt(lambda: fga.Shield().step(draw(st.sampled_from([situation(0.0, [1]), None])), draw(st.sampled_from([wish, fga.Decision([]), 3]))))


CAMPAIGN = """name = "small"
encounters = 3
seeds = [1]
policies = ["none"]
[[grid]]
family = "threats"
count = [1]
first_seen_m = [300]
speed_mps = [[5, 20]]
"""


@functools.cache
def configuration():
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "small.toml")
        with open(file, "w", encoding="utf-8") as out:
            out.write(CAMPAIGN)
        return fga.Campaign(file).to_json()


@CASES
@given(st.data())
def test_campaigns(data):
    """A configuration with one value changed: refused, or a campaign that says its size."""
    draw = data.draw
    told = json.loads(configuration())
    places = []

    def walk(node):
        for key in node if isinstance(node, dict) else range(len(node)):
            places.append((node, key))
            if isinstance(node[key], (dict, list)):
                walk(node[key])

    walk(told)
    for _ in range(draw(st.integers(1, 2))):
        node, key = draw(st.sampled_from(places))
        node[key] = draw(st.one_of(number, st.integers(), st.sampled_from([[], {}, 2**64 - 1, -1, "turn-aware"])))
    campaign = attempt(lambda: fga.Campaign.from_json(json.dumps(told)))
    if campaign is not None:
        assert campaign.blocks >= 0 and repr(campaign.encounters) and campaign.hash
        block = draw(st.sampled_from([0, 1, 2**63, 2**64 - 1, -1]))
        attempt(lambda: campaign.range_of(block))
        attempt(lambda: campaign.decisions(draw(st.integers(-1, 4)), draw(st.sampled_from(["none", "x", None, 3]))))


class Own(pickle.Unpickler):
    def find_class(self, module, name):
        if module.split(".")[0] != "fga" or "." in name:
            raise ValueError(f"{module}.{name} is refused")
        return super().find_class(module, name)


VALUES = [
    fga.Ownship((0, 0, 100), 0.0, 15.0), fga.Vehicle(15.0, 40.0), fga.Settings(), fga.Mission([(0, 0, 0), (100, 0, 0)]),
    fga.Obstacle(1, (1, 2, 3), 4), fga.Decision([]), situation(0.0, [1]), fga.Avoider(), fga.Avoider().step(situation(0.0, [1])),
    fga.Obstacles(id=[1, 2], **{name: [0.5, 2.0] for name in ("x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps", "radius_m")}),
]  # fmt: skip


@CASES
@given(st.sampled_from(VALUES), st.integers(0, pickle.HIGHEST_PROTOCOL), st.integers(0, 400), st.binary(max_size=4))
def test_pickles(value, protocol, place, noise):
    """What is pickled comes back or is refused; a damaged pickle is an exception."""
    data = attempt(lambda: pickle.dumps(value, protocol))
    attempt(lambda: copy.copy(value))
    attempt(lambda: copy.deepcopy(value))
    if data is None:
        return
    back = pickle.loads(data)
    assert back == value and repr(back) == repr(value)
    damaged = data[:place] + noise + data[place + len(noise) :]
    # Data may become another pickle: only names of this package are taken, so that nothing else is called.
    attempt(lambda: Own(io.BytesIO(damaged)).load(), DAMAGED)


@CASES
@given(st.lists(st.integers(0, 4), max_size=3), number)
def test_a_fork_between_any_steps(ids, time_s):
    avoider = fga.Avoider()
    attempt(lambda: avoider.step(situation(0.0, ids)))
    child = os.fork()
    if child == 0:
        try:
            attempt(lambda: avoider.step(situation(time_s, ids)))
        except BaseException:  # noqa: BLE001
            os._exit(1)
        os._exit(0)
    attempt(lambda: avoider.step(situation(time_s, ids)))
    assert os.waitpid(child, 0)[1] == 0
