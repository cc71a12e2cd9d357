"""Multibody programs on a mechanism that a file describes as a tree of bodies with closed loops, in the plane. Trees in space, which have
no loops, are in trees_in_space.py.

The file has

    tree(p, q, qd) -> dictionary; p: the mechanism's parameters by name, q and qd: its coordinates and velocities at the start
        gravity    (x, y), m/s^2
        bodies     list of dictionaries: `parent` (index, None: the ground), `at` (place of the joint in the parent's frame),
                   `joint` ("hinge", or "slide": along the parent's x), `q` and `v` (value and rate of the joint at the
                   start; rad or m), `mass`, `com` (centre of mass in the body's frame), `inertia` (about it)
        loops      list of (body, place, body, place): points that stay together
        springs    list of (body or None, place, body, place, stiffness, length at rest)
        torques    list of (body, torque): on the hinge of the body
    coordinates(p, place, angle) -> the mechanism's coordinates; place(body, (x, y)) is a point in the frame of the ground,
                   angle(body) the body's angle against it, angle.count the number of bodies

Settings are those that the programs' documentation recommends for closed loops.
"""

import numpy as np
import trees_in_space
from peers import ladder, tell

# Frequency of Baumgarte's stabilisation times the length of the motion: errors of the loops decay many times within it.
STABILISED = 200.0

PROGRAMS = {"mujoco": "MuJoCo", "exudyn": "Exudyn", "drake": "Drake", "pinocchio": "Pinocchio"}


class Tree:
    """A tree at its start, with what all programs need of it."""

    def __init__(self, file, question):
        self.parameters = question["parameters"]
        told = file.tree(self.parameters, question["q"], question["qd"])
        self.file, self.gravity, self.bodies = file, told["gravity"], told["bodies"]
        self.loops, self.springs, self.torques = (told.get(name, []) for name in ("loops", "springs", "torques"))
        self.times = np.array(question["times"])
        self.q0 = np.array([body["q"] for body in self.bodies], dtype=float)
        self.v0 = np.array([body["v"] for body in self.bodies], dtype=float)
        self.longest = question["longest"]
        begin = np.array(self.states(self.q0[None])[0])
        apart = np.abs(begin - question["q"])
        if not apart.max() < 1e-9 * max(1.0, np.abs(begin).max()):
            raise ValueError(f"the tree starts elsewhere: coordinate {int(apart.argmax())} differs by {apart.max():.1e}")

    @property
    def end(self):
        return float(self.times[-1] - self.times[0])

    def poses(self, q):
        """Places and angles of the bodies' frames for joint values (instants, bodies)."""
        places, angles = [], []
        for i, body in enumerate(self.bodies):
            parent, zero = body["parent"], np.zeros(len(q))
            base, turn = (np.zeros((len(q), 2)), zero) if parent is None else (places[parent], angles[parent])
            slides = body["joint"] == "slide"
            at = np.stack([body["at"][0] + (q[:, i] if slides else zero), body["at"][1] + zero], -1)
            places.append(base + rotated(turn, at))
            angles.append(turn + (zero if slides else q[:, i]))
        return places, angles

    def read(self, places, angles):
        """The mechanism's coordinates (instants, coordinates)."""
        place = lambda body, at: (places[body] + rotated(angles[body], np.asarray(at, dtype=float))).T
        angle = lambda body: angles[body]
        angle.count = len(angles)
        told = self.file.coordinates(self.parameters, place, angle)
        return np.stack([np.broadcast_to(one, len(angles[0])) for one in told], -1).tolist()

    def states(self, q):
        """The mechanism's coordinates for joint values (instants, bodies)."""
        return self.read(*self.poses(q))

    def steps(self):
        """Fixed steps that end at the instants: (label, number)."""
        parts = len(self.times) - 1
        return [(f"{parts * 2**k} steps", parts * 2**k) for k in range(14)]


def rotated(angle, vector):
    """Vectors turned by angles (instants)."""
    c, s = np.cos(angle), np.sin(angle)
    vector = np.broadcast_to(vector, (len(angle), 2))
    return np.stack([c * vector[:, 0] - s * vector[:, 1], s * vector[:, 0] + c * vector[:, 1]], -1)


