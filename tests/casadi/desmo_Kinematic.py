"""Desmodromic valvetrain with permanent contact, q = [theta opener s closer]; for both pitch curves stand sums of sines."""

NAME = "DesmoKinematic"
N = 4
V = 19
RATES = []


def define(ca, q, v, t, der):
    theta, opener, s, closer = (q[i] for i in range(N))
    centre, opener_pivot, opener_cam, opener_valve = ([v[i], v[i + 1]] for i in (0, 2, 4, 6))
    sense, speed, begin = v[8], v[9], v[10]
    closer_pivot, closer_cam, closer_valve = ([v[i], v[i + 1]] for i in (11, 13, 15))

    def carried(pivot, angle, arm):
        c, sn = ca.cos(angle), ca.sin(angle)
        return [pivot[0] + c * arm[0] - sn * arm[1], pivot[1] + sn * arm[0] + c * arm[1]]

    # The stand-ins of both functions and their derivatives by hand.
    def opening(x):
        a, b, c = x + 0.3, 2 * x + 1.1, 3 * x + 1.9
        value = 0.75 * ca.sin(a) - 0.5 * ca.sin(b) + 0.25 * ca.sin(c)
        return value, 0.75 * ca.cos(a) - ca.cos(b) + 0.75 * ca.cos(c)

    def shutting(x):
        a, b, c = 1.125 * x + 0.75, 2.125 * x + 0.75, 2.875 * x + 2.15
        value = 0.75 * ca.sin(a) - 0.5 * ca.sin(b) + 0.25 * ca.sin(c)
        return value, 0.84375 * ca.cos(a) - 1.0625 * ca.cos(b) + 0.71875 * ca.cos(c)

    def on_cam(curve, pad, radius):
        x, y = pad[0] - centre[0], pad[1] - centre[1]
        r = ca.sqrt(x * x + y * y)
        polar, slope = curve(ca.atan2(y, x) - sense * theta)
        # Gradient of r - R: along the radius 1, across it -R'/r.
        tilt = slope / r
        length = ca.sqrt(1 + tilt * tilt)
        normal = [(x / r + tilt * y / r) / length, (y / r - tilt * x / r) / length]
        return r - polar, [pad[0] - radius * normal[0], pad[1] - radius * normal[1]]

    a, b = carried(opener_pivot, opener, opener_cam), carried(opener_pivot, opener, opener_valve)
    d, e = carried(closer_pivot, closer, closer_cam), carried(closer_pivot, closer, closer_valve)
    opens, opener_touch = on_cam(opening, a, v[17])
    closes, closer_touch = on_cam(shutting, d, v[18])
    # Ways of the valve's pads downwards.
    down = opener_pivot[1] + opener_valve[1] - b[1]
    fork = closer_pivot[1] + closer_valve[1] - e[1]
    rows = [theta - begin - speed * t, opens, closes, s - down]
    zero = ca.SX(0)
    outputs = [fork - down, s, *centre, *opener_pivot, *a, *b, zero, -s, zero, -s - 0.04]
    outputs += [*closer_pivot, *d, *e, *opener_touch, *closer_touch, sense * theta]
    return rows, [(each, 2) for each in outputs]
