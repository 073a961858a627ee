"""The compiled part of the package `fga`; written by python/stubs.py."""

from os import PathLike
from typing import Any, Callable, Literal, Mapping, Sequence, final

import numpy as np
import pandas
import polars
from numpy.typing import ArrayLike, NDArray

_Path = str | PathLike[str]
_Triple = tuple[float, float, float]
_Progress = Callable[[int, int], None]

versions: dict[str, str]

@final
class Avoider:
    """Collision avoidance for one aircraft: call it each cycle with a Situation and fly its Decision.

    Call `step` every `settings.decision_period_s` seconds. It remembers its present manoeuvre, so one
    aircraft needs one avoider. A situation may have another mission than the last one: it begins at its first leg, or goes on
    where both have the same waypoints up to the end of the present leg. A step releases the interpreter's lock; a second thread that steps the same
    avoider meanwhile gets RuntimeError. It cannot be pickled; after a fork each process has its own copy.
    """

    def __new__(cls, settings: Settings | None = None, vehicle: Vehicle | None = None) -> Avoider: ...
    def restart(self) -> None:
        """Forgets the last flight."""
        ...
    def retune(self, vehicle: Vehicle) -> None:
        """Applies changed limits of the vehicle."""
        ...
    def step(self, situation: Situation) -> Decision:
        """Decides the command until the next step."""
        ...

@final
class Campaign:
    """A campaign from its file: encounters drawn by number, flown under every policy, in blocks.

    `Campaign(file)` reads a campaign file as the program does. It pickles as its configuration, so workers
    need neither the file nor its folder; files of encounters in it must keep their paths.
    """

    def __new__(cls, file: _Path, encounters: int | None = None, policies: list[str] = ..., vehicle: _Path | None = None, oracle: bool = False, recordings: Sequence[_Path] = ..., model: _Path | None = None, time_limit_s: float = ...) -> Campaign: ...
    @staticmethod
    def block_of(name: str) -> int | None:
        """The number of a block by the name of its file; None for a file of another name."""
        ...
    @property
    def blocks(self) -> int:
        """Number of blocks."""
        ...
    def decisions(self, encounter: int, policy: object | None = None) -> list[Decision]:
        """Flies one encounter again with everything logged, under the named policy or the first one."""
        ...
    @property
    def encounters(self) -> int:
        """Number of encounters."""
        ...
    def fly_block(self, block: int, threads: int | None = None, progress: _Progress | None = None) -> tuple[str, int, bytes]:
        """Flies one block: the name of its file, which holds its checksum, the number of its rows, and its
        bytes. The same on every machine of one kind, on any number of threads.
        """
        ...
    @staticmethod
    def from_json(text: str, own: Sequence[object] = ..., time_limit_s: float = ...) -> Campaign:
        """The campaign of a configuration from `to_json`; `own` are its policies that are no names, each with its fingerprint."""
        ...
    @property
    def hash(self) -> str:
        """Fingerprint of everything that determines the results."""
        ...
    def manifest_json(self) -> str:
        """The text of campaign.json for a folder of this campaign."""
        ...
    def merge(self, folder: _Path, csv: bool = False) -> str:
        """Merges the blocks of a folder: results.parquet, the summary and run.json, as from the program.
        Returns the SHA-256 of results.parquet.
        """
        ...
    @property
    def name(self) -> str:
        """Its name."""
        ...
    def open(self, folder: _Path) -> None:
        """Prepares a folder for blocks: writes campaign.json, or checks that the existing one belongs to this
        campaign.
        """
        ...
    @property
    def policies(self) -> list[str]:
        """The policies."""
        ...
    def range_of(self, block: int) -> tuple[int, int]:
        """Encounters of a block: its first number and the one after its last."""
        ...
    def read(self, path: _Path) -> Table:
        """The rows of a results.parquet of this campaign."""
        ...
    def run(self, out: _Path, threads: int | None = None, resume: bool = True, csv: bool = False, progress: _Progress | None = None) -> str:
        """Flies the missing blocks of a folder and merges them: `fga campaign run`. Returns the SHA-256 of
        results.parquet. Ctrl-C keeps the finished blocks, and the next call continues with them.
        """
        ...
    def to_json(self) -> str:
        """The configuration with all defaults written out, as one line of JSON."""
        ...

@final
class Candidate:
    """An examined manoeuvre."""

    def __new__(cls) -> Candidate: ...
    @property
    def cost(self) -> float:
        """Its cost."""
        ...
    @property
    def margin_m(self) -> float:
        """Certified lower bound of the separation beyond every volume, metres."""
        ...
    @property
    def stages(self) -> list[Stage]:
        """Its commands."""
        ...
    @property
    def verdict(self) -> Literal["certified", "rejected", "chosen"]:
        """certified, rejected or chosen."""
        ...

