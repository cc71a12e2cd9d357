"""Numbers of the cases that no closed form gives: reduced equations by hand, DOP853 and Radau of SciPy at 1e-13, mpmath.

`pip install scipy mpmath`, then `python references.py`. None of it shares code with the library.
"""

import mpmath as mp
import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

G = 9.81
np.set_printoptions(precision=17)


def integrated(f, y, until, method="DOP853", **options):
    found = solve_ivp(f, (0.0, until), y, method=method, rtol=1e-13, atol=1e-14, **options)
    return found.y[:, -1]


def parallelogram():
    """I φ̈ = −S g cos φ: the coupler does not turn."""
    r = 0.1
    stiffness = G * 3 * r / (2 * (1e-3 + r * r / 4) + 2 * r * r)
    return integrated(lambda t, y: [y[1], -stiffness * np.cos(y[0])], [np.pi / 2, -20.0], 2.0)[0]


def light_cart():
    """Angle of the bob and place of the cart after 1.2 s: the time from rest is an integral over the angle."""
    mp.mp.dps = 40
    cart, bob, length, first = mp.mpf("1e-8"), mp.mpf(1), mp.mpf(1), mp.mpf(1)
    g = mp.mpf("9.81")

    def share(a):
        return bob * length**2 * (mp.sin(a) ** 2 + cart / (cart + bob) * mp.cos(a) ** 2)

    def slowness(s):
        # a = first − s², so that the integrand is smooth at the rest.
        a = first - s * s
        drop = 2 * bob * g * length * (mp.cos(a) - mp.cos(first))
        return 2 * s * mp.sqrt(share(a) / drop) if s > 0 else mp.mpf(0)

    edge = mp.mpf("1e-4")
    points = [mp.sqrt(first - a) for a in (first - mp.mpf("1e-30"), 0.5, 0.1, 0.01, edge, edge / 10, 0)]

    def time(a):
        ends = [p for p in points if p < mp.sqrt(first - a)] + [mp.sqrt(first - a)]
        return mp.quad(slowness, ends)

    quarter = time(mp.mpf(0))
    # It rises on the other side as it fell: a(quarter + τ) = −a(quarter − τ); the whole period is four quarters.
    asked = mp.mpf("0.5")
    angle = -mp.findroot(lambda a: time(a) - (2 * quarter - asked), mp.mpf("0.6"))
    place = -bob / (cart + bob) * length * (mp.sin(angle) - mp.sin(first))
    return quarter, angle, place


def stiff_and_soft():
    """Two masses of 1 kg: 10 N/m to the ground, 1e9 N/m with 2e4 N s/m between them. The matrix exponential."""
    mp.mp.dps = 40
    k, c, soft = mp.mpf("1e9"), mp.mpf("2e4"), mp.mpf(10)
    a = mp.matrix([[0, 0, 1, 0], [0, 0, 0, 1], [-soft - k, k, -c, c], [k, -k, c, -c]])
    x = mp.matrix([mp.mpf("0.1"), mp.mpf("0.1"), 0, 0])
    values, vectors = mp.eig(a)
    parts = mp.lu_solve(vectors, x)
    y = vectors * mp.matrix([parts[i] * mp.exp(values[i] * 1) for i in range(4)])
    return mp.re(y[0]), mp.re(y[1])


def massless_rod():
    """Crank of 2e-3 kg m² and slider of 0.4 kg with a rod without mass: energy gives the time of an angle."""
    r, rod, inertia, mass = 0.05, 0.15, 2e-3, 0.4

    def effective(a):
        sine = r * np.sin(a) / rod
        rate = -r * np.sin(a) - r * np.cos(a) * sine / np.sqrt(1 - sine**2)
        return inertia + mass * rate**2

    energy = effective(0.3) * 40.0**2
    time = lambda a: quad(lambda u: np.sqrt(effective(u) / energy), 0.3, a, epsabs=1e-15, epsrel=1e-14, limit=400)[0]
    return brentq(lambda a: time(a) - 0.3, 8.0, 16.0, xtol=1e-15, rtol=1e-15)


