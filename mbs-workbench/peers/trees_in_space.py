"""Multibody programs on a mechanism that a file describes as a tree of bodies in space, without closed loops.

The file has `SPACE = True`, and

    tree(p, q, qd) -> dictionary; p: the mechanism's parameters by name, q and qd: its coordinates and velocities at the start
        gravity    (x, y, z), m/s^2
        bodies     list of dictionaries: `parent` (index, None: the ground), `at` (place of the joint in the parent's frame),
                   `joint` ("hinge" or "slide") with its `axis` ("x", "y" or "z" of the frame), `q` and `v` (value and rate of the
                   joint at the start; rad or m), `mass`, `com` (centre of mass in the body's frame), `inertia` (about it, along
                   the body's axes)
        springs    list of (body or None, place, body, place, stiffness, length at rest, damping)
    coordinates(p, place, joint) -> the mechanism's coordinates; place(body, (x, y, z)) is a point in the frame of the ground,
                   joint(body) the value of the body's joint

A body's frame is the parent's, moved by the joint.
"""

import numpy as np
from peers import ladder, tell

AXES = "xyz"


class Tree:
    """A tree at its start, with what all programs need of it."""

    def __init__(self, file, question):
        self.parameters = question["parameters"]
        told = file.tree(self.parameters, question["q"], question["qd"])
        self.file, self.gravity, self.bodies = file, [float(g) for g in told["gravity"]], told["bodies"]
        self.springs = told.get("springs", [])
        self.times = np.array(question["times"])
        self.q0 = np.array([body["q"] for body in self.bodies], dtype=float)
        self.v0 = np.array([body["v"] for body in self.bodies], dtype=float)
        self.longest = question["longest"]
        for name, places, given in (("coordinate", self.q0[None], question["q"]), ("velocity", None, question["qd"])):
            if places is not None:
                begin = np.array(self.states(places)[0])
            else:
                step = 1e-6
                ahead, behind = (np.array(self.states((self.q0 + sign * step * self.v0)[None])[0]) for sign in (1, -1))
                begin = (ahead - behind) / (2 * step)
            apart = np.abs(begin - given)
            bound = 1e-9 if places is not None else 1e-7
            if not apart.max() < bound * max(1.0, np.abs(begin).max()):
                raise ValueError(f"the tree starts elsewhere: {name} {int(apart.argmax())} differs by {apart.max():.1e}")

    @property
    def end(self):
        return float(self.times[-1] - self.times[0])

    def states(self, q):
        """The mechanism's coordinates for joint values (instants, bodies)."""
        places, turns = [], []
        for i, body in enumerate(self.bodies):
            parent = body["parent"]
            base = np.zeros((len(q), 3)) if parent is None else places[parent]
            turn = np.broadcast_to(np.eye(3), (len(q), 3, 3)) if parent is None else turns[parent]
            at = np.broadcast_to(np.asarray(body["at"], dtype=float), (len(q), 3)).copy()
            axis = AXES.index(body["axis"])
            if body["joint"] == "slide":
                at[:, axis] += q[:, i]
                turns.append(turn)
            else:
                turns.append(turn @ rotations(axis, q[:, i]))
            places.append(base + np.einsum("tij,tj->ti", turn, at))
        place = lambda body, at: (places[body] + turns[body] @ np.asarray(at, dtype=float)).T
        joint = lambda body: q[:, body]
        told = self.file.coordinates(self.parameters, place, joint)
        return np.stack([np.broadcast_to(one, len(q)) for one in told], -1).tolist()

    def steps(self):
        """Fixed steps that end at the instants: (label, number)."""
        parts = len(self.times) - 1
        return [(f"{parts * 2**k} steps", parts * 2**k) for k in range(14)]


def rotations(axis, angle):
    """Matrices of rotations about an axis of the frame by angles (instants)."""
    c, s = np.cos(angle), np.sin(angle)
    found = np.zeros((len(angle), 3, 3))
    one, other = (axis + 1) % 3, (axis + 2) % 3
    found[:, axis, axis] = 1
    found[:, one, one], found[:, other, other] = c, c
    found[:, one, other], found[:, other, one] = -s, s
    return found


def words_of(vector):
    return " ".join(repr(float(x)) for x in vector)


def run_program(program, file, question):
    tree = Tree(file, question)
    {"mujoco": mujoco, "exudyn": exudyn, "drake": drake, "pinocchio": pinocchio}[program](tree, question)


