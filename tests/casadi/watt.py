"""Watt's six-bar, q = [theta2 theta3 theta4 theta5 theta6]: two loops over the ternary rocker."""

NAME = "Watt"
N = 5
V = 10
RATES = []


def define(ca, q, v, t, der):
    L2, L3, L4, Lc, L5, L6, d, f, delta, omega = (v[i] for i in range(V))

    def arm(length, angle):
        return [length * ca.cos(angle), length * ca.sin(angle)]

    a, ab, db = arm(L2, q[0]), arm(L3, q[1]), arm(L4, q[2])
    dc, ce, fe = arm(Lc, q[2] - delta), arm(L5, q[3]), arm(L6, q[4])
    rows = [
        a[0] + ab[0] - d - db[0],
        a[1] + ab[1] - db[1],
        d + dc[0] + ce[0] - f - fe[0],
        dc[1] + ce[1] - fe[1],
        q[0] - omega * t,
    ]
    zero = ca.SX(0)
    points = [zero, zero, *a, d + db[0], db[1], d + dc[0], dc[1], d, zero, f + fe[0], fe[1], f, zero]
    return rows, [(e, 2) for e in [*points, d + dc[0] + ce[0] / 2, dc[1] + ce[1] / 2]]
