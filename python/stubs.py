"""Writes the type stubs of the compiled part from the module itself: `python python/stubs.py > python/src/fga/_fga.pyi`.

Names, parameters and defaults come from the module; types come from the units in the names and from the tables
below, which must have every other name. A test compares the file with the output.
"""

from __future__ import annotations

import inspect
import re
import sys

from fga import _fga

HEAD = '''"""The compiled part of the package `fga`; written by python/stubs.py."""

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
'''

STATE = 'Literal["cruise", "threatened", "avoiding", "recovering"]'
KIND = 'Literal["straight", "still", "aircraft", "uas"]'

# By "Class.name" first, then by name.
TYPES = {
    "position_m": "_Triple",
    "velocity_mps": "_Triple",
    "wind_mps": "_Triple",
    "Obstacle.half_height_m": "float | None",
    "VehicleModel.half_height_m": "float | None",
    "Mission.waypoints_m": "list[_Triple]",
    "Mission.__new__.waypoints_m": "Sequence[_Triple] | ArrayLike",
    "fly_over": "Sequence[int]",
    "limits_m": "tuple[float, float]",
    "Mission.fly_over": "list[int]",
    "Mission.zones": "list[Zone]",
    "Mission.ground": "Ground | None",
    "Zone.polygon_m": "list[tuple[float, float]] | None",
    "Zone.__new__.polygon_m": "Sequence[tuple[float, float]] | ArrayLike | None",
    "Zone.center_m": "tuple[float, float] | None",
    "Zone.radius_m": "float | None",
    "keep_in": "bool",
    "Ground.heights_m": "NDArray[np.float32]",
    "Ground.__new__.heights_m": "ArrayLike",
    "corner_m": "tuple[float, float]",
    "spacing_m": "tuple[float, float]",
    "Ground.height_m": "float | None",
    "kind": KIND,
    "Obstacle.__new__.kind": "str",
    "nature": 'Literal["unknown", "passengers", "natural-barrier"]',
    "Obstacle.__new__.nature": "str",
    "id": "int",
    "Settings.start": "str",
    "objective": "str",
    "work_limit": "int",
    "heading_cost": "float",
    "pitch_cost": "float",
    "confidence_sigmas": "float",
    "turn_rate_factor": "float",
    "bank_max_rad": "float | None",
    "ownship": "Ownship",
    "Simulation.__new__.ownship": "str | None",
    "run.ownship": "str | None",
    "mission": "Mission",
    "Situation.obstacles": "list[Obstacle]",
    "Situation.__new__.obstacles": "Sequence[Obstacle] | Obstacles | None",
    "stages": "list[Stage]",
    "Decision.__new__.stages": "Sequence[Stage]",
    "state": STATE,
    "rate_share": "float",
    "cost": "float",
    "verdict": 'Literal["certified", "rejected", "chosen"]',
    "reason": "str",
    "text": "str",
    "command": "list[Stage]",
    "stage_at": "Stage | None",
    "predicted": "Ownship",
    "threat": "Threat | None",
    "latest_start_s": "float | None",
    "Decision.start_s": "float | None",
    "chosen": "Candidate | None",
    "alternative": "Candidate | None",
    "proof": 'Literal["certified", "leaving"] | None',
    "resilience": "float | None",
    "p_loss_hold": "float | None",
    "p_loss": "float | None",
    "proven_share": "float | None",
    "tracked": "int",
    "unusable": "int",
    "threats": "int",
    "candidates": "int",
    "work": "int",
    "limit_met": "bool",
    "to_dict": "dict[str, Any]",
    "vehicle": "VehicleModel | _Path | None",
    "Avoider.vehicle": "Vehicle | None",
    "Shield.vehicle": "Vehicle | None",
    "VehicleModel.vehicle": "Vehicle",
    "Campaign.__new__.vehicle": "_Path | None",
    "retune.vehicle": "Vehicle",
    "predicted.vehicle": "Vehicle",
    "settings": "Settings | None",
    "VehicleModel.settings": "Settings",
    "name": "str",
    "model": "VehicleModel | _Path | None",
    "Simulation.model": "VehicleModel",
    "read": "VehicleModel",
    "Campaign.read": "Table",
    "path": "_Path",
    "policy": "str",
    "decisions.policy": "object | None",
    "run.policy": "object",
    "batch.policy": "object",
    "policies": "Sequence[object]",
    "intruders": "Sequence[object]",
    "own": "Sequence[object]",
    "recordings": "Sequence[_Path]",
    "Campaign.__new__.model": "_Path | None",
    "Campaign.policies": "list[str]",
    "Avoider.step": "Decision",
    "Pilot.step": "Decision",
    "Shield.step": "tuple[Decision, bool]",
    "Worlds.step": "tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]",
    "Simulation.step": "Decision | None",
    "step.situation": "Situation",
    "Simulation.situation": "Situation | None",
    "step.wish": "Decision",
    "step.pilot": "Avoider | Pilot",
    "step.actions": "NDArray[np.float64]",
    "step.held": "list[bool] | None",
    "advance": "bool",
    "advance.decision": "Decision",
    "outcome": "dict[str, Any]",
    "take_retuned": "Vehicle | None",
    "retune": "None",
    "restart": "None",
    "names": "list[str]",
    "file": "_Path",
    "summary": "dict[str, Any]",
    "separated": "bool",
    "track": "Table",
    "decisions": "list[Decision]",
    "track_csv": "bytes",
    "events_jsonl": "str",
    "replay_html": "str",
    "write": "None",
    "folder": "_Path",
    "column_names": "list[str]",
    "Table.columns": "list[str]",
    "Table.shape": "tuple[int, int]",
    "Table.__getitem__": "NDArray[Any]",
    "Table.__contains__": "bool",
    "Table.to_polars": "polars.DataFrame",
    "Table.to_pandas": "pandas.DataFrame",
    "Table.__getitem__.key": "str",
    "Table.__contains__.key": "object",
    "to_csv": "bytes",
    "__arrow_c_stream__": "object",
    "requested_schema": "object | None",
    "encounters": "object",
    "Campaign.__new__.encounters": "int | None",
    "Campaign.encounters": "int",
    "oracle": "Table",
    "Campaign.__new__.oracle": "bool",
    "batch": "Table",
    "stress": "dict[str, Any]",
    "stress.policy": "object",
    "stress.intruders": "int",
    "gust_mps": "float | None",
    "stress.kind": "str",
    "flights": "int",
    "league": "list[dict[str, Any]]",
    "league.encounters": "int | None",
    "sets": "Sequence[str]",
    "data": "_Path | None",
    "worst": "int",
    "run": "Run",
    "Campaign.run": "str",
    "merge": "str",
    "open": "None",
    "seed": "int",
    "threads": "int | None",
    "progress": "_Progress | None",
    "overlay": "Sequence[object]",
    "out": "_Path",
    "resume": "bool",
    "csv": "bool",
    "hash": "str",
    "blocks": "int",
    "block": "int",
    "block_of": "int | None",
    "range_of": "tuple[int, int]",
    "fly_block": "tuple[str, int, bytes]",
    "from_json": "Campaign",
    "to_json": "str",
    "manifest_json": "str",
    "encounter": "int",
    "cell": "str",
    "count": "int",
    "seen": "int",
    "shielded": "bool",
    "observed": "int",
    "observe": "NDArray[np.float32]",
    "reset": "None",
    "places": "list[int]",
    "numbers": "list[int]",
    "alerts": "Table",
    "Monitor.bands": "list[tuple[float, float, str]]",
    "bands": "Table",
    "recording": "_Path",
    "config": "_Path",
    "Monitor.step": "dict[int, int]",
    "highest_level": "int",
    "resolutions": "tuple[float | None, float | None]",
    "quantity": "str",
    "identify": "Identified",
    "log": "_Path | Mapping[str, ArrayLike]",
    "Identified.airspeed_mps": "Estimate",
    "Identified.max_bank_deg": "Estimate",
    "Identified.dead_time_s": "Estimate",
    "Identified.bank_time_constant_s": "Estimate",
    "Identified.turn_rate_factor": "Estimate",
    "Identified.climb_min_deg": "Estimate",
    "Identified.climb_max_deg": "Estimate",
    "Identified.climb_rate_radps": "Estimate",
    "Identified.position_error_m": "Estimate",
    "Identified.to_toml.half_height_m": "float | None",
    "windows": "int",
    "windows_left_out": "int",
    "to_toml": "str",
    "value": "float",
    "low": "float",
    "high": "float",
    "__len__": "int",
    "__repr__": "str",
    "__new__": "None",
}
UNIT = re.compile(r"_(m|s|mps|rad|radps|deg)$")
SHOWN = ("__len__", "__arrow_c_stream__", "__getitem__", "__contains__")


