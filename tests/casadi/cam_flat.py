"""Disc cam with a flat follower: contact of the profile and tangent in the face, q = [theta c x y]."""

NAME = "CamFlat"
N = 4
V = 3
RATES = []


def define(ca, q, v, t, der):
    theta, c, x, y = (q[i] for i in range(N))
    rb, h, omega = v[0], v[1], v[2]
    # ((1 - cos c)/2)^2 as a Fourier sum, and its derivatives
    lift = h * (3 - 4 * ca.cos(c) + ca.cos(2 * c)) / 8
    lift_d = h * (2 * ca.sin(c) - ca.sin(2 * c)) / 4
    lift_dd = h * (ca.cos(c) - ca.cos(2 * c)) / 2
    cs, sn = ca.cos(theta - c), ca.sin(theta - c)
    radius = rb + lift + lift_dd
    rows = [
        x - cs * lift_d + sn * (rb + lift),
        y - sn * lift_d - cs * (rb + lift),
        radius * sn,
        theta - omega * t,
    ]
    zero = ca.SX(0)
    points = [zero, zero, x, y, -0.6 * rb, y, 0.6 * rb, y, zero, y + 1.6 * rb]
    return rows, [(e, 2) for e in [*points, radius]]
