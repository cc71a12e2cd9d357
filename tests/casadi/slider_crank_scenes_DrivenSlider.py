"""Slider-crank, slider driven, q = [theta phi x]: the closure from the crank's centre to the slider."""

NAME = "CrankSliderDrivenSlider"
N = 3
V = 5
RATES = []


def define(ca, q, v, t, der):
    theta, phi, x = q[0], q[1], q[2]
    r, L, offset, stroke, pace = (v[i] for i in range(V))
    rows = [
        r * ca.cos(theta) + L * ca.cos(phi) - x,
        r * ca.sin(theta) + L * ca.sin(phi) - offset,
        x - 0.18 - stroke * ca.sin(pace * t),
    ]
    zero = ca.SX(0)
    return rows, [(e, 2) for e in [zero, zero, r * ca.cos(theta), r * ca.sin(theta), x, offset]]
