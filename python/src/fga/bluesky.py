"""fga as conflict resolution in BlueSky (PyPI: bluesky-simulator).

`python -m fga.bluesky ~/bluesky` puts the plugin into BlueSky's folder. In BlueSky, or in a scenario:

    PLUGIN FGA
    ASAS ON
    RESO FGA

Every fixed-wing aircraft in a conflict gets an `Avoider` of its own. It flies past the protected zones that
BlueSky's conflict detection has (ZONER, ZONEDH, with the factors RFACH and RFACV) by turns at the autopilot's bank,
and then back onto the route or line that the autopilot flew. Altitude and speed stay with the autopilot. Rotorcraft
keep their autopilot altogether. NORESO and RESOOFF work as for other methods.

Of two aircraft in conflict one has the right of way, as in the rules of the air: whoever overtakes, or has the other
on its right, gives way. Where that one has no certified way past all others, and the other one has, they change
parts. Whoever does not give way acts only once separation would be lost within half of the look-ahead time (DTLOOK).
Without this rule two aircraft that decide alike mirror each other and fly side by side for ever.

Frame of an avoider: x east, y north, z up, metres, about the place where the conflict was found.
"""

from __future__ import annotations

import math
import os
import sys
from dataclasses import dataclass, field
from typing import Sequence

import bluesky as bs
import numpy as np
from bluesky.traffic.asas import ConflictResolution

import fga

PLUGIN = '''"""fga as conflict resolution: RESO FGA."""
from fga.bluesky import FGA


def init_plugin():
    """What BlueSky asks of a plugin."""
    config = {"plugin_name": "FGA", "plugin_type": "sim"}
    return config
'''

_EARTH_M = 6_371_000.0
_GRAVITY_MPS2 = 9.80665
_CLIMB_CHANGE_MPS2 = 300 * 0.3048 / 60
"""Vertical acceleration of every aircraft in BlueSky: 300 ft/min in a second."""
_ROTOR = 2
"""OpenAP's lift type of rotorcraft."""
_FAR_M = 400_000.0
"""Where a mission without a route ends, and how far one with a route goes on."""
_UNPROVEN = ("best-available", "inside-volume", "invalid-input")
"""Reasons of decisions whose command has no certificate."""
_KEPT_SHARE = 0.995
"""Share of its distance that a neighbour inside of the enlarged zone has to keep."""
_SHORTEST_LEG_M = 500.0
_OVERTAKING_RAD = math.radians(70.0)
_FRAME_REACH_M = 60_000.0
"""An avoider that cruises farther from its origin gets a new one: the frame is flat."""


@dataclass
class _Flight:
    """One aircraft that has met a conflict."""

    lat_deg: float
    lon_deg: float
    avoider: fga.Avoider
    vehicle: fga.Vehicle
    mission: fga.Mission
    intent: tuple[float, ...]
    course_rad: float
    state: str = "cruise"
    ids: dict[str, int] = field(default_factory=dict)

    def xy_m(self, lat_deg: float, lon_deg: float) -> tuple[float, float]:
        """East and north of the origin."""
        east_deg = math.remainder(lon_deg - self.lon_deg, 360.0)
        return (
            _EARTH_M * math.radians(east_deg) * math.cos(math.radians(self.lat_deg)),
            _EARTH_M * math.radians(lat_deg - self.lat_deg),
        )

    def id_of(self, name: str) -> int:
        return self.ids.setdefault(name, len(self.ids) + 1)


