"""Andrews' squeezer: crank and rod, a triangle, and two guides with a rod each; three loops close at the hub, for `mbs cost andrews --peers`."""

D, DA, E, EA, RR, RA, SS = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092, 0.035
SA, SB, SC, SD, TA, TB = 0.01874, 0.01043, 0.018, 0.02, 0.02308, 0.00916
U, UA, UB, ZF, ZT, FA = 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421


def tree(p, q, qd):
    vector = lambda name: tuple(p[f"{name}.{k}"] for k in (0, 1))
    a, b, c = vector("A"), vector("B"), vector("C")
    mass, inertia = ([p[f"{name}.{k}"] for k in range(7)] for name in ("m", "I"))

    def body(k, parent, at, joint, com):
        return {
            "parent": parent, "at": at, "joint": "hinge", "q": q[joint], "v": qd[joint],
            "mass": mass[k], "com": com, "inertia": inertia[k],
        }

    # Across a direction, clockwise, is -y of a body's frame.
    bodies = [
        body(0, None, (0, 0), 0, (RA, 0)),
        body(1, 0, (RR, 0), 1, (-DA, 0)),
        body(2, None, b, 2, (SB, -SA)),
        body(4, None, a, 4, (TA, TB)),
        body(3, 3, (ZT, 0), 3, (0, -(E - EA))),
        body(6, None, a, 6, (UB, -UA)),
        body(5, 5, (0, -U), 5, (ZF - FA, 0)),
    ]
    loops = [(2, (0, -SS), 1, (-D, 0)), (4, (0, -E), 1, (-D, 0)), (6, (ZF, 0), 1, (-D, 0))]
    springs = [(None, c, 2, (SD, -SC), p["c0"], p["l0"])]
    return {"gravity": (0, 0), "bodies": bodies, "loops": loops, "springs": springs, "torques": [(0, p["mom"])]}


def coordinates(p, place, angle):
    beta, gamma, delta, epsilon = angle(0), angle(2), angle(3), angle(5)
    return beta, angle(1) - beta, gamma, angle(4) - delta, delta, angle(6) - epsilon, epsilon