@final
class Decision:
    """The command until the next step, and its reasons.

    `Decision(stages, state)` makes one, for a policy of your own.
    """

    def __new__(cls, stages: Sequence[Stage], state: Literal["cruise", "threatened", "avoiding", "recovering"] = 'avoiding') -> Decision: ...
    @property
    def alternative(self) -> Candidate | None:
        """The best manoeuvre to the other side, if there was a search for it."""
        ...
    @property
    def candidates(self) -> int:
        """Manoeuvres evaluated."""
        ...
    @property
    def chosen(self) -> Candidate | None:
        """The manoeuvre, flown or awaited."""
        ...
    @property
    def command(self) -> list[Stage]:
        """The command: stages in order of their start; without any: hold course and climb angle."""
        ...
    @property
    def latest_start_s(self) -> float | None:
        """Latest start of a certified manoeuvre, seconds from now; None where none exists."""
        ...
    @property
    def limit_met(self) -> bool:
        """Whether the step met its limit of work before the search ended."""
        ...
    @property
    def p_loss(self) -> float | None:
        """The same as it flies."""
        ...
    @property
    def p_loss_hold(self) -> float | None:
        """Chance to enter a protected volume within a minute on the mission, of decisions by beliefs."""
        ...
    def predicted(self, vehicle: Vehicle, after_s: float) -> Ownship:
        """The predicted state of an aircraft with these limits some seconds after the decision, if nothing new
        happens, in still air.

        Raises ValueError for a decision of your own, which knows no aircraft, or a time that is not from 0 to
        600.
        """
        ...
    @property
    def proof(self) -> Literal["certified", "leaving"] | None:
        """What is proven about the command: "certified" if it keeps clear of everything that is assumed, "leaving" if the aircraft
        is already in a volume and it leads out, None if nothing is proven.
        """
        ...
    @property
    def proven_share(self) -> float | None:
        """Weight of the futures of the aircraft around of which the certificate keeps clear; None where reports count as exact."""
        ...
    @property
    def reason(self) -> str:
        """The reason, by its key in files."""
        ...
    @property
    def resilience(self) -> float | None:
        """Share of the bounds of aircraft that the manoeuvre withstands."""
        ...
    def stage_at(self, after_s: float = 0.0) -> Stage | None:
        """The commanded stage this long after the decision, seconds; None before the first one."""
        ...
    @property
    def start_s(self) -> float | None:
        """Start of the chosen manoeuvre, seconds from now."""
        ...
    @property
    def state(self) -> Literal["cruise", "threatened", "avoiding", "recovering"]:
        """State of the avoider: cruise, threatened, avoiding or recovering."""
        ...
    @property
    def text(self) -> str:
        """The decision as a sentence."""
        ...
    @property
    def threat(self) -> Threat | None:
        """The most urgent threat."""
        ...
    @property
    def threats(self) -> int:
        """Obstacles in sight that threaten the mission."""
        ...
    def to_dict(self) -> dict[str, Any]:
        """State, reason, text, command and figures as plain values."""
        ...
    @property
    def tracked(self) -> int:
        """Obstacles within the surveillance radius."""
        ...
    @property
    def unusable(self) -> int:
        """Obstacles left out because a number of theirs is not finite."""
        ...
    @property
    def work(self) -> int:
        """Work done, in the unit of `Settings.work_limit`."""
        ...

@final
class Estimate:
    """A figure with its interval: the middle 90 % of what windows of the log give."""

    def __new__(cls) -> Estimate: ...
    @property
    def high(self) -> float:
        """5 % of the windows give more."""
        ...
    @property
    def low(self) -> float:
        """5 % of the windows give less."""
        ...
    @property
    def value(self) -> float:
        """The median."""
        ...