def sleeping_top():
    """Height of the axis u = cos θ after 1 s of a top that passes the vertical, from θ = 0.5 rad, θ̇ = −6 rad/s.

    u̇² = (α − β u)(1 − u²) − (b − d u)², b = p_z/A, d = p_c/A, β = 2 m g l/A, with p_z = p_c; so ü = f'(u)/2.
    """
    mass, length, a, c, spin, tilt, rate = 1.0, 0.1, 0.012, 0.002, 60.0, 0.5, -6.0
    b = d = c * spin / a
    beta, first = 2 * mass * G * length / a, np.cos(tilt)
    alpha = beta * first + rate**2 + (b - d * first) ** 2 / (1 - first**2)
    slope = lambda u: -beta * (1 - u * u) - 2 * u * (alpha - beta * u) + 2 * d * (b - d * u)
    return integrated(lambda t, y: [y[1], slope(y[0]) / 2], [first, -np.sin(tilt) * rate], 1.0)[0]


def bouncing_ball():
    """Height after 3 s of a ball of 1 kg from 0.5 m on a floor of 1e5 N/m that damps: force k p max(1 − d ġ, 0)."""
    k, damping = 1e5, 0.2
    t, y = 0.0, np.array([0.5, 0.0])
    free = lambda t, y: [y[1], -G]
    touch = lambda t, y: [y[1], -G + k * max(-y[0], 0.0) * max(1 - damping * y[1], 0.0)]
    count, is_free = 0, True
    while t < 3.0:
        event = lambda t, y: y[0]
        event.terminal, event.direction = True, -1.0 if is_free else 1.0
        f = free if is_free else touch
        found = solve_ivp(f, (t, 3.0), y, method="DOP853", rtol=1e-13, atol=1e-15, events=event, max_step=0.01 if is_free else 1e-4)
        t, y = found.t[-1], found.y[:, -1]
        if found.status == 1:
            y[0] = 0.0
            count += 1
            is_free = not is_free
    return y, count


def roof():
    """Height after 1.2 s of a ball thrown at 6.15 m/s under a roof of 1e6 N/m at 1.9 m: three closed forms."""
    mp.mp.dps = 30
    g, speed, height, k = mp.mpf("9.81"), mp.mpf("6.15"), mp.mpf("1.9"), mp.mpf("1e6")
    first = (speed - mp.sqrt(speed**2 - 2 * g * height)) / g
    v = speed - g * first
    w = mp.sqrt(k)
    # y − 1.9 = −g/w² (1 − cos w τ) + v/w sin w τ is 0 again where cot w τ/2 = g/(w v).
    back = (mp.pi - 2 * mp.atan(g / (w * v))) / w
    rest = mp.mpf("1.2") - first - back
    return height - v * rest - g * rest**2 / 2


def friction_limit():
    """Way after 2 s of a block on a slope of 30° with μ = tan 30° less 1e-4, friction smoothed over 1 mm/s."""
    slope, speed = np.pi / 6, 1e-3
    mu = np.tan(slope) - 1e-4
    f = lambda t, y: [y[1], G * (np.sin(slope) - mu * np.cos(slope) * np.tanh(y[1] / speed))]
    return integrated(f, [0.0, 0.0], 2.0, method="Radau")


def stick_slip():
    """Place of a block on a belt after 3 s: 1 kg, 100 N/m, μ = 0.3, belt 0.2 m/s, friction smoothed over 1 cm/s."""
    f = lambda t, y: [y[1], -100 * y[0] - 0.3 * G * np.tanh((y[1] - 0.2) / 1e-2)]
    return integrated(f, [0.05, 0.0], 3.0)


def drive_jump():
    """Place of a block on a spring whose other end jumps by 1 cm at 0.5 s: 1 kg, 100 N/m; a closed form."""
    return 0.01 * (1 - np.cos(10 * (2.0 - 0.5)))


def two_scales():
    """Angles of a double pendulum with masses of 1e-6 kg and 1 kg, 1 m each, after 1 s from 0.5 rad and rest."""
    m1, m2 = 1e-6, 1.0

    def f(t, y):
        a, b, u, v = y
        d = a - b
        den = m1 + m2 * np.sin(d) ** 2
        au = (-m2 * u * u * np.sin(d) * np.cos(d) + m2 * G * np.sin(b) * np.cos(d) - m2 * v * v * np.sin(d) - (m1 + m2) * G * np.sin(a)) / den
        av = (m2 * v * v * np.sin(d) * np.cos(d) + (m1 + m2) * (G * np.sin(a) * np.cos(d) + u * u * np.sin(d) - G * np.sin(b))) / den
        return [u, v, au, av]

    return integrated(f, [0.5, 0.5, 0.0, 0.0], 1.0)


if __name__ == "__main__":
    for case in (parallelogram, stiff_and_soft, massless_rod, sleeping_top, roof, friction_limit, stick_slip, two_scales, bouncing_ball, light_cart):
        print(case.__name__, case(), flush=True)
