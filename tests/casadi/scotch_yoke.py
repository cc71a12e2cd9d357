"""Scotch yoke, q = [theta x y]: the yoke's place and the pin's height are those of the crank pin."""

NAME = "ScotchYoke"
N = 3
V = 3
RATES = []


def define(ca, q, v, t, der):
    theta, x, y = (q[i] for i in range(N))
    r, b, omega = (v[i] for i in range(V))
    pin = [r * ca.cos(theta), r * ca.sin(theta)]
    rows = [x - pin[0], y - pin[1], theta - omega * t]
    zero = ca.SX(0)
    points = [zero, zero, *pin, x, zero, x + b, zero, x - b, zero, x, 1.25 * r, x, -1.25 * r]
    return rows, [(e, 2) for e in points]
