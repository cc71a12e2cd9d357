"""SciPy, CVODES and IDAS on the equations of motion that CasADi derives from a definition, compiled as C.

The accelerations solve [[M, J'], [J, 0]] [qdd, lambda] = [Q, gamma - 2 w rate - w^2 phi], with w = 0 or Baumgarte's
stabilisation of one time constant. The system is eliminated by sparse QR, written out up to 13 unknowns.
"""

import ctypes
import os
import subprocess

import casadi as ca
import numpy as np
from peers import Late, Watch, ladder, last_words, shortest, tell
from scipy.integrate import solve_ivp

# Unknowns up to which the elimination is written out: beyond, its expressions take minutes to compile.
WRITTEN_OUT = 13

# Baumgarte's frequency times the motion's length: errors of the rows decay many times within it.
STABILISED = 200.0

EQUATIONS = ["SciPy DOP853", "SciPy Radau", "CVODES Adams", "CVODES BDF", "IDAS"]


class Cannot(Exception):
    """The equations cannot be handed on; the reason in words."""


class Equations:
    """Right-hand sides y' = f(t, y), y = [q, qd, z], as compiled C."""

    def __init__(self, back_end, definition, question):
        for name, value in [("M", definition.N), ("K", 0)]:
            if not hasattr(definition, name):
                setattr(definition, name, value)
        c = back_end.Calculus(definition)
        told, _ = back_end.functions(c, definition)
        told |= back_end.dynamics(c, definition, told["phi"], told["gamma"])
        n, m, k = definition.N, definition.M, definition.K
        self.n, self.m, self.scratch = n, m, question["scratch"]
        value = ca.DM(question["v"])
        picked = ["phi", "phi_q", "phi_t", "gamma", "mass", "force", "state_rates"]
        parts = [ca.substitute(ca.densify(told[name]), c.v, value) for name in picked]
        phi, slopes, phi_t, gamma, mass, force, rates = parts
        if any(ca.depends_on(e, c.l) for e in (force, rates)):
            raise Cannot("its forces depend on Lagrange multipliers")
        self.symbols = c
        self.jacobian = ca.sparsify(ca.reshape(slopes, n, m).T) if m else ca.SX(0, n)
        self.mass = ca.sparsify(ca.reshape(mass, n, n).T)
        self.force, self.rates, self.gamma, self.phi = force, rates, gamma, phi
        self.speed = ca.mtimes(self.jacobian, c.qd) + phi_t
        self.start = np.array(question["q"] + question["qd"] + question["z"])
        self.states = k
        at = ca.Function("at", [c.q, c.qd, c.t, c.z], [self.jacobian, self.system(0.0)[0]])
        q, qd, z = np.split(self.start, [n, 2 * n])
        rows, system = (np.array(ca.DM(x)) for x in at(q, qd, question["times"][0], z))
        if m and np.linalg.matrix_rank(rows / np.abs(rows).max(axis=1, keepdims=True), tol=1e-9) < m:
            raise Cannot("its rows are redundant: the matrix of the equations is singular")
        scale = np.abs(system).max(axis=1, keepdims=True)
        if np.linalg.cond(system / np.where(scale > 0, scale, 1)) > 1e13:
            raise Cannot("the matrix of the equations is singular at the start")

    def system(self, w):
        """Matrix and right-hand side of the accelerations and multipliers."""
        m = self.m
        matrix = ca.blockcat([[self.mass, self.jacobian.T], [self.jacobian, ca.SX(m, m)]])
        return matrix, ca.vertcat(self.force, self.gamma - 2 * w * self.speed - w * w * self.phi)

    def accelerations(self, w):
        """[qdd, lambda] of [q, qd, z] and t as a function of SX or MX symbols: (t, y, rates)."""
        c, n = self.symbols, self.n
        matrix, right = self.system(w)
        y = ca.vertcat(c.q, c.qd, c.z)
        if n + self.m <= WRITTEN_OUT:
            x = ca.qr_solve(right, *ca.qr_sparse(matrix), False)
            return ca.Function("rates", [c.t, y], [ca.cse(ca.vertcat(c.qd, x[:n], self.rates))])
        parts = ca.Function("parts", [c.t, y], ca.cse([matrix, right, self.rates]))
        t, state = ca.MX.sym("t"), ca.MX.sym("y", y.numel())
        matrix, right, rates = parts(t, state)
        x = ca.solve(matrix, right, "qr")[:n]
        return ca.Function("rates", [t, state], [ca.vertcat(state[n : 2 * n], x, rates)])

    def compiled(self, w):
        """The right-hand sides as a CasADi function from a shared library, and as a plain C function."""
        name = f"rates{'_stabilised' if w else ''}"
        function = self.accelerations(w)
        source = f"{name}.c"
        function.generate(source, {"with_header": False})
        sizes = [max(size, 1) for size in (function.sz_arg(), function.sz_res(), function.sz_iw(), function.sz_w())]
        with open(source, "a", encoding="utf-8") as file:
            file.write(
                "\nvoid plain(double t, const double* y, double* out) {\n"
                f"  static const double* arg[{sizes[0]}]; static double* res[{sizes[1]}];\n"
                f"  static casadi_int iw[{sizes[2]}]; static double w[{sizes[3]}];\n"
                "  arg[0] = &t; arg[1] = y; res[0] = out; rates(arg, res, iw, w, 0);\n}\n"
            )
        library = os.path.join(self.scratch, f"{name}.so")
        compiler = os.environ.get("CC", "cc")
        command = [compiler, "-O3", "-march=native", "-shared", "-fPIC", source, "-o", library, "-lm"]
        subprocess.run(command, check=True, capture_output=True)
        plain = ctypes.CDLL(library).plain
        plain.argtypes = [ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p]
        plain.restype = None
        return ca.external("rates", library, {"enable_fd": True}), plain