@final
class Ground:
    """Heights of the ground on a regular grid, bilinear in between.

    `heights_m` is an array of shape (rows, columns): rows from the south, columns from the west, metres, NaN where unknown. `corner_m` is the
    south-west post (east, north), `spacing_m` the distance between posts east and north. `error_m` is the vertical error of the heights,
    `clearance_m` the height above them that is asked for. Copied once.

    Raises ValueError for an array with less than 2 rows or columns, lengths that are not positive, or numbers that are not finite.
    """

    def __new__(cls, heights_m: ArrayLike, corner_m: tuple[float, float], spacing_m: tuple[float, float], clearance_m: float, error_m: float = 0.0) -> Ground: ...
    @property
    def clearance_m(self) -> float:
        """The height above the ground that is asked for, metres."""
        ...
    @property
    def corner_m(self) -> tuple[float, float]:
        """The south-west post (east, north), metres."""
        ...
    @property
    def error_m(self) -> float:
        """Vertical error of the heights, metres."""
        ...
    def height_m(self, east_m: float, north_m: float) -> float | None:
        """Height of the ground at a place east and north, metres; None where it is not known."""
        ...
    @property
    def heights_m(self) -> NDArray[np.float32]:
        """The heights of the posts, metres: rows from the south, columns from the west; a copy."""
        ...
    @property
    def spacing_m(self) -> tuple[float, float]:
        """Distance between posts east and north, metres."""
        ...

@final
class Identified:
    """What a flight log says about its aircraft."""

    def __new__(cls) -> Identified: ...
    @property
    def airspeed_mps(self) -> Estimate:
        """Airspeed, metres per second."""
        ...
    @property
    def bank_time_constant_s(self) -> Estimate:
        """Time constant of the first-order bank response, seconds."""
        ...
    @property
    def climb_max_deg(self) -> Estimate:
        """Steepest climb, degrees."""
        ...
    @property
    def climb_min_deg(self) -> Estimate:
        """Steepest descent, degrees."""
        ...
    @property
    def climb_rate_radps(self) -> Estimate:
        """Rate at which the climb angle changes, radians per second."""
        ...
    @property
    def dead_time_s(self) -> Estimate:
        """Time before a command has any effect, seconds."""
        ...
    @property
    def max_bank_deg(self) -> Estimate:
        """Steepest bank that is held, or mean bank of 3 s where none is held, degrees."""
        ...
    @property
    def position_error_m(self) -> Estimate:
        """Horizontal distance from where the figures put the aircraft after 5 s, metres."""
        ...
    def to_toml(self, name: str, radius_m: float, half_height_m: float | None = None) -> str:
        """The text of a vehicle file. The protected volume is no property of the log.

        Raises ValueError for a radius or a half height that is not positive.
        """
        ...
    @property
    def turn_rate_factor(self) -> Estimate:
        """Course rate over that of the ideal coordinated turn."""
        ...
    @property
    def windows(self) -> int:
        """Windows of the log in which the command moves and the bank follows it."""
        ...
    @property
    def windows_left_out(self) -> int:
        """Windows in which the bank does not follow, which are left out."""
        ...

@final
class Mission:
    """A mission: straight legs from waypoint to waypoint.

    `waypoints_m` holds (east, north, up) triples or an array of shape (n, 3); `fly_over` the indices of the
    waypoints that the aircraft passes over before the turn; `limits_m` the lowest and the highest altitude;
    `zones` those of the airspace, `ground` the heights of the ground. No waypoint at all means: hold course and altitude.

    Raises ValueError for a single waypoint or a number that is not finite.
    """

    def __new__(cls, waypoints_m: Sequence[_Triple] | ArrayLike, fly_over: list[int] = ..., limits_m: tuple[float, float] = ..., zones: list[Zone] = ..., ground: Ground | None = None) -> Mission: ...
    def __len__(self) -> int: ...
    @property
    def fly_over(self) -> list[int]:
        """Indices of the fly-over waypoints."""
        ...
    @property
    def ground(self) -> Ground | None:
        """The ground, if it is known."""
        ...
    @property
    def limits_m(self) -> tuple[float, float]:
        """Lowest and highest altitude, metres."""
        ...
    @property
    def waypoints_m(self) -> list[_Triple]:
        """Waypoints, metres, local frame."""
        ...
    @property
    def zones(self) -> list[Zone]:
        """The zones."""
        ...

@final
class Monitor:
    """Alert levels and bands over time, as a DAIDALUS configuration defines them.

    `step` takes the situations that an `Avoider` takes. Wind is taken out; directions are clockwise from north.
    One monitor serves one aircraft and one thread at a time.
    """

    def __new__(cls, config: _Path) -> Monitor: ...
    def bands(self, quantity: str = 'direction_rad') -> list[tuple[float, float, str]]:
        """The bands of the last step, in growing order: (low, high, region). `quantity` is direction_rad,
        horizontal_speed_mps, vertical_speed_mps or altitude_m.
        """
        ...
    @property
    def highest_level(self) -> int:
        """The highest level of the last step."""
        ...
    def resolutions(self, quantity: str = 'direction_rad') -> tuple[float | None, float | None]:
        """The nearest values of a quantity without conflict, to the left or below and to the right or above; None
        where none is needed or there is none.
        """
        ...
    def step(self, situation: Situation) -> dict[int, int]:
        """Takes the aircraft of one time; the alert level of each obstacle by its identifier, 0 for none.

        Raises ValueError for an identifier that is there twice.
        """
        ...

