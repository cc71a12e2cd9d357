"""The lecture's four-bar by x, y, phi of crank, coupler and rocker; each revolute joint two rows."""

NAME = "FourBarReferencePoint"
N = 9
V = 8
RATES = []


def define(ca, q, v, t, der):
    x1, y1, phi1, x2, y2, phi2, x3, y3, phi3 = (q[i] for i in range(N))
    L1, L2, L3, L4, L5, alpha, omega, _side = (v[i] for i in range(V))

    def point(x, y, phi, along):
        return [x + along * ca.cos(phi), y + along * ca.sin(phi)]

    a, a2 = point(x1, y1, phi1, L1 / 2), point(x2, y2, phi2, -L2 / 2)
    b, b3 = point(x2, y2, phi2, L2 / 2), point(x3, y3, phi3, L3 / 2)
    o, d = point(x1, y1, phi1, -L1 / 2), point(x3, y3, phi3, -L3 / 2)
    phi = [*o, a[0] - a2[0], a[1] - a2[1], b[0] - b3[0], b[1] - b3[1], d[0] - L4, d[1], phi1 - omega * t]
    zero = ca.SX(0)
    p = [a2[0] + L5 * ca.cos(phi2 + alpha), a2[1] + L5 * ca.sin(phi2 + alpha)]
    return phi, [(e, 2) for e in [zero, zero, *a, *b, L4, zero, *p]]