def _vehicle(traffic, i: int, state: str) -> fga.Vehicle:
    """The limits of BlueSky's autopilot at the present airspeed; it may climb only as it climbs now.

    In a manoeuvre it goes on climbing as it does: no plan may rest on levelling off, which nobody would command.
    """
    airspeed = max(1.0, float(traffic.tas[i]))
    climb = math.asin(max(-0.9, min(0.9, float(traffic.vs[i]) / airspeed)))
    return fga.Vehicle(
        airspeed_mps=airspeed,
        turn_radius_m=airspeed**2 / (_GRAVITY_MPS2 * math.tan(float(traffic.ap.bankdef[i]))),
        climb_min_rad=min(0.0, climb),
        climb_max_rad=max(0.0, climb),
        climb_rate_radps=_CLIMB_CHANGE_MPS2 / airspeed if state == "cruise" else 0.0,
    )


def _ahead_m(traffic, i: int, flight: _Flight) -> list[tuple[float, float]]:
    """The way over the ground that the autopilot flies: the rest of the route, or straight on."""
    x, y = flight.xy_m(traffic.lat[i], traffic.lon[i])
    way = [(x, y)]
    route = traffic.ap.route[i]
    if traffic.swlnav[i] and 0 <= route.iactwp < route.nwp:
        for lat, lon in zip(route.wplat[route.iactwp :], route.wplon[route.iactwp :], strict=True):
            point = flight.xy_m(lat, lon)
            if math.dist(point, way[-1]) >= _SHORTEST_LEG_M:
                way.append(point)
    if len(way) > 1:
        (ax, ay), (bx, by) = way[-2:]
        track = math.atan2(by - ay, bx - ax)
    else:
        track = math.radians(90.0 - float(traffic.ap.trk[i]))
    end_x, end_y = way[-1]
    way.append((end_x + _FAR_M * math.cos(track), end_y + _FAR_M * math.sin(track)))
    return way


def _mission(traffic, i: int, flight: _Flight) -> fga.Mission:
    """The way of the autopilot with its altitudes: on to the selected one, then level."""
    way = _ahead_m(traffic, i, flight)
    altitude, selected = float(traffic.alt[i]), float(traffic.ap.alt[i])
    rate, to_go = float(traffic.vs[i]), selected - altitude
    if abs(to_go) < 30.0 or abs(rate) < 0.5:
        # Level, or told to leave its altitude but not yet doing so.
        return fga.Mission([(x, y, altitude) for x, y in way])
    slope = rate / max(1.0, float(traffic.gs[i]))
    # Where it leaves the selected altitude behind, as above its ceiling, nobody knows the end.
    left_m = to_go / slope if to_go * rate > 0.0 else math.inf
    points = [(*way[0], altitude)]
    for (ax, ay), (bx, by) in zip(way, way[1:], strict=False):
        leg_m = math.dist((ax, ay), (bx, by))
        if 0.0 < left_m < leg_m:
            share = left_m / leg_m
            points.append((ax + share * (bx - ax), ay + share * (by - ay), selected))
            points.append((bx, by, selected))
        else:
            last = points[-1][2]
            points.append((bx, by, selected if left_m <= 0.0 else last + slope * leg_m))
        left_m -= leg_m
    return fga.Mission(points)


def _intent(traffic, i: int) -> tuple[float, ...]:
    """What the mission of an aircraft is made from, but for its place: another one is another mission."""
    by_route = bool(traffic.swlnav[i])
    track = -1.0 if by_route else round(float(traffic.ap.trk[i]))
    return (by_route, track, round(float(traffic.ap.alt[i])), round(float(traffic.vs[i])))


def _is_rotorcraft(traffic, i: int) -> bool:
    """Whether the performance model knows it as one."""
    kinds = getattr(traffic.perf, "lifttype", None)
    return kinds is not None and kinds[i] == _ROTOR