def run_program(program, file, question):
    if file is None:
        reason = f"no description as a tree of bodies (a file peers/{question['name']}.py in the mechanism's crate)"
        tell(program=PROGRAMS[program], setting="", refused=f"cannot: {reason}")
        return
    if getattr(file, "SPACE", False):
        trees_in_space.run_program(program, file, question)
        return
    tree = Tree(file, question)
    {"mujoco": mujoco, "exudyn": exudyn, "drake": drake, "pinocchio": pinocchio}[program](tree, question)


def mujoco(tree, question):
    """Joints of a tree, loops by `connect` (soft; its time constant is two steps, the least that is recommended)."""
    import mujoco as mj

    def xml(h, integrator):
        words = [
            f'<mujoco><compiler angle="radian"/><option timestep="{h!r}" gravity="{tree.gravity[0]!r} {tree.gravity[1]!r} 0" '
            f'integrator="{integrator}" iterations="200" tolerance="1e-16" solver="Newton" jacobian="dense">'
            '<flag contact="disable"/></option>'
            f'<default><equality solref="{2 * h!r} 1" solimp="0.9999 0.9999 0.001"/></default><worldbody>'
        ]

        def body(i):
            own = tree.bodies[i]
            about = max(own["inertia"], 1e-12)
            # The joint's value at the start is in the frame: joints begin at 0.
            slides = own["joint"] == "slide"
            x, turn = (own["at"][0] + own["q"], 0.0) if slides else (own["at"][0], own["q"])
            words.append(f'<body name="b{i}" pos="{float(x)!r} {float(own["at"][1])!r} 0" euler="0 0 {float(turn)!r}">')
            kind = 'type="slide" axis="1 0 0"' if slides else 'type="hinge" axis="0 0 1"'
            words.append(f'<joint name="j{i}" {kind}/>')
            c = own["com"]
            words.append(f'<inertial pos="{c[0]!r} {c[1]!r} 0" mass="{own["mass"]!r}" diaginertia="{about!r} {about!r} {about!r}"/>')
            for k, (one, p, other, r, *_) in enumerate(tree.springs):
                for end, owner, at in (("a", one, p), ("b", other, r)):
                    if owner == i:
                        words.append(f'<site name="s{k}{end}" pos="{at[0]!r} {at[1]!r} 0"/>')
            for child, other in enumerate(tree.bodies):
                if other["parent"] == i:
                    body(child)
            words.append("</body>")

        for k, (one, p, *_) in enumerate(tree.springs):
            if one is None:
                words.append(f'<site name="s{k}a" pos="{p[0]!r} {p[1]!r} 0"/>')
        for i, own in enumerate(tree.bodies):
            if own["parent"] is None:
                body(i)
        words.append("</worldbody>")
        for k, (*_, stiffness, length) in enumerate(tree.springs):
            words.append(f'<tendon><spatial stiffness="{stiffness!r}" springlength="{length!r}"><site site="s{k}a"/><site site="s{k}b"/></spatial></tendon>')
        for i, _ in tree.torques:
            words.append(f'<actuator><motor joint="j{i}"/></actuator>')
        for one, p, other, r in tree.loops:
            words.append(f'<equality><connect body1="b{one}" body2="b{other}" anchor="{p[0]!r} {p[1]!r} 0"/></equality>')
        return "".join(words) + "</mujoco>"

    def run_with(integrator):
        def run(steps):
            h = tree.end / steps
            model = mj.MjModel.from_xml_string(xml(h, integrator))
            data = mj.MjData(model)
            order = [model.joint(f"j{i}").qposadr[0] for i in range(len(tree.bodies))]

            def reset():
                mj.mj_resetData(model, data)
                data.qvel[order] = tree.v0
                data.ctrl[:] = [torque for _, torque in tree.torques]

            reset()
            per = steps // (len(tree.times) - 1)
            found = [tree.q0]
            for _ in tree.times[1:]:
                mj.mj_step(model, data, per)
                found.append(tree.q0 + data.qpos[order])

            def again():
                reset()
                mj.mj_step(model, data, steps)

            return (tree.states(np.array(found)), None), again, steps

        return run

    for integrator in ("RK4", "implicit"):
        ladder(f"MuJoCo {integrator}", tree.steps(), run_with(integrator), tree.longest)


