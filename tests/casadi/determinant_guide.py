"""Lecture, joints: the prismatic joint as a determinant of three points, here on a turning guide."""

NAME = "DeterminantGuide"
N = 5
V = 5
RATES = []


def define(ca, q, v, t, der):
    theta, x, y, phi, psi = (q[i] for i in range(N))
    d, L, e, h, omega = (v[i] for i in range(V))

    def guide(along):
        return [along * ca.cos(theta) - e * ca.sin(theta), along * ca.sin(theta) + e * ca.cos(theta)]

    a, b = guide(0), guide(0.2)

    def determinant(c):
        rows = [[*a, 1], [*b, 1], [*c, 1]]
        return ca.det(ca.vertcat(*[ca.horzcat(*row) for row in rows]))

    rows = [
        determinant([x - h * ca.cos(phi), y - h * ca.sin(phi)]),
        determinant([x + h * ca.cos(phi), y + h * ca.sin(phi)]),
        x - d - L * ca.cos(psi),
        y - L * ca.sin(psi),
        theta - omega * t,
    ]
    zero = ca.SX(0)
    return rows, [(value, 2) for value in [zero, zero, d, zero, *a, *b, x, y]]
