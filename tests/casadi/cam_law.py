"""Disc cam with a flat follower and a law from outside, q = [theta x y]; for the law stands a sum of sines."""

NAME = "CamLaw"
N = 3
V = 2
RATES = []


def define(ca, q, v, t, der):
    theta, x, y = (q[i] for i in range(N))
    rb, omega = v[0], v[1]
    # The stand-in of the first function, and its derivatives by hand.
    a, b, c = theta + 0.3, 2 * theta + 1.1, 3 * theta + 1.9
    lift = 0.75 * ca.sin(a) - 0.5 * ca.sin(b) + 0.25 * ca.sin(c)
    slope = 0.75 * ca.cos(a) - ca.cos(b) + 0.75 * ca.cos(c)
    bend = -0.75 * ca.sin(a) + 2 * ca.sin(b) - 2.25 * ca.sin(c)
    rows = [x - slope, y - (rb + lift), theta - omega * t]
    zero = ca.SX(0)
    points = [zero, zero, x, y, -0.6 * rb, y, 0.6 * rb, y, zero, y + 1.6 * rb]
    return rows, [*((e, 2) for e in points), (rb + lift + bend, 1)]
