#!/usr/bin/env python3
"""Recomputes what a campaign says of flown encounters, from tracks alone.

    flown.py RECORDINGS CAMPAIGN RUNS POLICY

RECORDINGS holds .daa files of two aircraft, the first one the ownship. CAMPAIGN is the folder of
`fga campaign run --csv`, RUNS has the folder of `fga run --policy POLICY` of each recording, named
after it. The script reads tracks (the recordings and `track.csv`), judges near mid-air collision and
well clear by itself, and compares each row of `results.csv` and the risk ratios of `risk.csv`.
It uses nothing but the standard library, and no line of fga.

Exit code 0: everything agrees; 1: each difference on a line.
"""

import csv
import math
import sys
from pathlib import Path

FOOT = 0.3048
NMAC = (500 * FOOT, 100 * FOOT)
WELL_CLEAR = (2000 * FOOT, 250 * FOOT)
# The recordings have six decimals of a degree: 0.1 m.
TOLERANCE_M = 0.5


def recording(path):
    """Two tracks (t, x, y, z) in a plane about the ownship's first place, metres and seconds."""
    rows, header = {}, None
    for line in path.read_text().splitlines():
        fields = [field for field in line.replace(",", " ").split() if field]
        if not fields or fields[0].startswith("#") or "=" in line:
            continue
        if header is None:
            header = [name.lower() for name in fields]
            continue
        if fields[-1].startswith("["):
            continue
        row = dict(zip(header, fields))
        place = tuple(float(row[name]) for name in ("time", "lat", "lon", "alt"))
        rows.setdefault(row["name"], []).append(place)
    own, other = rows.values()
    begin, lat, lon, alt = own[0]
    origin = cartesian(lat, lon)
    east, north = axes(lat, lon)

    def local(track):
        for time, lat, lon, height in track:
            offset = [a - b for a, b in zip(cartesian(lat, lon), origin)]
            x = sum(a * b for a, b in zip(east, offset))
            y = sum(a * b for a, b in zip(north, offset))
            yield time - begin, x, y, (height - alt) * FOOT

    return list(local(own)), list(local(other))


def cartesian(lat, lon):
    """Geocentric place on a sphere with a nautical mile for each minute of arc, metres.

    That is the Earth of `.daa` files, in DAIDALUS as in fga. On the WGS 84 ellipsoid distances
    from west to east are 0.35 % longer at 45 degrees; the counts are the same on both.
    """
    radius = 1852 * 60 * 180 / math.pi
    lat, lon = math.radians(lat), math.radians(lon)
    return (
        radius * math.cos(lat) * math.cos(lon),
        radius * math.cos(lat) * math.sin(lon),
        radius * math.sin(lat),
    )


def axes(lat, lon):
    """Unit vectors to the east and to the north."""
    lat, lon = math.radians(lat), math.radians(lon)
    east = (-math.sin(lon), math.cos(lon), 0.0)
    north = (-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat))
    return east, north


def at(track, time, place):
    """The position at a time, straight between rows; `place` is the row before or at it."""
    while place + 2 < len(track) and track[place + 1][0] <= time:
        place += 1
    (t0, *a), (t1, *b) = track[place], track[place + 1]
    part = (time - t0) / (t1 - t0) if t1 > t0 else 0.0
    return [p + part * (q - p) for p, q in zip(a, b)], place


def judge(own, other):
    """Whether NMAC and well clear are lost, and the least horizontal distance, while both are known."""
    begin, end = max(own[0][0], other[0][0]), min(own[-1][0], other[-1][0])
    times = {begin, end}
    times.update(t for t, *_ in own + other if begin <= t <= end)
    times = sorted(times)
    offsets, i, j = [], 0, 0
    for time in times:
        a, i = at(own, time, i)
        b, j = at(other, time, j)
        offsets.append([p - q for p, q in zip(a, b)])
    lost, least = [False, False], math.inf
    for before, after in zip(offsets, offsets[1:] or offsets):
        lost = [was or enters(before, after, *volume) for was, volume in zip(lost, (NMAC, WELL_CLEAR))]
        least = min(least, nearest(before, after))
    return *lost, least


