"""Motion of the engine of `mechanisms/src/slider_crank_engine.rs` by equations derived by hand: one degree of freedom.

    python3 slider_crank_engine.py > slider_crank_engine.txt     needs numpy and scipy
    python3 slider_crank_engine.py gas                           harmonics of the gas pressure, as they stand in the text

Newton's and Euler's equations of piston, rod and crank are solved for the acceleration of the crank and the forces in the pins;
friction makes them depend on the sizes of these forces, which a fixed-point iteration finds. The state is (theta, omega).
"""

import sys

import numpy as np
from scipy.integrate import solve_ivp

MEAN = 366600
COSINES = [650400, 458000, 279800, 173300, 110100, 55900, 3100, -30800, -43500, -42900, -43800, -45200, -44600, -36900, -28400,
           -21500, -19100, -16100, -12300, -7100]
SINES = [208300, 290100, 274800, 221100, 191200, 172100, 146300, 106100, 70500, 47100, 34900, 22400, 8800, -2700, -7200, -7200,
         -6900, -8700, -10300, -9400]

RPM = 2 * np.pi / 60
# The defaults of the text.
ENGINE = dict(r=0.04, L=0.14, d=0.045, piston_mass=0.45, rod_mass=0.6, rod_inertia=2.2e-3, wheel=0.15, speed=2400 * RPM, bore=0.08,
              g=9.81, mu_liner=0.08, viscous=4.0, mu_pins=0.002, stall=60.0, idle=6000 * RPM, drag=2e-4, stiffness=3000.0)
# Speed below which friction is smooth (m/s), radii of the pins (m), end and unloaded length of the spring (m).
SMOOTH, BIG_END, SMALL_END, TOP, UNLOADED = 0.1, 0.022, 0.011, 0.26, 0.12


def pressure(theta):
    k = np.arange(1, len(COSINES) + 1)
    return MEAN + np.dot(COSINES, np.cos(k * theta / 2)) + np.dot(SINES, np.sin(k * theta / 2))


def solve(e, theta, omega):
    """Acceleration of the crank (rad/s^2), force of the rod on the piston (N, N), force of the crank on the rod (N, N)."""
    r, L, d = e["r"], e["L"], e["d"]
    s, c = np.sin(theta), np.cos(theta)
    sp = -r / L * s
    cp = np.sqrt(1 - sp * sp)
    phi_rate = -r * c * omega / (L * cp)
    # Accelerations are affine in that of the crank: a + b alpha.
    phi_acc = np.array([(r * s * omega**2 + L * sp * phi_rate**2) / (L * cp), -r * c / (L * cp)])
    pin_acc = np.array([[r * s * omega**2, -r * c], [-r * c * omega**2, -r * s]])
    along_acc = np.array([[sp * phi_rate**2, 0], [-cp * phi_rate**2, 0]]) + np.outer([-cp, -sp], phi_acc)
    centre_acc = pin_acc + d * along_acc
    piston_acc = (pin_acc + L * along_acc)[1]
    y, y_rate = r * c + L * cp, -r * s * omega - L * sp * phi_rate
    pin, along = np.array([-r * s, r * c]), np.array([-sp, cp])
    near, far = -d * along, (L - d) * along

    outer = -np.pi / 4 * e["bore"]**2 * pressure(theta) - e["piston_mass"] * e["g"]
    outer += e["stiffness"] * (TOP - y - UNLOADED) - e["viscous"] * y_rate
    torque = e["stall"] * (1 - omega / e["idle"]) - e["drag"] * omega * abs(omega)
    rings = -e["mu_liner"] * np.tanh(y_rate / SMOOTH)
    big = -e["mu_pins"] * np.tanh(BIG_END * (phi_rate - omega) / SMOOTH) * BIG_END
    small = -2 * e["mu_pins"] * np.tanh(SMALL_END * phi_rate / SMOOTH) * SMALL_END

    # Unknowns: alpha, Sx, Sy (rod on piston), Cx, Cy (crank on rod).
    matrix = np.zeros((5, 5))
    right = np.zeros(5)
    matrix[0, 0], matrix[0, 2] = e["piston_mass"] * piston_acc[1], -1
    matrix[1, 0], matrix[1, 1], matrix[1, 3] = e["rod_mass"] * centre_acc[0, 1], 1, -1
    matrix[2, 0], matrix[2, 2], matrix[2, 4] = e["rod_mass"] * centre_acc[1, 1], 1, -1
    matrix[3] = [e["rod_inertia"] * phi_acc[1], -far[1], far[0], near[1], -near[0]]
    matrix[4] = [e["wheel"], 0, 0, -pin[1], pin[0]]
    forces = np.zeros(5)
    for _ in range(200):
        side, joint, crank = abs(forces[1]), np.hypot(*forces[1:3]), np.hypot(*forces[3:5])
        right[0] = outer + rings * side - e["piston_mass"] * piston_acc[0]
        right[1] = -e["rod_mass"] * centre_acc[0, 0]
        right[2] = -e["rod_mass"] * (centre_acc[1, 0] + e["g"])
        right[3] = big * crank + small * joint - e["rod_inertia"] * phi_acc[0]
        right[4] = torque - big * crank
        found = np.linalg.solve(matrix, right)
        if np.max(np.abs(found - forces)) <= 1e-14 * np.max(np.abs(found)):
            return found
        forces = found
    raise RuntimeError("the forces do not converge")


