"""Right-hand sides that SciPy's Radau takes, and true errors, for the problems of `d15_stiff_motions.rs`.

Run by `python scipy_radau.py > data/scipy_radau.csv` with NumPy, SciPy and SymPy. Each problem is written here from its source,
in minimal coordinates where the text of the test has rows. References are runs of another method (LSODA or DOP853) at tolerances
near rounding, and Radau at 1e-12; both must agree to the digits that the test asks for. The line of a problem's reference has the
method `reference` and how far the two runs are apart as its error. `nfev` is what `solve_ivp` returns; it leaves out the
evaluations for its numerical Jacobians.
"""

import sys

import numpy as np
import scipy
import sympy
from scipy.integrate import solve_ivp

G = 9.81


def van_der_pol():
    def rhs(t, y):
        return [y[1], ((1 - y[0] ** 2) * y[1] - y[0]) * 1e6]

    return rhs, [2.0, -0.66], 2.0, [0], "Radau"


def oscillator(smooth):
    """A block that a spring pulls to and fro over rough ground: it sticks at each return."""
    m, k, mu, a, omega = 1.0, 100.0, 0.3, 0.1, 5.0

    def rhs(t, y):
        pull = k * (a * np.sin(omega * t) - y[0])
        return [y[1], (pull - mu * m * G * np.tanh(y[1] / smooth)) / m]

    return rhs, [0.0, 0.0], 5.0, [0], "LSODA"


def belt(smooth):
    """A block on a moving belt, held by a spring: it is taken along, slides, and is caught again."""
    m, k, mu, v = 1.0, 100.0, 0.3, 0.2

    def rhs(t, y):
        return [y[1], (-k * y[0] - mu * m * G * np.tanh((y[1] - v) / smooth)) / m]

    return rhs, [0.05, 0.0], 3.0, [0], "LSODA"


def lagrange(q, v, kinetic, potential, force):
    """q'' = f(q, v) of Lagrange's equations with generalized forces."""
    momenta = [sympy.diff(kinetic, x) for x in v]
    mass = sympy.Matrix([[sympy.diff(p, x) for x in v] for p in momenta])
    gyro = [sum(sympy.diff(p, x) * w for x, w in zip(q, v)) for p in momenta]
    right = [
        sympy.diff(kinetic, x) - sympy.diff(potential, x) + f - g for x, f, g in zip(q, force, gyro)
    ]
    function = sympy.lambdify([q, v], [mass, right], cse=True)
    n = len(q)

    def rhs(t, y):
        mass, right = function(y[:n], y[n:])
        return np.concatenate([y[n:], np.linalg.solve(np.array(mass, float), np.array(right, float))])

    return rhs


def governor():
    """IFToMM benchmark A05 in the angle of the shaft, the height of the slider and the angles of both rods below the level."""
    rho, ball, k, c, l0, omega = 3000.0, 5.0, 8e5, 4e4, 0.5, 2 * np.pi
    L, A, B, H = 1.0, 0.01, 0.1, 0.05
    phi, s, b1, b2, dphi, ds, d1, d2 = sympy.symbols("phi s b1 b2 dphi ds d1 d2")
    rod, slider = rho * L * A**2, rho * B**3
    thin, long, cube = rod * A**2 / 6, rod * (L**2 + A**2) / 12, slider * B**2 / 6
    kinetic = thin * dphi**2 / 2 + slider * ds**2 / 2 + cube * dphi**2 / 2
    potential = slider * G * s
    force = [0, 0, 0, 0]
    for index, (b, db) in enumerate([(b1, d1), (b2, d2)]):
        for mass, reach in [(rod, L / 2), (ball, L)]:
            radius = H + reach * sympy.cos(b)
            kinetic += mass * ((reach * db) ** 2 + (radius * dphi) ** 2) / 2
            potential += mass * G * (L - reach * sympy.sin(b))
        turning = thin * sympy.sin(b) ** 2 + long * sympy.cos(b) ** 2
        kinetic += (turning * dphi**2 + long * db**2) / 2
        length = sympy.sqrt((L / 2 * sympy.cos(b)) ** 2 + (L - L / 2 * sympy.sin(b) - s) ** 2)
        potential += k * (length - l0) ** 2 / 2
        along_s, along_b = sympy.diff(length, s), sympy.diff(length, b)
        damper = -c * (along_s * ds + along_b * db)
        force[1] += damper * along_s
        force[2 + index] += damper * along_b
    rhs = lagrange([phi, s, b1, b2], [dphi, ds, d1, d2], kinetic, potential, force)
    alpha = np.pi / 6
    return rhs, [0, 0.5, alpha, alpha, omega, 0, 0, 0], 2.0, [1], "LSODA"


