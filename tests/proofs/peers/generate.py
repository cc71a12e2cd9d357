"""Writes the C code of the peers: CasADi's and SymPy's.

    python generate.py DIRECTORY

makes, for each problem below, CasADi's function of (q, qd, t) that gives phi, the nonzeros of phi_q, phi_t and gamma
(`casadi_NAME_plain`, and `casadi_NAME_shared` with common subexpressions eliminated), SymPy's with common subexpressions
eliminated (`sympy_NAME`, nonzeros row by row), and CasADi's kinematic step from (start value, t): Newton's method to
1e-12, velocity, acceleration (`casadi_step_NAME`). What integrates motions is written by `dynamics.py`. `casadi` is a link to CasADi's own libraries.
"""

import math
import os
import sys

import casadi as ca
import sympy as sp

# The sources' directory stays as it is.
sys.dont_write_bytecode = True
import dynamics  # noqa: E402

TURN = 2 * math.pi


def four_bar(m, q, t):
    x2, y2, phi1, phi2, phi3 = q
    l1, l2, l3, l4, l5, alpha = 0.20, 0.60, 0.50, 0.55, 0.35, math.pi / 6
    return [
        x2 - l1 * m.cos(phi1) - l5 * m.cos(alpha + phi2),
        y2 - l1 * m.sin(phi1) - l5 * m.sin(alpha + phi2),
        -l1 * m.cos(phi1) - l2 * m.cos(phi2) + l3 * m.cos(phi3) + l4,
        l1 * m.sin(phi1) + l2 * m.sin(phi2) - l3 * m.sin(phi3),
        phi1 - TURN * t,
    ]


def andrews(m, q, t):
    """Andrews' squeezing mechanism, its motor driven; numbers from the IVP test set."""
    beta, theta, gamma, phi, delta, omega, epsilon = q
    x = 0.007 * m.cos(beta) - 0.028 * m.cos(beta + theta)
    y = 0.007 * m.sin(beta) - 0.028 * m.sin(beta + theta)
    xa, ya, xb, yb = -0.06934, -0.00227, -0.03635, 0.03273
    return [
        x - 0.035 * m.sin(gamma) - xb,
        y + 0.035 * m.cos(gamma) - yb,
        x - 0.02 * m.sin(phi + delta) - 0.04 * m.cos(delta) - xa,
        y + 0.02 * m.cos(phi + delta) - 0.04 * m.sin(delta) - ya,
        x - 0.02 * m.cos(omega + epsilon) - 0.04 * m.sin(epsilon) - xa,
        y - 0.02 * m.sin(omega + epsilon) + 0.04 * m.cos(epsilon) - ya,
        beta - TURN * t,
    ]


def chain(m, q, t):
    """Loops of unit bars in natural coordinates: point k is at (k + q[2 k], q[2 k + 1])."""
    points = [(q[2 * k], q[2 * k + 1]) for k in range(len(q) // 2)]
    rows = [points[0][0] - 0.5 * m.sin(TURN * t)]
    rows += [u**2 + y**2 - 1 for u, y in points]
    rows += [(1 + u - v) ** 2 + (y - z) ** 2 - 1 for (v, z), (u, y) in zip(points, points[1:])]
    return rows


PROBLEMS = {"four_bar": (four_bar, 5), "andrews": (andrews, 7), "chain": (chain, 22)}


def casadi_peer(name, define, n):
    q, qd, t = ca.SX.sym("q", n), ca.SX.sym("qd", n), ca.SX.sym("t")
    phi = ca.vertcat(*define(ca, ca.vertsplit(q), t))
    phi_q, phi_t = ca.jacobian(phi, q), ca.densify(ca.jacobian(phi, t))
    phi_d = ca.mtimes(phi_q, qd) + phi_t
    gamma = ca.densify(-(ca.jtimes(phi_d, q, qd) + ca.jacobian(phi_d, t)))
    outputs = [phi, phi_q, phi_t, gamma]
    for suffix, expressions in (("plain", outputs), ("shared", ca.cse(outputs))):
        function = f"casadi_{name}_{suffix}"
        ca.Function(function, [q, qd, t], expressions).generate(f"{function}.c", {"with_header": False})

    phi, phi_q, phi_t, gamma = ca.cse(outputs)
    jacobian = ca.Function("jacobian", [q, t], [phi_q, phi_t])
    right_side = ca.Function("right_side", [q, qd, t], [gamma])
    options = {"abstol": 1e-12, "abstolStep": 1e-300, "max_iter": 20}
    newton = ca.rootfinder("newton", "fast_newton", {"x": q, "p": t, "g": phi}, options)
    start, now = ca.MX.sym("start", n), ca.MX.sym("t")
    position = newton(x0=start, p=now)["x"]
    rows, rate = jacobian(position, now)
    velocity = ca.solve(rows, -rate, "qr")
    acceleration = ca.solve(rows, right_side(position, velocity, now), "qr")
    motion = [position, velocity, acceleration]
    write_step(f"casadi_step_{name}", [start, now], motion)
    # `ca.solve` factorizes for velocity and acceleration each; written out, one factorization serves both.
    v, r, beta, row_order, column_order = ca.qr_sparse(phi_q)

    def solved(right):
        return ca.qr_solve(right, v, r, beta, row_order, column_order, False)

    qd_solved = solved(-phi_t)
    rates = [qd_solved, solved(ca.substitute(gamma, qd, qd_solved))]
    rates = ca.Function("rates", [q, t], ca.cse(rates))
    write_step(f"casadi_factored_step_{name}", [start, now], [position, *rates(position, now)])


def write_step(name, arguments, motion):
    ca.Function(name, arguments, motion).generate(f"{name}.c", {"with_header": False})


def sympy_peer(name, define, n):
    q, qd, t = sp.symbols(f"q0:{n}"), sp.symbols(f"v0:{n}"), sp.Symbol("t")
    phi = sp.Matrix(define(sp, q, t))
    phi_q, phi_t = phi.jacobian(q), phi.diff(t)
    phi_d = phi_q * sp.Matrix(qd) + phi_t
    gamma = -(phi_d.jacobian(q) * sp.Matrix(qd) + phi_d.diff(t))
    outputs = [*phi, *(entry for entry in phi_q if entry != 0), *phi_t, *gamma]
    shared, reduced = sp.cse(outputs, symbols=sp.numbered_symbols("w"))
    names = {symbol: sp.Symbol(f"q[{k}]") for k, symbol in enumerate(q)}
    names |= {symbol: sp.Symbol(f"qd[{k}]") for k, symbol in enumerate(qd)}
    
    def code(expression):
        return sp.ccode(expression.xreplace(names))

    with open(f"sympy_{name}.c", "w") as file:
        file.write("#include <math.h>\n")
        file.write(f"void sympy_{name}(const double *q, const double *qd, double t, double *out) {{\n")
        for symbol, expression in shared:
            file.write(f"    const double {symbol} = {code(expression)};\n")
        for k, expression in enumerate(reduced):
            file.write(f"    out[{k}] = {code(expression)};\n")
        file.write("}\n")


def main():
    os.makedirs(sys.argv[1], exist_ok=True)
    os.chdir(sys.argv[1])
    os.symlink(os.path.dirname(ca.__file__), "casadi")
    dynamics.write()
    for name, (define, n) in PROBLEMS.items():
        casadi_peer(name, define, n)
        sympy_peer(name, define, n)


if __name__ == "__main__":
    main()