def told_of(value: object, indent: str) -> list[str]:
    """The documentation of a class or function, as lines of a stub; none without one."""
    text = inspect.getdoc(value)
    if not text:
        return []
    first, *rest = text.replace(chr(92), chr(92) * 2).split(chr(10))
    if not rest:
        return [f'{indent}"""{first}"""']
    return [f'{indent}"""{first}', *(f"{indent}{line}".rstrip() for line in rest), f'{indent}"""']


def documented(line: str, value: object, indent: str) -> list[str]:
    """A line of a function that ends in `...`, with its documentation before that."""
    told = told_of(value, indent)
    return [line.removesuffix(" ..."), *told, f"{indent}..."] if told else [line]


def type_of(*keys: str) -> str:
    """The type of the first known key."""
    for key in keys:
        if key in TYPES:
            return TYPES[key]
    if UNIT.search(keys[-1]):
        return "float"
    raise SystemExit(f"python/stubs.py: no type for {' or '.join(keys)}")


def parameters(owner: str, name: str, value: object) -> list[str]:
    """Parameters with their types and defaults."""
    shown = []
    for parameter in inspect.signature(value).parameters.values():
        if parameter.name in ("self", "cls", "slf"):
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in shown:
            shown.append("*")
        keys = (f"{owner}.{name}.{parameter.name}", f"{name}.{parameter.name}")
        if owner == "Obstacles":
            kind = "ArrayLike"
            if parameter.default is None:
                kind += " | None"
        else:
            kind = type_of(*keys, *([f"{owner}.{parameter.name}"] if name == "__new__" else []), parameter.name)
        default = ""
        if parameter.default is not parameter.empty:
            default = " = ..." if parameter.default is ... else f" = {parameter.default!r}"
            if parameter.default is None and "None" not in kind and kind != "object":
                kind += " | None"
        shown.append(f"{parameter.name}: {kind}{default}")
    return shown


