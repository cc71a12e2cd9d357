"""Writes CasADi's C for the definitions in a directory: `python peers.py DIRECTORY`.

Each `NAME.py` there is a definition with the numbers of its variables in `VALUES`. For each it makes functions of (q, qd, t):
`NAME_all` with phi, the nonzeros of phi_q, phi_t and gamma; of (q, t): `NAME_rows` with phi, phi_q dense and phi_t; and
`NAME_gamma`. Common subexpressions are eliminated.
"""

import importlib
import os
import sys

import casadi as ca

sys.dont_write_bytecode = True


def write(name):
    definition = importlib.import_module(name)
    n = definition.N
    q, qd, t = ca.SX.sym("q", n), ca.SX.sym("qd", n), ca.SX.sym("t")

    class Words:
        def __getattr__(self, word):
            return getattr(ca, word)

    def rate(value):
        return ca.jtimes(value, q, qd) + ca.jacobian(value, t)

    rows, _ = definition.define(Words(), ca.vertsplit(q), [ca.SX(value) for value in definition.VALUES], t, rate)
    phi = ca.vertcat(*rows)
    phi_q, phi_t = ca.jacobian(phi, q), ca.densify(ca.jacobian(phi, t))
    phi_d = ca.mtimes(phi_q, qd) + phi_t
    gamma = ca.densify(-(ca.jtimes(phi_d, q, qd) + ca.jacobian(phi_d, t)))
    dense = ca.densify(phi_q)
    for suffix, arguments, results in (
        ("all", [q, qd, t], [ca.densify(phi), phi_q, phi_t, gamma]),
        ("rows", [q, t], [ca.densify(phi), dense, phi_t]),
        ("gamma", [q, qd, t], [gamma]),
    ):
        function = f"{name}_{suffix}"
        ca.Function(function, arguments, ca.cse(results)).generate(f"{function}.c", {"with_header": False})


os.chdir(sys.argv[1])
sys.path.insert(0, ".")
for file in sorted(os.listdir(".")):
    if file.endswith(".py"):
        write(file[:-3])
