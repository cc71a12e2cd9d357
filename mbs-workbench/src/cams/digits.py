"""Laws and profiles in 60 digits, for the tests of cams: `python digits.py > digits.txt` with mpmath 1.3.

None of it shares code with the library. Laws are typed from textbooks, those of modified sine and trapezoid by integrating their
acceleration. Points are complex numbers; derivatives over the cam angle are differences of mpmath, which carry the digits that they lose.
A value is a sum of two numbers of 53 bits, 32 digits of the 60.

    law NAME theta s v a j                  three derivatives over the cam angle (m, rad)
    place FOLLOWER SENSE theta VALUE…       in the order of `place` below
"""
from mpmath import mp, mpf, mpc, matrix

mp.dps = 60
I = mpc(0, 1)
PI = mp.pi

# ---- laws: functions of the cam angle within one turn


def even(exponents, height, duration):
    half = mpf(duration) / 2
    # Derivatives 0 to n - 1 vanish at x = 1.
    n = len(exponents)
    rows, right = matrix(n, n), matrix(n, 1)
    for order in range(n):
        for k, p in enumerate(exponents):
            rows[order, k] = mp.ff(p, order)
        right[order] = -1 if order == 0 else 0
    c = mp.lu_solve(rows, right)

    def law(theta):
        x = abs(theta) / half
        return mpf(0) if x >= 1 else mpf(height) * (1 + sum(c[k] * x**p for k, p in enumerate(exponents)))

    return law


def from_acceleration(pieces):
    """Shares of a rise whose acceleration is piecewise A cos(w x + f) + B, scaled to the height 1: (end, A, w, f, B)."""
    found, v, s, begin = [], mpf(0), mpf(0), mpf(0)
    for end, a, w, f, b in pieces:
        at = (lambda a, w, f, b, begin, v, s: lambda x: (
            s + (v - a * mp.sin(w * begin + f) / w) * (x - begin)
            - a * (mp.cos(w * x + f) - mp.cos(w * begin + f)) / w**2 + b * (x - begin) ** 2 / 2)
              )(a, w, f, b, begin, v, s)
        slope = (lambda a, w, f, b, begin, v: lambda x: (
            v + a * (mp.sin(w * x + f) - mp.sin(w * begin + f)) / w + b * (x - begin)))(a, w, f, b, begin, v)
        found.append((end, at))
        s, v, begin = at(end), slope(end), end
    height = s

    def shape(x):
        if x <= 0:
            return mpf(0)
        if x >= 1:
            return mpf(1)
        return next(at for end, at in found if x < end)(x) / height

    return shape


def even_velocity(x):
    """The velocity rises by a 3-4-5 polynomial over a quarter and falls as its mirror image."""
    def begun(u):
        w = 4 * u
        blend = lambda w: (5 * w**4 / 2 - 3 * w**5 + w**6) / 4
        return blend(w) if w < 1 else blend(mpf(1)) + u - mpf(1) / 4

    whole = 2 * begun(mpf(1) / 2)
    return (begun(x) if 2 * x < 1 else whole - begun(1 - x)) / whole


EIGHTH = mpf(1) / 8
SHAPES = {
    "345": lambda x: 10 * x**3 - 15 * x**4 + 6 * x**5,
    "4567": lambda x: 35 * x**4 - 84 * x**5 + 70 * x**6 - 20 * x**7,
    "cycloid": lambda x: x - mp.sin(2 * PI * x) / (2 * PI),
    "harmonic": lambda x: (1 - mp.cos(PI * x)) / 2,
    # Neklutin's: sine of a quarter, then of three quarters of a longer wave, then of a quarter.
    "modified-sine": from_acceleration([
        (EIGHTH, 1, 4 * PI, -PI / 2, 0),
        (7 * EIGHTH, 1, 4 * PI / 3, -PI / 6, 0),
        (mpf(1), 1, 4 * PI, -PI / 2, 0),
    ]),
    "modified-trapezoid": from_acceleration([
        (EIGHTH, 1, 4 * PI, -PI / 2, 0),
        (3 * EIGHTH, 0, 1, 0, 1),
        (5 * EIGHTH, 1, 4 * PI, -3 * PI / 2, 0),
        (7 * EIGHTH, 0, 1, 0, -1),
        (mpf(1), 1, 4 * PI, -PI / 2, 0),
    ]),
    "constant-velocity": even_velocity,
}


def flanks(name, height, rise, dwell, back):
    shape = SHAPES[name]
    height, rise, dwell, back = map(mpf, (height, rise, dwell, back))

    def law(theta):
        up = 0 if theta <= 0 else 1 if theta >= rise else shape(theta / rise)
        since = theta - rise - dwell
        down = 0 if since <= 0 else 1 if since >= back else shape(since / back)
        return height * (up - down)

    return law