def stub_of(name: str, value: type) -> str:
    """The stub of a class."""
    lines = ["@final", f"class {name}:"]
    body = told_of(value, "    ")
    if body:
        body.append("")
    try:
        inspect.signature(value)
        body.append(f"    def __new__(cls, {', '.join(parameters(name, '__new__', value))}) -> {name}: ...".replace("(cls, )", "(cls)"))
    except ValueError:
        pass
    # The order in which the module holds them differs from build to build.
    for member, told in sorted(vars(value).items()):
        if member.startswith("_") and member not in SHOWN:
            continue
        if inspect.isgetsetdescriptor(told):
            line = f"    def {member}(self) -> {type_of(f'{name}.{member}', member)}: ..."
            body += ["    @property", *documented(line, told, " " * 8)]
        elif isinstance(told, staticmethod):
            told = getattr(value, member)
            line = f"    def {member}({', '.join(parameters(name, member, told))}) -> {type_of(f'{name}.{member}', member)}: ..."
            body += ["    @staticmethod", *documented(line, told, " " * 8)]
        elif callable(told):
            try:
                arguments = ["self", *parameters(name, member, told)]
            except ValueError:
                arguments = ["self"]
            line = f"    def {member}({', '.join(arguments)}) -> {type_of(f'{name}.{member}', member)}: ..."
            body += [line] if member.startswith("_") else documented(line, told, " " * 8)
    return "\n".join(lines + (body or ["    ..."])) + "\n"


def stubs() -> str:
    """The whole file."""
    parts = [HEAD]
    for name, value in sorted(vars(_fga).items()):
        if inspect.isclass(value):
            parts.append(stub_of(name, value))
        elif inspect.isbuiltin(value) and not name.startswith("_"):
            arguments = ", ".join(parameters(name, name, value))
            line = f"def {name}({arguments}) -> {type_of(name)}: ..."
            parts.append("\n".join(documented(line, value, "    ")) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    sys.stdout.write(stubs())