def exudyn(tree, question):
    """Rigid bodies of the plane with a joint each, generalised-alpha and the trapezoidal rule of index 2."""
    import exudyn as exu
    from exudyn.itemInterface import (
        LoadMassProportional, MarkerBodyMass, MarkerBodyPosition, MarkerBodyRigid, NodeRigidBody2D, ObjectGround,
        ObjectJointPrismatic2D, ObjectJointRevolute2D, ObjectRigidBody2D, ObjectConnectorSpringDamper, SensorBody, Torque,
    )

    places, angles = tree.poses(tree.q0[None])
    step = 1e-7
    ahead, later = tree.poses((tree.q0 + step * tree.v0)[None])
    behind, before = tree.poses((tree.q0 - step * tree.v0)[None])

    def build():
        container = exu.SystemContainer()
        system = container.AddSystem()
        ground = system.AddObject(ObjectGround())
        numbers = []
        for i, own in enumerate(tree.bodies):
            com = lambda p, a: (p[i] + rotated(a[i], np.array(own["com"], dtype=float)))[0]
            centre = com(places, angles)
            speed = (com(ahead, later) - com(behind, before)) / (2 * step)
            turn = (later[i][0] - before[i][0]) / (2 * step)
            node = system.AddNode(NodeRigidBody2D(
                referenceCoordinates=[*centre, angles[i][0]], initialVelocities=[*speed, turn]))
            numbers.append(system.AddObject(ObjectRigidBody2D(
                physicsMass=own["mass"], physicsInertia=max(own["inertia"], 1e-12), nodeNumber=node)))
            weight = system.AddMarker(MarkerBodyMass(bodyNumber=numbers[-1]))
            system.AddLoad(LoadMassProportional(markerNumber=weight, loadVector=[*tree.gravity, 0]))

        def marker(body, at, kind=MarkerBodyPosition):
            if body is None:
                return system.AddMarker(kind(bodyNumber=ground, localPosition=[*at, 0]))
            local = np.array(at, dtype=float) - tree.bodies[body]["com"]
            return system.AddMarker(kind(bodyNumber=numbers[body], localPosition=[*local, 0]))

        for i, own in enumerate(tree.bodies):
            if own["joint"] == "slide":
                ends = [marker(own["parent"], own["at"], MarkerBodyRigid), marker(i, (0, 0), MarkerBodyRigid)]
                system.AddObject(ObjectJointPrismatic2D(markerNumbers=ends, axisMarker0=[1, 0, 0], normalMarker1=[0, 1, 0]))
            else:
                ends = [marker(own["parent"], own["at"]), marker(i, (0, 0))]
                system.AddObject(ObjectJointRevolute2D(markerNumbers=ends))
        for one, p, other, r in tree.loops:
            system.AddObject(ObjectJointRevolute2D(markerNumbers=[marker(one, p), marker(other, r)]))
        for one, p, other, r, stiffness, length in tree.springs:
            ends = [marker(one, p), marker(other, r)]
            system.AddObject(ObjectConnectorSpringDamper(markerNumbers=ends, stiffness=stiffness, referenceLength=length))
        for body, torque in tree.torques:
            at = marker(body, (0, 0), MarkerBodyRigid)
            system.AddLoad(Torque(markerNumber=at, loadVector=[0, 0, torque]))
        sensors = [
            [system.AddSensor(SensorBody(bodyNumber=number, storeInternal=True, outputVariableType=kind))
             for kind in (exu.OutputVariableType.Position, exu.OutputVariableType.Rotation)]
            for number in numbers
        ]
        system.Assemble()
        return container, system, sensors

    def run_with(kind, settle):
        def run(steps):
            settings = exu.SimulationSettings()
            clock = settings.timeIntegration
            clock.numberOfSteps, clock.endTime, clock.verboseMode = steps, float(tree.end), 0
            clock.newton.useModifiedNewton = True
            clock.newton.relativeTolerance, clock.newton.absoluteTolerance = 1e-10, 1e-12
            settings.solutionSettings.writeSolutionToFile = False
            settings.solutionSettings.sensorsWritePeriod = tree.end / (len(tree.times) - 1)
            dense = len(tree.bodies) < 15
            settings.linearSolverType = exu.LinearSolverType.EXUdense if dense else exu.LinearSolverType.EigenSparse
            settle(clock)
            container, system, sensors = build()
            if not system.SolveDynamic(settings, solverType=kind, showHints=False):
                raise RuntimeError("its solver did not converge")
            seen = []
            for own, begin, (place, turn) in zip(tree.bodies, angles, sensors):
                rows = [system.GetSensorStoredData(sensor) for sensor in (place, turn)]
                if any(len(row) != len(tree.times) for row in rows):
                    raise RuntimeError("its sensors missed instants")
                # Rotations are counted from the start, or not, by version.
                turned = np.unwrap(rows[1][:, -1])
                angle = begin[0] + turned - turned[0]
                seen.append((rows[0][:, 1:3] - rotated(angle, np.array(own["com"], dtype=float)), angle))
            states = tree.read([place for place, _ in seen], [turn for _, turn in seen])
            # What records nothing is timed.
            container, timed, _ = build()
            settings.solutionSettings.sensorsWritePeriod = 1e9

            def again():
                timed.SolveDynamic(settings, solverType=kind, showHints=False)

            return (states, None), again, steps

        return run

    def alpha(clock):
        clock.generalizedAlpha.spectralRadius = 0.9

    def trapezoidal(clock):
        clock.generalizedAlpha.useIndex2Constraints = True
        clock.generalizedAlpha.useNewmark = True

    exu.SetWriteToConsole(False)
    kinds = exu.DynamicSolverType
    ladder("Exudyn generalised-alpha", tree.steps(), run_with(kinds.GeneralizedAlpha, alpha), tree.longest)
    ladder("Exudyn trapezoidal rule, index 2", tree.steps(), run_with(kinds.TrapezoidalIndex2, trapezoidal), tree.longest)


