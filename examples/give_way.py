#!/usr/bin/env python3
"""A policy of one's own over a pipe: turn right for what is close ahead, as the rules of the air say.

    fga run scenarios/first-flight.toml --policy "pipe:examples/give_way.py"

docs/own-policy.md describes the lines. It needs Python alone, and any language can do the same.
"""

import json
import math
import sys

LOOK_AHEAD_S = 12.0


def is_in_the_way(own, obstacle):
    """Whether an obstacle is ahead, near and closing."""
    course, climb, speed = own["course_rad"], own["climb_rad"], own["airspeed_mps"]
    flies = (speed * math.cos(climb) * math.cos(course), speed * math.cos(climb) * math.sin(course), speed * math.sin(climb))
    offset = [there - here for there, here in zip(obstacle["position_m"], own["position_m"])]
    ahead = sum(d * v for d, v in zip(offset, flies)) > 0.0
    closing = sum(d * (u - v) for d, u, v in zip(offset, obstacle["velocity_mps"], flies)) < 0.0
    return ahead and closing and math.dist((0.0, 0.0, 0.0), offset) < LOOK_AHEAD_S * speed


for line in sys.stdin:
    situation = json.loads(line)
    own = situation["ownship"]
    if any(is_in_the_way(own, obstacle) for obstacle in situation["obstacles"]):
        # A right turn decreases the course.
        command = {"course_rad": own["course_rad"] - math.radians(30.0), "climb_rad": 0.0}
    else:
        command = {}
    print(json.dumps(command), flush=True)
