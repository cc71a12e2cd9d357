"""Lecture, coordinates and constraints: the loop whose psi3 is a length; L3 stands at -pi/2 to the guide."""

NAME = "LoopLength"
N = 3
V = 4
RATES = []


def define(ca, q, v, t, der):
    psi1, psi2, psi3 = q[0], q[1], q[2]
    L1, L3, OD, omega = (v[i] for i in range(V))
    guide = psi1 + psi2
    # cos(g - pi/2) = sin(g), sin(g - pi/2) = -cos(g)
    phi = [
        psi1 - omega * t,
        L1 * ca.cos(psi1) + psi3 * ca.cos(guide) + L3 * ca.sin(guide) - OD,
        L1 * ca.sin(psi1) + psi3 * ca.sin(guide) - L3 * ca.cos(guide),
    ]
    zero = ca.SX(0)
    a = [L1 * ca.cos(psi1), L1 * ca.sin(psi1)]
    b = [a[0] + psi3 * ca.cos(guide), a[1] + psi3 * ca.sin(guide)]
    end = [a[0] + 0.18 * ca.cos(guide), a[1] + 0.18 * ca.sin(guide)]
    return phi, [(e, 2) for e in [zero, zero, *a, *b, OD, zero, *end, guide]]
