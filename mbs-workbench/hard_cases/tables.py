"""Tables of the cases whose motion is known at some instants: closed forms piece by piece in 40 digits, two solutions by SciPy.

`pip install scipy mpmath`, then `python tables.py` writes the tables beside it. None of it shares code with the library.
"""

from pathlib import Path

import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import cho_factor, cho_solve, solve_banded

mp.mp.dps = 40
HERE = Path(__file__).parent


def written(name, columns, rows):
    lines = [",".join(["t", *columns])]
    lines += [",".join(repr(float(value)) for value in row) for row in rows]
    (HERE / name).write_text("\n".join(lines) + "\n")


def chattering_valve():
    """Disk of 1 kg on a seat with e = 0.3: a spring, and a pressure that rises while the valve is shut."""
    m, k, preload, slope, e = mp.mpf(1), mp.mpf(2000), mp.mpf(100), mp.mpf(2500), mp.mpf("0.3")
    low, high, end = mp.mpf("2e-3"), mp.mpf("1e-2"), mp.mpf(5)
    w = mp.sqrt(k / m)
    pieces = []  # begin, function of the time
    counts = {"impacts": 0, "lifts": 0}

    def flight(t0, x0, v0, since):
        """Place and velocity from (t0, x0, v0) on; the pressure is off where `since` is none."""
        rate = slope if since is not None else mp.mpf(0)
        middle = lambda t: (rate * (t - since) - preload) / k if since is not None else -preload / k
        a, b = x0 - middle(t0), (v0 - rate / k) / w
        place = lambda t: middle(t) + a * mp.cos(w * (t - t0)) + b * mp.sin(w * (t - t0))
        speed = lambda t: rate / k - a * w * mp.sin(w * (t - t0)) + b * w * mp.cos(w * (t - t0))
        return place, speed

    def crossing(place, t0, step, level, sign):
        """First time behind t0 at which sign·(place − level) rises through 0; `step` is shorter than the way there and back."""
        a = t0 + step
        while True:
            b = a + step
            if sign * (place(b) - level) > 0:
                break
            if b > end + mp.mpf("0.1"):
                return end + 1
            a = b
        for _ in range(130):
            c = (a + b) / 2
            if sign * (place(c) - level) > 0:
                b = c
            else:
                a = c
        return b

    t, since = mp.mpf(0), mp.mpf(0)
    while t < end:
        # At rest on the seat until the pressure lifts it.
        pieces.append((t, lambda t: mp.mpf(0)))
        assert t < since + preload / slope
        t = since + preload / slope
        counts["lifts"] += 1
        place, speed = flight(t, mp.mpf(0), mp.mpf(0), since)
        pieces.append((t, place))
        t = crossing(place, t, mp.mpf("1e-5"), high, 1)
        # Open: the pressure is gone.
        place, speed = flight(t, high, speed(t), None)
        pieces.append((t, place))
        t = crossing(place, t, mp.mpf("1e-5"), low, -1)
        since = t
        place, speed = flight(t, low, speed(t), since)
        pieces.append((t, place))
        t = crossing(place, t, mp.mpf("1e-6"), mp.mpf(0), -1)
        v = -e * speed(t)
        while v > mp.mpf("1e-20"):
            counts["impacts"] += 1
            place, speed = flight(t, mp.mpf(0), v, since)
            pieces.append((t, place))
            t = crossing(place, t, v / 1000, mp.mpf(0), -1)
            v = -e * speed(t)

    def at(t):
        return next(place for begin, place in reversed(pieces) if begin <= t)(t)

    rows = [(t, at(t)) for t in (end * j / 64 for j in range(65))]
    written("chattering_valve.csv", ["x"], rows)
    return counts, rows[-1]