def andrews():
    """IVP test set, in the index 1: accelerations and multipliers of all seven angles."""
    m = [0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498]
    inertia = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5]
    xa, ya, xb, yb, xc, yc = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
    c0, l0, mom = 4530, 0.07785, 0.033
    d, da, e, ea, rr, ra, ss, sa = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092, 0.035, 0.01874
    sb, sc, sd, ta, tb, u, ua, ub = 0.01043, 0.018, 0.02, 0.02308, 0.00916, 0.04, 0.01228, 0.00449
    zf, zt, fa = 0.02, 0.04, 0.01421
    q = list(sympy.symbols("b T g P de O ep"))
    v = list(sympy.symbols("vb vT vg vP vde vO vep"))
    b, T, g, P, de, O, ep = q
    sin, cos = sympy.sin, sympy.cos
    centres = [
        (ra * cos(b), ra * sin(b), b),
        (rr * cos(b) - da * cos(b + T), rr * sin(b) - da * sin(b + T), b + T),
        (xb + sa * sin(g) + sb * cos(g), yb - sa * cos(g) + sb * sin(g), g),
        (xa + zt * cos(de) + (e - ea) * sin(P + de), ya + zt * sin(de) - (e - ea) * cos(P + de), P + de),
        (xa + ta * cos(de) - tb * sin(de), ya + ta * sin(de) + tb * cos(de), de),
        (xa + u * sin(ep) + (zf - fa) * cos(O + ep), ya - u * cos(ep) + (zf - fa) * sin(O + ep), O + ep),
        (xa + ua * sin(ep) + ub * cos(ep), ya - ua * cos(ep) + ub * sin(ep), ep),
    ]
    rate = lambda x: sum(sympy.diff(x, a) * w for a, w in zip(q, v))
    kinetic = sum(
        mass * (rate(x) ** 2 + rate(y) ** 2) / 2 + J * rate(angle) ** 2 / 2
        for mass, J, (x, y, angle) in zip(m, inertia, centres)
    )
    xd, yd = sd * cos(g) + sc * sin(g) + xb, sd * sin(g) - sc * cos(g) + yb
    length = sympy.sqrt((xd - xc) ** 2 + (yd - yc) ** 2)
    potential = c0 * (length - l0) ** 2 / 2 - mom * b
    rows = [
        rr * cos(b) - d * cos(b + T) - ss * sin(g) - xb,
        rr * sin(b) - d * sin(b + T) + ss * cos(g) - yb,
        rr * cos(b) - d * cos(b + T) - e * sin(P + de) - zt * cos(de) - xa,
        rr * sin(b) - d * sin(b + T) + e * cos(P + de) - zt * sin(de) - ya,
        rr * cos(b) - d * cos(b + T) - zf * cos(O + ep) - u * sin(ep) - xa,
        rr * sin(b) - d * sin(b + T) - zf * sin(O + ep) + u * cos(ep) - ya,
    ]
    momenta = [sympy.diff(kinetic, x) for x in v]
    mass = sympy.Matrix([[sympy.diff(p, x) for x in v] for p in momenta])
    right = [sympy.diff(kinetic, x) - sympy.diff(potential, x) - rate(p) for x, p in zip(q, momenta)]
    phi_q = sympy.Matrix([[sympy.diff(row, x) for x in q] for row in rows])
    gamma = [-rate(rate(row)) for row in rows]
    function = sympy.lambdify([q, v], [mass, right, phi_q, gamma], cse=True)

    def rhs(t, y):
        mass, right, phi_q, gamma = (np.array(x, float) for x in function(y[:7], y[7:]))
        whole = np.block([[mass, phi_q.T], [phi_q, np.zeros((6, 6))]])
        return np.concatenate([y[7:], np.linalg.solve(whole, np.concatenate([right, gamma]))[:7]])

    start = [
        -0.0617138900142764496358948458001, 0, 0.455279819163070380255912382449,
        0.222668390165885884674473185609, 0.487364979543842550225598953530,
        -0.222668390165885884674473185609, 1.23054744454982119249735015568,
    ]
    return rhs, start + [0] * 7, 0.03, [0], "DOP853"


PROBLEMS = {
    "van der Pol": van_der_pol(),
    "oscillator 1e-3": oscillator(1e-3),
    "oscillator 1e-4": oscillator(1e-4),
    "belt 1e-3": belt(1e-3),
    "belt 1e-4": belt(1e-4),
    "governor": governor(),
    "Andrews": andrews(),
}


def main():
    print(f"# SciPy {scipy.__version__}, NumPy {np.__version__}")
    print("problem,tolerance,nfev,njev,nlu,error,value")
    for name, (rhs, start, end, [index], other) in PROBLEMS.items():
        span = (0.0, end)
        exact = solve_ivp(rhs, span, start, method="Radau", rtol=1e-12, atol=1e-13)
        beside = solve_ivp(rhs, span, start, method=other, rtol=3e-13, atol=1e-14)
        reference = float(beside.y[index, -1])
        apart = abs(reference - exact.y[index, -1])
        print(f"{name},reference,{beside.nfev},,,{apart:.3e},{reference!r}", flush=True)
        for tolerance in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]:
            found = solve_ivp(rhs, span, start, method="Radau", rtol=tolerance, atol=tolerance)
            error = abs(found.y[index, -1] - reference)
            print(f"{name},{tolerance:g},{found.nfev},{found.njev},{found.nlu},{error:.3e},", flush=True)
        sys.stderr.write(name + "\n")


if __name__ == "__main__":
    main()
