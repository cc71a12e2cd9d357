"""The falling slider-crank: crank and rod as a chain of hinges, the piston on a slide, for `mbs cost slider_crank_mass:Released --peers`."""


def tree(p, q, qd):
    r, length, offset = p["r"], p["L"], p["offset"]
    crank, rod, piston = p["mass.0"], p["mass.1"], p["mass.2"]
    (theta, phi, x), (theta_d, phi_d, x_d) = q, qd
    bodies = [
        {
            "parent": None, "at": (0, 0), "joint": "hinge", "q": theta, "v": theta_d,
            "mass": crank, "com": (r / 2, 0), "inertia": crank * r**2 / 12,
        },
        {
            "parent": 0, "at": (r, 0), "joint": "hinge", "q": phi - theta, "v": phi_d - theta_d,
            "mass": rod, "com": (length / 2, 0), "inertia": rod * length**2 / 12,
        },
        {
            "parent": None, "at": (0, offset), "joint": "slide", "q": x, "v": x_d,
            "mass": piston, "com": (0, 0), "inertia": 0.0,
        },
    ]
    loops = [(1, (length, 0), 2, (0, 0))]
    return {"gravity": (0, -p["g"]), "bodies": bodies, "loops": loops, "torques": [(0, p["tau"])]}


def coordinates(p, place, angle):
    return angle(0), angle(1), place(2, (0, 0))[0]
