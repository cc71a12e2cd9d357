"""Writes CasADi's C code for {phi, phi_q, phi_t, gamma} of the lecture's four-bar, its numbers as constants.

    python casadi_four_bar.py DEFINITION.py DIRECTORY

makes DIRECTORY/casadi_plain.c and DIRECTORY/casadi_shared.c (common subexpressions eliminated first), each with
one function of (q, qd, t). The definition is `tests/casadi/four_bar.py`.
"""

import importlib.util
import math
import os
import sys

import casadi as ca

NUMBERS = [0.20, 0.60, 0.50, 0.55, 0.35, math.pi / 6, 2 * math.pi, 1]


def main():
    definition, directory = sys.argv[1:]
    spec = importlib.util.spec_from_file_location("definition", definition)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    os.chdir(directory)

    q, qd, t = ca.SX.sym("q", module.N), ca.SX.sym("qd", module.N), ca.SX.sym("t")
    rows, _ = module.define(ca, q, NUMBERS, t, None)
    phi = ca.vertcat(*rows)
    phi_q, phi_t = ca.jacobian(phi, q), ca.densify(ca.jacobian(phi, t))
    phi_d = ca.mtimes(phi_q, qd) + phi_t
    gamma = ca.densify(-(ca.jtimes(phi_d, q, qd) + ca.jacobian(phi_d, t)))
    outputs = [phi, phi_q, phi_t, gamma]
    for name, expressions in (("casadi_plain", outputs), ("casadi_shared", ca.cse(outputs))):
        ca.Function(name, [q, qd, t], expressions).generate(f"{name}.c", {"with_header": False})
    with open("sparsity.h", "w") as header:
        column = [j for j in range(module.N) for _ in range(phi_q.sparsity().colind()[j], phi_q.sparsity().colind()[j + 1])]
        places = [5 * row + col for row, col in zip(phi_q.sparsity().row(), column)]
        header.write(f"enum {{ NONZEROS = {len(places)} }};\n")
        header.write(f"static const int PLACES[] = {{{', '.join(map(str, places))}}};\n")


if __name__ == "__main__":
    main()
