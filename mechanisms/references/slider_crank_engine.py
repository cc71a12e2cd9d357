"""Motion of the engine of `mechanisms/src/slider_crank_engine.rs` by equations derived by hand: one degree of freedom, three with
play in the piston's pin.

    python3 slider_crank_engine.py > slider_crank_engine.txt     needs numpy and scipy
    python3 slider_crank_engine.py clearance > slider_crank_engine_clearance.txt     takes minutes
    python3 slider_crank_engine.py gas                           harmonics of the gas pressure, as they stand in the text

Newton's and Euler's equations of piston, rod and crank are solved for the acceleration of the crank and the forces in the pins;
friction makes them depend on the sizes of these forces, which a fixed-point iteration finds. The state is (theta, omega).

With play the force between pin and eye is a law of the state (theta, phi, y, and their rates), and the same equations have the
accelerations of rod and piston as unknowns. Each touch and each lift-off ends an integration.
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


# Of the effect `clearance`: radial play (m), stiffness (N/m), damping (s/m), coefficient of friction, mass of the bush (kg).
PLAY, EYE, DAMPING, MU_EYE, BUSH = 15e-6, 5e8, 20.0, 0.004, 0.04


def eye(e, state):
    """Depth of the pin in the eye, its rate, and the unit vector from the eye's centre to the pin's."""
    theta, phi, y, omega, phi_rate, y_rate = state
    r, L = e["r"], e["L"]
    off = np.array([r * np.sin(theta) + L * np.sin(phi), y - r * np.cos(theta) - L * np.cos(phi)])
    rate = np.array([r * np.cos(theta) * omega + L * np.cos(phi) * phi_rate,
                     y_rate + r * np.sin(theta) * omega + L * np.sin(phi) * phi_rate])
    distance = np.hypot(*off)
    out = off / distance
    return distance - PLAY, out @ rate, out


def loose(e, state, touching):
    """Accelerations of crank, rod and piston, the force of the rod on the piston, and its size."""
    theta, phi, y, omega, phi_rate, y_rate = state
    r, L = e["r"], e["L"]
    # Rod and bush together: mass, centre of mass, moment of inertia about it.
    mass = e["rod_mass"] + BUSH
    d = (e["rod_mass"] * e["d"] + BUSH * L) / mass
    inertia = e["rod_inertia"] + e["rod_mass"] * (d - e["d"])**2 + BUSH * (L - d)**2
    depth, depth_rate, out = eye(e, state)
    push = EYE * depth * max(1 + DAMPING * depth_rate, 0) if touching else 0.0
    on_piston = -push * out
    pin, along = r * np.array([-np.sin(theta), np.cos(theta)]), np.array([-np.sin(phi), np.cos(phi)])
    across = np.array([-np.cos(phi), -np.sin(phi)])
    pin_slope = r * np.array([-np.cos(theta), -np.sin(theta)])
    near, far = -d * along, (L - d) * along

    outer = -np.pi / 4 * e["bore"]**2 * pressure(theta) - e["piston_mass"] * e["g"]
    outer += e["stiffness"] * (TOP - y - UNLOADED) - e["viscous"] * y_rate
    rings = -e["mu_liner"] * np.tanh(y_rate / SMOOTH) * abs(on_piston[0])
    piston = (outer + rings + on_piston[1]) / e["piston_mass"]
    torque = e["stall"] * (1 - omega / e["idle"]) - e["drag"] * omega * abs(omega)
    big = -e["mu_pins"] * np.tanh(BIG_END * (phi_rate - omega) / SMOOTH) * BIG_END
    small = -MU_EYE * np.tanh(SMALL_END * phi_rate / SMOOTH) * SMALL_END * push

    # Unknowns: accelerations of crank and rod, Cx, Cy (crank on rod).
    towards = -pin * omega**2 - d * along * phi_rate**2
    matrix, right = np.zeros((4, 4)), np.zeros(4)
    for k in range(2):
        matrix[k, 0], matrix[k, 1] = mass * pin_slope[k], mass * d * across[k]
        matrix[k, 2 + k] = -1
        right[k] = -on_piston[k] - mass * (towards[k] + (e["g"] if k else 0))
    matrix[2] = [0, inertia, near[1], -near[0]]
    matrix[3] = [e["wheel"], 0, -pin[1], pin[0]]
    turns = far[0] * -on_piston[1] + far[1] * on_piston[0]
    found = np.zeros(4)
    for _ in range(200):
        crank = np.hypot(*found[2:])
        right[2], right[3] = turns + big * crank + small, torque - big * crank
        before, found = found, np.linalg.solve(matrix, right)
        if np.max(np.abs(found - before)) <= 1e-13 * np.max(np.abs(found)):
            return np.array([found[0], found[1], piston]), on_piston, push
    raise RuntimeError("the forces do not converge")


def loose_motion(e, times, tolerance, step):
    """(t, theta, phi, y, omega, side load, force in the eye) at `times`, and the number of touches and lift-offs."""
    state = np.array([0, 0, e["r"] + e["L"] - PLAY, e["speed"], -e["r"] / e["L"] * e["speed"], 0.0])
    touches, changes, t, rows = True, 0, 0.0, []
    while t < times[-1]:
        rates = lambda _, state: [*state[3:], *loose(e, state, touches)[0]]
        # Of an open gap the depth, of a closed one the force: it never pulls.
        ends = lambda _, state: eye(e, state)[0]
        ends.terminal, ends.direction = True, -1 if touches else 1
        ahead = [one for one in times if one > t or not rows]
        run = solve_ivp(rates, (t, times[-1]), state, "DOP853", ahead, rtol=tolerance, atol=tolerance * 1e-3, max_step=step,
                        events=ends)
        assert run.success, run.message
        for t, at in zip(run.t, np.transpose(run.y)):
            _, force, push = loose(e, at, touches)
            rows.append((t, *at[:4], force[0], push))
        if run.status == 0:
            break
        t, state, touches, changes = run.t_events[0][0], run.y_events[0][0], not touches, changes + 1
    return rows, changes


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
    elif sys.argv[1:] == ["clearance"]:
        times = np.linspace(0, 0.05, 26)
        (fine, changes), (rough, _) = (loose_motion(ENGINE, times, *of) for of in ((1e-13, 1e-6), (1e-12, 2e-6)))
        far = np.max(np.abs(np.array(fine) - np.array(rough)), axis=0)
        print("# Made by slider_crank_engine.py clearance: t (s), theta (rad), phi (rad), y (m), omega (rad/s), side load (N), "
              "force in the eye (N)")
        print(f"# {changes} touches and lift-offs; differences from a rougher run:", *(f"{value:.1e}" for value in far[1:]))
        for t, *row in fine:
            print(f"{t:.3f}", *(f"{value:.14g}" for value in row))
    else:
        times = np.linspace(0, 0.05, 26)
        print("# Made by slider_crank_engine.py: case, t (s), theta (rad), omega (rad/s), side load (N)")
        for name, changed in CASES.items():
            fine, rough = (motion(ENGINE | changed, times, *of) for of in ((1e-13, 1e-5), (1e-12, 3e-5)))
            far = max(abs(a[1] - b[1]) for a, b in zip(fine, rough))
            assert far < 1e-9, (name, far)
            for t, theta, omega, side in fine:
                print(f"{name} {t:.3f} {theta:.14g} {omega:.14g} {side:.14g}")