def flying_through():
    """Place of a cart of 2 m/s that is pushed with 20 m/s² in each of eight places of 10 mm."""
    push, wide, first, apart = mp.mpf(20), mp.mpf("0.01"), mp.mpf("0.13"), mp.mpf("0.31")
    pieces, t, x, v = [], mp.mpf(0), mp.mpf(0), mp.mpf(2)
    for i in range(8):
        pieces.append((t, x, v, mp.mpf(0)))
        begin = first + i * apart
        t, x = t + (begin - x) / v, begin
        pieces.append((t, x, v, push))
        faster = mp.sqrt(v**2 + 2 * push * wide)
        t, x, v = t + (faster - v) / push, begin + wide, faster
    pieces.append((t, x, v, mp.mpf(0)))

    def at(time):
        t, x, v, a = next(piece for piece in reversed(pieces) if piece[0] <= time)
        return x + v * (time - t) + a * (time - t) ** 2 / 2

    rows = [(t, at(t)) for t in (mp.mpf(j) / 64 for j in range(65))]
    written("flying_through.csv", ["x"], rows)
    return pieces[-1][0], rows[-1]


G, LINKS, LENGTH = 9.81, 200, 1.0
LINK = LENGTH / LINKS
CHAIN_ENDS = 2.5


def by_tensions(t, y):
    """Newton's equations of the points along each link: tensions solve a tridiagonal system. Angles from the vertical downwards."""
    a, w = y[:LINKS], y[LINKS:]
    c, s = np.cos(a), np.sin(a)
    dot = c[1:] * c[:-1] + s[1:] * s[:-1]
    bands = np.zeros((3, LINKS))
    bands[1] = -2.0
    bands[1, 0] = -1.0
    bands[0, 1:], bands[2, :-1] = dot, dot
    rest = -LINK * w * w
    rest[0] -= G * c[0]
    tension = solve_banded((1, 1), bands, rest)
    after, before = np.append(tension[1:], 0), np.append(0, tension[:-1])
    ax = after * np.append(s[1:], 0) + before * np.append(0, s[:-1])
    ay = -after * np.append(c[1:], 0) - before * np.append(0, c[:-1])
    ay[0] -= G
    return np.concatenate([w, (c * ax + s * ay) / LINK])


INDEX = np.arange(LINKS)
WEIGHT = LINKS - np.maximum.outer(INDEX, INDEX)


def by_lagrange(t, y):
    """Lagrange's equations of the angles, a full mass matrix."""
    a, w = y[:LINKS], y[LINKS:]
    turn = a[:, None] - a[None, :]
    force = -LINK * LINK * (WEIGHT * np.sin(turn)) @ (w * w) - G * LINK * (LINKS - INDEX) * np.sin(a)
    return np.concatenate([w, cho_solve(cho_factor(LINK * LINK * WEIGHT * np.cos(turn)), force)])


def falling_chain():
    """Every tenth point of a chain of 200 links that falls from level, by both equations to different tolerances: they agree to 1e-8."""
    times = [CHAIN_ENDS * (k + 1) / 16 for k in range(16)]
    start = np.concatenate([np.full(LINKS, np.pi / 2), np.zeros(LINKS)])
    found = []
    for equations, tolerance in ((by_tensions, 1e-13), (by_lagrange, 1e-12)):
        run = solve_ivp(equations, (0.0, times[-1]), start, "DOP853", times, rtol=tolerance, atol=tolerance)
        angles = run.y[:LINKS]
        found.append([np.cumsum(LINK * np.sin(angles), axis=0), np.cumsum(-LINK * np.cos(angles), axis=0)])
    apart = np.abs(np.array(found[0]) - np.array(found[1])).max()
    assert apart < 1e-8, apart
    shown = range(9, LINKS, 10)
    columns = [f"P.{point}.{axis}" for point in shown for axis in (0, 1)]
    rows = [[t, *(found[0][axis][point, k] for point in shown for axis in (0, 1))] for k, t in enumerate(times)]
    written("falling_chain.csv", columns, rows)
    return apart


if __name__ == "__main__":
    for table in (flying_through, chattering_valve, falling_chain):
        print(table.__name__, table(), flush=True)
