"""Scenarios of BlueSky, flown headless with each conflict resolution, and judged by code of their own.

`python bluesky_flights.py FOLDER SCENARIO…` prints a table. A scenario is a command of BlueSky's generator of
conflicts, such as `SYN SUPER 8`, a formation (`WALL 20`, `MATRIX 3`), or the path of a scenario file. BlueSky runs in a
process without its server, stepped from here: its own loop waits for real time and ends only with QUIT.
"""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

METHODS = ("OFF", "MVP", "FGA")
STEP_S = 0.25
NAUTICAL_MILE_M = 1852.0
ZONE_M, ZONE_HALF_HEIGHT_M = 5 * NAUTICAL_MILE_M, 1000 * 0.3048
_EARTH_M = 6_371_000.0
# What a scenario file says about resolution, display and pace is the runner's business.
_NOT_OURS = {
    "RESO", "RMETHH", "RMETHV", "RFACH", "RFACV", "PRIORULES", "ASAS", "CDMETHOD", "PLUGIN",
    "HOLD", "OP", "FF", "QUIT", "DT", "DTMULT", "RTF", "SCEN", "IC", "RESET", "BENCHMARK",
    "PAN", "ZOOM", "+", "++", "+++", "-", "--", "---", "SYMBOL", "SWRAD", "TRAIL", "TRAILS", "SSD", "ECHO", "LABEL", "SHOWPZ",
}  # fmt: skip


