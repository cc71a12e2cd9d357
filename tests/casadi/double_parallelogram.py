"""Plate on three parallel cranks, q = [alpha beta gamma psi]; five rows, one of them redundant."""

NAME = "DoubleParallelogram"
N = 4
M = 5
V = 6
RATES = []


def define(ca, q, v, t, der):
    alpha, beta, gamma, psi = (q[i] for i in range(N))
    length, d, e, h, error, omega = (v[i] for i in range(V))

    def arm(radius, angle):
        return [radius * ca.cos(angle), radius * ca.sin(angle)]

    zero = ca.SX(0)
    a, b, c = arm(length, alpha), arm(length + error, beta), arm(length, gamma)
    b[0] += d
    c = [c[0] + e, c[1] + h]
    corner = [e * ca.cos(psi) - h * ca.sin(psi), e * ca.sin(psi) + h * ca.cos(psi)]
    rows = [
        a[0] + d * ca.cos(psi) - b[0],
        a[1] + d * ca.sin(psi) - b[1],
        a[0] + corner[0] - c[0],
        a[1] + corner[1] - c[1],
        alpha - omega * t - 0.5,
    ]
    points = [[zero, zero], [d, zero], [e, h], a, b, c]
    return rows, [(entry, 2) for point in points for entry in point]
