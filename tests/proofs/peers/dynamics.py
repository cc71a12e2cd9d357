"""Writes the peers of motion from forces: CasADi's right-hand side as C code, and SUNDIALS' CVODES that integrates it.

The right-hand side solves the equations of motion with multipliers by CasADi's sparse QR factorization; it keeps rows
that it has been released on by Baumgarte's method. `write()` leaves in the working directory, for each problem below,
`casadi_NAME_rates.c` of (q, qd), and in `cvodes_native.casadi` and `cvodes_default.casadi` integrators for several
tolerances that call the same code from a shared library, compiled for this processor and for the default target.
"""

import math
import os
import subprocess

import casadi as ca

# Damping and frequency (rad/s) of the stabilisation.
XI, OMEGA = 1.0, 10.0

# Tolerances, relative and absolute, that the bench chooses from: the loosest one that is exact enough.
TOLERANCES = [10 ** (-k / 2) for k in range(10, 23)]

# Samples of the motion that its error is taken from, where more than the end is known.
SAMPLES = 1000


def andrews():
    """Andrews' squeezing mechanism; numbers from the IVP test set."""
    q, v = ca.SX.sym("q", 7), ca.SX.sym("v", 7)
    beta, theta, gamma, phi, delta, omega, epsilon = ca.vertsplit(q)

    def unit(angle):
        return ca.vertcat(ca.cos(angle), ca.sin(angle))

    def across(angle):
        return ca.vertcat(ca.sin(angle), -ca.cos(angle))

    a, b = ca.DM([-0.06934, -0.00227]), ca.DM([-0.03635, 0.03273])
    c = ca.DM([0.014, 0.072])
    e = 0.007 * unit(beta) - 0.028 * unit(beta + theta)
    g, h = a + 0.04 * unit(delta), a + 0.04 * across(epsilon)
    bodies = [
        (0.04325, 2.194e-6, 0.00092 * unit(beta), beta),
        (0.00365, 4.410e-7, 0.007 * unit(beta) - 0.0115 * unit(beta + theta), beta + theta),
        (0.02373, 5.255e-6, b + 0.01874 * across(gamma) + 0.01043 * unit(gamma), gamma),
        (0.00706, 5.667e-7, g + (0.02 - 0.01421) * across(phi + delta), phi + delta),
        (0.07050, 1.169e-5, a + 0.02308 * unit(delta) - 0.00916 * across(delta), delta),
        (0.00706, 5.667e-7, h + (0.02 - 0.01421) * unit(omega + epsilon), omega + epsilon),
        (0.05498, 1.912e-5, a + 0.01228 * across(epsilon) + 0.00449 * unit(epsilon), epsilon),
    ]
    spring = ca.norm_2(b + 0.02 * unit(gamma) + 0.018 * across(gamma) - c)
    potential = 0.5 * 4530 * (spring - 0.07785) ** 2
    rows = ca.vertcat(
        e - b - 0.035 * across(gamma),
        e - g - 0.02 * across(phi + delta),
        e - h - 0.02 * unit(omega + epsilon),
    )
    mass, inertia = mass_and_inertia(bodies, q, v)
    force = ca.vertcat(0.033, ca.SX(6, 1)) - ca.gradient(potential, q) - inertia
    start = [-0.06171389001427645, 0, 0.45527981916307037, 0.22266839016588588]
    start += [0.48736497954384256, -0.22266839016588588, 1.2305474445498212]
    return q, v, mass, force, rows, start, 0.03, False


def mass_and_inertia(bodies, q, v):
    """The mass matrix, and its part of the forces at no acceleration."""
    mass, inertia = ca.SX(q.numel(), q.numel()), ca.SX(q.numel(), 1)
    for m, j, com, angle in bodies:
        for weight, place in ((m, com), (j, angle)):
            rate = ca.jacobian(place, q)
            mass += weight * rate.T @ rate
            inertia += weight * rate.T @ ca.jtimes(rate @ v, q, v)
    return mass, inertia


