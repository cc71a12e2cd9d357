"""Lecture, coordinates and constraints: closed loop in relative coordinates psi1 psi2 psi3, time constraint first."""

NAME = "LoopRelative"
N = 3
V = 6
RATES = []


def define(ca, q, v, t, der):
    psi1, psi2, psi3 = q[0], q[1], q[2]
    L1, L2, L3, OD, omega, _side = (v[i] for i in range(V))
    angles = [psi1, psi1 + psi2, psi1 + psi2 + psi3]
    phi = [
        psi1 - omega * t,
        L1 * ca.cos(angles[0]) + L2 * ca.cos(angles[1]) + L3 * ca.cos(angles[2]) - OD,
        L1 * ca.sin(angles[0]) + L2 * ca.sin(angles[1]) + L3 * ca.sin(angles[2]),
    ]
    zero = ca.SX(0)
    a = [L1 * ca.cos(psi1), L1 * ca.sin(psi1)]
    b = [a[0] + L2 * ca.cos(psi1 + psi2), a[1] + L2 * ca.sin(psi1 + psi2)]
    middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]
    return phi, [(e, 2) for e in [zero, zero, *a, *b, OD, zero, *middle]]
