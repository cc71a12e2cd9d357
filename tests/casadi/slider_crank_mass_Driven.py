"""Offset slider-crank with masses, the crank driven, q = [theta phi x]."""

import math

NAME = "CrankPistonDriven"
N = 3
V = 8
RATES = []
K = 0


def points(ca, q, v):
    theta, phi, x = q[0], q[1], q[2]
    r, L, offset = v[0], v[1], v[2]
    pin = [r * ca.cos(theta), r * ca.sin(theta)]
    middle = [pin[0] + L / 2 * ca.cos(phi), pin[1] + L / 2 * ca.sin(phi)]
    return pin, middle, [x, offset]


def define(ca, q, v, t, der):
    theta, phi, x = q[0], q[1], q[2]
    r, L, offset, omega = v[0], v[1], v[2], v[7]
    rows = [
        r * ca.cos(theta) + L * ca.cos(phi) - x,
        r * ca.sin(theta) + L * ca.sin(phi) - offset,
        theta - math.pi / 3 - omega * t,
    ]
    pin, middle, slider = points(ca, q, v)
    zero = ca.SX(0)
    return rows, [(e, 2) for e in [zero, zero, *pin, *slider, *middle]]


def dynamics(ca, q, v, t, der, z, l):
    theta, phi, x = q[0], q[1], q[2]
    r, L, _offset, crank, rod, piston, g = (v[i] for i in range(7))
    pin, middle, slider = points(ca, q, v)
    # A uniform crank about its end; a uniform rod by its middle and its turning.
    kinetic = [
        crank * r**2 / 6 * der(theta) ** 2,
        rod / 2 * (der(middle[0]) ** 2 + der(middle[1]) ** 2) + rod * L**2 / 24 * der(phi) ** 2,
        piston / 2 * der(x) ** 2,
    ]
    potential = [g * (crank * pin[1] / 2 + rod * middle[1] + piston * slider[1])]
    zero = ca.SX(0)
    # Forces of pins at states that no motion has are a matter of least squares: `mbs verify` and the tests of the mechanism
    # compare them.
    ca.joints_resolved = zero
    return dict(kinetic=kinetic, potential=potential, forces=[], rates=[], loads=[*[zero] * 6, -l[2]])