def nearest(a, b):
    """Least horizontal distance on a straight piece."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    square = dx * dx + dy * dy
    part = min(1.0, max(0.0, -(a[0] * dx + a[1] * dy) / square)) if square > 0 else 0.0
    return math.hypot(a[0] + part * dx, a[1] + part * dy)


def enters(a, b, radius, height):
    """Whether a straight piece enters a cylinder."""
    low, high = 0.0, 1.0
    dz = b[2] - a[2]
    if dz == 0:
        if abs(a[2]) >= height:
            return False
    else:
        first, second = sorted(((-height - a[2]) / dz, (height - a[2]) / dz))
        low, high = max(low, first), min(high, second)
    dx, dy = b[0] - a[0], b[1] - a[1]
    square, along = dx * dx + dy * dy, a[0] * dx + a[1] * dy
    room = along * along - square * (a[0] ** 2 + a[1] ** 2 - radius * radius)
    if square == 0:
        if math.hypot(a[0], a[1]) >= radius:
            return False
    elif room <= 0:
        return False
    else:
        root = math.sqrt(room)
        low, high = max(low, (-along - root) / square), min(high, (-along + root) / square)
    return low < high


def flown(folder):
    """The flown track and whether the policy acted."""
    with open(folder / "track.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    track = [tuple(float(row[name]) for name in ("t_s", "x_m", "y_m", "z_m")) for row in rows]
    return track, any(row["state"] == "avoiding" for row in rows)


def wilson(losses, of):
    """The 95 % interval of a share by Wilson (1927)."""
    z = 1.959963984540054
    share, square = losses / of, z * z
    middle = share + square / (2 * of)
    half = z * math.sqrt(share * (1 - share) / of + square / (4 * of * of))
    below = 1 + square / of
    return max(0.0, (middle - half) / below), min(1.0, (middle + half) / below)


def main(recordings, campaign, runs, policy):
    differences = []

    def compare(what, found, expected, tolerance=0.0):
        agree = abs(found - expected) <= tolerance if tolerance else found == expected
        if not agree:
            differences.append(f"{what}: {found} here, {expected} in the campaign")

    with open(campaign / "results.csv", newline="") as file:
        rows = {row["name"]: row for row in csv.DictReader(file) if row["policy"] == policy}
    counted = {"nominal": [0, 0], "flown": [0, 0], "induced": [0, 0], "needless": [0, 0], "acted": 0}
    files = sorted(recordings.glob("*.daa"))
    for path in files:
        own, other = recording(path)
        *nominal, least = judge(own, other)
        track, acted = flown(runs / path.stem)
        *lost, kept = judge(track, other)
        row = rows.pop(path.stem)
        for name, value in zip(("nominal_nmac", "nominal_lowc", "nmac", "lowc"), (*nominal, *lost)):
            compare(f"{path.stem}: {name}", value, row[name] == "true")
        compare(f"{path.stem}: nominal_horizontal_m", least, float(row["nominal_horizontal_m"]), TOLERANCE_M)
        compare(f"{path.stem}: horizontal_m", kept, float(row["horizontal_m"]), TOLERANCE_M)
        counted["acted"] += acted
        for k in range(2):
            counted["nominal"][k] += nominal[k]
            counted["flown"][k] += lost[k]
            counted["induced"][k] += lost[k] and not nominal[k]
            counted["needless"][k] += acted and not nominal[k]
    compare("encounters", len(files), len(files) + len(rows))
    with open(campaign / "risk.csv", newline="") as file:
        risks = [row for row in csv.DictReader(file) if row["policy"] == policy and row["class"] == "all"]
    for k, loss in enumerate(("nmac", "lowc")):
        row = next(row for row in risks if row["loss"] == loss)
        compare(f"{loss}: encounters", len(files), int(row["encounters"]))
        compare(f"{loss}: acted", counted["acted"], int(row["acted"]))
        for name in ("nominal", "flown", "induced", "needless"):
            compare(f"{loss}: {name}", counted[name][k], int(row[name]))
        ratio = counted["flown"][k] / counted["nominal"][k]
        compare(f"{loss}: ratio", ratio, float(row["ratio"]), 1e-6)
        if counted["flown"][k] <= counted["nominal"][k]:
            interval = wilson(counted["flown"][k], counted["nominal"][k])
            for name, value in zip(("wilson_low", "wilson_high"), interval):
                compare(f"{loss}: {name}", value, float(row[name]), 1e-5)
    for difference in differences:
        print(difference)
    nominal, left = counted["nominal"], counted["flown"]
    print(f"{policy}: {len(files)} encounters, NMAC {left[0]}/{nominal[0]}, LoWC {left[1]}/{nominal[1]}", end="")
    print(f", acted in {counted['acted']}; {len(differences)} differences")
    return 1 if differences else 0


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3]), sys.argv[4]))
