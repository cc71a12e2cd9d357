"""Values of functions in 60 digits, as sums of two numbers of 53 bits: `python values.py > values.txt` with mpmath 1.3."""
import random
from mpmath import mp, mpf

mp.dps = 60
random.seed(18)

RANGES = {
    "sin": (-1e4, 1e4), "cos": (-1e4, 1e4), "tan": (-9, 9), "exp": (-700, 700), "ln": (1e-300, 1e300), "sqrt": (1e-3, 1e6),
    "asin": (-1, 1), "acos": (-1, 1), "atan": (-50, 50), "sinh": (-30, 30), "cosh": (-30, 30), "tanh": (-3, 3),
    "asinh": (-1e6, 1e6), "acosh": (1, 1e6), "atanh": (-1, 1),
}
SMALL = {"sin", "tan", "exp", "asin", "atan", "sinh", "tanh", "asinh", "atanh"}


def parts(value):
    high = float(value)
    return f"{high!r} {float(value - mpf(high))!r}"


for name, (low, high) in RANGES.items():
    points = [random.uniform(low, high) for _ in range(8)]
    if low > 0:
        points = [10 ** random.uniform(mp.log10(low), mp.log10(high)) for _ in range(8)]
    if name in SMALL:
        points += [10.0 ** -random.uniform(0, 12) for _ in range(6)]
    if name == "acosh":
        points += [1 + 10.0 ** -random.uniform(0, 12) for _ in range(6)]
    for x in map(float, points):
        rest = x * 2.0**-54 * random.uniform(-1, 1)
        if not (low <= x + rest <= high):
            rest = 0.0
        value = getattr(mp, name)(mpf(x) + mpf(rest))
        print(name, repr(x), repr(rest), parts(value))
for _ in range(12):
    x, y = random.uniform(-3, 3), random.uniform(-3, 3)
    print("atan2", repr(y), repr(x), parts(mp.atan2(mpf(y), mpf(x))))
    print("hypot", repr(y), repr(x), parts(mp.hypot(mpf(y), mpf(x))))
    print("powf", repr(abs(x)), repr(y), parts(mpf(abs(x)) ** mpf(y)))
    print("div", repr(x), repr(y), parts(mpf(x) / mpf(y)))
print("powf", "-1.1", "3.0", parts(mpf(-1.1) ** 3))
print("powf", "1.7", "-900.0", parts(mpf(1.7) ** -900))
