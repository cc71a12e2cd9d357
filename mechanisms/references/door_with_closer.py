"""Motion of the door of `mechanisms/src/door_with_closer.rs`: its laws, integrated by SciPy between switches.

    python3 door_with_closer.py > door_with_closer.txt     needs numpy and scipy

The friction sticks or slides to one side, the bolt is in or out. Each mode is integrated up to the next switch or kink of a law:
an end of sliding, a moment beyond the limit of sticking, the bolt, the frame, the gust. A line for each instant of a case: case,
t (s), phi (rad), its rate (rad/s). `caught` has the times at which the bolt falls in, and `border` the angle (rad) above which
the friction holds the door at rest.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

WIDTH, INERTIA, RADIUS, NORMAL, MU, MUS = 0.9, 30 * 0.81 / 3, 0.02, 300.0, 0.25, 0.35
DEG = np.pi / 180


def restitution(e):
    low, high = 1e-3, 1 / e * (1 - 1e-15)
    for _ in range(200):
        c = (low + high) / 2
        low, high = (c, high) if c - np.log1p(c) + e * c + np.log1p(-e * c) > 0 else (low, c)
    return low


DAMPING = restitution(0.3) / 0.3


def closer(phi):
    x, y = 0.25 * np.cos(phi) - 0.05, 0.25 * np.sin(phi) + 0.3
    reach = np.hypot(x, y)
    tension = 60 * (0.5 / (0.5 - (reach - np.hypot(0.2, 0.3))))**1.2
    return -tension * (0.25 * np.cos(phi) * y - 0.25 * np.sin(phi) * x) / reach


def pull(phi):
    return 3e5 * max(WIDTH * phi - 0.003, 0)


def moment(case, t, phi, omega, caught):
    """Of everything but the friction of the hinge."""
    x = (t - case["since"]) / case["lasts"]
    wind = -case["gust"] * WIDTH**2 * 16 * max(x * (1 - x), 0)**2
    damper = -12 * min(omega, 0) - 0.5 * max(omega, 0)
    depth = max(-WIDTH * phi, 0)
    frame = WIDTH * 2e5 * depth * max(1 - DAMPING * WIDTH * omega, 0)
    return closer(phi) + wind + damper + frame - caught * WIDTH * pull(phi)


def motion(name, until, lines, opened=70 * DEG, gust=0.0, since=1.0, lasts=1.5):
    case = dict(gust=gust, since=since, lasts=lasts)
    t, y, caught, when = 0.0, np.array([opened, 0.0]), WIDTH * opened < 0.003, []
    slides, held = RADIUS * NORMAL * MU, RADIUS * NORMAL * MUS
    kinks = sorted({since, since + lasts, until})

    def side_at(t, y):
        push = moment(case, t, y[0], 0.0, caught)
        return 0 if abs(push) <= held else int(np.sign(push))

    side = side_at(t, y)
    asked, rows = list(until * np.arange(1, lines + 1) / lines), []
    while t < until:
        end = next(kink for kink in kinks if kink > t)

        def rates(t, y):
            if side == 0:
                return [0.0, 0.0]
            return [y[1], (moment(case, t, y[0], y[1], caught) - side * slides) / INERTIA]

        # Name, function, direction: 0 of both.
        watched = [("frame", lambda t, y: y[0], 0), ("edge", lambda t, y: WIDTH * y[0] - 0.003, 0),
                   ("pulls", lambda t, y: 1 - DAMPING * WIDTH * y[1], 0)]
        if side:
            watched.append(("stops", lambda t, y: side * y[1], -1))
        else:
            watched.append(("slips", lambda t, y: abs(moment(case, t, y[0], 0.0, caught)) - held, 1))
        if caught:
            watched.append(("breaks", lambda t, y: 3e5 * (WIDTH * y[0] - 0.003) - 60, 1))
        events = []
        for _, function, direction in watched:
            def event(t, y, function=function):
                return function(t, y)
            event.terminal, event.direction = True, direction
            events.append(event)
        # A short step off a switch, so that it is not found again.
        step = 1e-9 if t > 0 else 0.0
        if side and step:
            k1 = np.array(rates(t, y))
            k2 = np.array(rates(t + step / 2, y + step / 2 * k1))
            y, t = y + step * k2, t + step
        found = solve_ivp(rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-15, events=events, dense_output=True,
                          max_step=0.02)
        while asked and asked[0] <= found.t[-1]:
            rows.append((asked[0], *(found.sol(asked[0]) if side else y)))
            asked.pop(0)
        t, y = found.t[-1], found.y[:, -1].copy()
        hit = [watched[k][0] for k in range(len(events)) if len(found.t_events[k])]
        if "edge" in hit and y[1] < 0 and not caught:
            caught = True
            when.append(t)
        if "breaks" in hit:
            caught = False
        if "stops" in hit:
            y[1] = 0.0
            side = side_at(t, y)
        elif "slips" in hit:
            side = int(np.sign(moment(case, t, y[0], 0.0, caught)))
    for t, phi, omega in rows:
        print(f"{name} {t:.17g} {phi:.13g} {omega:.13g}")
    for t in when:
        print(f"caught {name} {t:.12g}")


motion("closes", 6.0, 24)
motion("held", 6.0, 6, opened=95 * DEG)
motion("gust", 6.0, 24, opened=95 * DEG, gust=30.0)
motion("torn", 6.0, 24, opened=0.1 * DEG, gust=-100.0, lasts=0.3)
print(f"border {brentq(lambda phi: closer(phi) + RADIUS * NORMAL * MUS, 80 * DEG, 99 * DEG, xtol=1e-14):.13g}")