def formation(name: str, size: int) -> list[str]:
    """Commands for WALL and MATRIX of BlueSky's generator, whose own ones fail in version 1.1.1.

    There they take the zone's radius from traffic that is not there yet. Distances as there: 1.1 zones between
    neighbours.
    """
    apart = 1.1 * ZONE_M / 111_319.0
    places = []
    if name == "WALL":
        places.append(("OWNSHIP", 0.0, -0.6, 90))
        places += [(f"OTHER{k}", (k - size // 2) * apart, 0.6, 270) for k in range(size)]
    else:
        # What an aircraft of 200 m/s flies in 5.5 minutes.
        out = apart * (size - 1) / 2 + 200 * 1.1 * 300 / 111_319.0
        for k in range(size):
            beside = (k - (size - 1) / 2) * apart
            places += [(f"NORTH{k}", out, beside, 180), (f"SOUTH{k}", -out, beside, 0)]
            places += [(f"EAST{k}", beside, out, 270), (f"WEST{k}", beside, -out, 90)]
    # Mach 0.63 at 20,000 ft is 200 m/s.
    return [f"CRE {acid} B744 {lat:.6f} {lon:.6f} {track} 20000 0.63" for acid, lat, lon, track in places]


def commands_of(scenario: str) -> list[tuple[float, str]]:
    """Times and commands of a scenario file, without those that choose the resolution or the pace."""
    name, _, size = scenario.partition(" ")
    if name in ("WALL", "MATRIX"):
        return [(0.0, command) for command in formation(name, int(size))]
    if not scenario.lower().endswith(".scn"):
        return [(0.0, scenario)]
    commands = []
    for line in Path(scenario).read_text(encoding="utf-8", errors="replace").splitlines():
        stamp, bracket, rest = line.strip().partition(">")
        if not bracket or stamp.startswith("#"):
            continue
        hours, minutes, seconds = (float(part) for part in stamp.split(":"))
        due_s = hours * 3600 + minutes * 60 + seconds
        # BlueSky 1.1.1 no longer reads `0.` as a number; its own scenarios have it.
        rest = re.sub(r"(?<=\d)\.(?=[\s,]|$)", ".0", rest)
        for command in rest.split(";"):
            words = command.replace(",", " ").upper().split()
            if words[:1] == ["SYN"] and words[1:2] in (["WALL"], ["MATRIX"]):
                size = int(words[2]) if len(words) > 2 else 20
                commands += [(due_s, made) for made in formation(words[1], size)]
            elif words and words[0] not in _NOT_OURS:
                commands.append((due_s, command.strip()))
    return commands


def places_m(traffic) -> np.ndarray:
    """East, north, up of every aircraft, metres, on the sphere that BlueSky flies on."""
    lat, lon = np.radians(traffic.lat), np.radians(traffic.lon)
    return np.column_stack([_EARTH_M * lon, _EARTH_M * lat, traffic.alt])


def separations(traffic) -> tuple[np.ndarray, np.ndarray]:
    """Horizontal (great circle) and vertical distance of each pair, metres."""
    lat, lon = np.radians(traffic.lat), np.radians(traffic.lon)
    a, b = np.triu_indices(len(lat), 1)
    half = np.sin((lat[b] - lat[a]) / 2) ** 2 + np.cos(lat[a]) * np.cos(lat[b]) * np.sin((lon[b] - lon[a]) / 2) ** 2
    return 2 * _EARTH_M * np.arcsin(np.sqrt(np.minimum(1.0, half))), np.abs(traffic.alt[b] - traffic.alt[a])


def fly(folder: str, scenario: str, method: str, for_s: float, seed: int = 1) -> dict:
    """Flies one scenario; what came of it, with the tracks."""
    import bluesky as bs

    from fga import bluesky as fga_bluesky

    fga_bluesky.install(folder)
    bs.init(mode="sim", detached=True, workdir=folder)
    bs.settings.simdt = STEP_S
    bs.sim.reset()
    bs.sim.setseed(seed)
    zone_m, half_m = bs.settings.asas_pzr * NAUTICAL_MILE_M, bs.settings.asas_pzh * 0.3048
    bs.stack.stack("PLUGIN FGA")
    bs.stack.stack("PLUGIN SYNTHETIC")
    bs.stack.process()
    # Its generator gives whole degrees where its traffic expects numbers with a fraction.
    create = bs.traf.cre
    bs.traf.cre = lambda *a, **k: create(*a, **{key: float(v) if key in ("aclat", "aclon") and isinstance(v, int) else v for key, v in k.items()})
    waiting = commands_of(scenario)
    for due, command in [w for w in waiting if w[0] <= 0.0]:
        bs.stack.stack(command)
    bs.stack.process()
    waiting = sorted((w for w in waiting if w[0] > 0.0), key=lambda w: w[0])
    for command in ("ASAS ON", f"RESO {method}"):
        bs.stack.stack(command)
    bs.stack.process()
    chosen = bs.traf.cr._selected().__name__.upper().replace("CONFLICTRESOLUTION", "OFF")
    assert chosen == method, f"{chosen} was chosen, expected {method}"
    taken_s: list[float] = []
    update = bs.traf.cr.update

    def timed(*arguments):
        begun = time.perf_counter()
        update(*arguments)
        taken_s.append(time.perf_counter() - begun)

    # BlueSky calls the selected method's functions as its proxy keeps them.
    vars(bs.traf.cr)["update"] = timed
    lost: set[frozenset[str]] = set()
    born_lost: set[frozenset[str]] = set()
    seen: set[frozenset[str]] = set()
    least = math.inf
    tracks: dict[str, list] = {}
    bs.sim.op()
    steps = round(for_s / STEP_S)
    for step in range(steps):
        while waiting and waiting[0][0] <= bs.sim.simt:
            bs.stack.stack(waiting.pop(0)[1])
        bs.sim.step()
        assert bs.sim.state == bs.OP, "the simulation runs on"
        if bs.traf.ntraf < 2:
            continue
        apart_m, above_m = separations(bs.traf)
        names = bs.traf.id
        pairs = list(zip(*np.triu_indices(len(names), 1)))
        # 1 on the zone's border, less inside.
        share = np.maximum(apart_m / zone_m, above_m / half_m)
        for place, (a, b) in enumerate(pairs):
            pair = frozenset((names[a], names[b]))
            if share[place] < 1.0:
                (lost if pair in seen else born_lost).add(pair)
            elif pair not in seen:
                seen.add(pair)
        clear = [s for s, (a, b) in zip(share, pairs) if frozenset((names[a], names[b])) not in born_lost]
        least = min([least, *clear])
        if step % round(2.0 / STEP_S) == 0:
            for name, place in zip(names, places_m(bs.traf)):
                tracks.setdefault(name, []).append([bs.sim.simt, *place])
    return {
        "scenario": scenario if not scenario.lower().endswith(".scn") else Path(scenario).stem,
        "method": method,
        "aircraft": len(tracks),
        "lost": sorted(sorted(pair) for pair in lost - born_lost),
        "least_share": None if math.isinf(least) else least,
        "simulated_s": float(bs.sim.simt),
        "update_ms": [float(1e3 * np.percentile(taken_s, q)) for q in (50, 99, 100)] if taken_s else None,
        "tracks": tracks,
    }


def departures_m(tracks: dict, without: dict) -> dict[str, float]:
    """Largest distance of each aircraft from the path that it flies without resolution, horizontal, metres."""
    found = {}
    for name, flown in tracks.items():
        path = np.array(without.get(name, []))
        if len(path) < 2:
            continue
        here = np.array(flown)
        most = 0.0
        for _, x, y, _ in here:
            narrow = math.cos(y / _EARTH_M)
            most = max(most, float(np.hypot((path[:, 1] - x) * narrow, path[:, 2] - y).min()))
        found[name] = most
    return found


def flown_apart(folder: str, scenario: str, method: str, for_s: float) -> dict:
    """`fly` in a process of its own: BlueSky is one per process."""
    told = subprocess.run(
        [sys.executable, __file__, "--one", folder, scenario, method, str(for_s)],
        capture_output=True,
        text=True,
        timeout=3600,
    )
    if told.returncode:
        raise RuntimeError(f"{scenario} with {method}: {told.stderr[-2000:]}")
    return json.loads(told.stdout.splitlines()[-1])


def main() -> None:
    if sys.argv[1] == "--one":
        _, _, folder, scenario, method, for_s = sys.argv
        print("\n" + json.dumps(fly(folder, scenario, method, float(for_s))))
        return
    folder, for_s, scenarios = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
    for scenario in scenarios:
        without, lost = None, {}
        for method in METHODS:
            told = flown_apart(folder, scenario, method, for_s)
            without = without or told["tracks"]
            lost[method] = {frozenset(pair) for pair in told["lost"]}
            away = list(departures_m(told["tracks"], without).values()) or [0.0]
            print(
                f"| {told['scenario']} | {told['aircraft']} | {method} | {len(told['lost'])} | "
                f"{told['least_share'] if told['least_share'] is None else round(told['least_share'], 3)} | "
                f"{np.median(away) / NAUTICAL_MILE_M:.1f}, {max(away) / NAUTICAL_MILE_M:.1f} | "
                + (", ".join(f"{ms:.2f}" for ms in told["update_ms"]) if told["update_ms"] else "")
                + " |",
                flush=True,
            )
        worse = sorted(sorted(pair) for pair in lost["FGA"] - lost["MVP"])
        if worse:
            print(f"lost with FGA, kept with MVP: {worse}", file=sys.stderr)


if __name__ == "__main__":
    main()
