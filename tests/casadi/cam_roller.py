"""Disc cam with an offset roller follower: the roller's centre on the pitch curve, q = [theta c y]."""

NAME = "CamRoller"
N = 3
V = 5
RATES = []


def define(ca, q, v, t, der):
    theta, c, y = q[0], q[1], q[2]
    rb, rr, e, h, omega = (v[i] for i in range(V))
    # ((1 - cos c)/2)^3 as a Fourier sum, and its derivative
    lift = h * (10 - 15 * ca.cos(c) + 6 * ca.cos(2 * c) - ca.cos(3 * c)) / 32
    slope = h * (15 * ca.sin(c) - 12 * ca.sin(2 * c) + 3 * ca.sin(3 * c)) / 32
    height = ca.sqrt((rb + rr) ** 2 - e**2) + lift
    cs, sn = ca.cos(theta - c), ca.sin(theta - c)
    rows = [e - cs * e + sn * height, y - sn * e - cs * height, theta - omega * t]
    n = [cs * (e - slope) - sn * height, sn * (e - slope) + cs * height]
    length = ca.sqrt(n[0] ** 2 + n[1] ** 2)
    zero = ca.SX(0)
    points = [zero, zero, e, y, e - rr * n[0] / length, y - rr * n[1] / length, e, y + 1.6 * rb]
    return rows, [(x, 2) for x in [*points, ca.atan2(slope - e, height)]]
