"""Motion of the quarter car of `mechanisms/src/kerb.rs` by Newton's equations of its two masses.

    python3 kerb.py > kerb.txt     needs numpy and scipy

The state is (y0, y1, v0, v1). Each law is written down as a function of position and velocity, without events: short steps at a small
tolerance go over their kinks.
"""

import numpy as np
from scipy.integrate import solve_ivp

G = 9.81
BODY, WHEEL = 300.0, 40.0
DEFAULTS = dict(g=G, spring=20e3, damping=1500.0, tyre=180e3, up=60e3, down=60e3, rub=40.0, height=0.1, speed=8.0)
OFF = dict(weight=["g"], spring=["spring"], damper=["damping"], bump_stop=["up"], rebound_stop=["down"], dry=["rub"])
KERB, AT, TYRE_LOSS, LOSS, SMOOTH, BUMP, REBOUND = 0.3, 0.1, 0.02, 0.15, 0.02, 0.05, 0.04


def road(e, t):
    s = min(max((t - AT) * e["speed"] / KERB, 0.0), 1.0)
    rate = e["speed"] / KERB if 0 < s < 1 else 0.0
    return e["height"] * s**3 * (10 - 15 * s + 6 * s * s), e["height"] * 30 * s * s * (1 - s)**2 * rate


def contact(depth, rate, stiffness, loss):
    """Force of a contact of this depth, which grows with this rate."""
    return stiffness * depth * max(1 + loss * rate, 0.0) if depth > 0 else 0.0


def forces(e, t, state):
    y0, y1, v0, v1 = state
    height, rise = road(e, t)
    travel, rate = y0 - y1, v0 - v1
    # At rest on a flat road the springs carry the weights.
    tyre = contact((BODY + WHEEL) * G / DEFAULTS["tyre"] - (y1 - height), -(v1 - rise), e["tyre"], TYRE_LOSS)
    strut = e["spring"] * (BODY * G / DEFAULTS["spring"] - travel)
    strut -= e["damping"] * (max(rate, 0.0) + 0.6 * min(rate, 0.0))
    strut += contact(-(travel + BUMP), -rate, e["up"], LOSS)
    strut -= contact(-(REBOUND - travel), rate, e["down"], LOSS)
    strut -= e["rub"] * np.tanh(rate / SMOOTH)
    return tyre, strut


def rates(e, t, state):
    tyre, strut = forces(e, t, state)
    return [state[2], state[3], strut / BODY - e["g"], (tyre - strut) / WHEEL - e["g"]]


CASES = {"all": {}} | {"without_" + name: {key: 0.0 for key in keys} for name, keys in OFF.items()}

if __name__ == "__main__":
    print("# case, t (s), y0 (m), y1 (m), force of the tyre (N): made by kerb.py")
    times = np.arange(1, 31) * 0.05
    for case, changed in CASES.items():
        e = DEFAULTS | changed
        # The kerb begins and ends where its third derivative jumps.
        state, now, done = [0.0, 0.0, 0.0, 0.0], 0.0, []
        for end in (AT, AT + KERB / e["speed"], times[-1]):
            here = times[(times > now + 1e-12) & (times <= end + 1e-12)]
            asked = np.unique(np.append(here, end))
            run = solve_ivp(lambda t, s: rates(e, t, s), (now, end), state, "DOP853", asked, rtol=1e-12, atol=1e-13, max_step=2e-4)
            assert run.success, run.message
            done += [(t, *s) for t, s in zip(run.t, run.y.T) if np.min(np.abs(here - t), initial=1) < 1e-12]
            state, now = run.y[:, -1], end
        for t, *s in done:
            print(case, f"{t:.2f}", *(f"{value:.12e}" for value in s[:2]), f"{forces(e, t, s)[0]:.9e}")
