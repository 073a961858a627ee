"""Real-time 3D collision avoidance for fixed-wing aircraft.

Decide step by step, with an aircraft of your own:

>>> import fga
>>> mission = fga.Mission([(0, 0, 100), (5000, 0, 100)])
>>> ownship = fga.Ownship(position_m=(0, 0, 100), course_rad=0.0, airspeed_mps=15.0)
>>> tower = fga.Obstacle(id=1, position_m=(120, 5, 100), radius_m=30, kind="still")
>>> decision = fga.Avoider().step(fga.Situation(0.0, ownship, mission, [tower]))
>>> decision.state, decision.threat.id
('avoiding', 1)

Frame: x east, y north, z up, metres; angles in radians, courses from +x towards +y (a left turn increases the
course). Names carry their units. Wrong input raises ValueError (TypeError for a wrong type,
FileNotFoundError for a file that is not there) with the sentence of the program; a path that is not writable raises OSError.

The package keeps no threads or locks from one call to the next, so processes may fork. The values that an
Avoider takes and its decisions can be pickled; an Avoider, Pilot, Monitor, Simulation or Run cannot.
"""

import importlib
from typing import TYPE_CHECKING

from ._fga import (
    Avoider,
    Campaign,
    Candidate,
    Decision,
    Estimate,
    Ground,
    Identified,
    Mission,
    Monitor,
    Obstacle,
    Obstacles,
    Ownship,
    Pilot,
    Run,
    Settings,
    Shield,
    Simulation,
    Situation,
    Stage,
    Table,
    Threat,
    Vehicle,
    VehicleModel,
    Worlds,
    Zone,
    alerts,
    bands,
    batch,
    identify,
    league,
    oracle,
    run,
    stress,
    versions,
)
from ._progress import progress_bar
from ._replay import replay

if TYPE_CHECKING:
    from .campaign import campaign

__version__ = versions["version"]


def __getattr__(name):
    # Loaded on demand, so that `python -m fga.campaign` finds it unloaded.
    if name == "campaign":
        return importlib.import_module(".campaign", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "Avoider",
    "Campaign",
    "Candidate",
    "Decision",
    "Estimate",
    "Ground",
    "Identified",
    "Mission",
    "Monitor",
    "Obstacle",
    "Obstacles",
    "Ownship",
    "Pilot",
    "Run",
    "Settings",
    "Shield",
    "Simulation",
    "Situation",
    "Stage",
    "Table",
    "Threat",
    "Vehicle",
    "VehicleModel",
    "Worlds",
    "Zone",
    "alerts",
    "bands",
    "batch",
    "campaign",
    "identify",
    "league",
    "oracle",
    "progress_bar",
    "replay",
    "run",
    "stress",
    "versions",
]
