"""Lecture, independent coordinates: open chain, theta1 theta2 theta3 with a time constraint each."""

NAME = "OpenChain"
N = 3
V = 6
RATES = []


def define(ca, q, v, t, der):
    theta1, theta2, theta3 = q[0], q[1], q[2]
    L1, L2, L3, omega, swing1, swing2 = (v[i] for i in range(V))
    phi = [
        theta1 - (0.9 + swing1 * ca.sin(omega * t)),
        theta2 - (swing2 * ca.cos(2 * omega * t) - 0.5),
        theta3 + omega * t,
    ]
    zero = ca.SX(0)
    a = [L1 * ca.cos(theta1), L1 * ca.sin(theta1)]
    b = [a[0] + L2 * ca.cos(theta1 + theta2), a[1] + L2 * ca.sin(theta1 + theta2)]
    end = [b[0] + L3 * ca.cos(theta1 + theta2 + theta3), b[1] + L3 * ca.sin(theta1 + theta2 + theta3)]
    speed = ca.sqrt(der(end[0]) ** 2 + der(end[1]) ** 2)
    return phi, [(e, 2) for e in [zero, zero, *a, *b, *end]] + [(speed, 1)]
