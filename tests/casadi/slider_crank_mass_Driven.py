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


def least_squares(ca, columns, known):
    """Unknowns by orthogonal factors, and whether no column is nearly a sum of earlier ones."""
    matrix = ca.horzcat(*[ca.vertcat(*c) for c in columns])
    orthogonal, upper = ca.qr(matrix)
    resolved = ca.SX(1)
    for k in range(len(columns)):
        resolved = ca.logic_and(resolved, ca.fabs(upper[k, k]) >= ca.norm_2(matrix[:, k]) / 32)
    return ca.solve(upper, ca.mtimes(orthogonal.T, ca.vertcat(*known))), resolved


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

    # Newton's and Euler's sums of crank, rod and, along its guide, piston; moments over the longest length. At states that
    # no motion has they contradict each other: then their least squares count.
    def weighed(mass, point):
        return [mass * der(der(point[0])), mass * (der(der(point[1])) + g)]

    length = ca.SX(0)
    for known in [r, L, v[2]]:
        length = ca.fmax(length, ca.fabs(known))
    on_crank, on_rod = weighed(crank, [pin[0] / 2, pin[1] / 2]), weighed(rod, middle)
    crank_moment = crank * r**2 / 12 * der(der(theta)) + l[2]
    rod_moment = rod * L**2 / 12 * der(der(phi))
    known = [*on_crank, crank_moment / length, *on_rod, rod_moment / length, piston * der(der(x))]
    # Half of the crank, the rod from its middle to either pin.
    a, b = [pin[0] / 2, pin[1] / 2], [pin[k] - middle[k] for k in range(2)]
    c = [slider[k] - middle[k] for k in range(2)]
    columns = [
        [1, 0, a[1] / length, 0, 0, 0, 0],
        [0, 1, -a[0] / length, 0, 0, 0, 0],
        [-1, 0, a[1] / length, 1, 0, -b[1] / length, 0],
        [0, -1, -a[0] / length, 0, 1, b[0] / length, 0],
        [0, 0, 0, 1, 0, -c[1] / length, -1],
        [0, 0, 0, 0, 1, c[0] / length, 0],
    ]
    found, ca.joints_resolved = least_squares(ca, columns, known)
    loads = [*[found[k] for k in range(6)], -l[2]]
    return dict(kinetic=kinetic, potential=potential, forces=[], rates=[], loads=loads)