def drake(tree, question):
    """A multibody plant; loops by ball constraints, which exist for its discrete steps alone."""
    from pydrake.all import (
        ApplySimulatorConfig, DiagramBuilder, DiscreteContactApproximation, FixedOffsetFrame, LinearSpringDamper,
        MultibodyPlant, PrismaticJoint, RevoluteJoint, RigidTransform, RotationalInertia, Simulator, SimulatorConfig,
        SpatialInertia,
    )

    def build(h):
        builder = DiagramBuilder()
        plant = builder.AddSystem(MultibodyPlant(h))
        plant.set_name("plant")
        if h > 0:
            plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        plant.mutable_gravity_field().set_gravity_vector([*tree.gravity, 0])
        bodies, joints = [], []
        for i, own in enumerate(tree.bodies):
            about = RotationalInertia(*[max(own["inertia"], 1e-12)] * 3)
            inertia = SpatialInertia.MakeFromCentralInertia(own["mass"], np.array([*own["com"], 0.0]), about)
            bodies.append(plant.AddRigidBody(f"b{i}", inertia))
            parent = plant.world_body() if own["parent"] is None else bodies[own["parent"]]
            at = RigidTransform([*map(float, own["at"]), 0.0])
            frame = plant.AddFrame(FixedOffsetFrame(f"f{i}", parent.body_frame(), at))
            kind, axis = (PrismaticJoint, [1, 0, 0]) if own["joint"] == "slide" else (RevoluteJoint, [0, 0, 1])
            joints.append(plant.AddJoint(kind(f"j{i}", frame, bodies[i].body_frame(), axis)))
        at = lambda place: [*map(float, place), 0.0]
        for one, p, other, r, stiffness, length in tree.springs:
            first = plant.world_body() if one is None else bodies[one]
            plant.AddForceElement(LinearSpringDamper(first, at(p), bodies[other], at(r), length, stiffness, 0.0))
        for body, _ in tree.torques:
            plant.AddJointActuator(f"m{body}", joints[body])
        for one, p, other, r in tree.loops:
            plant.AddBallConstraint(bodies[one], at(p), bodies[other], at(r))
        plant.Finalize()
        return builder.Build(), plant, joints

    def run_with(scheme):
        def run(value):
            system, plant, joints = build(0.0 if scheme else tree.end / value)
            first = system.CreateDefaultContext()
            own = plant.GetMyContextFromRoot(first)
            for body, joint, q, v in zip(tree.bodies, joints, tree.q0, tree.v0):
                slides = body["joint"] == "slide"
                (joint.set_translation if slides else joint.set_angle)(own, q)
                (joint.set_translation_rate if slides else joint.set_angular_rate)(own, v)
            simulator = Simulator(system)
            if scheme:
                config = SimulatorConfig(integration_scheme=scheme, accuracy=value, use_error_control=True, max_step_size=0.1)
                ApplySimulatorConfig(config, simulator)
            context = simulator.get_mutable_context()
            for one in (own, plant.GetMyContextFromRoot(context)):
                if tree.torques:
                    plant.get_actuation_input_port().FixValue(one, [torque for _, torque in tree.torques])

            def reset():
                context.SetTimeStateAndParametersFrom(first)
                context.SetTime(0.0)
                simulator.Initialize()

            def joint_values():
                now = plant.GetMyContextFromRoot(context)
                pairs = zip(tree.bodies, joints)
                return [joint.get_translation(now) if body["joint"] == "slide" else joint.get_angle(now) for body, joint in pairs]

            reset()
            found = [tree.q0]
            for t in tree.times[1:]:
                simulator.AdvanceTo(float(t - tree.times[0]))
                found.append(joint_values())

            def again():
                reset()
                simulator.AdvanceTo(float(tree.end))

            return (tree.states(np.array(found)), None), again, 0 if scheme else value

        return run

    ladder("Drake discrete, SAP", tree.steps(), run_with(None), tree.longest)
    if not tree.loops:
        settings = [(f"accuracy 1e-{digits}", 10.0**-digits) for digits in question["digits"]]
        for scheme in ("runge_kutta3", "runge_kutta5"):
            ladder(f"Drake {scheme}", settings, run_with(scheme), tree.longest)
    else:
        tell(program="Drake, error-controlled", setting="", refused="cannot: closed loops need its discrete steps")