def ramped(law, begin, end, height, duration):
    """A ramp ends its velocity within its last quarter, which lies under the law; the closing one is its mirror image."""
    height, duration = mpf(height), mpf(duration)

    def share(x):
        return 0 if x <= 0 else 1 if x >= 1 else even_velocity(x)

    def lift(theta):
        opening = share((theta - begin) / duration + mpf(3) / 4)
        return law(theta) + height * (opening - share((theta - end) / duration + mpf(1) / 4))

    return lift


def harmonics(mean, *amplitudes):
    return lambda theta: mean + sum(a * mp.cos(k * theta) + b * mp.sin(k * theta) for k, (a, b) in enumerate(amplitudes, 1))


def polydyne(law, c):
    return lambda theta: law(theta) + mpf(c) * mp.diff(law, theta, 2)


def two_quintics(begin, middle, end, lift, top):
    """Quintics on both sides of `middle`, at rest at the ends, of the height `lift` and acceleration `top` in the middle."""
    def quintic(start, stop):
        rows, right = matrix(6, 6), matrix(6, 1)
        for order in range(3):
            for row, at in ((order, start), (3 + order, stop)):
                for power in range(order, 6):
                    rows[row, power] = mp.ff(power, order) * at ** (power - order)
                right[row] = (lift, 0, top)[order] if at == middle else 0
        c = mp.lu_solve(rows, right)
        return lambda x: sum(c[power] * x**power for power in range(6))

    first, second = quintic(begin, middle), quintic(middle, end)
    return lambda theta: mpf(0) if not begin < theta < end else (first if theta < middle else second)(theta)


m = mpf
HUMP = even([2, 6, 8, 10, 12], 0.011, 2.8)
ANGLE = flanks("4567", 0.3, 1.4, 0.7, 1.75)
LINEAR = flanks("4567", 0.008, 1.5, 0.5, 1.8)
LAWS = {
    "even:2,6,8,10,12": HUMP,
    "even:2,4,6": even([2, 4, 6], 0.011, 2.8),
    **{name: flanks(name, 0.01, 1.5, 0.5, 1.8) for name in SHAPES},
    "polydyne": polydyne(even([2, 6, 8, 10, 12], 0.011, 2.8), 0.0625),
    "ramps": ramped(flanks("345", 0.01, 1.5, 0.5, 1.8), mpf(0), mpf(1.5) + mpf(0.5) + mpf(1.8), 0.00025, 0.5),
    "harmonics": harmonics(m(0.004), (m(-0.0045), m(0.0005)), (m(0.0005), m(0.00025)), (m(0), m(-0.0001))),
    "bspline": two_quintics(mpf(0), mpf(1.25), mpf(2.75), mpf(0.0078125), mpf(-0.015625)),
}

# ---- followers: pose(s) is the pad's centre, or direction and distance of a face, with the angle of the arm


def flat(base):
    return None, lambda s: (PI / 2, base + s), None


def roller(base, radius, offset):
    height = mp.sqrt((base + radius) ** 2 - offset**2)
    return radius, lambda s: offset + I * (height + s), None


def oscillating_flat(base, pivot, face, side):
    towards = mp.arg(pivot)
    rest = mp.acos((base - face) / abs(pivot))

    def pose(s):
        phi = towards + side * (rest - s)
        return phi, mp.re(mp.conj(mp.expj(phi)) * pivot) + face

    return None, pose, pivot


def oscillating_roller(base, pivot, arm, radius, side):
    apart, reach = abs(pivot), base + radius
    rest = mp.acos((apart**2 + arm**2 - reach**2) / (2 * apart * arm))
    return radius, lambda s: pivot + arm * mp.expj(mp.arg(-pivot) + side * (rest + s)), pivot


def rocker(pivot, cam_pad, radius, valve_pad):
    a, b = cam_pad - pivot, valve_pad - pivot

    def pose(s):
        # The pad on the valve falls by s: Newton's method from the rest.
        psi = mpf(0)
        for _ in range(200):
            step = (mp.im(b * mp.expj(psi)) - mp.im(b) + s) / mp.re(b * mp.expj(psi))
            psi -= step
            if abs(step) < mpf(10) ** (5 - mp.dps):
                break
        return pivot + a * mp.expj(psi)

    return radius, pose, pivot


def at(x, y):
    return mpc(mpf(x), mpf(y))


