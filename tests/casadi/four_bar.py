"""Lecture, kinematics, example: four-bar with coupler point, q = [x2 y2 phi1 phi2 phi3]."""

NAME = "FourBar"
N = 5
V = 8
RATES = []


def define(ca, q, v, t, der):
    x2, y2, phi1, phi2, phi3 = (q[i] for i in range(N))
    L1, L2, L3, L4, L5, alpha, omega, _side = (v[i] for i in range(V))
    phi = [
        x2 - L1 * ca.cos(phi1) - L5 * ca.cos(alpha + phi2),
        y2 - L1 * ca.sin(phi1) - L5 * ca.sin(alpha + phi2),
        -L1 * ca.cos(phi1) - L2 * ca.cos(phi2) + L3 * ca.cos(phi3) + L4,
        L1 * ca.sin(phi1) + L2 * ca.sin(phi2) - L3 * ca.sin(phi3),
        phi1 - omega * t,
    ]
    zero = ca.SX(0)
    a = [L1 * ca.cos(phi1), L1 * ca.sin(phi1)]
    b = [a[0] + L2 * ca.cos(phi2), a[1] + L2 * ca.sin(phi2)]
    points = [zero, zero, *a, *b, L4, zero, x2, y2]
    return phi, [(e, 2) for e in [*points, phi3 - phi2]]