def pinocchio(tree, question):
    """`constraintDynamics` (proximal, Baumgarte) in compiled C++, with Runge-Kutta steps of order 4: it brings none of its own."""
    from pinocchio_shim import library

    function = library(question["cache"], lambda words: tell(program="Pinocchio", progress=words))
    parents = [-1 if body["parent"] is None else body["parent"] for body in tree.bodies]
    kinds = [3 if body["joint"] == "slide" else 2 for body in tree.bodies]
    numbers = [[*body["at"], 0, body["mass"], *body["com"], 0, *[body["inertia"]] * 3] for body in tree.bodies]
    loops = [[one, *p, 0, other, *r, 0] for one, p, other, r in tree.loops]
    springs = [
        [-1 if one is None else one, *p, 0, other, *r, 0, stiffness, length, 0]
        for one, p, other, r, stiffness, length in tree.springs
    ]
    torques = np.zeros(len(tree.bodies))
    for body, torque in tree.torques:
        torques[body] += torque
    w = STABILISED / tree.end if tree.loops else 0.0

    def run(steps):
        def call(samples):
            out = np.zeros((max(samples, 1), len(tree.bodies)))
            function(parents, kinds, numbers, loops, springs, torques, [*tree.gravity, 0], tree.q0, tree.v0, tree.end, steps, samples, w, out)
            return out

        found = call(len(tree.times) - 1)
        if not np.isfinite(found).all():
            raise RuntimeError("the states are not finite")
        return (tree.states(np.vstack([tree.q0, found])), None), lambda: call(0), 4 * steps

    ladder("Pinocchio RK4" + (", proximal, Baumgarte" if tree.loops else ""), tree.steps(), run, tree.longest)
