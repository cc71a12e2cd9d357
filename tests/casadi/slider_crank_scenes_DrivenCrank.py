"""Slider-crank, crank driven, q = [theta phi x]: the closure from the crank's centre to the slider."""

NAME = "CrankSliderDrivenCrank"
N = 3
V = 4
RATES = []


def define(ca, q, v, t, der):
    theta, phi, x = q[0], q[1], q[2]
    r, L, offset, omega = (v[i] for i in range(V))
    rows = [
        r * ca.cos(theta) + L * ca.cos(phi) - x,
        r * ca.sin(theta) + L * ca.sin(phi) - offset,
        theta - omega * t,
    ]
    zero = ca.SX(0)
    return rows, [(e, 2) for e in [zero, zero, r * ca.cos(theta), r * ca.sin(theta), x, offset]]
