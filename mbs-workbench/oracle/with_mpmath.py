"""Back end of oracle.py: 50-digit arithmetic, with a bound on what double precision may lose.

Every quantity is a `Series`: value, first and second derivative along a line through the state. The derivatives of
elementary functions are mpmath's own numerical ones, so that no formula for a derivative stands here but the product
rule and the chain rule.

An entry is a list [value, rest, bound]: value + rest is the number to 32 digits, null where it is not finite;
bound times 2**-53 is the sum of the roundings that double precision makes on the way, null where they decide on which
side of a kink the number is.
"""

import math

from mpmath import mp, mpf

# Fifty digits, and ten more for what cancels.
mp.dps = 60

# Roundings granted for each operation: so near zero, the sign is a matter of rounding.
ROUNDINGS = 64 * 2.0**-53

# What is not known: the third derivative behind the second one of a rate.
UNKNOWN = mp.nan


class Series:
    """v[k]: k-th derivative along the line; b[k]: bound on its rounding error in units of 2**-53."""

    __slots__ = ("v", "b", "torn")

    def __init__(self, v, b=None, torn=False):
        self.v = [mpf(x) for x in v]
        self.b = size(self.v) if b is None else b
        self.torn = torn

    def __neg__(self):
        return Series([-x for x in self.v], self.b, self.torn)

    def __add__(self, other):
        return self.plus(other, 1)

    def __sub__(self, other):
        return self.plus(other, -1)

    def plus(self, other, sign):
        v = [x + sign * y for x, y in zip(self.v, other.v)]
        b = [x + y + z for x, y, z in zip(self.b, other.b, size(v))]
        return Series(v, b, self.torn or other.torn)

    def __mul__(self, other):
        (x0, x1, x2), (y0, y1, y2) = self.v, other.v
        x, y, p, q = size(self.v), size(other.v), self.b, other.b

        def term(i, j):
            return p[i] * y[j] + x[i] * q[j] + x[i] * y[j]

        b = [
            2 * term(0, 0),
            2 * (term(1, 0) + term(0, 1)),
            2 * (term(2, 0) + 2 * term(1, 1) + term(0, 2)),
        ]
        return Series([x0 * y0, x1 * y0 + x0 * y1, x2 * y0 + 2 * x1 * y1 + x0 * y2], b, self.torn or other.torn)

    def __truediv__(self, other):
        return self * other.of(("inverse",), lambda x: 1 / x)

    def __pow__(self, other):
        n = other.v[0]
        if other.v[1] != 0 or other.v[2] != 0:
            return function("exp")(other * function("log")(self))
        power = self.of(("power", n._mpf_), lambda x: mp.power(x, n))
        # A power may be computed by repeated products, one rounding each.
        power.b = [bound * (abs(float(n)) + 1) for bound in power.b]
        return power

    def of(self, key, f):
        """f of this series by the chain rule; `key` tells f from other functions."""
        x0, x1, x2 = self.v
        f0, f1, f2, f3 = derivatives(key, f, x0)
        v = [f0, f1 * x1, f2 * x1 * x1 + f1 * x2]
        s0, s1, s2, s3 = TERMS.get(key, size)([f0, f1, f2, f3])
        _, s, a = size(self.v)
        b0, b1, b2 = self.b
        b = [
            s1 * b0 + s0,
            s2 * b0 * s + s1 * b1 + (s1 + s2) * s,
            s3 * b0 * s * s
            + 2 * s2 * s * b1
            + s2 * b0 * a
            + s1 * b2
            + (s2 + s3) * s * s
            + (s1 + s2) * a,
        ]
        return Series(v, [2 * bound for bound in b], self.torn)

    def signed(self):
        """Whether rounding decides on the sign."""
        return self.torn or abs(self.v[0]) <= ROUNDINGS * self.b[0]

    def with_torn(self, torn):
        return Series(self.v, self.b, torn)

    def rate(self):
        """The derivative along the line, as a series one order shorter."""
        return Series([*self.v[1:], UNKNOWN], [*self.b[1:], float("nan")], self.torn)


def size(numbers):
    return [abs(float(x)) for x in numbers]


def terms_of_tanh(derivatives):
    """The slope of tanh is emitted as 1 - tanh²: where tanh saturates, it has the rounding of 1."""
    t = abs(float(derivatives[0]))
    slope = 1 + t * t
    return [t, slope, 2 * t * slope, (2 * slope + 4 * t * t) * slope]


# Absolute values that are summed up in a function and its derivatives, where they are more than the results'.
TERMS = {("tanh",): terms_of_tanh}


# Derivatives by function and place: at one state many lines pass through the same values.
KNOWN = {}


def derivatives(key, f, x):
    """f and its first three derivatives at x, not a number where f has no real value."""
    place = (*key, x._mpf_)
    if place not in KNOWN:
        try:
            found = [mp.re(d) if mp.im(d) == 0 else UNKNOWN for d in mp.diffs(f, x, 3)]
        except (ValueError, ZeroDivisionError):
            found = [UNKNOWN] * 4
        KNOWN[place] = found
    return KNOWN[place]


def function(name):
    f = getattr(mp, name)
    return lambda x: x.of((name,), f)