def split(states, n):
    """Coordinates and velocities from rows of states."""
    return states[:, :n].tolist(), states[:, n : 2 * n].tolist()


def scipy_run(equations, plain, method, times, longest):
    size, n, start = len(equations.start), equations.n, equations.start

    def run(tolerance):
        watch = Watch(longest)

        def rates(t, y):
            watch.count()
            y = np.ascontiguousarray(y)
            out = np.empty(size)
            plain(t, y.ctypes.data, out.ctypes.data)
            return out

        span = (times[0], times[-1])
        settings = {"method": method, "rtol": max(tolerance, 2.3e-14), "atol": tolerance}
        found = solve_ivp(rates, span, start, t_eval=times, **settings)
        if not found.success or found.y.shape[1] != len(times):
            raise RuntimeError(found.message)

        def again():
            watch.end = float("inf")
            solve_ivp(rates, span, start, t_eval=span[1:], **settings)

        return split(found.y.T, n), again, found.nfev

    return run


def sundials_run(equations, problem, plugin, options, start, times):
    def run(tolerance):
        # Few enough for a singular position to end the run, not to stall it.
        told = options | {"abstol": tolerance, "reltol": tolerance, "max_num_steps": 200_000}
        whole = ca.integrator("whole", plugin, problem, times[0], list(times[1:]), told)
        told |= {"max_num_steps": 200_000 * len(times)}
        last = ca.integrator("last", plugin, problem, times[0], [times[-1]], told)
        states = np.array(whole(**start)["xf"]).T
        if not np.isfinite(states).all():
            raise RuntimeError("the states are not finite")
        states = np.vstack([equations.start, states])
        return split(states, equations.n), lambda: last(**start), 0

    return run


def run_all(back_end, definition, question):
    os.chdir(question["scratch"])
    times, longest = np.array(question["times"]), question["longest"]
    try:
        equations = Equations(back_end, definition, question)
    except Cannot as reason:
        for program in EQUATIONS:
            tell(program=program, setting="", refused=f"cannot: {reason}")
        return
    settings = [(f"tolerance 1e-{digits}", 10.0**-digits) for digits in question["digits"]]
    w = STABILISED / (times[-1] - times[0])
    for label, w in [(", not stabilised", 0.0), (", Baumgarte", w)] if equations.m else [("", 0.0)]:
        tell(program="equations", progress=f"C of the equations{label}")
        external, plain = equations.compiled(w)
        for method in ["DOP853", "Radau"]:
            ladder(f"SciPy {method}{label}", settings, scipy_run(equations, plain, method, times, longest), longest)
        y, t = ca.MX.sym("y", len(equations.start)), ca.MX.sym("t")
        problem = {"x": y, "t": t, "ode": external(t, y)}
        for name, lmm, iteration in [("Adams", "adams", "functional"), ("BDF", "bdf", "newton")]:
            options = {"linear_multistep_method": lmm, "nonlinear_solver_iteration": iteration}
            run = sundials_run(equations, problem, "cvodes", options, {"x0": ca.DM(equations.start)}, times)
            ladder(f"CVODES {name}{label}", settings, run, longest)
        if w or not equations.m:
            idas(equations, w, settings, times, longest, label)


def idas(equations, w, settings, times, longest, label):
    """The same equations as a differential-algebraic system of index 1: accelerations and multipliers are its unknowns."""
    c, n, m = equations.symbols, equations.n, equations.m
    a, l = ca.SX.sym("a", n), ca.SX.sym("l", m)
    matrix, right = equations.system(w)
    y = ca.vertcat(c.q, c.qd, c.z)
    problem = {
        "x": y,
        "t": c.t,
        "z": ca.vertcat(a, l),
        "ode": ca.vertcat(c.qd, a, equations.rates),
        "alg": ca.mtimes(matrix, ca.vertcat(a, l)) - right,
    }
    at = ca.Function("at", [y, c.t], [matrix, right, equations.rates])
    matrix, right, rates = (np.array(ca.DM(x)) for x in at(equations.start, times[0]))
    first = np.linalg.solve(matrix, right).ravel()
    speeds = list(equations.start[n : 2 * n]) + list(first[:n]) + list(rates.ravel())
    options = {
        "calc_ic": False,
        # Without these two the error test fails at the start.
        "suppress_algebraic": True,
        "init_xdot": speeds,
        "jit": True,
        "compiler": "shell",
        "jit_options": {"flags": ["-O3", "-march=native"], "verbose": False},
    }
    start = {"x0": ca.DM(equations.start), "z0": ca.DM(first)}
    ladder(f"IDAS{label}", settings, sundials_run(equations, problem, "idas", options, start, times), longest)
