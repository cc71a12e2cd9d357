"""Peaucellier's linkage: two arms, a rhombus, a crank through the fixed joint's circle."""

NAME = "Peaucellier"
N = 7
V = 5
RATES = []


def define(ca, q, v, t, der):
    theta, xa, ya, xb, yb, xs, ys = (q[i] for i in range(N))
    k, L, c, swing, omega = (v[i] for i in range(V))
    xp, yp = k * (1 + ca.cos(theta)), k * ca.sin(theta)
    rows = [
        xa**2 + ya**2 - L**2,
        xb**2 + yb**2 - L**2,
        (xa - xp) ** 2 + (ya - yp) ** 2 - c**2,
        (xb - xp) ** 2 + (yb - yp) ** 2 - c**2,
        (xs - xa) ** 2 + (ys - ya) ** 2 - c**2,
        (xs - xb) ** 2 + (ys - yb) ** 2 - c**2,
        theta - swing * ca.sin(omega * t),
    ]
    zero = ca.SX(0)
    return rows, [(e, 2) for e in [zero, zero, k, zero, xp, yp, xa, ya, xb, yb, xs, ys]]
