"""Lecture, dynamics, example: the four-bar with masses, q = [x2 y2 phi1 phi2 phi3]; x2 and y2 have none."""

import math

NAME = "FourBarMassDriven"
N = 5
V = 11
RATES = []
K = 0


def define(ca, q, v, t, der):
    x2, y2, phi1, phi2, phi3 = (q[i] for i in range(N))
    L1, L2, L3, L4, L5, alpha = (v[i] for i in range(6))
    phi = [
        x2 - L1 * ca.cos(phi1) - L5 * ca.cos(alpha + phi2),
        y2 - L1 * ca.sin(phi1) - L5 * ca.sin(alpha + phi2),
        -L1 * ca.cos(phi1) - L2 * ca.cos(phi2) + L3 * ca.cos(phi3) + L4,
        L1 * ca.sin(phi1) + L2 * ca.sin(phi2) - L3 * ca.sin(phi3),
        phi1 - math.pi / 3 - v[10] * t,
    ]
    zero = ca.SX(0)
    a = [L1 * ca.cos(phi1), L1 * ca.sin(phi1)]
    b = [a[0] + L2 * ca.cos(phi2), a[1] + L2 * ca.sin(phi2)]
    return phi, [(e, 2) for e in [zero, zero, *a, *b, L4, zero, x2, y2]]


def dynamics(ca, q, v, t, der, z, l):
    phi1, phi2, phi3 = q[2], q[3], q[4]
    L1, L2, L3, crank, coupler, rocker, g = v[0], v[1], v[2], v[6], v[7], v[8], v[9]
    middle = [L1 * ca.cos(phi1) + L2 / 2 * ca.cos(phi2), L1 * ca.sin(phi1) + L2 / 2 * ca.sin(phi2)]
    # Crank and rocker turn about their ends, the coupler moves with its middle and turns.
    kinetic = [
        crank * L1**2 / 6 * der(phi1) ** 2,
        coupler / 2 * (der(middle[0]) ** 2 + der(middle[1]) ** 2) + coupler * L2**2 / 24 * der(phi2) ** 2,
        rocker * L3**2 / 6 * der(phi3) ** 2,
    ]
    heights = [crank * L1 / 2 * ca.sin(phi1), coupler * middle[1], rocker * L3 / 2 * ca.sin(phi3)]
    zero = ca.SX(0)
    # Forces of pins at states that no motion has are a matter of least squares: `mbs verify` and the tests of the mechanism
    # compare them.
    ca.joints_resolved = zero
    loads = [*[zero] * 8, -l[4]]
    return dict(kinetic=kinetic, potential=[g * sum(heights)], forces=[], rates=[], loads=loads)
