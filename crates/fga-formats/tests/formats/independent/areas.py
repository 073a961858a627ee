"""Writes files of areas into a folder, and prints places beside their edges with whether they are inside, by GEOS on edges of PROJ."""
import json
import os
import sys

import numpy as np
from pyproj import Geod
from shapely.geometry import Point, Polygon

folder = sys.argv[1]
geod = Geod(ellps="WGS84")
random = np.random.default_rng(5)
hole = [[8.2, 47.2], [8.4, 47.2], [8.3, 47.3], [8.2, 47.2]]
rings = {
    "square": [[[8.0, 47.0], [8.6, 47.0], [8.6, 47.4], [8.0, 47.4], [8.0, 47.0]], hole],
    "long": [[[5.0, 45.0], [7.6, 45.0], [6.0, 46.2], [5.0, 45.0]]],
    "north": [[[20.0, 69.0], [24.0, 69.5], [21.0, 70.2], [20.0, 69.0]]],
    "south": [[[-70.0, -34.0], [-68.0, -34.5], [-69.0, -33.0], [-70.0, -34.0]]],
}


def dense(ring, geodesic):
    """The ring with a corner each hundred metres."""
    all = []
    for (x, y), (x2, y2) in zip(ring, ring[1:]):
        steps = int(geod.inv(x, y, x2, y2)[2] / 100) + 1
        straight = [(x + (x2 - x) * k / steps, y + (y2 - y) * k / steps) for k in range(steps)]
        all += [(x, y)] + geod.npts(x, y, x2, y2, steps) if geodesic else straight
    return all + all[:1]


def show(name, geodesic):
    for index, outline in enumerate(rings.values()):
        lines = [dense(ring, geodesic) for ring in outline]
        polygon = Polygon(lines[0], lines[1:])
        for line in lines:
            for at in random.integers(0, len(line) - 1, 8):
                (x, y), (x2, y2) = line[at : at + 2]
                along, _, _ = geod.inv(x, y, x2, y2)
                for side, off in [(90, 2.5), (-90, 2.5), (90, 900.0), (-90, 900.0)]:
                    px, py, _ = geod.fwd((x + x2) / 2, (y + y2) / 2, along + side, off)
                    print(f"{name}:{index}", repr(float(py)), repr(float(px)), int(polygon.contains(Point(px, py))))


def write(name, text, geodesic):
    with open(os.path.join(folder, name), "w") as file:
        file.write(text)
    show(name, geodesic)


feature = lambda ring: dict(type="Feature", properties={}, geometry=dict(type="Polygon", coordinates=ring))
write("a.geojson", json.dumps(dict(type="FeatureCollection", features=[feature(ring) for ring in rings.values()])), False)
volume = lambda ring: dict(uomDimensions="M", horizontalProjection=dict(type="Polygon", coordinates=ring))
write("a.json", json.dumps(dict(features=[dict(identifier="A", geometry=[volume(ring)]) for ring in rings.values()])), True)
text = lambda ring: " ".join(f"{x},{y}" for x, y in ring)
boundary = lambda ring, of: f"<{of}BoundaryIs><LinearRing><coordinates>{text(ring)}</coordinates></LinearRing></{of}BoundaryIs>"
polygon = lambda ring: "".join([boundary(ring[0], "outer")] + [boundary(inner, "inner") for inner in ring[1:]])
places = "".join(f"<Placemark><Polygon>{polygon(ring)}</Polygon></Placemark>" for ring in rings.values())
write("a.kml", f"<kml><Document>{places}</Document></kml>", True)
