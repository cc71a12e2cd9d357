"""Planetary gear with a fixed ring, q = [theta_s theta_p theta_c theta_r]."""

from math import pi

NAME = "PlanetaryGear"
N = 4
V = 3
RATES = []


def define(ca, q, v, t, der):
    sun, planet, carrier, ring = (q[i] for i in range(N))
    rs, rp, omega = v[0], v[1], v[2]
    rr = rs + 2 * rp
    rows = [
        rs * (sun - carrier) + rp * (planet - carrier),
        rp * (planet - carrier) - rr * (ring - carrier),
        ring,
        sun - omega * t,
    ]

    def arm(length, angle):
        return [length * ca.cos(angle), length * ca.sin(angle)]

    zero = ca.SX(0)
    centres = [arm(rs + rp, carrier + k * 2 * pi / 3) for k in (0, 1, -1)]
    rim = arm(rp, planet)
    rims = [[c[0] + rim[0], c[1] + rim[1]] for c in centres]
    points = [[zero, zero], *centres, arm(rs, sun), arm(rr, ring), *rims]
    return rows, [(e, 2) for point in points for e in point]