@final
class Obstacle:
    """One obstacle: a protected volume, its position and its velocity over the ground.

    Without `half_height_m` the volume is a sphere, with it an upright cylinder. `kind` says how it may move:
    `still`, `straight`, `aircraft` (crewed) or `uas`. The sigmas are standard deviations along an axis. `nature` is
    `unknown`, `passengers` or `natural-barrier`: only the published rules ask for it.

    Raises ValueError for a number that is not finite, a length that is negative, or a velocity of kind `still` without a
    `velocity_sigma_mps`: where it is measured it may be noise.
    """

    def __new__(cls, id: int, position_m: _Triple, radius_m: float, velocity_mps: _Triple = ..., half_height_m: float | None = None, position_sigma_m: float = 0.0, velocity_sigma_mps: float = 0.0, kind: str = 'straight', nature: str = 'unknown') -> Obstacle: ...
    @property
    def half_height_m(self) -> float | None:
        """Half height of a cylinder, metres; None for a sphere."""
        ...
    @property
    def id(self) -> int:
        """Identifier, unique among the obstacles of a situation."""
        ...
    @property
    def kind(self) -> Literal["straight", "still", "aircraft", "uas"]:
        """Its possible motion: still, straight, aircraft or uas."""
        ...
    @property
    def nature(self) -> Literal["unknown", "passengers", "natural-barrier"]:
        """Its nature: unknown, passengers or natural-barrier."""
        ...
    @property
    def position_m(self) -> _Triple:
        """Centre of the volume, metres, local frame."""
        ...
    @property
    def position_sigma_m(self) -> float:
        """Standard deviation of the position along an axis, metres."""
        ...
    @property
    def radius_m(self) -> float:
        """Radius of the volume, metres."""
        ...
    @property
    def velocity_mps(self) -> _Triple:
        """Velocity over the ground, metres per second."""
        ...
    @property
    def velocity_sigma_mps(self) -> float:
        """Standard deviation of the velocity along an axis, metres per second."""
        ...

@final
class Obstacles:
    """Many obstacles, one column per quantity: arrays of numpy, copied once.

    Units as in `Obstacle`; every column has the length of `id`.

    Raises ValueError for columns of different lengths, a number that is not finite, a length that is
    negative or an identifier that is used twice; TypeError for a column of another type.
    """

    def __new__(cls, *, id: ArrayLike, x_m: ArrayLike, y_m: ArrayLike, z_m: ArrayLike, vx_mps: ArrayLike, vy_mps: ArrayLike, vz_mps: ArrayLike, radius_m: ArrayLike, half_height_m: ArrayLike | None = None, position_sigma_m: ArrayLike | None = None, velocity_sigma_mps: ArrayLike | None = None) -> Obstacles: ...
    def __len__(self) -> int: ...

@final
class Ownship:
    """State of the aircraft: position over the ground, motion through the air.

    Frame: x east, y north, z up, metres. Courses are radians from +x towards +y (a left turn increases the
    course), climb angles positive upwards, bank angles positive in a left turn.

    Raises ValueError for a number that is not finite or an airspeed that is not positive.
    """

    def __new__(cls, position_m: _Triple, course_rad: float, airspeed_mps: float, climb_rad: float = 0.0, bank_rad: float = 0.0) -> Ownship: ...
    @property
    def airspeed_mps(self) -> float:
        """Total airspeed, metres per second."""
        ...
    @property
    def bank_rad(self) -> float:
        """Bank angle, radians, positive in a left turn."""
        ...
    @property
    def climb_rad(self) -> float:
        """Climb angle, radians."""
        ...
    @property
    def course_rad(self) -> float:
        """Course through the air, radians."""
        ...
    @property
    def position_m(self) -> _Triple:
        """Position, metres, local frame."""
        ...

@final
class Pilot:
    """Any policy of the program by its name, as in `Pilot("published --start t0", model)`.

    The same rules hold as for `Avoider`; with another mission a policy that is not fga's own begins another flight.
    """

    def __new__(cls, policy: str = 'turn-aware', model: VehicleModel | _Path | None = None) -> Pilot: ...
    @property
    def name(self) -> str:
        """The policy's name."""
        ...
    def restart(self) -> None:
        """Forgets the last flight."""
        ...
    def retune(self, vehicle: Vehicle) -> None:
        """Applies changed limits of the vehicle."""
        ...
    def step(self, situation: Situation) -> Decision:
        """Decides the command until the next step."""
        ...

