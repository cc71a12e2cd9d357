"""One turn of the desmodromic valvetrain at 9000/min in SciPy and in Exudyn, with the same gap and the same table of the cams.

    python peers.py PROGRAM METHOD TOLERANCE PLAY ROUNDS

PROGRAM: `scipy` with a METHOD of `solve_ivp`, or `exudyn` with the name of an explicit solver. Prints the lift at 72 places, then
the processor time (ns) of each round.
"""

import math
import sys
import time

SPEED = 9000 * math.pi / 30
SPAN = 2 * math.pi / SPEED
CENTRE, HALF, LIFT, KNOTS, LEGS = (0.012, 0.020), math.radians(80), 0.011, 720, 72
TIMES = [SPAN * leg / LEGS for leg in range(1, LEGS + 1)]
sin, cos, sqrt, atan2, floor, pi = math.sin, math.cos, math.sqrt, math.atan2, math.floor, math.pi


def law(theta):
    x = math.remainder(theta, 2 * pi) / HALF
    if abs(x) >= 1:
        return 0.0, 0.0, 0.0
    terms = [(0, 1), (2, -3), (6, 10), (8, -15), (10, 9), (12, -2)]
    s = sum(c * x**p for p, c in terms)
    s1 = sum(c * p * x ** (p - 1) for p, c in terms if p)
    s2 = sum(c * p * (p - 1) * x ** (p - 2) for p, c in terms if p)
    return LIFT * s, LIFT * s1 / HALF, LIFT * s2 / HALF**2


class Rocker:
    """Pivot, arms to the pads on cam and valve at lift 0 (m), the cam's pitch curve as a table."""

    def __init__(self, pivot, cam, valve):
        self.pivot, self.cam, self.valve = pivot, cam, valve
        base = math.atan2(*(self.pitch(0)[0].imag, self.pitch(0)[0].real))
        knots = [self.radius(k * 2 * pi / KNOTS, base) for k in range(KNOTS + 1)]
        self.table = [self.quintic(a, b) for a, b in zip(knots, knots[1:])]

    def pitch(self, theta):
        s, s1, s2 = law(theta)
        bx, by = self.valve
        length = math.hypot(bx, by)
        at = pi - math.asin((by - s) / length)
        slope = length * cos(at)
        psi = math.remainder(at - atan2(by, bx), 2 * pi)
        psi1 = -s1 / slope
        psi2 = (-s2 + length * sin(at) * psi1 * psi1) / slope
        a = complex(*self.cam) * complex(cos(psi), sin(psi))
        w = complex(*self.pivot) - complex(*CENTRE) + a
        w1, w2 = 1j * psi1 * a, (1j * psi2 - psi1**2) * a
        back = complex(cos(theta), -sin(theta))
        return back * w, back * (w1 - 1j * w), back * (w2 - 2j * w1 - w)

    def radius(self, angle, base):
        theta = base - angle
        for _ in range(30):
            z, z1, _ = self.pitch(theta)
            left = (z.conjugate() * complex(cos(angle), sin(angle)))
            step = atan2(left.imag, left.real) * abs(z) ** 2 / (z.conjugate() * z1).imag
            theta += step
            if abs(step) < 1e-15:
                break
        z, z1, z2 = self.pitch(theta)
        # log z = log r + i w, derivative by derivative.
        first = z1 / z
        second = z2 / z - first * first
        r = abs(z)
        r1, r2 = r * first.real, r * (second.real + first.real**2)
        w1, w2 = first.imag, second.imag
        return r, r1 / w1, (r2 * w1 - r1 * w2) / w1**3

    @staticmethod
    def quintic(a, b):
        h = 2 * pi / KNOTS
        d0 = b[0] - a[0] - a[1] * h - 0.5 * a[2] * h * h
        d1, d2 = (b[1] - a[1] - a[2] * h) * h, (b[2] - a[2]) * h * h
        ends = 10 * d0 - 4 * d1 + 0.5 * d2, -15 * d0 + 7 * d1 - d2, 6 * d0 - 3 * d1 + 0.5 * d2
        return (a[0], a[1] * h, 0.5 * a[2] * h * h, *ends)

    def gap(self, si, co, theta):
        """Gap of pad and cam, derivatives over the rocker's and the cam's angle."""
        ax = co * self.cam[0] - si * self.cam[1]
        ay = si * self.cam[0] + co * self.cam[1]
        x, y = self.pivot[0] - CENTRE[0] + ax, self.pivot[1] - CENTRE[1] + ay
        rr = x * x + y * y
        r = sqrt(rr)
        per = KNOTS / (2 * pi)
        u = (atan2(y, x) - theta) * per
        u -= KNOTS * floor(u / KNOTS)
        k = min(int(u), KNOTS - 1)
        c0, c1, c2, c3, c4, c5 = self.table[k]
        u -= k
        R = c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
        R1 = per * (c1 + u * (2 * c2 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5))))
        R2 = per * per * (2 * c2 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5)))
        tilt = R1 / r
        root = 1 / sqrt(1 + tilt * tilt)
        beside = (r - R) * tilt * root**3
        dr, dw = (y * ax - x * ay) / r, (x * ax + y * ay) / rr
        over = (dr - R1 * dw) * root - beside * (R2 * dw / r - R1 * dr / rr)
        return (r - R) * root, over, R1 * root + beside * R2 / r


