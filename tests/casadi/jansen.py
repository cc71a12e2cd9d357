"""Theo Jansen's leg: each joint by its distances to two others."""

NAME = "Jansen"
N = 11
V = 14
RATES = []


def define(ca, q, v, t, der):
    a, b, c, d, e, f, g, h, i, j, k, l, m, omega = (v[n] for n in range(V))
    top, knee, rear, heel, foot = ([q[n], q[n + 1]] for n in range(1, N, 2))
    crank, pivot = [m * ca.cos(q[0]), m * ca.sin(q[0])], [-a, -l]
    bars = [
        (top, crank, j),
        (top, pivot, b),
        (knee, crank, k),
        (knee, pivot, c),
        (rear, top, e),
        (rear, pivot, d),
        (heel, rear, f),
        (heel, knee, g),
        (foot, heel, h),
        (foot, knee, i),
    ]
    rows = [(p[0] - o[0]) ** 2 + (p[1] - o[1]) ** 2 - length**2 for p, o, length in bars]
    zero = ca.SX(0)
    points = [zero, zero, *pivot, *crank, *top, *knee, *rear, *heel, *foot]
    return [*rows, q[0] + omega * t], [(x, 2) for x in points]
