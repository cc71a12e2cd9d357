"""Offset slider-crank, q = [theta phi x]: the closure from the crank's centre to the slider."""

NAME = "SliderCrank"
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
    pin = [r * ca.cos(theta), r * ca.sin(theta)]
    middle = [pin[0] + L / 2 * ca.cos(phi), pin[1] + L / 2 * ca.sin(phi)]
    return rows, [(e, 2) for e in [zero, zero, *pin, x, offset, *middle]]
