"""The lecture's four-bar by Cartesian points: constant distances squared, coupler point by linear combination."""

NAME = "FourBarNatural"
N = 6
V = 8
RATES = []


def define(ca, q, v, t, der):
    xa, ya, xb, yb, xp, yp = (q[i] for i in range(N))
    L1, L2, L3, L4, L5, alpha, omega, _side = (v[i] for i in range(V))
    c, s = L5 / L2 * ca.cos(alpha), L5 / L2 * ca.sin(alpha)
    phi = [
        xa**2 + ya**2 - L1**2,
        (xb - xa) ** 2 + (yb - ya) ** 2 - L2**2,
        (xb - L4) ** 2 + yb**2 - L3**2,
        xp - xa - c * (xb - xa) + s * (yb - ya),
        yp - ya - c * (yb - ya) - s * (xb - xa),
        ca.cos(omega * t) * ya - ca.sin(omega * t) * xa,
    ]
    zero = ca.SX(0)
    return phi, [(e, 2) for e in [zero, zero, xa, ya, xb, yb, L4, zero, xp, yp]]
