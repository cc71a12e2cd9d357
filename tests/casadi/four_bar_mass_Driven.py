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


def least_squares(ca, columns, known):
    """Unknowns by orthogonal factors, and whether no column is nearly a sum of earlier ones."""
    matrix = ca.horzcat(*[ca.vertcat(*c) for c in columns])
    orthogonal, upper = ca.qr(matrix)
    resolved = ca.SX(1)
    for k in range(len(columns)):
        resolved = ca.logic_and(resolved, ca.fabs(upper[k, k]) >= ca.norm_2(matrix[:, k]) / 32)
    return ca.solve(upper, ca.mtimes(orthogonal.T, ca.vertcat(*known))), resolved


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

    # Newton's and Euler's sums of crank, coupler and rocker, moments over the longest length. At states that no motion has
    # they contradict each other: then their least squares count.
    def weighed(mass, point):
        return [mass * der(der(point[0])), mass * (der(der(point[1])) + g)]

    def half(length, angle):
        return [length / 2 * ca.cos(angle), length / 2 * ca.sin(angle)]

    length = ca.SX(0)
    for known in [v[k] for k in range(5)]:
        length = ca.fmax(length, ca.fabs(known))
    a, b, c = half(L1, phi1), half(L2, phi2), half(L3, phi3)
    centre = [v[3] + c[0], c[1]]
    known = [*weighed(crank, a), (crank * L1**2 / 12 * der(der(phi1)) + l[4]) / length]
    known += [*weighed(coupler, middle), coupler * L2**2 / 12 * der(der(phi2)) / length]
    known += [*weighed(rocker, centre), rocker * L3**2 / 12 * der(der(phi3)) / length]
    # The elbow is the coupler's end; away from an assembly it is not the rocker's.
    elbow = [middle[k] + b[k] - centre[k] for k in range(2)]
    # On which body a pin's force acts and with which arm, and on which it acts back.
    pins = [
        (0, [-a[0], -a[1]], None, None),
        (1, [-b[0], -b[1]], 0, a),
        (2, elbow, 1, b),
        (2, [-c[0], -c[1]], None, None),
    ]
    columns = []
    for on, at, back, there in pins:
        for force in ([1, 0], [0, 1]):
            column = [ca.SX(0)] * 9
            for body, arm, sign in ((on, at, 1), (back, there, -1)):
                if body is not None:
                    moment = arm[0] * force[1] - arm[1] * force[0]
                    column[3 * body : 3 * body + 3] = [sign * force[0], sign * force[1], sign * moment / length]
            columns.append(column)
    found, ca.joints_resolved = least_squares(ca, columns, known)
    loads = [*[found[k] for k in range(8)], -l[4]]
    return dict(kinetic=kinetic, potential=[g * sum(heights)], forces=[], rates=[], loads=loads)
