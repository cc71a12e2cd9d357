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
        self.z = ca.SX.sym("z", definition.K)
        self.l = ca.SX.sym("l", definition.M)
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


# How much shorter a column may become by what it has in common with earlier ones, for the same reason.
SHORTEST_COLUMN = 1 / 32.0

# How many times larger than a gain the terms of its solution may be: the bound of the comparison grants a few hundred
# roundings, and a solution takes a few of each term. Beyond, 50 digits judge.
LARGEST_TERMS = 32.0


class Words:
    """The functions of a definition: those of casadi, and what is solved with its Jacobian."""

    def __init__(self, q):
        self.q = q
        self.gains, self.values, self.resolved = [], [], []
        self.joints_resolved = ca.SX(1)

    def __getattr__(self, name):
        return getattr(ca, name)

    def gain(self, e, rows, row, sign):
        """de/dq x where J x = sign e_row: a symbol, until `replaced` puts the value there."""
        unit = ca.SX.zeros(len(rows), 1)
        unit[row] = sign
        jacobian, slope = ca.jacobian(ca.vertcat(*rows), self.q), ca.jacobian(ca.SX(e), self.q)
        x, y = ca.solve(jacobian, unit), ca.solve(jacobian.T, slope.T)
        value = ca.mtimes(slope, x)
        terms = ca.mtimes(ca.fabs(y).T, ca.mtimes(ca.fabs(jacobian), ca.fabs(x)))
        self.gains.append(ca.SX.sym(f"gain{len(self.gains)}"))
        self.values.append(value)
        self.resolved.append(terms <= LARGEST_TERMS * ca.fabs(value))
        return self.gains[-1]

    def pins(self, bodies, gravity, joints, acting, held, length, der):
        """Forces of joints on their first bodies: least squares of Newton's and Euler's sums by orthogonal factors,
        moments over the reference length."""
        known = ca.SX.zeros(3 * len(bodies), 1)
        for i, (mass, centre, inertia, angle) in enumerate(bodies):
            for k in range(2):
                known[3 * i + k] = mass * (der(der(centre[k])) - sum((field[k] for field in gravity), ca.SX(0)))
            if angle is not None:
                known[3 * i + 2] = inertia * der(der(angle))

        def wrench(body, force, place):
            _, centre, _, angle = bodies[body]
            arm = [place[k] - centre[k] for k in range(2)]
            moment = 0 if angle is None else arm[0] * force[1] - arm[1] * force[0]
            return ca.vertcat(force[0], force[1], moment)

        for body, value, place in acting:
            if place is None:
                known[3 * body + 2] -= value
            else:
                known[3 * body : 3 * body + 3] -= wrench(body, value, place)
        columns = []
        for place, first, second in joints:
            for force in ([1, 0], [0, 1]):
                column = ca.SX.zeros(3 * len(bodies), 1)
                for body, sign in ((first, 1), (second, -1)):
                    if body is not None:
                        column[3 * body : 3 * body + 3] += sign * wrench(body, force, place)
                columns.append(column)
        for body, component in held:
            column = ca.SX.zeros(3 * len(bodies), 1)
            column[3 * body + component] = 1
            columns.append(column)
        scale = ca.diag(ca.vertcat(*([1, 1, 1 / length] * len(bodies))))
        scaled = ca.mtimes(scale, ca.horzcat(*columns))
        # The sums are one more column: what they have along the others is exact however little orthogonal these are.
        n = len(columns)
        _, upper = ca.qr(ca.horzcat(scaled, ca.mtimes(scale, known)))
        for k in range(n):
            own = ca.fabs(upper[k, k]) >= SHORTEST_COLUMN * ca.norm_2(scaled[:, k])
            self.joints_resolved = ca.logic_and(self.joints_resolved, own)
        forces = ca.solve(upper[:n, :n], upper[:n, n])
        return [forces[i] for i in range(2 * len(joints))]

    def replaced(self, e):
        """e with the gains' values, and whether rounding leaves it as many digits as the comparison asks for."""
        used = [i for i, gain in enumerate(self.gains) if ca.depends_on(e, gain)]
        resolved = ca.SX(1)
        for i in used:
            resolved = ca.logic_and(resolved, self.resolved[i])
        if not used:
            return e, resolved
        return ca.substitute(e, column(self.gains), column(self.values)), resolved


def column(entries):
    return ca.vertcat(*entries) if entries else ca.SX(0, 1)


def rows(matrix):
    """A matrix row after row: column after column of its transpose."""
    return ca.vec(matrix.T)


def functions(c, definition):
    """All functions as dense columns, by name, and how many derivatives each output has."""
    words = Words(c.q)
    residuals, outs = definition.define(words, c.q, c.v, c.t, c.total)
    phi = column(residuals)
    if phi.shape != (definition.M, 1):
        raise ValueError(f"the definition says {definition.M} rows and gives {phi.shape[0]}")
    phi_t = c.partial(phi)
    phi_tt = c.partial(phi_t)
    phi_qt_qd = c.along(phi_t, c.q, c.qd)
    gamma = -c.along(c.along(phi, c.q, c.qd), c.q, c.qd) - 2 * phi_qt_qd - phi_tt
    out, resolved = [], []
    for e, order in outs:
        value, digits = words.replaced(ca.SX(e))
        out.append(value if order >= 0 else ca.SX(0))
        resolved.append(digits if order >= 0 else ca.SX(0))
    orders = [order for _, order in outs]
    out_d = column([c.total(e) if order > 0 else ca.SX(0) for e, order in outs])
    out_dd = column([c.total(c.total(e)) if order > 1 else ca.SX(0) for e, order in outs])
    return {
        "phi": phi,
        "phi_q": rows(ca.jacobian(phi, c.q)),
        "phi_t": phi_t,
        "phi_tt": phi_tt,
        "phi_qt_qd": phi_qt_qd,
        "gamma": gamma,
        "out": column(out),
        "resolved": column(resolved),
        "out_d": out_d,
        "out_dd": out_dd,
    }, {"out_d": [order > 0 for order in orders], "out_dd": [order > 1 for order in orders]}


