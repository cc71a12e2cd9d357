"""The pendulum as a hinge with a point mass, for `mbs cost pendulum --peers`."""

import math


def tree(p, q, qd):
    length = p["L"]
    rate = (q[0] * qd[1] - q[1] * qd[0]) / length**2
    bob = {
        "parent": None, "at": (0, 0), "joint": "hinge", "q": math.atan2(q[1], q[0]), "v": rate,
        "mass": p["m"], "com": (length, 0), "inertia": 0.0,
    }
    return {"gravity": (0, -p["g"]), "bodies": [bob]}


def coordinates(p, place, angle):
    return place(0, (p["L"], 0))