FOLLOWERS = {
    "flat": (flat(m(0.03)), LINEAR),
    "roller": (roller(m(0.025), m(0.008), m(0.006)), LINEAR),
    "oscillating-flat-left": (oscillating_flat(m(0.03), at(0.0625, 0.01), m(0.004), 1), flanks("4567", 0.1, 1.4, 0.7, 1.75)),
    "oscillating-flat-right": (oscillating_flat(m(0.03), at(0.0625, 0.01), m(0.004), -1), flanks("4567", 0.1, 1.4, 0.7, 1.75)),
    "oscillating-roller-left": (oscillating_roller(m(0.03), at(0.0625, 0.01), m(0.055), m(0.01), 1), ANGLE),
    "oscillating-roller-right": (oscillating_roller(m(0.03), at(0.0625, 0.01), m(0.055), m(0.01), -1), ANGLE),
    "opener": (rocker(at(0.019, -0.019), at(0.001, -0.02398), m(0.012), at(-0.012, -0.012)), HUMP),
    "closer": (rocker(at(0.023, -0.029), at(0.0287, -0.0006), m(0.012), at(-0.012, -0.032)), HUMP),
}


def place(follower, law, sigma, theta):
    radius, pose, pivot = follower
    back = lambda t: mp.expj(-sigma * t)
    diff = mp.diff
    if radius is not None:
        pitch = lambda t: back(t) * pose(law(t))

        def outward(t):
            rate = diff(pitch, t)
            # On the right of the way against the rotation.
            return sigma * I * rate / abs(rate)

        contour = lambda t: pitch(t) - radius * outward(t)
        first, second = diff(pitch, theta), diff(pitch, theta, 2)
        bent = sigma * mp.im(mp.conj(second) * first) / abs(first) ** 3
        of_pitch = 1 / bent
        of_contour = of_pitch - radius
        along = mpf(0)
    else:
        def outward(t):
            return back(t) * mp.expj(pose(law(t))[0])

        def offset(t):
            # Support function over the direction of its normal.
            return diff(lambda u: pose(law(u))[1], t) / diff(lambda u: pose(law(u))[0] - sigma * u, t)

        contour = lambda t: (pose(law(t))[1] + I * offset(t)) * outward(t)
        pitch = contour
        along = offset(theta)
        turned = diff(lambda u: pose(law(u))[0] - sigma * u, theta)
        of_contour = of_pitch = pose(law(theta))[1] + diff(offset, theta) / turned
    here, n = contour(theta), outward(theta)
    ahead = 1 / back(theta)
    contact, normal, centre = ahead * here, ahead * n, ahead * pitch(theta)
    lift_rate = diff(law, theta)
    if pivot is None:
        velocity, moves = I * lift_rate, I
    else:
        arm = (lambda t: mp.arg(pose(law(t)) - pivot)) if radius is not None else (lambda t: pose(law(t))[0])
        velocity = I * (contact - pivot) * diff(arm, theta)
        moves = I * ((centre if radius is not None else contact) - pivot)
    sliding = mp.re((velocity - sigma * I * contact) * mp.conj(I * normal))
    pressure = mp.atan(mp.im(mp.conj(moves) * normal) / mp.re(mp.conj(moves) * normal))
    rate = diff(contour, theta)
    r, angle = (lambda t: abs(contour(t))), (lambda t: mp.arg(contour(t) / here))
    r1, r2 = diff(r, theta), diff(r, theta, 2)
    w1, w2 = diff(angle, theta), diff(angle, theta, 2)
    polar = (r2 - r1 * w2 / w1) / w1**2
    # Line contact of steel, 800 N on 12 mm (Johnson 1985, §4.2).
    modulus = mpf(115e9)
    curved = 1 / of_contour + (0 if radius is None else 1 / radius)
    hertz = mp.sqrt(800 * modulus * curved / (PI * mpf(0.012))) if curved > 0 else mpf(0)
    pairs = [pitch(theta), here, rate, contact, centre, normal]
    return [part for point in pairs for part in (mp.re(point), mp.im(point))] + [
        of_contour, of_pitch, abs(here), polar, pressure, sliding, along, hertz]


def parts(value):
    high = float(value)
    return f"{high!r} {float(value - mpf(high))!r}"


def main():
    for name, law in LAWS.items():
        begin = -1.4 if name.startswith("even:") or name == "polydyne" else -0.375 if name == "ramps" else 0.0
        for k in range(11):
            theta = begin + 0.11 + 0.34375 * k
            values = [law(mpf(theta))] + [mp.diff(law, mpf(theta), order) for order in (1, 2, 3)]
            print("law", name, repr(theta), *map(parts, values))
    for name, (follower, law) in FOLLOWERS.items():
        begin = -1.4 if law is HUMP else 0.0
        for sense, sigma in (("ccw", 1), ("cw", -1)):
            for k in range(8):
                theta = begin - 0.2 + 0.4375 * k
                print("place", name, sense, repr(theta), *map(parts, place(follower, law, sigma, mpf(theta))))


main()