def dynamics(c, definition, phi, gamma):
    """Functions of masses and forces, by Lagrange's equations: nothing but energies and works comes from the text."""
    words = Words(c.q)
    told = definition.dynamics(words, c.q, c.v, c.t, c.total, c.z, c.l)
    kinetic, potential = (sum(told[name], ca.SX(0)) for name in ["kinetic", "potential"])
    momenta = ca.jacobian(kinetic, c.qd).T
    mass = ca.jacobian(momenta, c.qd)
    # d/dt of the momenta without accelerations, less the slope of the energy.
    inertia = c.partial(momenta) + c.along(momenta, c.q, c.qd) - ca.jacobian(kinetic, c.q).T
    force = -inertia - ca.jacobian(potential, c.q).T
    powers = []
    for part in told["forces"]:
        # What the time moves of a place gives nothing to the mechanism; of a spring's end it changes what is stored.
        power = sum((value * c.along(place, c.q, c.qd) for value, place in part["work"]), ca.SX(0))
        power += c.partial(part.get("stored", ca.SX(0)))
        for value, place in part["work"]:
            force += ca.jacobian(place, c.q).T * value
        if part["rayleigh"] is not None:
            slope = ca.jacobian(part["rayleigh"], c.qd)
            force -= slope.T
            power -= ca.mtimes(slope, c.qd)
        powers.append(power)
    mass_times, rates = ca.mtimes(mass, c.qdd), column(told["rates"])
    reaction = ca.mtimes(ca.jacobian(phi, c.q).T, c.l)
    return {
        "mass": rows(mass),
        "mass_times": mass_times,
        "force": force,
        "force_q": rows(ca.jacobian(force, c.q)),
        "force_qd": rows(ca.jacobian(force, c.qd)),
        "force_lambda": rows(ca.jacobian(force, c.l)),
        "force_z": rows(ca.jacobian(force, c.z).T),
        "mass_times_q": rows(ca.jacobian(mass_times, c.q)),
        "reaction": reaction,
        "reaction_q": rows(ca.jacobian(reaction, c.q)),
        "reaction_rate": ca.jacobian(ca.dot(c.l, c.along(phi, c.q, c.qd) + c.partial(phi)), c.q).T,
        "gamma_rate": ca.dot(c.l, c.along(gamma, c.q, c.qd) + c.partial(gamma)),
        "energy": ca.vertcat(kinetic, potential),
        "powers": column(powers),
        "state_rates": rates,
        "state_rates_q": rows(ca.jacobian(rates, c.q)),
        "state_rates_qd": rows(ca.jacobian(rates, c.qd)),
        "state_rates_z": rows(ca.jacobian(rates, c.z)),
        "loads": column(told["loads"]),
        "loads_resolved": column([words.joints_resolved] * len(told["loads"])),
    }


def plain(value):
    """A number as JSON can hold it."""
    if math.isnan(value):
        return "nan"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return float(value)


def compiled(definition):
    """All functions as one of CasADi's, their names, and which derivatives exist."""
    c = Calculus(definition)
    expressions, exists = functions(c, definition)
    if hasattr(definition, "dynamics"):
        expressions |= dynamics(c, definition, expressions["phi"], expressions["gamma"])
    names = list(expressions)
    outputs = [ca.densify(expressions[name]) for name in names]
    return ca.Function("mechanism", [c.q, c.qd, c.qdd, c.t, c.v, c.z, c.l], outputs), names, exists


def evaluate(definition, states):
    function, names, exists = compiled(definition)

    def stacked(key, size):
        # Of a mechanism without masses the states have no multipliers, and nothing depends on them.
        given = [state[key] or [0.0] * size for state in states] if key == "l" else [state[key] for state in states]
        return np.array(given, dtype=float).reshape(len(states), size).T

    n = definition.N
    sizes = {"q": n, "qd": n, "qdd": n, "t": 1, "v": definition.V, "z": definition.K, "l": definition.M}
    arguments = [stacked(key, size) for key, size in sizes.items()]
    values = function.map(len(states)).call([ca.DM(a) for a in arguments])
    tables = {name: np.array(value).reshape(-1, len(states)).T for name, value in zip(names, values)}
    resolved = {"out": tables.pop("resolved"), "loads": tables.pop("loads_resolved", True)}
    result = {}
    for name, table in tables.items():
        there = np.broadcast_to(resolved.get(name, exists.get(name, True)), table.shape)
        result[name] = [
            [plain(x) if known else None for x, known in zip(row, mask)] for row, mask in zip(table, there)
        ]
    return result
