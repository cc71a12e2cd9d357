"""Back end of oracle.py: CasADi's expressions, evaluated in 50-digit arithmetic with the sum of what they round.

An entry is a list [value, rest, bound] as that of with_mpmath.py; bound sums the absolute values that the expression rounds on the
way, each as it moves the result. It is null where these roundings decide on a kink or on the side of a jump.
"""

import importlib.util
import math

import casadi as ca
from mpmath import mp, mpf

mp.dps = 60

# Roundings of double precision that may decide on a side, as many as with_mpmath.py grants.
ROUNDINGS = 64 * 2.0**-53

spec = importlib.util.spec_from_file_location("with_casadi", r"""WITH_CASADI""")
with_casadi = importlib.util.module_from_spec(spec)
spec.loader.exec_module(with_casadi)

SMOOTH = {
    ca.OP_EXP: mp.exp,
    ca.OP_LOG: mp.log,
    ca.OP_SQRT: mp.sqrt,
    ca.OP_SIN: mp.sin,
    ca.OP_COS: mp.cos,
    ca.OP_TAN: mp.tan,
    ca.OP_ASIN: mp.asin,
    ca.OP_ACOS: mp.acos,
    ca.OP_ATAN: mp.atan,
    ca.OP_SINH: mp.sinh,
    ca.OP_COSH: mp.cosh,
    ca.OP_TANH: mp.tanh,
    ca.OP_ASINH: mp.asinh,
    ca.OP_ACOSH: mp.acosh,
    ca.OP_ATANH: mp.atanh,
    ca.OP_ERF: mp.erf,
    ca.OP_LOG1P: mp.log1p,
    ca.OP_EXPM1: mp.expm1,
    ca.OP_SQ: lambda x: x * x,
    ca.OP_INV: lambda x: 1 / x,
    ca.OP_POW: mp.power,
    ca.OP_CONSTPOW: mp.power,
    ca.OP_ATAN2: mp.atan2,
    ca.OP_HYPOT: mp.hypot,
}

COMPARISONS = {
    ca.OP_LT: lambda d: d < 0,
    ca.OP_LE: lambda d: d <= 0,
    ca.OP_EQ: lambda d: d == 0,
    ca.OP_NE: lambda d: d != 0,
}


class Number:
    """A value, the bound of its rounding, and whether rounding decides on it."""

    __slots__ = ("v", "b", "torn")

    def __init__(self, v, b=0.0, torn=False):
        self.v, self.b, self.torn = v, b, torn


def slope(f, values, k):
    """Derivative of f by its argument k."""
    along = lambda x: f(*values[:k], x, *values[k + 1 :])
    return abs(float(mp.re(mp.diff(along, values[k]))))


def smooth(f, arguments):
    values = [x.v for x in arguments]
    v = f(*values)
    if not isinstance(v, mpf):
        v = mp.nan
    moved = sum(slope(f, values, k) * x.b for k, x in enumerate(arguments) if x.b > 0)
    return Number(v, moved + abs(float(v)))


def near(x):
    """Whether rounding decides on the sign."""
    return abs(x.v) <= ROUNDINGS * x.b


def apply(op, x):
    if op == ca.OP_ADD or op == ca.OP_SUB:
        v = x[0].v + x[1].v if op == ca.OP_ADD else x[0].v - x[1].v
        return Number(v, x[0].b + x[1].b + abs(float(v)))
    if op == ca.OP_MUL:
        v = x[0].v * x[1].v
        return Number(v, abs(float(x[0].v)) * x[1].b + abs(float(x[1].v)) * x[0].b + abs(float(v)))
    if op == ca.OP_DIV:
        v = x[0].v / x[1].v if x[1].v != 0 else mp.nan
        return Number(v, (x[0].b + abs(float(v)) * x[1].b) / abs(float(x[1].v) or math.nan) + abs(float(v)))
    if op == ca.OP_NEG:
        return Number(-x[0].v, x[0].b)
    if op == ca.OP_TWICE:
        return Number(2 * x[0].v, 2 * x[0].b)
    if op == ca.OP_ASSIGN:
        return x[0]
    if op == ca.OP_FABS:
        return Number(abs(x[0].v), x[0].b, near(x[0]) and x[0].b > 0)
    if op == ca.OP_SIGN:
        return Number(mp.sign(x[0].v), 0.0, near(x[0]) and x[0].b > 0)
    if op in (ca.OP_FMIN, ca.OP_FMAX):
        difference = Number(x[0].v - x[1].v, x[0].b + x[1].b)
        first = (difference.v < 0) == (op == ca.OP_FMIN)
        chosen = x[0] if first else x[1]
        return Number(chosen.v, chosen.b, near(difference) and difference.b > 0)
    if op in COMPARISONS:
        difference = Number(x[0].v - x[1].v, x[0].b + x[1].b)
        return Number(mpf(COMPARISONS[op](difference.v)), 0.0, near(difference) and difference.b > 0)
    if op == ca.OP_NOT:
        return Number(mpf(x[0].v == 0))
    if op == ca.OP_AND:
        return Number(mpf(x[0].v != 0 and x[1].v != 0))
    if op == ca.OP_OR:
        return Number(mpf(x[0].v != 0 or x[1].v != 0))
    if op == ca.OP_IF_ELSE_ZERO:
        return Number(x[1].v, x[1].b) if x[0].v != 0 else Number(mpf(0))
    return smooth(SMOOTH[op], x)


def values(function, arguments):
    """Outputs of a function, entry by entry, for arguments as lists of floats."""
    work = {}
    outputs = [[None] * function.nnz_out(i) for i in range(function.n_out())]
    for k in range(function.n_instructions()):
        op = function.instruction_id(k)
        into, out_of = function.instruction_output(k), function.instruction_input(k)
        if op == ca.OP_INPUT:
            work[into[0]] = Number(mpf(arguments[out_of[0]][out_of[1]]))
        elif op == ca.OP_CONST:
            work[into[0]] = Number(mpf(function.instruction_constant(k)))
        elif op == ca.OP_OUTPUT:
            outputs[into[0]][into[1]] = work[out_of[0]]
        else:
            given = [work[i] for i in out_of]
            found = apply(op, given)
            work[into[0]] = Number(found.v, found.b, found.torn or any(x.torn for x in given))
    return outputs


def entry(x):
    if not mp.isfinite(x.v):
        return [None, None, None]
    value = float(x.v)
    return [value, float(x.v - value), None if x.torn or not math.isfinite(x.b) else x.b]


def evaluate(definition, states):
    function, names, exists = with_casadi.compiled(definition)
    rows = {name: [] for name in names}
    for state in states:
        multipliers = state["l"] or [0.0] * definition.M
        arguments = [state["q"], state["qd"], state["qdd"], [state["t"]], state["v"], state["z"], multipliers]
        for name, output in zip(names, values(function, arguments)):
            there = exists.get(name, [True] * len(output))
            rows[name].append([entry(x) if known else None for x, known in zip(output, there)])
    for name in ("resolved", "loads_resolved"):
        rows.pop(name, None)
    return rows
