"""Stephenson's six-bar with the crank on the coupler point, q = [theta alpha beta gamma delta]."""

NAME = "Stephenson"
N = 5
V = 11
RATES = []


def define(ca, q, v, t, der):
    theta, alpha, beta, gamma, delta = (q[i] for i in range(N))
    d, La, Lb, Ld, m, n, fx, fy, r, l, omega = (v[i] for i in range(V))
    c, s = ca.cos(beta), ca.sin(beta)
    a = [La * ca.cos(alpha), La * ca.sin(alpha)]
    b = [d + Ld * ca.cos(gamma), Ld * ca.sin(gamma)]
    p = [a[0] + m * c + n * s, a[1] + m * s - n * c]
    e = [fx + r * ca.cos(theta), fy + r * ca.sin(theta)]
    rows = [
        a[0] + Lb * c - b[0],
        a[1] + Lb * s - b[1],
        e[0] + l * ca.cos(delta) - p[0],
        e[1] + l * ca.sin(delta) - p[1],
        theta - omega * t,
    ]
    zero = ca.SX(0)
    return rows, [(x, 2) for x in [zero, zero, *a, *b, d, zero, *e, fx, fy, *p]]