@final
class Run:
    """One flight with everything logged, as in the files of `fga run`."""

    def __new__(cls) -> Run: ...
    @property
    def decisions(self) -> list[Decision]:
        """Every decision, in order."""
        ...
    def events_jsonl(self) -> str:
        """The text of events.jsonl."""
        ...
    def replay_html(self) -> str:
        """The replay page."""
        ...
    @property
    def separated(self) -> bool:
        """Whether the flight entered no protected volume."""
        ...
    @property
    def summary(self) -> dict[str, Any]:
        """The summary, as `fga run --json` prints it."""
        ...
    @property
    def track(self) -> Table:
        """The flown states, at most 0.1 s apart: the columns of track.csv, to full precision."""
        ...
    def track_csv(self) -> bytes:
        """The bytes of track.csv."""
        ...
    def write(self, folder: _Path) -> None:
        """Writes the files of `fga run` into a folder."""
        ...

@final
class Settings:
    """Settings of the avoider.

    `start` is `free`, `t0`, `latest` or `Cs=0` to `Cs=1`; `objective` is `paper-cost`, `least-deviation` or
    `shortest-path`. The pages of the crate `fga` have their meanings and ranges.

    Raises ValueError, with the sentence of the program, for a setting out of range.
    """

    def __new__(cls, *, start: str = 'free', decision_period_s: float = 0.1, surveillance_radius_m: float = ..., horizon_s: float = 60.0, margin_m: float = 0.05, confidence_sigmas: float = 3.0, heading_cost: float = 0.2, pitch_cost: float = 0.5, objective: str = 'paper-cost', work_limit: int = 100000, drift_mps: float = 0.0, loss_price_m: float = 42000.0) -> Settings: ...
    @property
    def confidence_sigmas(self) -> float:
        """Standard deviations that widen an obstacle's volume."""
        ...
    @property
    def decision_period_s(self) -> float:
        """Time from one step to the next, seconds."""
        ...
    @property
    def drift_mps(self) -> float:
        """Standard deviation of the velocity that carries the aircraft off its prediction, m/s."""
        ...
    @property
    def heading_cost(self) -> float:
        """Cost of a change of course, per radian."""
        ...
    @property
    def horizon_s(self) -> float:
        """Horizon of the certificate, seconds."""
        ...
    @property
    def loss_price_m(self) -> float:
        """Price of a loss of a protected volume, metres of departure, where chances decide."""
        ...
    @property
    def margin_m(self) -> float:
        """Distance kept beyond the protected volume, metres."""
        ...
    @property
    def objective(self) -> str:
        """The measure of the cheapest manoeuvre."""
        ...
    @property
    def pitch_cost(self) -> float:
        """Cost of a change of climb angle, per radian."""
        ...
    @property
    def start(self) -> str:
        """The start of a manoeuvre."""
        ...
    @property
    def surveillance_radius_m(self) -> float:
        """Obstacles farther away do not count, metres."""
        ...
    @property
    def work_limit(self) -> int:
        """Most work of one step."""
        ...

@final
class Shield:
    """Run-time assurance: any policy may fly as long as a certified way out remains.

    `step(situation, stages)` gives the decision to fly and whether it is the shield's own. It passes the
    stages while a certified manoeuvre exists at the end of their path to the next decision, and flies
    the avoider instead otherwise.
    """

    def __new__(cls, settings: Settings | None = None, vehicle: Vehicle | None = None) -> Shield: ...
    def restart(self) -> None:
        """Forgets the last flight."""
        ...
    def step(self, situation: Situation, wish: Decision) -> tuple[Decision, bool]:
        """Passes the wish of a policy, or decides instead."""
        ...

