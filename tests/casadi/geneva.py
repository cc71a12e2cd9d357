"""Geneva drive, four slots: the pin in the slot between -45 and 45 degrees, locked outside."""

from math import pi, sqrt

NAME = "Geneva"
N = 3
V = 2
RATES = []


def define(ca, q, v, t, der):
    theta, phi, s = q[0], q[1], q[2]
    d, omega = v[0], v[1]
    r = d / sqrt(2)
    engaged = ca.if_else(theta < -pi / 4, -pi / 4, ca.if_else(theta > pi / 4, pi / 4, theta))
    rows = [
        r * ca.cos(engaged) - d + s * ca.cos(phi),
        r * ca.sin(engaged) + s * ca.sin(phi),
        theta - omega * t + pi,
    ]
    zero = ca.SX(0)
    points = [zero, zero, r * ca.cos(theta), r * ca.sin(theta), d, zero, d - r * ca.cos(phi), -r * ca.sin(phi)]
    return rows, [(e, 2) for e in points]