def motion(e, times, tolerance, step):
    rates = lambda t, state: [state[1], solve(e, *state)[0]]
    # Short steps: the size of a normal force has kinks.
    run = solve_ivp(rates, (0, times[-1]), [0, e["speed"]], "DOP853", times, rtol=tolerance, atol=tolerance, max_step=step)
    assert run.success, run.message
    return [(t, theta, omega, solve(e, theta, omega)[1]) for t, theta, omega in zip(run.t, *run.y)]


# All effects, and each alone on top of the masses of crank and piston.
OFF = dict(bore=0, g=0, mu_liner=0, viscous=0, mu_pins=0, stall=0, drag=0, stiffness=0)
CASES = {"all": {}} | {
    name: {key: 0.0 for key in OFF if key not in own}
    for name, own in dict(gas=["bore"], gravity=["g"], liner_friction=["mu_liner", "viscous"], pin_friction=["mu_pins"],
                          motor=["stall"], fan=["drag"], spring=["stiffness"]).items()
}


def cycle():
    """A working cycle: compression and expansion with n = 1.3, heat by Wiebe's law, intake and exhaust at constant pressures."""
    degree = np.pi / 180
    r, L, n = ENGINE["r"], ENGINE["L"], 1.3
    area = np.pi * ENGINE["bore"]**2 / 4
    swept = 2 * area * r
    volume = lambda a: swept / 8.5 + area * (r + L - r * np.cos(a * degree) - np.sqrt(L * L - (r * np.sin(a * degree))**2))
    burnt = lambda a: 1 - np.exp(-5 * max(a + 12, 0)**3 / 60**3)
    intake, exhaust, heat, step = 0.92e5, 1.06e5, 950, 0.05
    angles = np.arange(-360, 360, step)
    pressures, p = [], intake
    for a in angles:
        if a < -140:
            pressures.append(intake if a > -350 else exhaust)
        elif a < 140:
            pressures.append(p)
            p = p * (volume(a) / volume(a + step))**n + (n - 1) * heat * (burnt(a + step) - burnt(a)) / volume(a + step)
        else:
            pressures.append(exhaust + (p - exhaust) * np.exp(-(a - 140) / 18))
    return angles * degree / 2, np.array(pressures) - 1.013e5


if __name__ == "__main__":
    if sys.argv[1:] == ["gas"]:
        half, over = cycle()
        rounded = lambda values: [int(100 * round(value / 100)) for value in values]
        k = range(1, len(COSINES) + 1)
        print(rounded([over.mean()]), rounded([2 * (over * np.cos(i * half)).mean() for i in k]),
              rounded([2 * (over * np.sin(i * half)).mean() for i in k]))
    else:
        times = np.linspace(0, 0.05, 26)
        print("# Made by slider_crank_engine.py: case, t (s), theta (rad), omega (rad/s), side load (N)")
        for name, changed in CASES.items():
            fine, rough = (motion(ENGINE | changed, times, *of) for of in ((1e-13, 1e-5), (1e-12, 3e-5)))
            far = max(abs(a[1] - b[1]) for a, b in zip(fine, rough))
            assert far < 1e-9, (name, far)
            for t, theta, omega, side in fine:
                print(f"{name} {t:.3f} {theta:.14g} {omega:.14g} {side:.14g}")