def n_four_bar(loops):
    """Uniform rods of 1 m and 1 kg: uprights that hang 60 degrees off the vertical, at rest, joined by couplers."""
    points = loops + 1
    q, v = ca.SX.sym("q", 2 * points), ca.SX.sym("v", 2 * points)
    p = [q[2 * k : 2 * k + 2] for k in range(points)]
    feet = [ca.DM([k, 0]) for k in range(points)]
    rods = list(zip(feet, p)) + list(zip(p, p[1:]))
    mass, potential = ca.SX(q.numel(), q.numel()), 0
    for one, other in rods:
        for weight, part in ((1.0, (one + other) / 2), (1 / 12, other - one)):
            rate = ca.jacobian(part, q)
            mass += weight * rate.T @ rate
        potential += 9.81 * (one[1] + other[1]) / 2
    rows = ca.vertcat(*(ca.sumsqr(other - one) - 1 for one, other in rods))
    angle = -math.pi / 6
    start = sum(([k + math.cos(angle), math.sin(angle)] for k in range(points)), [])
    return q, v, ca.sparsify(mass), -ca.gradient(potential, q), rows, start, 10.0, True


PROBLEMS = {"andrews": andrews(), "n_four_bar": n_four_bar(10)}


def rates(name, q, v, mass, force, rows):
    """The accelerations as a function of (q, qd), stabilised or not."""
    rows_q = ca.jacobian(rows, q)
    speed = rows_q @ v
    gamma = -ca.jtimes(speed, q, v)

    def function(name, right):
        zero = ca.SX(rows.numel(), rows.numel())
        matrix = ca.blockcat([[mass, rows_q.T], [rows_q, zero]])
        system = ca.Function("system", [q, v], ca.cse([matrix, ca.vertcat(force, right)]))
        position, velocity = ca.MX.sym("q", q.numel()), ca.MX.sym("v", v.numel())
        solution = ca.solve(*system(position, velocity), "qr")
        return ca.Function(name, [position, velocity], [solution[: q.numel()]])

    return function(name, gamma), function(f"{name}_stabilised", gamma - 2 * XI * OMEGA * speed - OMEGA**2 * rows)


def library(function, flags):
    """The compiled code of a function of the state."""
    name = f"{function.name()}_{'native' if flags else 'default'}"
    function.generate(f"{name}.inc", {"with_header": False})
    compiler = os.environ.get("CC", "cc")
    command = [compiler, "-O3", *flags, "-shared", "-fPIC", "-x", "c", f"{name}.inc", "-o", f"{name}.so", "-lm"]
    subprocess.run(command, check=True)
    # The integrator asks how derivatives could be had, and never does: the method of Adams iterates without them.
    return ca.external(function.name(), os.path.abspath(f"{name}.so"), {"enable_fd": True})


def integrators(name, code, n, end, sampled):
    """CVODES for every tolerance: the end alone, and samples where asked for."""
    state = ca.MX.sym("state", 2 * n)
    equation = {"x": state, "ode": code(state)}
    grids = {"end": [end]} | ({"samples": [end * k / SAMPLES for k in range(1, SAMPLES + 1)]} if sampled else {})
    for suffix, grid in grids.items():
        for index, tolerance in enumerate(TOLERANCES):
            options = {
                "abstol": tolerance,
                "reltol": tolerance,
                "max_num_steps": 1_000_000,
                "linear_multistep_method": "adams",
                "nonlinear_solver_iteration": "functional",
            }
            made = ca.integrator("made", "cvodes", equation, 0, grid, options)
            x = ca.MX.sym("x", 2 * n)
            yield ca.Function(f"{name}_{suffix}_{index}", [x], [made(x0=x)["xf"]])


def write():
    flags = {"native": ["-march=native"], "default": []}
    made = {target: [] for target in flags}
    for name, (q, v, mass, force, rows, start, end, sampled) in PROBLEMS.items():
        plain, stabilised = rates(f"casadi_{name}_rates", q, v, mass, force, rows)
        plain.generate(f"casadi_{name}_rates.c", {"with_header": False})
        state = ca.MX.sym("state", 2 * q.numel())
        position, velocity = ca.vertsplit(state, q.numel())
        function = ca.Function(f"{name}_ode", [state], [ca.vertcat(velocity, stabilised(position, velocity))])
        for target, options in flags.items():
            code = library(function, options)
            made[target] += integrators(name, code, q.numel(), end, sampled)
    for target, functions in made.items():
        file = ca.FileSerializer(f"cvodes_{target}.casadi")
        file.pack(functions)
        del file