@final
class Simulation:
    """A scenario (.toml) or recording (.daa) that waits for each decision.

    `step(pilot)` lets a pilot decide and flies on; `situation` and `advance(decision)` are for a policy of
    your own. Flown with the same policy, it is the flight of `fga run`, bit for bit.
    """

    def __new__(cls, file: _Path, vehicle: VehicleModel | _Path | None = None, ownship: str | None = None) -> Simulation: ...
    def advance(self, decision: Decision) -> bool:
        """Flies a decision until the next one is due. Returns whether the flight goes on."""
        ...
    @property
    def model(self) -> VehicleModel:
        """Its aircraft."""
        ...
    @property
    def name(self) -> str:
        """Its name."""
        ...
    @property
    def names(self) -> list[str]:
        """Names of the obstacles."""
        ...
    def outcome(self) -> dict[str, Any]:
        """The result of the flight so far, by the names of the columns of results.csv, with `min_terrain_clearance_m` and
        `min_zone_margin_m`, None without ground or zones; of a recording also what the standards count
        (`standards`: near mid-air collision, well clear, severity, alerts), by the names of the columns of results.parquet.
        """
        ...
    @property
    def ownship(self) -> Ownship:
        """The aircraft now."""
        ...
    def restart(self) -> None:
        """Back to the start."""
        ...
    @property
    def situation(self) -> Situation | None:
        """The present situation; None once the flight has ended."""
        ...
    def step(self, pilot: Avoider | Pilot) -> Decision | None:
        """Lets a pilot decide and flies on. Returns its decision; None once the flight has ended."""
        ...
    def take_retuned(self) -> Vehicle | None:
        """Changed limits of the vehicle since the last decision, once; a pilot applies them by `retune`
        before it decides.
        """
        ...
    @property
    def time_s(self) -> float:
        """Time of the next decision, seconds; at the end the time of the end."""
        ...

@final
class Situation:
    """The input of one decision.

    `time_s` is the time of the state on any clock that does not run backwards. `obstacles` are a sequence of
    `Obstacle` or one `Obstacles`, over the ground. `wind_mps` is the velocity of the air over the ground.

    Raises ValueError for a number that is not finite or too large, or two obstacles with the same `id`.
    """

    def __new__(cls, time_s: float, ownship: Ownship, mission: Mission, obstacles: Sequence[Obstacle] | Obstacles | None = None, wind_mps: _Triple = ...) -> Situation: ...
    @property
    def mission(self) -> Mission:
        """The mission."""
        ...
    @property
    def obstacles(self) -> list[Obstacle]:
        """The obstacles, one record each."""
        ...
    @property
    def ownship(self) -> Ownship:
        """The aircraft."""
        ...
    @property
    def time_s(self) -> float:
        """Time of the state, seconds."""
        ...
    @property
    def wind_mps(self) -> _Triple:
        """Velocity of the air over the ground, metres per second."""
        ...

@final
class Stage:
    """A command from a moment on, until the next stage begins.

    `course_rad` is not wrapped: the aircraft turns by the plain difference to its own course.
    """

    def __new__(cls, course_rad: float, climb_rad: float = 0.0, start_s: float = 0.0, rate_share: float = 1.0) -> Stage: ...
    @property
    def climb_rad(self) -> float:
        """Climb angle to take up, radians."""
        ...
    @property
    def course_rad(self) -> float:
        """Course to turn to, radians."""
        ...
    @property
    def rate_share(self) -> float:
        """Share of the largest course rate to turn with."""
        ...
    @property
    def start_s(self) -> float:
        """Its start, seconds from the moment of the decision."""
        ...

@final
class Table:
    """A table that every library with the Arrow PyCapsule interface takes without copying:
    `polars.DataFrame(table)`, `pyarrow.table(table)`, `pandas.DataFrame.from_arrow(table)`, duckdb.
    """

    def __new__(cls) -> Table: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __contains__(self, key: object) -> bool: ...
    def __getitem__(self, key: str) -> NDArray[Any]: ...
    def __len__(self) -> int: ...
    @property
    def column_names(self) -> list[str]:
        """Names of the columns."""
        ...
    @property
    def columns(self) -> list[str]:
        """Names of the columns, as `column_names`."""
        ...
    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns."""
        ...
    def to_csv(self) -> bytes:
        """The bytes of the program's file with the same content.

        Raises ValueError for a table that the program does not write as CSV.
        """
        ...
    def to_pandas(self) -> pandas.DataFrame:
        """The table as `pandas.DataFrame`. Raises ImportError without pandas."""
        ...
    def to_polars(self) -> polars.DataFrame:
        """The table as `polars.DataFrame`. Raises ImportError without polars."""
        ...

@final
class Threat:
    """The obstacle that a decision is about."""

    def __new__(cls) -> Threat: ...
    @property
    def closest_s(self) -> float:
        """Time of the closest approach, seconds from now."""
        ...
    @property
    def entry_s(self) -> float:
        """Time of the entry into its volume on the mission, seconds from now."""
        ...
    @property
    def id(self) -> int:
        """The obstacle's identifier."""
        ...
    @property
    def margin_m(self) -> float:
        """Separation from its volume at that time, metres; negative inside."""
        ...

