"""Slider-crank with a cylinder as rod, q = [theta phi x rod]: the slider locked, the cylinder driven."""

NAME = "CrankSliderTelescopingRod"
N = 4
V = 5
RATES = []


def define(ca, q, v, t, der):
    theta, phi, x, rod = q[0], q[1], q[2], q[3]
    r, L, offset, reach, pace = (v[i] for i in range(V))
    rows = [
        r * ca.cos(theta) + rod * ca.cos(phi) - x,
        r * ca.sin(theta) + rod * ca.sin(phi) - offset,
        x - 0.18,
        rod - L - reach * ca.sin(pace * t),
    ]
    zero = ca.SX(0)
    pin = [r * ca.cos(theta), r * ca.sin(theta)]
    tube = [pin[0] + 0.6 * L * ca.cos(phi), pin[1] + 0.6 * L * ca.sin(phi)]
    piston = [x - 0.6 * L * ca.cos(phi), offset - 0.6 * L * ca.sin(phi)]
    return rows, [(e, 2) for e in [zero, zero, *pin, x, offset, *tube, *piston]]
