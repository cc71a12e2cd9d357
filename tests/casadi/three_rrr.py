"""Planar 3-RRR platform, q = [x y phi theta0..2 psi0..2]."""

from math import pi

NAME = "ThreeRrr"
N = 9
V = 7
RATES = []


def define(ca, q, v, t, der):
    R, rp, l1, l2, home, swing, omega = (v[i] for i in range(V))
    x, y, phi = q[0], q[1], q[2]
    legs, motors, fixed, elbows, corners = [], [], [], [], []
    for i in range(3):
        base = pi / 2 + 2 * pi / 3 * i
        theta, psi = q[3 + i], q[6 + i]
        o = [R * ca.cos(base), R * ca.sin(base)]
        b = [o[0] + l1 * ca.cos(theta), o[1] + l1 * ca.sin(theta)]
        c = [x + rp * ca.cos(phi + base), y + rp * ca.sin(phi + base)]
        legs += [b[0] + l2 * ca.cos(psi) - c[0], b[1] + l2 * ca.sin(psi) - c[1]]
        motors.append(theta - base - home - swing * ca.sin(omega * t + 2 * pi / 3 * i))
        fixed += o
        elbows += b
        corners += c
    return [*legs, *motors], [(e, 2) for e in [*fixed, *elbows, *corners, x, y]]