@final
class Vehicle:
    """Limits of an aircraft at its airspeed, and its response to commands.

    Raises ValueError, with the sentence of the program, for a limit out of range.
    """

    def __new__(cls, airspeed_mps: float, turn_radius_m: float, climb_min_rad: float = ..., climb_max_rad: float = ..., climb_rate_radps: float = 0.2, dead_time_s: float = 0.0, bank_time_constant_s: float = 0.0, turn_rate_factor: float = 1.0) -> Vehicle: ...
    @property
    def airspeed_mps(self) -> float:
        """Constant total airspeed, metres per second."""
        ...
    @property
    def bank_max_rad(self) -> float | None:
        """Largest bank angle, radians."""
        ...
    @property
    def bank_time_constant_s(self) -> float:
        """Time constant of the first-order bank response, seconds; 0 for none."""
        ...
    @property
    def climb_max_rad(self) -> float:
        """Steepest climb, radians, at least 0."""
        ...
    @property
    def climb_min_rad(self) -> float:
        """Steepest descent, radians, at most 0."""
        ...
    @property
    def climb_rate_radps(self) -> float:
        """Rate limit of the climb angle, radians per second."""
        ...
    @property
    def course_rate_radps(self) -> float:
        """Largest real course rate, radians per second."""
        ...
    @property
    def dead_time_s(self) -> float:
        """Time before a command has any effect, seconds."""
        ...
    @property
    def turn_radius_m(self) -> float:
        """Least radius of the ideal coordinated turn, metres."""
        ...
    @property
    def turn_rate_factor(self) -> float:
        """Flown course rate over the ideal coordinated turn's."""
        ...

@final
class VehicleModel:
    """An aircraft from its TOML file: limits, settings, protected volume, wind.

    `VehicleModel.read(path)` reads a file as the program does, `VehicleModel()` is the aircraft of the
    paper's Table 4. Raises ValueError with the sentence of the program.
    """

    def __new__(cls) -> VehicleModel: ...
    @property
    def half_height_m(self) -> float | None:
        """Half height of the volume, metres; None for a sphere."""
        ...
    @property
    def name(self) -> str:
        """Its name for people."""
        ...
    @property
    def radius_m(self) -> float:
        """Radius of the volume about each obstacle, metres."""
        ...
    @staticmethod
    def read(path: _Path) -> VehicleModel:
        """Reads a vehicle file."""
        ...
    @property
    def settings(self) -> Settings:
        """The decision settings."""
        ...
    @property
    def vehicle(self) -> Vehicle:
        """Its limits."""
        ...
    @property
    def wind_mps(self) -> _Triple:
        """Velocity of the air over the ground, metres per second."""
        ...

