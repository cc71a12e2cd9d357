"""The flyball governor as a tree: a shaft that turns, a slider on it, and two rods on hinges, for `mbs cost governor --peers`."""

import math

SPACE = True

L, A, B, H = 1.0, 0.01, 0.1, 0.05


def tree(p, q, qd):
    rod, slider, ball = p["rho"] * L * A**2, p["rho"] * B**3, p["ball_mass"]
    thin, long, cube = rod * A**2 / 6, rod * (L**2 + A**2) / 12, slider * B**2 / 6
    # A rod with its ball: x along the rod, y its hinge.
    mass = rod + ball
    com = (rod * L / 2 + ball * L) / mass
    across = long + rod * (com - L / 2) ** 2 + ball * (L - com) ** 2

    def arm(side, r, r_d):
        below = math.asin((L - r[2]) / (L / 2))
        rate = -r_d[2] / (L / 2 * math.cos(below))
        value, rate = (below, rate) if side > 0 else (math.pi - below, -rate)
        return {
            "parent": 0, "at": (side * H, 0, L), "joint": "hinge", "axis": "y", "q": value, "v": rate,
            "mass": mass, "com": (com, 0, 0), "inertia": (thin, across, across),
        }

    bodies = [
        {
            "parent": None, "at": (0, 0, 0), "joint": "hinge", "axis": "z", "q": q[0], "v": qd[0],
            "mass": rod, "com": (0, 0, L / 2), "inertia": (long, long, thin),
        },
        {
            "parent": 0, "at": (0, 0, 0), "joint": "slide", "axis": "z", "q": q[1], "v": qd[1],
            "mass": slider, "com": (0, 0, 0), "inertia": (cube, cube, cube),
        },
        arm(1, q[2:5], qd[2:5]),
        arm(-1, q[5:8], qd[5:8]),
    ]
    springs = [(1, (side * H, 0, 0), body, (L / 2, 0, 0), p["k"], p["l0"], p["c"]) for side, body in ((1, 2), (-1, 3))]
    return {"gravity": (0, 0, -p["g"]), "bodies": bodies, "springs": springs}


def coordinates(p, place, joint):
    import numpy as np

    # Euler parameters: about z by the shaft, about y by the hinge; the second rod is turned about itself by half a turn.
    c, s = np.cos(joint(0) / 2), np.sin(joint(0) / 2)
    a, b = np.cos(joint(2) / 2), np.sin(joint(2) / 2)
    d, e = np.cos(joint(3) / 2), np.sin(joint(3) / 2)
    first = (c * a, -s * b, c * b, s * a)
    second = (-s * e, -c * d, -s * d, c * e)
    middle = (L / 2, 0, 0)
    return (joint(0), joint(1), *place(2, middle), *place(3, middle), *first, *second)
