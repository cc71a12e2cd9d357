"""Disc cam with an oscillating roller follower: the arm's end on the pitch curve, q = [theta c psi]."""

NAME = "CamOscillating"
N = 3
V = 6
RATES = []


def define(ca, q, v, t, der):
    theta, c, psi = q[0], q[1], q[2]
    d, l, rr, psi0, swing, omega = (v[i] for i in range(V))
    # ((1 - cos c)/2)^2 as a Fourier sum
    law = psi0 + swing * (3 - 4 * ca.cos(c) + ca.cos(2 * c)) / 8
    cs, sn = ca.cos(theta - c), ca.sin(theta - c)
    pitch = [d - l * ca.cos(law), l * ca.sin(law)]
    turned = [cs * pitch[0] - sn * pitch[1], sn * pitch[0] + cs * pitch[1]]
    centre = [d - l * ca.cos(psi), l * ca.sin(psi)]
    rows = [centre[0] - turned[0], centre[1] - turned[1], theta - omega * t]
    # The normal is a quarter turn to the left of the pitch curve's derivative along c.
    tangent = [ca.jacobian(turned[0], c), ca.jacobian(turned[1], c)]
    length = ca.sqrt(tangent[0] ** 2 + tangent[1] ** 2)
    zero = ca.SX(0)
    contact = [centre[0] + rr * tangent[1] / length, centre[1] - rr * tangent[0] / length]
    return rows, [(e, 2) for e in [zero, zero, d, zero, *centre, *contact]]
