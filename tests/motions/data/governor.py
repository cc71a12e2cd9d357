"""Stiff flyball governor for 1000 s, in the slope of its rods and the height of its slider; the shaft's speed follows from its momentum.

    python3 governor.py > governor.txt     needs numpy and scipy, and eleven minutes

Data: IFToMM benchmark A05. The rods move alike. An explicit method and an implicit one, which agree to 1e-9 m and 2e-7 rad.
"""

import math

import numpy as np
from scipy.integrate import ode, solve_ivp

LENGTH, SIDE, CUBE, HINGE, GRAVITY = 1.0, 0.01, 0.1, 0.05, 9.81
BALL, STIFFNESS, DAMPING, REST, OMEGA, START = 5.0, 8e5, 4e4, 0.5, 2 * math.pi, math.pi / 6
ROD, SLIDER = 3000 * LENGTH * SIDE**2, 3000 * CUBE**3
THIN, LONG = ROD * SIDE**2 / 6, ROD * (LENGTH**2 + SIDE**2) / 12
UPRIGHT = SLIDER * CUBE**2 / 6 + THIN
INERTIA = 2 * (ROD * LENGTH**2 / 4 + LONG + BALL * LENGTH**2)


def about_shaft(cosine, sine):
    middle, end = HINGE + LENGTH / 2 * cosine, HINGE + LENGTH * cosine
    return 2 * (ROD * middle**2 + THIN * sine**2 + LONG * cosine**2 + BALL * end**2) + UPRIGHT


MOMENTUM = OMEGA * about_shaft(math.cos(START), math.sin(START))


def rates(t, state):
    slope, height, turning, rising = state[0], state[1], state[2], state[3]
    cosine, sine = math.cos(slope), math.sin(slope)
    middle, end = HINGE + LENGTH / 2 * cosine, HINGE + LENGTH * cosine
    speed = MOMENTUM / about_shaft(cosine, sine)
    # Half the derivative of the moment of inertia about the shaft.
    wider = (2 * (THIN - LONG) * cosine - (ROD * middle + 2 * BALL * end) * LENGTH) * sine
    across, up = LENGTH / 2 * cosine, LENGTH - LENGTH / 2 * sine - height
    spring = math.hypot(across, up)
    by_slope, by_height = -LENGTH / 2 * (across * sine + up * cosine) / spring, -up / spring
    force = 2 * (STIFFNESS * (spring - REST) + DAMPING * (by_slope * turning + by_height * rising))
    falls = GRAVITY * cosine * (ROD + 2 * BALL) * LENGTH
    slope_rate = (wider * speed**2 + falls - force * by_slope) / INERTIA
    return turning, rising, slope_rate, -GRAVITY - force * by_height / SLIDER, speed


START_STATE = [START, 0.5, 0.0, 0.0, 0.0]
TIMES = [1000.0 * k / 64 for k in range(65)]

if __name__ == "__main__":
    run = ode(rates).set_integrator("dop853", rtol=1e-13, atol=1e-15, nsteps=10**9)
    run.set_initial_value(START_STATE, 0.0)
    found = np.array([START_STATE, *(run.integrate(t) for t in TIMES[1:])])
    other = solve_ivp(rates, (0.0, TIMES[-1]), START_STATE, "LSODA", TIMES, rtol=1e-13, atol=1e-15).y.T
    apart = np.abs(found - other).max(axis=0)
    assert apart[1] < 1e-9 and apart[4] < 2e-7, apart
    print("# governor.py: time (s), height of the slider (m), angle of the shaft (rad)")
    for t, row in zip(TIMES, found):
        print(f"{t!r} {float(row[1])!r} {float(row[4])!r}")
