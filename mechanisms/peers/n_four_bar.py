"""N four-bars in a row: uprights on hinges, each with a coupler that closes a loop with the next, for `mbs cost n_four_bar --peers`."""

import math


def tree(p, q, qd):
    m, length = p["m"], p["L"]
    rod = {"joint": "hinge", "mass": m, "com": (length / 2, 0), "inertia": m * length**2 / 12}
    turns, rates = [], []

    def turning(x, y, x_d, y_d):
        return math.atan2(y, x), (x * y_d - y * x_d) / length**2

    count = len(q) // 2
    for i in range(count):
        turn, rate = turning(q[2 * i] - i * length, q[2 * i + 1], qd[2 * i], qd[2 * i + 1])
        turns.append(turn)
        rates.append(rate)
    bodies = [rod | {"parent": None, "at": (i * length, 0), "q": turns[i], "v": rates[i]} for i in range(count)]
    loops = []
    for i in range(count - 1):
        own, other = 2 * i, 2 * i + 2
        turn, rate = turning(*(q[other + k] - q[own + k] for k in (0, 1)), *(qd[other + k] - qd[own + k] for k in (0, 1)))
        loops.append((len(bodies), (length, 0), i + 1, (length, 0)))
        bodies.append(rod | {"parent": i, "at": (length, 0), "q": turn - turns[i], "v": rate - rates[i]})
    return {"gravity": (0, -p["g"]), "bodies": bodies, "loops": loops}


def coordinates(p, place, angle):
    count = (angle.count + 1) // 2
    return [component for i in range(count) for component in place(i, (p["L"], 0))]