def _gives_way(traffic, i: int, k: int) -> bool:
    """Whether aircraft i gives way to aircraft k, by where each sees the other."""

    def bearing_rad(a: int, b: int) -> float:
        """Of b as a sees it, clockwise from its track, from -pi to pi."""
        north = math.radians(traffic.lat[b] - traffic.lat[a])
        narrow = math.cos(math.radians(traffic.lat[a]))
        east = math.radians(math.remainder(traffic.lon[b] - traffic.lon[a], 360.0)) * narrow
        return math.remainder(math.atan2(east, north) - math.radians(traffic.trk[a]), 2 * math.pi)

    sees, is_seen = bearing_rad(i, k), bearing_rad(k, i)
    along = abs(math.remainder(math.radians(traffic.trk[i] - traffic.trk[k]), 2 * math.pi)) < _OVERTAKING_RAD
    if along and (abs(sees) < math.pi / 2) != (abs(is_seen) < math.pi / 2):
        # The one behind overtakes.
        return abs(sees) < math.pi / 2
    if (sees > 0.0) != (is_seen > 0.0):
        return sees > 0.0
    # Each has the other on the same side, or dead ahead: one of them has to give way.
    return traffic.id[i] > traffic.id[k]


def _zones(
    apart_m: tuple[np.ndarray, np.ndarray], zones_m: tuple[np.ndarray, np.ndarray], factors: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Radius and half height to keep: the zone with its factors.

    From a neighbour that is already nearer, but outside of the zone itself, about the present distance is kept.
    Otherwise aircraft that fly side by side there would have no certified way but away from each other.
    """
    (beside_m, above_m), (radius_m, half_height_m) = apart_m, zones_m
    kept_m, kept_half_m = radius_m * factors[0], half_height_m * factors[1]
    is_within = (beside_m < kept_m) & (above_m < kept_half_m)
    is_beside = is_within & (beside_m >= radius_m)
    is_above = is_within & ~is_beside & (above_m >= half_height_m)
    return (
        np.where(is_beside, np.maximum(radius_m, _KEPT_SHARE * beside_m), kept_m),
        np.where(is_above, np.maximum(half_height_m, _KEPT_SHARE * above_m), kept_half_m),
    )


class FGA(ConflictResolution):
    """Conflict resolution by fga, for fixed-wing aircraft."""

    def __init__(self) -> None:
        super().__init__()
        self.flights: dict[str, _Flight] = {}
        # Who gives way in a pair that is or was in conflict, as decided when it was found.
        self.gives_way: dict[frozenset[str], str] = {}

    @property
    def vsactive(self):
        """The autopilot keeps the vertical speed."""
        return np.zeros_like(self.active)

    @property
    def altactive(self):
        """The autopilot keeps the altitude."""
        return np.zeros_like(self.active)

    @property
    def tasactive(self):
        """The autopilot keeps the speed."""
        return np.zeros_like(self.active)

    def reset(self) -> None:
        super().reset()
        self.flights.clear()
        self.gives_way.clear()

    def _agree(self, conf, traffic) -> tuple[set[str], dict[str, set[str]]]:
        """Who has to act now, and whom each aircraft may leave to give way to it."""
        place = {name: i for i, name in enumerate(traffic.id)}
        acting = {pair[0] for pair in conf.lospairs}
        left: dict[str, set[str]] = {}
        has_room: dict[int, bool] = {}
        for (name, other), until_s in zip(conf.confpairs, conf.tLOS):
            pair = frozenset((name, other))
            i, k = place[name], place[other]
            if pair not in self.gives_way:
                gives, goes = (i, k) if _gives_way(traffic, i, k) else (k, i)
                # In a formation the one that ought to give way may have no room, and would push its neighbours.
                boxed_in = not self._has_room(gives, conf, traffic, has_room)
                changed = boxed_in and self._has_room(goes, conf, traffic, has_room)
                self.gives_way[pair] = traffic.id[goes if changed else gives]
            stays = self.resooffac[k] or self.noresoac[i] or _is_rotorcraft(traffic, k)
            if self.gives_way[pair] == name or stays or until_s < 0.5 * conf.dtlookahead[i]:
                acting.add(name)
            else:
                left.setdefault(name, set()).add(other)
        here = set(place)
        self.gives_way = {
            pair: name
            for pair, name in self.gives_way.items()
            if pair <= here and (pair in conf.confpairs_unique or any(one in self.flights for one in pair))
        }
        return acting, left

    def _has_room(self, i: int, conf, traffic, known: dict[int, bool]) -> bool:
        """Whether an aircraft has a certified way past all others, if they fly on as they do."""
        if i not in known:
            known[i] = False
            if not (self.resooffac[i] or _is_rotorcraft(traffic, i) or traffic.tas[i] < 1.0):
                flight = self._begin(i, conf, traffic)
                decision = flight.avoider.step(self._situation(i, flight, conf, traffic, traffic, set()))
                known[i] = decision.reason not in _UNPROVEN
        return known[i]

    def update(self, conf, ownship, intruder) -> None:
        """Decides for every aircraft that is in a conflict or on its way round one."""
        acting, left = self._agree(conf, ownship)
        for name in set(self.flights) - set(ownship.id):
            del self.flights[name]
        for i, name in enumerate(ownship.id):
            flight = self.flights.get(name)
            if flight is None and name not in acting:
                continue
            if self.resooffac[i] or _is_rotorcraft(ownship, i) or ownship.tas[i] < 1.0:
                self._release(i, name, ownship)
                continue
            self._decide(i, name, conf, ownship, intruder, left.get(name, set()))
            if self.flights[name].state == "cruise" and name not in acting:
                self._release(i, name, ownship)

    def _release(self, i: int, name: str, traffic) -> None:
        """The autopilot has the aircraft."""
        self.flights.pop(name, None)
        if self.active[i]:
            self.active[i] = False
            route = traffic.ap.route[i]
            waypoint = route.findact(i)
            if traffic.swlnav[i] and waypoint != -1:
                route.direct(i, route.wpname[waypoint])

    def _begin(self, i: int, conf, traffic) -> _Flight:
        vehicle = _vehicle(traffic, i, "cruise")
        settings = fga.Settings(
            start="t0",
            decision_period_s=max(0.01, min(10.0, float(bs.settings.asas_dt))),
            surveillance_radius_m=math.inf,
            horizon_s=max(10.0, min(600.0, float(conf.dtlookahead[i]))),
        )
        flight = _Flight(
            lat_deg=float(traffic.lat[i]),
            lon_deg=float(traffic.lon[i]),
            avoider=fga.Avoider(settings, vehicle),
            vehicle=vehicle,
            mission=fga.Mission([]),
            intent=_intent(traffic, i),
            course_rad=math.radians(90.0 - float(traffic.hdg[i])),
        )
        flight.mission = _mission(traffic, i, flight)
        return flight

    def _decide(self, i: int, name: str, conf, ownship, intruder, left: set[str]) -> None:
        flight = self.flights.get(name)
        if flight is not None and flight.state == "cruise":
            is_far = math.hypot(*flight.xy_m(ownship.lat[i], ownship.lon[i])) > _FRAME_REACH_M
            if is_far or flight.intent != _intent(ownship, i):
                flight = None
        if flight is None:
            flight = self.flights[name] = self._begin(i, conf, ownship)
        vehicle = _vehicle(ownship, i, flight.state)
        if vehicle != flight.vehicle:
            flight.vehicle = vehicle
            flight.avoider.retune(vehicle)
        situation = self._situation(i, flight, conf, ownship, intruder, left)
        decision = flight.avoider.step(situation)
        flight.state = decision.state
        self.active[i] = decision.state in ("avoiding", "recovering")
        if self.active[i]:
            self._command(i, decision.stage_at(0.0), situation.ownship, flight.vehicle, situation.wind_mps)

    def _situation(self, i: int, flight: _Flight, conf, ownship, intruder, left: set[str]) -> fga.Situation:
        own = self._ownship(i, flight, ownship)
        wind = (float(ownship.windeast[i]), float(ownship.windnorth[i]), 0.0)
        obstacles = self._obstacles(i, flight, conf, intruder, left)
        return fga.Situation(float(bs.sim.simt), own, flight.mission, obstacles, wind)

    def _ownship(self, i: int, flight: _Flight, traffic) -> fga.Ownship:
        course = math.radians(90.0 - float(traffic.hdg[i]))
        flight.course_rad += math.remainder(course - flight.course_rad, 2 * math.pi)
        airspeed = float(traffic.tas[i])
        x, y = flight.xy_m(traffic.lat[i], traffic.lon[i])
        climb = math.asin(max(-1.0, min(1.0, float(traffic.vs[i]) / airspeed)))
        return fga.Ownship((x, y, float(traffic.alt[i])), flight.course_rad, airspeed, climb)

    def _obstacles(self, i: int, flight: _Flight, conf, traffic, left: set[str]) -> fga.Obstacles:
        others = [k for k in range(traffic.ntraf) if k != i and not self.noresoac[k] and traffic.id[k] not in left]
        places = np.array([flight.xy_m(traffic.lat[k], traffic.lon[k]) for k in others]).reshape(-1, 2)
        beside_m = np.hypot(*(places - flight.xy_m(traffic.lat[i], traffic.lon[i])).T)
        above_m = np.abs(np.asarray(traffic.alt, dtype=float)[others] - float(traffic.alt[i]))
        radius_m, half_height_m = _zones(
            (beside_m, above_m),
            (np.maximum(conf.rpz[others], conf.rpz[i]), np.maximum(conf.hpz[others], conf.hpz[i])),
            (self.resofach, self.resofacv),
        )
        return fga.Obstacles(
            id=np.array([flight.id_of(traffic.id[k]) for k in others], dtype=np.uint32),
            x_m=places[:, 0],
            y_m=places[:, 1],
            z_m=np.asarray(traffic.alt, dtype=float)[others],
            vx_mps=np.asarray(traffic.gseast, dtype=float)[others],
            vy_mps=np.asarray(traffic.gsnorth, dtype=float)[others],
            vz_mps=np.asarray(traffic.vs, dtype=float)[others],
            radius_m=radius_m,
            half_height_m=half_height_m,
        )

    def _command(self, i: int, stage, own: fga.Ownship, vehicle: fga.Vehicle, wind) -> None:
        """The track over the ground that flies a stage; without one the course is held."""
        turn = 0.0 if stage is None else stage.course_rad - own.course_rad
        if stage is not None and stage.rate_share < 1.0:
            most = stage.rate_share * vehicle.course_rate_radps * float(bs.settings.asas_dt)
            turn = max(-most, min(most, turn))
        # BlueSky turns the shorter way.
        course = own.course_rad + max(-3.0, min(3.0, turn))
        level = own.airspeed_mps * math.cos(own.climb_rad)
        east, north = level * math.cos(course) + wind[0], level * math.sin(course) + wind[1]
        self.trk[i] = math.degrees(math.atan2(east, north)) % 360.0


def install(folder: str | os.PathLike[str]) -> str:
    """Puts the plugin into BlueSky's folder, as BlueSky names it `workdir`; the path of the file."""
    plugins = os.path.join(os.path.expanduser(os.fspath(folder)), "plugins")
    os.makedirs(plugins, exist_ok=True)
    path = os.path.join(plugins, "fga.py")
    with open(f"{path}.part", "w", encoding="utf-8") as file:
        file.write(PLUGIN)
    os.replace(f"{path}.part", path)
    return path


def main(arguments: Sequence[str] | None = None) -> int:
    """`python -m fga.bluesky FOLDER`."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    if len(given) != 1 or given[0].startswith("-"):
        print("usage: python -m fga.bluesky FOLDER, where FOLDER is BlueSky's, as in ~/bluesky", file=sys.stderr)
        return 1
    try:
        print(install(given[0]))
    except OSError as error:
        print(f"fga: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