def mujoco(tree, question):
    """Joints of a tree, springs as tendons."""
    import mujoco as mj

    def xml(h, integrator):
        words = [
            f'<mujoco><compiler angle="radian"/><option timestep="{h!r}" gravity="{words_of(tree.gravity)}" '
            f'integrator="{integrator}"><flag contact="disable"/></option><worldbody>'
        ]

        def body(i):
            own = tree.bodies[i]
            axis = words_of(float(own["axis"] == name) for name in AXES)
            words.append(f'<body name="b{i}" pos="{words_of(own["at"])}">')
            words.append(f'<joint name="j{i}" type="{own["joint"]}" axis="{axis}"/>')
            about = words_of(max(value, 1e-12) for value in own["inertia"])
            words.append(f'<inertial pos="{words_of(own["com"])}" mass="{float(own["mass"])!r}" diaginertia="{about}"/>')
            for k, (one, p, other, r, *_) in enumerate(tree.springs):
                for end, owner, at in (("a", one, p), ("b", other, r)):
                    if owner == i:
                        words.append(f'<site name="s{k}{end}" pos="{words_of(at)}"/>')
            for child, other in enumerate(tree.bodies):
                if other["parent"] == i:
                    body(child)
            words.append("</body>")

        for k, (one, p, *_) in enumerate(tree.springs):
            if one is None:
                words.append(f'<site name="s{k}a" pos="{words_of(p)}"/>')
        for i, own in enumerate(tree.bodies):
            if own["parent"] is None:
                body(i)
        words.append("</worldbody><tendon>")
        for k, (*_, stiffness, length, damping) in enumerate(tree.springs):
            words.append(
                f'<spatial stiffness="{stiffness!r}" springlength="{length!r}" damping="{damping!r}">'
                f'<site site="s{k}a"/><site site="s{k}b"/></spatial>'
            )
        return "".join(words) + "</tendon></mujoco>"

    def run_with(integrator):
        def run(steps):
            model = mj.MjModel.from_xml_string(xml(tree.end / steps, integrator))
            data = mj.MjData(model)
            order = [model.joint(f"j{i}").qposadr[0] for i in range(len(tree.bodies))]

            def reset():
                mj.mj_resetData(model, data)
                data.qpos[order], data.qvel[order] = tree.q0, tree.v0

            reset()
            found = [tree.q0]
            for _ in tree.times[1:]:
                mj.mj_step(model, data, steps // (len(tree.times) - 1))
                found.append(data.qpos[order].copy())
            found = np.array(found)
            # An unstable run is put back to its start with a warning alone.
            if any(warning.number for warning in data.warning):
                raise RuntimeError("it warns that the motion is unstable")

            def again():
                reset()
                mj.mj_step(model, data, steps)

            return (tree.states(found), None), again, steps

        return run

    for integrator in ("RK4", "implicit"):
        ladder(f"MuJoCo {integrator}", tree.steps(), run_with(integrator), tree.longest)


def exudyn(tree, question):
    """A kinematic tree in joint coordinates, generalised-alpha."""
    import exudyn as exu
    from exudyn.itemInterface import (
        MarkerBodyPosition, MarkerKinematicTreeRigid, NodeGenericODE2, ObjectConnectorSpringDamper, ObjectGround,
        ObjectKinematicTree, SensorNode,
    )

    kinds = {("hinge", axis): f"Revolute{axis.upper()}" for axis in AXES} | {("slide", axis): f"Prismatic{axis.upper()}" for axis in AXES}
    count = len(tree.bodies)

    def build():
        container = exu.SystemContainer()
        system = container.AddSystem()
        node = system.AddNode(NodeGenericODE2(
            referenceCoordinates=[0.0] * count, initialCoordinates=list(tree.q0), initialCoordinates_t=list(tree.v0),
            numberOfODE2Coordinates=count))
        vectors = lambda name: exu.Vector3DList([np.array(body[name], dtype=float) for body in tree.bodies])
        matrices = lambda of: exu.Matrix3DList([of(body) for body in tree.bodies])
        own = system.AddObject(ObjectKinematicTree(
            nodeNumber=node, gravity=tree.gravity,
            jointTypes=[getattr(exu.JointType, kinds[body["joint"], body["axis"]]) for body in tree.bodies],
            linkParents=[-1 if body["parent"] is None else body["parent"] for body in tree.bodies],
            jointTransformations=matrices(lambda body: np.eye(3)), jointOffsets=vectors("at"),
            linkInertiasCOM=matrices(lambda body: np.diag(np.maximum(body["inertia"], 1e-12))), linkCOMs=vectors("com"),
            linkMasses=[float(body["mass"]) for body in tree.bodies]))
        ground = system.AddObject(ObjectGround())

        def marker(body, at):
            if body is None:
                return system.AddMarker(MarkerBodyPosition(bodyNumber=ground, localPosition=list(at)))
            return system.AddMarker(MarkerKinematicTreeRigid(objectNumber=own, linkNumber=body, localPosition=list(at)))

        for one, p, other, r, stiffness, length, damping in tree.springs:
            system.AddObject(ObjectConnectorSpringDamper(
                markerNumbers=[marker(one, p), marker(other, r)], stiffness=stiffness, damping=damping, referenceLength=length))
        sensor = system.AddSensor(SensorNode(
            nodeNumber=node, storeInternal=True, outputVariableType=exu.OutputVariableType.Coordinates))
        system.Assemble()
        return container, system, sensor

    def run(steps):
        settings = exu.SimulationSettings()
        clock = settings.timeIntegration
        clock.numberOfSteps, clock.endTime, clock.verboseMode = steps, float(tree.end), 0
        clock.newton.useModifiedNewton = True
        clock.newton.relativeTolerance, clock.newton.absoluteTolerance = 1e-10, 1e-12
        clock.generalizedAlpha.spectralRadius = 0.9
        settings.solutionSettings.writeSolutionToFile = False
        settings.solutionSettings.sensorsWritePeriod = tree.end / (len(tree.times) - 1)
        container, system, sensor = build()
        kind = exu.DynamicSolverType.GeneralizedAlpha
        if not system.SolveDynamic(settings, solverType=kind, showHints=False):
            raise RuntimeError("its solver did not converge")
        rows = system.GetSensorStoredData(sensor)
        if len(rows) != len(tree.times):
            raise RuntimeError("its sensor missed instants")
        other, timed, _ = build()
        settings.solutionSettings.sensorsWritePeriod = 1e9
        again = lambda: timed.SolveDynamic(settings, solverType=kind, showHints=False)
        return (tree.states(rows[:, 1:]), None), again, steps

    exu.SetWriteToConsole(False)
    ladder("Exudyn generalised-alpha, tree", tree.steps(), run, tree.longest)


def drake(tree, question):
    """A multibody plant in discrete steps, and with error-controlled integrators, one of them for stiff motions."""
    from pydrake.all import (
        ApplySimulatorConfig, DiagramBuilder, FixedOffsetFrame, LinearSpringDamper, MultibodyPlant, PrismaticJoint,
        RevoluteJoint, RigidTransform, RotationalInertia, Simulator, SimulatorConfig, SpatialInertia,
    )

    def build(h):
        builder = DiagramBuilder()
        plant = builder.AddSystem(MultibodyPlant(h))
        plant.mutable_gravity_field().set_gravity_vector(tree.gravity)
        bodies, joints = [], []
        for i, own in enumerate(tree.bodies):
            about = RotationalInertia(*[max(float(value), 1e-12) for value in own["inertia"]])
            inertia = SpatialInertia.MakeFromCentralInertia(own["mass"], np.array(own["com"], dtype=float), about)
            bodies.append(plant.AddRigidBody(f"b{i}", inertia))
            parent = plant.world_body() if own["parent"] is None else bodies[own["parent"]]
            at = RigidTransform([float(x) for x in own["at"]])
            frame = plant.AddFrame(FixedOffsetFrame(f"f{i}", parent.body_frame(), at))
            kind = PrismaticJoint if own["joint"] == "slide" else RevoluteJoint
            axis = [float(own["axis"] == name) for name in AXES]
            joints.append(plant.AddJoint(kind(f"j{i}", frame, bodies[i].body_frame(), axis)))
        place = lambda at: [float(x) for x in at]
        for one, p, other, r, stiffness, length, damping in tree.springs:
            first = plant.world_body() if one is None else bodies[one]
            plant.AddForceElement(LinearSpringDamper(first, place(p), bodies[other], place(r), length, stiffness, damping))
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
            if not np.isfinite(found).all():
                raise RuntimeError("the states are not finite")

            def again():
                reset()
                simulator.AdvanceTo(float(tree.end))

            return (tree.states(np.array(found)), None), again, 0 if scheme else value

        return run

    ladder("Drake discrete", tree.steps(), run_with(None), tree.longest)
    settings = [(f"accuracy 1e-{digits}", 10.0**-digits) for digits in question["digits"]]
    for scheme in ("runge_kutta3", "radau3"):
        ladder(f"Drake {scheme}", settings, run_with(scheme), tree.longest)


def pinocchio(tree, question):
    """`aba` in compiled C++, with Runge-Kutta steps of order 4: it brings none of its own."""
    from pinocchio_shim import library

    function = library(question["cache"], lambda words: tell(program="Pinocchio", progress=words))
    parents = [-1 if body["parent"] is None else body["parent"] for body in tree.bodies]
    kinds = [AXES.index(body["axis"]) + (3 if body["joint"] == "slide" else 0) for body in tree.bodies]
    numbers = [[*body["at"], body["mass"], *body["com"], *body["inertia"]] for body in tree.bodies]
    springs = [[-1 if one is None else one, *p, other, *r, *rest] for one, p, other, r, *rest in tree.springs]
    torques = np.zeros(len(tree.bodies))

    def run(steps):
        def call(samples):
            out = np.zeros((max(samples, 1), len(tree.bodies)))
            function(parents, kinds, numbers, [], springs, torques, tree.gravity, tree.q0, tree.v0, tree.end, steps, samples, 0.0, out)
            return out

        found = call(len(tree.times) - 1)
        if not np.isfinite(found).all():
            raise RuntimeError("the states are not finite")
        return (tree.states(np.vstack([tree.q0, found])), None), lambda: call(0), 4 * steps

    ladder("Pinocchio RK4", tree.steps(), run, tree.longest)