def arm():
    x, y = CENTRE[0] - 0.035, CENTRE[1] + 0.009
    angle = atan2(y, x) - math.acos(0.5 * math.hypot(x, y) / 0.029)
    return 0.029 * cos(angle), 0.029 * sin(angle)


OPENER = Rocker((0.031, 0.001), (-0.018, -0.00498), (-0.031, 0.007))
CLOSER = Rocker((0.035, -0.009), arm(), (-0.035, -0.003))


def normal(gap, rate):
    return 5e10 * -gap * sqrt(-gap) * max(1 - 1.5 * rate, 0) if gap < 0 else 0.0


def forces(t, a, b, s, va, vb, vs, play):
    """Generalized forces on opener, closer and valve."""
    theta = -pi + SPEED * t
    sa, ca, sb, cb = sin(a), cos(a), sin(b), cos(b)
    nose, nose_q, nose_t = OPENER.gap(sa, ca, theta)
    heel, heel_q, heel_t = CLOSER.gap(sb, cb, theta)
    (ox, oy), (cx, cy) = OPENER.valve, CLOSER.valve
    opened, opened_q = oy - sa * ox - ca * oy, -ca * ox + sa * oy
    closed, closed_q = cy - sb * cx - cb * cy, -cb * cx + sb * cy
    on_opener = normal(nose, nose_q * va + nose_t * SPEED)
    tip = normal(s - opened + play * 1e-4, vs - opened_q * va)
    seat = normal(s, vs)
    on_closer = normal(heel, heel_q * vb + heel_t * SPEED)
    fork = normal(closed - s + play * 3e-5, closed_q * vb - vs)
    weight = 0.028 * 9.80665
    return (
        on_opener * nose_q - tip * opened_q,
        on_closer * heel_q + fork * closed_q - 1.2 - b,
        tip + seat - fork + weight,
    )


def scipy(method, tolerance, play):
    from scipy.integrate import solve_ivp

    def rates(t, y):
        a, b, s, va, vb, vs = y.tolist()
        qa, qb, qs = forces(t, a, b, s, va, vb, vs, play)
        return [va, vb, vs, qa / 1.3e-5, qb / 2.2e-5, qs / 0.028]

    absolute = [0.1 * tolerance] * 3 + [100 * tolerance] * 3
    found = solve_ivp(rates, (0, SPAN), [0.0] * 6, method, TIMES, rtol=tolerance, atol=absolute, first_step=1e-9)
    return found.y[2].tolist()


def exudyn(method, tolerance, play):
    import exudyn as exu
    from exudyn.itemInterface import MarkerNodeCoordinate, NodeGenericODE2, ObjectGenericODE2, SensorUserFunction
    import numpy as np

    system = exu.SystemContainer()
    mbs = system.AddSystem()
    zero = [0.0] * 3
    node = mbs.AddNode(NodeGenericODE2(numberOfODE2Coordinates=3, referenceCoordinates=zero, initialCoordinates=zero,
                                       initialCoordinates_t=zero))

    def user(mbs, t, item, q, q_t):
        return forces(t, q[0], q[1], q[2], q_t[0], q_t[1], q_t[2], play)

    mbs.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag([1.3e-5, 2.2e-5, 0.028]), forceUserFunction=user))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solutionSettings.writeSolutionToFile = False
    settings.timeIntegration.verboseMode = 0
    integration = settings.timeIntegration
    integration.explicitIntegration.computeEndOfStepAccelerations = False
    integration.automaticStepSize = method == "DOPRI5"
    integration.relativeTolerance, integration.absoluteTolerance = tolerance, 0.1 * tolerance
    lifts = []
    steps = int(tolerance) if method == "RK44" else 4
    # Leg by leg: the state at the end is that of a step.
    solver = exu.MainSolverExplicit()
    begin = 0.0
    for until in TIMES:
        integration.startTime, integration.endTime, integration.numberOfSteps = begin, until, steps
        integration.minimumStepSize = 1e-12
        if not mbs.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, method), updateInitialValues=True):
            raise SystemExit("exudyn: the solver gave up")
        begin = until
        lifts.append(float(mbs.systemData.GetODE2Coordinates()[2]))
    return lifts


def main(program, method, tolerance, play, rounds):
    times, lifts = [], []
    # The first round warms up.
    for round in range(int(rounds) + 1):
        begun = time.process_time_ns()
        lifts = {"scipy": scipy, "exudyn": exudyn}[program](method, float(tolerance), float(play))
        if round:
            times.append(time.process_time_ns() - begun)
    print(",".join(f"{lift:.15e}" for lift in lifts))
    print(",".join(map(str, times)))


main(*sys.argv[1:])
