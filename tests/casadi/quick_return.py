"""Whitworth's quick return, q = [theta phi s beta x]: slot of the lever, rod to the ram."""

NAME = "QuickReturn"
N = 5
V = 5
RATES = []


def define(ca, q, v, t, der):
    theta, phi, s, beta, x = (q[i] for i in range(N))
    r, d, l, L, omega = (v[i] for i in range(V))
    c, sn = ca.cos(phi), ca.sin(phi)
    rows = [
        r * ca.cos(theta) - s * c,
        r * ca.sin(theta) + d - s * sn,
        L * ca.cos(beta) - l * c - x,
        L * ca.sin(beta) - l * sn,
        theta - omega * t,
    ]
    zero = ca.SX(0)

    def lever(along):
        return [along * c, along * sn - d]

    points = [zero, zero, r * ca.cos(theta), r * ca.sin(theta), zero, -d, *lever(-l), x, -d]
    return rows, [(e, 2) for e in [*points, *lever(0.3 * (r - d)), *lever(1.15 * (r + d))]]
