"""A vehicle file from a flight log: how the aircraft responds to its commands.

`python -m fga.identify LOG.csv --out vehicle.toml` reads a CSV file with the columns

    t_s, airspeed_mps, bank_command_rad, bank_rad, course_rad, climb_rad

at a steady rate of at least 5 Hz: bank commanded and flown (positive in a left turn), course (a left turn
increases it), climb angle of the path. The log should have steps of the bank command to both sides, and a
climb and a descent at their limits. Every figure comes with an interval: the middle 90 % of the values from
single pieces of the log.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import sys
from dataclasses import dataclass
from typing import Mapping, Sequence

import numpy as np

from ._fga import VehicleModel

COLUMNS = ("t_s", "airspeed_mps", "bank_command_rad", "bank_rad", "course_rad", "climb_rad")
_GRAVITY_MPS2 = 9.80665
_STEP_RAD = math.radians(5.0)
"""A change of the commanded bank that is a step."""
_LATEST_DEAD_TIME_S = 1.5
_SHORTEST_PIECE_S = 2.0


@dataclass(frozen=True)
class Estimate:
    """A figure with its interval: the middle 90 % of the values from single pieces of the log."""

    value: float
    low: float
    high: float

    @classmethod
    def of(cls, pieces: Sequence[float], value: float | None = None) -> "Estimate":
        """The median of the pieces, or a value that was estimated from all of them together."""
        low, middle, high = np.percentile(np.asarray(pieces, dtype=float), [5, 50, 95])
        middle = float(middle) if value is None else value
        return cls(middle, min(float(low), middle), max(float(high), middle))

    def __str__(self) -> str:
        return f"{self.value:.4g} ({self.low:.4g} to {self.high:.4g})"


@dataclass(frozen=True)
class Identified:
    """The figures of an aircraft from its log."""

    airspeed_mps: Estimate
    max_bank_deg: Estimate
    dead_time_s: Estimate
    bank_time_constant_s: Estimate
    turn_rate_factor: Estimate
    climb_min_deg: Estimate
    climb_max_deg: Estimate
    climb_rate_radps: Estimate
    bank_steps: int

    def to_toml(self, name: str, radius_m: float, half_height_m: float | None = None) -> str:
        """The text of a vehicle file; the log does not contain the protected volume."""

        def line(key: str, estimate: Estimate, digits: int) -> str:
            return (
                f"{key} = {estimate.value:.{digits}f}"
                f"    # {estimate.low:.{digits}f} to {estimate.high:.{digits}f}\n"
            )

        quoted = name.replace("\\", "\\\\").replace('"', '\\"')
        text = f'# Identified from {self.bank_steps} steps of the bank.\nname = "{quoted}"\n'
        text += line("airspeed_mps", self.airspeed_mps, 2)
        text += line("max_bank_deg", self.max_bank_deg, 1)
        text += line("climb_min_deg", self.climb_min_deg, 1)
        text += line("climb_max_deg", self.climb_max_deg, 1)
        text += line("climb_rate_radps", self.climb_rate_radps, 3)
        text += f"\n[protection]\nradius_m = {radius_m:.1f}\n"
        if half_height_m is not None:
            text += f"half_height_m = {half_height_m:.1f}\n"
        text += "\n[response]\n"
        text += line("dead_time_s", self.dead_time_s, 3)
        text += line("bank_time_constant_s", self.bank_time_constant_s, 3)
        text += line("turn_rate_factor", self.turn_rate_factor, 3)
        return text


def read(path: str | os.PathLike[str]) -> dict[str, np.ndarray]:
    """The columns of a log; other columns are ignored."""
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = list(csv.reader(file))
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{os.fspath(path)}: cannot be read: {error}") from error
    if not rows:
        raise ValueError(f"{os.fspath(path)}: is empty, expected the columns {','.join(COLUMNS)}")
    head = [name.strip() for name in rows[0]]
    for name in COLUMNS:
        if head.count(name) != 1:
            raise ValueError(
                f"{os.fspath(path)}, line 1: column {name} is there {head.count(name)} times, expected once"
            )
    columns: dict[str, np.ndarray] = {}
    for name in COLUMNS:
        place = head.index(name)
        values = []
        for number, row in enumerate(rows[1:], start=2):
            found = row[place] if place < len(row) else ""
            try:
                value = float(found)
            except ValueError:
                value = math.nan
            if not math.isfinite(value):
                raise ValueError(
                    f"{os.fspath(path)}, line {number}: column {name} holds {found!r}, expected a finite number"
                )
            values.append(value)
        columns[name] = np.array(values)
    return columns


def identify(log: str | os.PathLike[str] | Mapping[str, np.ndarray]) -> Identified:
    """The figures of an aircraft from its log, given by path or as columns.

    Raises ValueError for an unreadable log, or one without steps of the bank.
    """
    columns = read(log) if isinstance(log, (str, os.PathLike)) else log
    try:
        time_s, airspeed, command, bank, course, climb = (
            np.asarray(columns[name], dtype=float) for name in COLUMNS
        )
    except KeyError as error:
        raise ValueError(f"the column {error.args[0]} is missing, expected {', '.join(COLUMNS)}") from error
    if not len(time_s) == len(airspeed) == len(command) == len(bank) == len(course) == len(climb):
        raise ValueError("the columns have different lengths, expected one length")
    if len(time_s) < 50 or not all(np.isfinite(c).all() for c in (time_s, airspeed, command, bank, course, climb)):
        raise ValueError(f"the log has {len(time_s)} rows, expected at least 50 of finite numbers")
    steps_s = np.diff(time_s)
    period_s = float(np.median(steps_s))
    if period_s <= 0 or period_s > 0.2 or steps_s.max() > 2 * period_s or steps_s.min() < 0.5 * period_s:
        raise ValueError(
            f"the log has a row every {period_s:.3f} s, from {steps_s.min():.3f} to {steps_s.max():.3f} s apart, "
            "expected a steady rate of at least 5 Hz"
        )
    course = np.unwrap(course)
    pieces = _pieces(command, period_s)
    if len(pieces) < 4:
        raise ValueError(
            f"the bank command steps {len(pieces)} times, expected at least 4 steps of 5 degrees or more, each held for "
            f"{_SHORTEST_PIECE_S:.0f} s"
        )
    fits = [_first_order(command, bank, begin, end, period_s) for begin, end in pieces]
    factors, speeds, turned = [], [], []
    rate = np.gradient(course, period_s)
    ideal = _GRAVITY_MPS2 * np.tan(bank) / airspeed
    for begin, end in pieces:
        settled = slice(begin + (end - begin) // 2, end)
        speeds.append(float(airspeed[settled].mean()))
        if abs(bank[settled].mean()) > _STEP_RAD:
            weight = float((ideal[settled] ** 2).sum())
            factors.append(float((rate[settled] * ideal[settled]).sum()) / weight)
            turned.append(math.degrees(abs(float(bank[settled].mean()))))
    if not factors:
        raise ValueError("the aircraft never banks by 5 degrees or more, expected turns")
    steepest = max(turned)
    window = max(1, round(1.0 / period_s))
    smooth = np.convolve(climb, np.ones(window) / window, mode="valid")
    smooth_rate = np.abs(np.gradient(smooth, period_s))
    down, up = (np.degrees(np.percentile(smooth, q)) for q in ([2, 1, 0], [98, 99, 100]))
    change = np.percentile(smooth_rate, [90, 95, 99])
    return Identified(
        airspeed_mps=Estimate.of(speeds),
        max_bank_deg=Estimate.of([one for one in turned if one > 0.9 * steepest]),
        dead_time_s=Estimate.of([fit[0] for fit in fits]),
        bank_time_constant_s=Estimate.of([fit[1] for fit in fits]),
        turn_rate_factor=Estimate.of(factors),
        climb_min_deg=Estimate.of(sorted(min(0.0, float(d)) for d in down)),
        climb_max_deg=Estimate.of(sorted(max(0.0, float(u)) for u in up)),
        climb_rate_radps=Estimate.of([float(c) for c in change]),
        bank_steps=len(pieces),
    )


def _pieces(command: np.ndarray, period_s: float) -> list[tuple[int, int]]:
    """From each step of the command to the next one: first row and the row after the last."""
    steps = [0, *(np.flatnonzero(np.abs(np.diff(command)) > _STEP_RAD) + 1).tolist(), len(command)]
    shortest = round(_SHORTEST_PIECE_S / period_s)
    return [(a, b) for a, b in zip(steps[1:-1], steps[2:], strict=True) if b - a >= shortest]


def _first_order(
    command: np.ndarray, bank: np.ndarray, begin: int, end: int, period_s: float
) -> tuple[float, float]:
    """Dead time and time constant, seconds, of the first-order lag that fits one step best."""
    time_s = np.arange(end - begin) * period_s
    from_rad, to_rad = bank[begin], command[begin]
    constants_s = np.geomspace(0.02, 5.0, 120)
    best = (math.inf, 0.0, 0.0)
    for dead_s in np.arange(0.0, _LATEST_DEAD_TIME_S, 0.02):
        late_s = np.maximum(time_s - dead_s, 0.0)
        share = 1.0 - np.exp(-late_s[:, None] / constants_s)
        errors = ((from_rad + (to_rad - from_rad) * share - bank[begin:end, None]) ** 2).sum(axis=0)
        place = int(errors.argmin())
        if errors[place] < best[0]:
            best = (float(errors[place]), float(dead_s), float(constants_s[place]))
    return best[1], best[2]


def main(arguments: Sequence[str] | None = None) -> int:
    """`python -m fga.identify`."""
    parser = argparse.ArgumentParser(
        prog="python -m fga.identify", description="Write a vehicle file from a flight log."
    )
    parser.add_argument("log", help=f"a CSV file with the columns {', '.join(COLUMNS)}")
    parser.add_argument("--out", help="the vehicle file; printed without it")
    parser.add_argument("--name", default="identified", help="name of the aircraft")
    parser.add_argument("--radius-m", type=float, default=150.0, help="radius of the protected volume")
    parser.add_argument("--half-height-m", type=float, help="half height of the protected volume")
    told = parser.parse_args(arguments)
    try:
        text = identify(told.log).to_toml(told.name, told.radius_m, told.half_height_m)
        if told.out is None:
            print(text, end="")
            return 0
        part = f"{told.out}.part"
        with open(part, "w", encoding="utf-8") as file:
            file.write(text)
        VehicleModel.read(part)
        os.replace(part, told.out)
    except (ValueError, OSError) as error:
        print(f"fga: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
