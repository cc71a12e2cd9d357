"""Back end of oracle.py: CasADi differentiates the definition and evaluates it in double precision.

A number that is not finite is the string "nan", "inf" or "-inf".
"""

import math

import casadi as ca
import numpy as np


class Calculus:
    """Symbols of a mechanism and the derivatives along them."""

    def __init__(self, definition):
        self.q = ca.SX.sym("q", definition.N)
        self.qd = ca.SX.sym("qd", definition.N)
        self.qdd = ca.SX.sym("qdd", definition.N)
        self.t = ca.SX.sym("t")
        self.v = ca.SX.sym("v", definition.V)
        self.rates = definition.RATES

    def along(self, e, symbols, direction):
        """Directional derivative of the column e."""
        return ca.mtimes(ca.jacobian(e, symbols), direction)

    def partial(self, e):
        """Time derivative of e with the coordinates held; inputs move with their rates."""
        result = ca.jacobian(e, self.t)
        for value, rate, acceleration in self.rates:
            result += ca.jacobian(e, self.v[value]) * self.v[rate]
            result += ca.jacobian(e, self.v[rate]) * self.v[acceleration]
        return result

    def total(self, e):
        """Total time derivative of e."""
        return self.partial(e) + self.along(e, self.q, self.qd) + self.along(e, self.qd, self.qdd)


def column(entries):
    return ca.vertcat(*entries) if entries else ca.SX(0, 1)


def functions(c, definition):
    """All functions as dense columns, by name, and how many derivatives each output has."""
    rows, outs = definition.define(ca, c.q, c.v, c.t, c.total)
    phi = column(rows)
    if phi.shape != (definition.M, 1):
        raise ValueError(f"the definition says {definition.M} rows and gives {phi.shape[0]}")
    phi_t = c.partial(phi)
    phi_tt = c.partial(phi_t)
    phi_qt_qd = c.along(phi_t, c.q, c.qd)
    gamma = -c.along(c.along(phi, c.q, c.qd), c.q, c.qd) - 2 * phi_qt_qd - phi_tt
    out = column([e for e, _ in outs])
    orders = [order for _, order in outs]
    out_d = column([c.total(e) if order > 0 else ca.SX(0) for e, order in outs])
    out_dd = column([c.total(c.total(e)) if order > 1 else ca.SX(0) for e, order in outs])
    return {
        "phi": phi,
        # Column after column of the transpose is row after row of the matrix.
        "phi_q": ca.vec(ca.jacobian(phi, c.q).T),
        "phi_t": phi_t,
        "phi_tt": phi_tt,
        "phi_qt_qd": phi_qt_qd,
        "gamma": gamma,
        "out": out,
        "out_d": out_d,
        "out_dd": out_dd,
    }, {"out_d": [order > 0 for order in orders], "out_dd": [order > 1 for order in orders]}


def plain(value):
    """A number as JSON can hold it."""
    if math.isnan(value):
        return "nan"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return float(value)


def evaluate(definition, states):
    c = Calculus(definition)
    expressions, exists = functions(c, definition)
    names = list(expressions)
    outputs = [ca.densify(expressions[name]) for name in names]
    function = ca.Function("mechanism", [c.q, c.qd, c.qdd, c.t, c.v], outputs)

    def stacked(key, size):
        return np.array([state[key] for state in states], dtype=float).reshape(len(states), size).T

    n = definition.N
    arguments = [stacked("q", n), stacked("qd", n), stacked("qdd", n), stacked("t", 1), stacked("v", definition.V)]
    values = function.map(len(states)).call([ca.DM(a) for a in arguments])
    result = {}
    for name, value in zip(names, values):
        there = exists.get(name)
        table = np.array(value).reshape(-1, len(states)).T
        result[name] = [
            [plain(x) if there is None or there[i] else None for i, x in enumerate(row)] for row in table
        ]
    return result