@final
class Worlds:
    """Worlds side by side, stepped without the interpreter's lock; `fga.gym` makes environments of them."""

    def __new__(cls, cell: str, count: int, seed: int = 0, vehicle: VehicleModel | _Path | None = None, horizon_s: float = 60.0, seen: int = 4, shielded: bool = False) -> Worlds: ...
    def __len__(self) -> int: ...
    def observe(self) -> NDArray[np.float32]:
        """The observations of the worlds, one row each."""
        ...
    @property
    def observed(self) -> int:
        """Length of an observation."""
        ...
    def reset(self, places: list[int], numbers: list[int]) -> None:
        """Loads encounters by their numbers into worlds by their indices."""
        ...
    def step(self, actions: NDArray[np.float64], held: list[bool] | None = None) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Flies one action in each world, an array of shape (worlds, 2), until the next decision; worlds in
        `held` stand still.
        """
        ...

@final
class Zone:
    """A zone: a polygon or a circle, seen from above, between two altitudes.

    `polygon_m` holds 3 to 256 corners (east, north) in order; `center_m` and `radius_m` make a circle instead. With `keep_in` the aircraft stays
    within it, else out of it. Altitudes are metres, infinite without a limit.

    Raises ValueError for a polygon that crosses itself, too many corners, a number that is not finite, or a floor above the ceiling.
    """

    def __new__(cls, *, keep_in: bool = False, polygon_m: Sequence[tuple[float, float]] | ArrayLike | None = None, center_m: tuple[float, float] | None = None, radius_m: float | None = None, floor_m: float = ..., ceiling_m: float = ...) -> Zone: ...
    @property
    def ceiling_m(self) -> float:
        """Highest altitude, metres."""
        ...
    @property
    def center_m(self) -> tuple[float, float] | None:
        """Centre of a circle (east, north), metres; None for a polygon."""
        ...
    @property
    def floor_m(self) -> float:
        """Lowest altitude, metres."""
        ...
    @property
    def keep_in(self) -> bool:
        """Whether the aircraft stays within it, not out of it."""
        ...
    @property
    def polygon_m(self) -> list[tuple[float, float]] | None:
        """Corners of a polygon (east, north), metres; None for a circle."""
        ...
    @property
    def radius_m(self) -> float | None:
        """Radius of a circle, metres; None for a polygon."""
        ...

def alerts(recording: _Path, config: _Path) -> Table:
    """Says which alert levels a DAIDALUS configuration gives a recording: `fga alerts`.

    One row for each time and intruder: `time_s, ownship, traffic, alerter, level`, and `violation_s`, when the
    volume of the level begins. `to_csv` gives the bytes of alerts.csv. Raises ValueError with the program's sentence.
    """
    ...

def bands(recording: _Path, config: _Path) -> Table:
    """Says which maneuvers meet a conflict in a recording, as bands: `fga bands`.

    One row for each time, quantity and band: `time_s, quantity, low, high, region`, in the unit that the quantity
    names; directions are clockwise from north. `to_csv` gives the bytes of bands.out.
    """
    ...

def batch(encounters: object, policy: object = ..., vehicle: VehicleModel | _Path | None = None, horizon_s: float = 60.0, seed: int = 0, threads: int | None = None, progress: _Progress | None = None, time_limit_s: float = ...) -> Table:
    """Flies many encounters: `fga batch`.

    `encounters` is the path of a CSV file or of a folder that `fga campaign draw` wrote, or a table with the columns of the CSV file. `policy` is a name, or one of your own: a class or an
    object with `step(situation)`, with `step_all(flights, obstacles)` for many flights at once, or a function of the
    situation; `time_limit_s` is its time for a step. The table has the numbers of results.csv, whose bytes `to_csv` gives. `progress(done, total)` is called during the work.
    """
    ...

def identify(log: _Path | Mapping[str, ArrayLike]) -> Identified:
    """Says which aircraft a flight log shows: `fga identify`.

    `log` is the path of a log (CSV, .tlog, .bin), or a mapping of its columns `t_s, airspeed_mps,
    bank_command_rad, bank_rad, course_rad, climb_rad`. Raises ValueError for a log that cannot be used.
    """
    ...

def league(out: _Path, policies: Sequence[object] = ..., sets: Sequence[str] = ..., data: _Path | None = None, encounters: int | None = None, worst: int = 3, threads: int | None = None, progress: _Progress | None = None, time_limit_s: float = ..., intruders: Sequence[object] = ...) -> list[dict[str, Any]]:
    """Flies policies over sets of encounters and writes one page: `fga league`.

    `policies` are names, or policies of your own as in `fga.campaign`; without any, all built-in ones. `sets` are names of shipped
    sets or campaign files; without any, all shipped ones whose data are in the folder `data` (without it `FGA_DATA`).
    `intruders` are policies by which intruders with tracks react, each a set of its own beside the one without reactions; `itself` stands
    for the policy of the ownship. The folder
    `out` gets league.html, league.parquet, league.csv, and the campaign of each set and policy. What is complete there is not
    flown again. Returns the standings, one dict for each set and policy.
    """
    ...

def oracle(encounters: object, vehicle: VehicleModel | _Path | None = None, horizon_s: float = 60.0, threads: int | None = None, progress: _Progress | None = None) -> Table:
    """Finds for each encounter whether any manoeuvre could save it: `fga oracle`."""
    ...

def run(file: _Path, policy: object = ..., vehicle: VehicleModel | _Path | None = None, ownship: str | None = None, overlay: Sequence[object] = ..., time_limit_s: float = ...) -> Run:
    """Flies a scenario (.toml) or a recording (.daa) to its end: `fga run`.

    `overlay` names further policies whose flights the replay page shows too.
    """
    ...

def stress(out: _Path, policy: object = ..., vehicle: VehicleModel | _Path | None = None, kind: str = 'uas', flights: int = 2000, seed: int = 0, threads: int | None = None, time_limit_s: float = ..., intruders: int = 1, gust_mps: float | None = None) -> dict[str, Any]:
    """Searches the likeliest motions of intruders, and gusts, in which a policy fails: `fga stress`.

    `policy` is a name or a policy of your own; `kind` is `uas` or `aircraft`; `gust_mps` is the standard deviation of each component
    of a gust, without it the vehicle's `drift_mps`. The folder `out` gets stress.html, failures.csv,
    stress.json and the replays; after Ctrl-C the same call goes on. Returns the content of stress.json.
    """
    ...
