"""An aircraft of JSBSim, six degrees of freedom, flown by fga's commands through a bank-and-pitch loop.

Frame as in fga: x east, y north, z up, metres; courses from +x towards +y, left banks positive. JSBSim has feet,
headings from north and right banks positive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import fga

COLUMNS = ("t_s", "airspeed_mps", "bank_command_rad", "bank_rad", "course_rad", "climb_rad")
_FT = 0.3048


@dataclass(frozen=True)
class Loop:
    """How an aircraft is flown: gains of its bank-and-pitch loop."""

    model: str
    airspeed_mps: float
    path_rad: float = 0.0
    """Climb angle of the path when nothing else is asked; a glider descends."""
    engine: bool = True
    rate_hz: int = 60
    aileron: float = 1.2
    roll_rate_radps: float = 0.5
    elevator: float = 1.5
    elevator_trim: float = 0.6
    rudder: float = 2.0
    path_rate_radps: float = math.radians(3.0)
    """Rate at which an asked climb angle is taken up."""


C172X = Loop("c172x", 50.0)
MINISGS = Loop(
    "minisgs", 12.0, math.radians(-4.0), engine=False, rate_hz=240, aileron=0.8, roll_rate_radps=0.8, elevator=0.3, elevator_trim=0.2,
    rudder=1.0,
)
"""A glider of 5 kg and 2.4 m span without an engine: its airspeed is what the path gives."""


class Aircraft:
    """An aircraft that holds a bank angle and a climb angle of its path, and with an engine its airspeed."""

    def __init__(self, loop: Loop = C172X, airspeed_mps: float | None = None, altitude_m: float = 1000.0) -> None:
        import jsbsim

        self.loop = loop
        self.rate_hz = loop.rate_hz
        self.asked_mps = loop.airspeed_mps if airspeed_mps is None else airspeed_mps
        jsbsim.FGJSBBase().debug_lvl = 0
        self.fdm = jsbsim.FGFDMExec(None)
        self.fdm.set_debug_level(0)
        self.fdm.load_model(loop.model)
        self.fdm.disable_output()
        self.fdm.set_dt(1.0 / self.rate_hz)
        for name, value in {
            "ic/h-sl-ft": altitude_m / _FT,
            "ic/vt-fps": self.asked_mps / _FT,
            "ic/psi-true-deg": 90.0,
            "ic/gamma-deg": math.degrees(loop.path_rad),
            "ic/lat-geod-deg": 0.0,
            "ic/long-gc-deg": 0.0,
        }.items():
            self.fdm[name] = value
        self.fdm.run_ic()
        if loop.engine:
            self.fdm["propulsion/set-running"] = -1
            self.fdm["fcs/mixture-cmd-norm"] = 0.87
        self.altitude_m = altitude_m
        self.throttle, self.pitch_trim, self.roll_trim = 0.7, 0.0, 0.0
        self.climb_rad = loop.path_rad
        self.time_s = 0.0
        self._course_rad = 0.0
        self.x_m = self.y_m = 0.0
        # Straight flight before anything is asked.
        self.fly(0.0, loop.path_rad, 40.0)
        self.begin()

    def begin(self) -> None:
        """Makes the present moment and position the origin."""
        self.time_s = self.x_m = self.y_m = 0.0
        self.altitude_m = self.fdm["position/h-sl-ft"] * _FT

    def fly(self, bank_rad: float, climb_rad: float, for_s: float) -> None:
        """Holds a bank, positive to the left, and a climb angle of the path."""
        fdm, loop = self.fdm, self.loop
        for _ in range(round(for_s * self.rate_hz)):
            dt = 1.0 / self.rate_hz
            step = loop.path_rate_radps * dt
            self.climb_rad += max(-step, min(step, climb_rad - self.climb_rad))
            roll = -fdm["attitude/phi-rad"]
            roll_rate = -fdm["velocities/p-rad_sec"]
            # The propeller pulls to one side.
            self.roll_trim = max(-0.2, min(0.2, self.roll_trim + 0.4 * (bank_rad - roll) * dt))
            wanted = 2.0 * (bank_rad - roll) + self.roll_trim
            wanted = max(-loop.roll_rate_radps, min(loop.roll_rate_radps, wanted))
            fdm["fcs/aileron-cmd-norm"] = max(-1.0, min(1.0, -loop.aileron * (wanted - roll_rate)))
            path = fdm["flight-path/gamma-rad"]
            error = self.climb_rad - path
            self.pitch_trim = max(-0.6, min(0.6, self.pitch_trim + loop.elevator_trim * error * dt))
            asked_rate = max(-0.2, min(0.2, 1.2 * error))
            turning = 9.81 / max(0.6 * self.asked_mps, self.airspeed_mps) * math.sin(roll) * math.tan(roll)
            lift = self.pitch_trim + loop.elevator * (asked_rate + turning - fdm["velocities/q-rad_sec"])
            fdm["fcs/elevator-cmd-norm"] = max(-1.0, min(1.0, -lift))
            fdm["fcs/rudder-cmd-norm"] = max(-1.0, min(1.0, -loop.rudder * fdm["aero/beta-rad"]))
            slow = self.asked_mps - self.airspeed_mps
            if loop.engine:
                self.throttle = max(0.0, min(1.0, self.throttle + 0.03 * slow * dt))
                fdm["fcs/throttle-cmd-norm"] = max(0.0, min(1.0, self.throttle + 0.15 * slow))
            if not fdm.run():
                raise RuntimeError("JSBSim has stopped")
            self.x_m += fdm["velocities/v-east-fps"] * _FT * dt
            self.y_m += fdm["velocities/v-north-fps"] * _FT * dt
            self.time_s += dt

    @property
    def airspeed_mps(self) -> float:
        return self.fdm["velocities/vt-fps"] * _FT

    @property
    def bank_rad(self) -> float:
        return -self.fdm["attitude/phi-rad"]

    @property
    def ownship(self) -> fga.Ownship:
        """The state for fga."""
        east, north = self.fdm["velocities/v-east-fps"], self.fdm["velocities/v-north-fps"]
        course = math.atan2(north, east)
        self._course_rad += math.remainder(course - self._course_rad, 2 * math.pi)
        up_m = self.fdm["position/h-sl-ft"] * _FT - self.altitude_m
        return fga.Ownship(
            (self.x_m, self.y_m, up_m),
            self._course_rad,
            self.airspeed_mps,
            self.fdm["flight-path/gamma-rad"],
            self.bank_rad,
        )


def step_responses(aircraft: Aircraft, bank_deg: float) -> dict[str, np.ndarray]:
    """A log of bank steps to both sides, a steeper and a flatter path, at 20 Hz."""
    rows = []
    program = [(side * share * bank_deg, 0.0, 9.0) for share in (1.0, 0.6) for side in (1, 0, -1, 0)]
    steepest = 5.0 if aircraft.loop.engine else 4.0
    program += [(bank_deg, 0.0, 14.0), (0.0, steepest, 9.0), (0.0, -6.0, 9.0), (-bank_deg, 0.0, 14.0), (0.0, 0.0, 9.0)]
    for bank, climb, for_s in program:
        for _ in range(round(for_s * 20)):
            own = aircraft.ownship
            rows.append(
                (aircraft.time_s, own.airspeed_mps, math.radians(bank), own.bank_rad, own.course_rad, own.climb_rad)
            )
            aircraft.fly(math.radians(bank), aircraft.loop.path_rad + math.radians(climb), 0.05)
    return dict(zip(COLUMNS, np.array(rows).T, strict=True))


def bank_of(stage: fga.Stage | None, own: fga.Ownship, vehicle: fga.Vehicle, settle_s: float) -> float:
    """The bank that flies a stage: as steep as asked, out of the turn in good time."""
    if stage is None:
        return 0.0
    most = math.atan(stage.rate_share * math.tan(vehicle.bank_max_rad))
    rate = (stage.course_rad - own.course_rad) / settle_s
    bank = math.atan(own.airspeed_mps * rate / 9.80665)
    return max(-most, min(most, bank))


class Flight:
    """A closed loop: fga decides, JSBSim flies."""

    def __init__(self, aircraft: Aircraft, model: fga.VehicleModel) -> None:
        self.aircraft, self.model = aircraft, model
        self.avoider = fga.Avoider(model.settings, model.vehicle)
        vehicle = model.vehicle
        self.settle_s = vehicle.dead_time_s + vehicle.bank_time_constant_s + 0.3
        self.period_s = model.settings.decision_period_s

    def fly(self, obstacles, for_s: float, seen=lambda decision, own, time_s: None) -> float:
        """Flies a mission straight along its path past straight-flying obstacles; the least margin, metres."""
        start = self.aircraft.ownship
        x, y, z = start.position_m
        course = start.course_rad
        ahead = (x + 1e5 * math.cos(course), y + 1e5 * math.sin(course), z + 1e5 * math.tan(self.aircraft.loop.path_rad))
        mission = fga.Mission([start.position_m, ahead])
        least = math.inf
        begun = self.aircraft.time_s
        while (time_s := self.aircraft.time_s - begun) < for_s:
            own = self.aircraft.ownship
            now = [
                fga.Obstacle(
                    o.id,
                    tuple(p + v * time_s for p, v in zip(o.position_m, o.velocity_mps, strict=True)),
                    o.radius_m,
                    o.velocity_mps,
                )
                for o in obstacles
            ]
            for o in now:
                least = min(least, math.dist(o.position_m, own.position_m) - o.radius_m)
            decision = self.avoider.step(fga.Situation(time_s, own, mission, now))
            seen(decision, own, time_s)
            stage = decision.stage_at(0.0)
            climb = own.climb_rad if stage is None else stage.climb_rad
            self.aircraft.fly(
                bank_of(stage, own, self.model.vehicle, self.settle_s), climb, self.period_s
            )
        return least