class Arithmetic:
    """The functions of a definition, in the place of the module casadi."""

    sqrt, exp, log, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, asinh, acosh, atanh = (
        staticmethod(function(name))
        for name in "sqrt exp log sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh".split()
    )

    @staticmethod
    def SX(number):
        return Series([number, 0, 0])

    @staticmethod
    def fabs(x):
        return (-x if x.v[0] < 0 else x).with_torn(x.signed())

    @staticmethod
    def sign(x):
        return Series([mp.sign(x.v[0]), 0, 0], torn=x.signed())

    @staticmethod
    def fmin(x, y):
        return (x if x.v[0] < y.v[0] else y).with_torn((x - y).signed())

    @staticmethod
    def fmax(x, y):
        return (y if x.v[0] < y.v[0] else x).with_torn((x - y).signed())

    @staticmethod
    def hypot(x, y):
        return Arithmetic.sqrt(x * x + y * y)

    @staticmethod
    def atan2(y, x):
        # Either quotient turns as the angle does; the smaller one is finite.
        steep = abs(y.v[0]) > abs(x.v[0])
        angle = -Arithmetic.atan(x / y) if steep else Arithmetic.atan(y / x)
        angle.v[0] = mp.atan2(y.v[0], x.v[0])
        angle.b[0] += abs(float(angle.v[0]))
        return angle


class Slopes(Arithmetic):
    """The functions of a definition along one coordinate: of each gain, how its expression and the rows change."""

    def __init__(self):
        self.found = []

    def gain(self, e, rows, _row, _sign):
        self.found.append([(s.v[1], s.b[1]) for s in (e, *rows)])
        return Series([UNKNOWN] * 3)


class Solved(Arithmetic):
    """The functions of a definition where the slopes along each coordinate are known."""

    def __init__(self, slopes):
        self.calls = iter(list(zip(*(along.found for along in slopes))))

    def gain(self, _e, _rows, row, sign):
        value, bound = motion(next(self.calls), row, sign)
        return Series([value, UNKNOWN, UNKNOWN], [bound, float("nan"), float("nan")])


def motion(slopes, row, sign):
    """g . x with J x = sign e_row and a bound on its rounding; slopes are those of g and of J's rows, by coordinate."""
    n = len(slopes)
    along = mp.matrix([slope[0][0] for slope in slopes])
    jacobian = mp.matrix([[slope[1 + i][0] for slope in slopes] for i in range(n)])
    unit = mp.matrix(n, 1)
    unit[row] = sign
    try:
        x, y = mp.lu_solve(jacobian, unit), mp.lu_solve(jacobian.T, along)
    except ZeroDivisionError:
        return UNKNOWN, float("nan")
    # A solution by elimination has the rounding of n products with each entry beside that of the entry.
    entries = [
        (abs(y[i]), slopes[j][1 + i][1] + n * abs(jacobian[i, j]), abs(x[j])) for i in range(n) for j in range(n)
    ]
    terms = [(slope[0][1] + n * abs(slope[0][0])) * abs(x[j]) for j, slope in enumerate(slopes)]
    bound = sum(terms) + sum(left * entry * right for left, entry, right in entries)
    return (along.T * x)[0], float(bound)


class Line:
    """How the leaves move: time and inputs, coordinates with qd and qdd, or one coordinate alone at rate 1."""

    def __init__(self, definition, state, time=False, velocity=False, acceleration=False, axis=None):
        self.definition = definition
        still = [0] * definition.N
        rates = state["qd"] if velocity else [int(i == axis) for i in range(definition.N)]
        self.q = [Series(x) for x in zip(state["q"], rates, state["qdd"] if acceleration else still)]
        self.t = Series([state["t"], int(time), 0])
        v = state["v"]
        self.v = [Series([x, 0, 0]) for x in v]
        if time:
            for value, rate, acceleration in definition.RATES:
                self.v[value] = Series([v[value], v[rate], v[acceleration]])

    def values(self, words):
        """Residuals, and outputs with the number of their derivatives."""
        return self.definition.define(words, self.q, self.v, self.t, Series.rate)


def entry(v, b, torn):
    """A number as JSON can hold it."""
    if not mp.isfinite(v):
        return [None, None, None if torn else 0.0]
    value = float(v)
    bound = b if math.isfinite(b) else 0.0
    return [value, float(v - value), None if torn else bound]


def part(series, k, sign=1):
    return [entry(sign * s.v[k], s.b[k], s.torn) for s in series]


def functions(definition, state):
    """All functions at one state."""
    KNOWN.clear()
    slopes = [Slopes() for _ in range(definition.N)]
    columns = [part(Line(definition, state, axis=i).values(along)[0], 1) for i, along in enumerate(slopes)]
    time, _ = Line(definition, state, time=True).values(Solved(slopes))
    velocity, _ = Line(definition, state, velocity=True).values(Solved(slopes))
    both, _ = Line(definition, state, time=True, velocity=True).values(Solved(slopes))
    _, outs = Line(definition, state, time=True, velocity=True, acceleration=True).values(Solved(slopes))
    # By polarisation: twice the mixed derivative is what the joint motion has beyond its parts.
    mixed = [
        entry((j.v[2] - m.v[2] - s.v[2]) / 2, j.b[2] + m.b[2] + s.b[2], j.torn)
        for j, m, s in zip(both, velocity, time)
    ]

    def derivative(k):
        return [part([e], k)[0] if order >= k else None for e, order in outs]

    return {
        "phi": part(time, 0),
        "phi_q": [column[row] for row in range(len(time)) for column in columns],
        "phi_t": part(time, 1),
        "phi_tt": part(time, 2),
        "phi_qt_qd": mixed,
        "gamma": part(both, 2, -1),
        "out": derivative(0),
        "out_d": derivative(1),
        "out_dd": derivative(2),
    }


def evaluate(definition, states):
    found = [functions(definition, state) for state in states]
    return {name: [values[name] for values in found] for name in (found[0] if found else [])}
