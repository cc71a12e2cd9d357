"""Lecture, dependent coordinates: one loop, q_i = [theta2 theta3 theta4], q_d = [theta5 theta6]."""

from math import pi

NAME = "FiveAngleLoop"
N = 5
V = 8
RATES = []


def define(ca, q, v, t, der):
    L1, L2, L3, L4, L5, L6, omega, _side = (v[i] for i in range(V))
    lengths = [L2, L3, L4, L5, L6]
    phi = [
        sum(length * ca.cos(q[i]) for i, length in enumerate(lengths)) - L1,
        sum(length * ca.sin(q[i]) for i, length in enumerate(lengths)),
        q[0] - omega * t,
        q[1] - (7 * pi / 18 + 0.25 * ca.sin(omega * t)),
        q[2] - (pi / 18 - 0.3 * ca.cos(2 * omega * t)),
    ]
    zero = ca.SX(0)
    points = [zero, zero]
    for i, length in enumerate(lengths[:4]):
        points += [points[-2] + length * ca.cos(q[i]), points[-1] + length * ca.sin(q[i])]
    return phi, [(e, 2) for e in [*points, L1, zero]]
