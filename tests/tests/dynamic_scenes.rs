//! Masses, forces and functions in effects: scenes that move by a drive, by forces or by both, from one text.
#![forbid(unsafe_code)]
#![deny(warnings, missing_docs, unreachable_pub)]

use mbs_runtime::driver::Polynomial;
use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{
    Dynamic, DynamicState, Function, Lanes, Mechanism, Partitioned, Scalar, Stepper, mechanism,
};
use mechanisms::andrews::Andrews;

mechanism! {
    /// A slider-crank that is driven, loaded, weighed, or left to itself.
    pub mechanism Rig;
    param r: m = 0.1;
    param L: m = 0.3;
    coord theta: rad = 0.8;
    coord rod: rad = -0.24;
    coord x: m = 0.36;
    constraint closure { r*unit(theta) + L*unit(rod) == [x, 0]; }
    branch ahead: cos(rod) > 0;
    effect turned { param omega: rad/s = 3; drive motor: theta == 0.5 + omega*t; }
    effect massive {
        param m: kg = 2;
        body flywheel { mass: 0.5, inertia: 0.02, com: [0, 0], angle: theta }
        body slider { mass: m, com: [x, 0] }
        body coupler { mass: 1, inertia: 0.01, com: r*unit(theta) + 0.5*L*unit(rod), angle: rod }
    }
    effect weighed { gravity g { acceleration: [0, -9.81] } }
    effect pressed {
        function push: N(m), C1;
        force gas: push(x) on x;
        out guide: N = lambda(closure[1]);
    }
    effect carried {
        function lift: m(rad), C3;
        body follower { mass: 0.3, com: [0, lift(theta)] }
    }
    effect rubbed { force slip: -0.1*lambda(closure[1]) on x; }
    effect measured { out torque_1: N*m = effort(motor); }
    out height: m = r*sin(theta);
    /// By the drive alone: no masses.
    scene Still = turned;
    /// By forces, without weight.
    scene Free = massive + pressed;
    /// By its weight: it calls no function.
    scene Heavy = massive + weighed;
    /// By its weight, with a follower.
    scene Cam = massive + weighed + carried;
    /// By forces that depend on what the guide carries.
    scene Rough = massive + pressed + rubbed;
    /// By the drive, against everything.
    scene Driven = turned + massive + weighed + pressed + carried + measured;
}

type Push = Polynomial<3>;
type Lift = Polynomial<4>;

const PUSH: Push = Polynomial { coefficients: [5.0, -20.0, 3.0] };
const LIFT: Lift = Polynomial { coefficients: [0.05, 0.02, 0.01, -0.004] };
const GRAVITY: f64 = 9.81;

/// A state; nothing of it satisfies the constraint.
const Q: [f64; 3] = [0.7, -0.3, 0.35];
const QD: [f64; 3] = [1.3, -0.6, 0.2];
const LAMBDA: [f64; 2] = [4.0, -7.0];

/// No function at all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Nothing;

/// Equal but for rounding.
#[track_caller]
fn close<const N: usize>(found: [f64; N], expected: [f64; N]) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-13 * (1.0 + expected.abs()), "{found} instead of {expected}");
    }
}

/// Q of a scene at [`Q`], [`QD`] and [`LAMBDA`].
fn force<S: Dynamic<f64, 3, M, States = [f64; 0]>, const M: usize>(scene: &S, lambda: [f64; M]) -> [f64; 3] {
    let parameters = scene.parameters();
    scene.force(&parameters, &scene.position(&parameters, &Q, 0.0), &QD, &[], &lambda)
}

/// −(inertia force at q̈ = 0) of the coupler, which every scene with masses has: m Jᵀ J̇ q̇.
fn coupler() -> [f64; 3] {
    let ([theta, rod, _], [turning, swinging, _]) = (Q, QD);
    let (r, half) = (0.1, 0.15);
    let [x, y] = [
        -r * theta.cos() * turning * turning - half * rod.cos() * swinging * swinging,
        -r * theta.sin() * turning * turning - half * rod.sin() * swinging * swinging,
    ];
    let along = |length: f64, angle: f64| -length * (y * angle.cos() - x * angle.sin());
    [along(r, theta), along(half, rod), 0.0]
}

/// Its weight.
fn weight() -> [f64; 3] {
    [-GRAVITY * 0.1 * Q[0].cos(), -GRAVITY * 0.15 * Q[1].cos(), 0.0]
}

fn sum<const K: usize>(parts: [[f64; 3]; K]) -> [f64; 3] {
    parts.iter().fold([0.0; 3], |sum, part| [sum[0] + part[0], sum[1] + part[1], sum[2] + part[2]])
}

#[test]
fn each_scene_has_the_forces_and_masses_of_its_effects_alone() {
    let gas = [0.0, 0.0, Function::<f64>::jet::<1>(&PUSH, Q[2])[0]];
    let [lift, slope, bend] = Function::<f64>::jet::<3>(&LIFT, Q[0]);
    let follower = [-0.3 * slope * (bend * QD[0] * QD[0] + GRAVITY), 0.0, 0.0];
    let rubbing = [0.0, 0.0, -0.1 * LAMBDA[1]];
    let free: RigFree<Push, Nothing> = Rig::new(PUSH, Nothing);
    close(force(&free, LAMBDA), sum([coupler(), gas]));
    let heavy: RigHeavy<Nothing, Nothing> = Rig::new(Nothing, Nothing);
    close(force(&heavy, LAMBDA), sum([coupler(), weight()]));
    let cam: RigCam<Nothing, Lift> = Rig::new(Nothing, LIFT);
    close(force(&cam, LAMBDA), sum([coupler(), weight(), follower]));
    let rough: RigRough<Push, Nothing> = Rig::new(PUSH, Nothing);
    close(force(&rough, LAMBDA), sum([coupler(), gas, rubbing]));
    let driven: RigDriven<Push, Lift> = Rig::new(PUSH, LIFT);
    close(force(&driven, [4.0, -7.0, 1.0]), sum([coupler(), weight(), gas, follower]));

    let turning = |mass: [[f64; 3]; 3]| mass[0][0];
    let parameters = heavy.parameters();
    let without = turning(heavy.mass(&parameters, &heavy.position(&parameters, &Q, 0.0)));
    let parameters = cam.parameters();
    let position = cam.position(&parameters, &Q, 0.0);
    close([turning(cam.mass(&parameters, &position))], [without + 0.3 * slope * slope]);
    let potential = cam.energy(&parameters, &position, &QD).potential;
    close([potential], [GRAVITY * (0.1 * Q[0].sin() + 0.15 * Q[1].sin() + 0.3 * lift)]);
}

#[test]
fn scenes_list_their_own_functions_forces_and_loads() {
    let names = |entries: &'static [mbs_runtime::Entry]| entries.iter().map(|e| e.name).collect::<Vec<_>>();
    let functions =
        |entries: &'static [mbs_runtime::FunctionEntry]| entries.iter().map(|e| e.name).collect::<Vec<_>>();
    type Free = RigFree<Push, Nothing>;
    type Heavy = RigHeavy<Nothing, Nothing>;
    type Driven = RigDriven<Push, Lift>;
    assert_eq!(functions(<RigStill<Nothing, Nothing> as Mechanism<f64, 3, 3>>::FUNCTIONS), [""; 0]);
    assert_eq!(functions(<Heavy as Mechanism<f64, 3, 2>>::FUNCTIONS), [""; 0]);
    assert_eq!(functions(<Free as Mechanism<f64, 3, 2>>::FUNCTIONS), ["push"]);
    assert_eq!(functions(<Driven as Mechanism<f64, 3, 3>>::FUNCTIONS), ["push", "lift"]);
    assert_eq!(names(<Heavy as Dynamic<f64, 3, 2>>::FORCES), [""; 0]);
    assert_eq!(names(<Free as Dynamic<f64, 3, 2>>::FORCES), ["gas"]);
    assert_eq!(names(<Free as Dynamic<f64, 3, 2>>::LOADS), ["guide"]);
    assert_eq!(names(<Driven as Dynamic<f64, 3, 3>>::LOADS), ["guide", "torque_1"]);
    assert_eq!(names(<Heavy as Mechanism<f64, 3, 2>>::OUTPUTS), ["height"]);
    const { assert!(<RigRough<Push, Nothing> as Dynamic<f64, 3, 2>>::FORCE_USES_MULTIPLIERS) };
    const { assert!(!<Free as Dynamic<f64, 3, 2>>::FORCE_USES_MULTIPLIERS) };
}

#[test]
fn a_driven_scene_with_masses_moves_as_the_one_without() {
    let still: RigStill<Nothing, Nothing> = Rig { omega: 2.0, ..Rig::new(Nothing, Nothing) };
    let driven: RigDriven<Push, Lift> = Rig { omega: 2.0, ..Rig::new(PUSH, LIFT) };
    let guess = still.guess(&still.parameters());
    let mut still = Stepper::assemble(still, guess, 0.0).expect("it closes");
    let mut driven = Stepper::assemble(driven, guess, 0.0).expect("it closes");
    for _ in 0..100 {
        still.advance(0.01).expect("it turns");
        driven.advance(0.01).expect("it turns");
    }
    assert_eq!((still.q(), still.qd(), still.qdd()), (driven.q(), driven.qd(), driven.qdd()));
}

/// Kinetic and potential energy and the work of the gas stay in balance over a second of free motion.
#[track_caller]
fn swings<S: Dynamic<f64, 3, 2, States = [f64; 0]> + Clone>(scene: S) -> f64 {
    let parameters = scene.parameters();
    let guess = scene.guess(&parameters);
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut motion = Simulation::start(scene, method, 0.0, consistent(guess[0]), [0.0; 3])
        .expect("at rest")
        .with_tolerance(Tolerance::new(1e-11));
    motion.advance_to(1.0).expect("it swings");
    let balance = motion.balance();
    // Rounding and 1e-11 a step, in J: the energies are of the order of 1.
    assert!(balance.defect.abs() < 1e-9 && balance.phi < 1e-12, "{balance:?}");
    motion.q()[0]
}

/// The linkage closed at a crank angle.
fn consistent(theta: f64) -> [f64; 3] {
    let rod = -(0.1 * theta.sin() / 0.3).asin();
    [theta, rod, 0.1 * theta.cos() + 0.3 * rod.cos()]
}

#[test]
fn scenes_move_apart_by_what_they_declare() {
    let heavy = swings::<RigHeavy<Nothing, Nothing>>(Rig::new(Nothing, Nothing));
    let cam = swings::<RigCam<Nothing, Lift>>(Rig::new(Nothing, LIFT));
    let free = swings::<RigFree<Push, Nothing>>(Rig::new(PUSH, Nothing));
    let rough = swings::<RigRough<Push, Nothing>>(Rig::new(PUSH, Nothing));
    for (a, b) in [(heavy, cam), (heavy, free), (free, rough)] {
        assert!((a - b).abs() > 1e-3, "{a} {b}");
    }
}

#[test]
fn lanes_and_single_precision_compute_the_same_dynamics() {
    let plain: RigDriven<Push, Lift> = Rig::new(PUSH, LIFT);
    let expected = everything(&plain, |x| x);
    let lanes: RigDriven<Push, Lift, Lanes<f64, 4>> = Rig::new(PUSH, LIFT);
    for (found, expected) in everything(&lanes, Lanes::<f64, 4>::constant).iter().zip(&expected) {
        close([found.lane(0), found.lane(3)], [*expected; 2]);
    }
    let single: RigDriven<Push, Lift, f32> = Rig::new(PUSH, LIFT);
    for (found, expected) in everything(&single, |x| x as f32).iter().zip(&expected) {
        // A few dozen roundings of f32.
        let error = (f64::from(*found) - expected).abs();
        assert!(error < 3e-6 * (1.0 + expected.abs()), "{found} instead of {expected}");
    }
}

/// Every function of the dynamics at one state.
fn everything<S, T>(scene: &S, number: impl Fn(f64) -> T) -> Vec<T>
where
    S: Dynamic<T, 3, 3, States = [T; 0]>,
    T: Scalar,
{
    let parameters = scene.parameters();
    let [q, qd, qdd] = [Q, QD, [0.4, -0.2, 0.9]].map(|numbers| numbers.map(&number));
    let lambda = [4.0, -7.0, 1.0].map(&number);
    let position = scene.position(&parameters, &q, number(0.1));
    let energy = scene.energy(&parameters, &position, &qd);
    let motion = DynamicState { qd: &qd, qdd: &qdd, lambda: &lambda, states: &[] };
    let mut all = vec![energy.kinetic, energy.potential];
    all.extend(scene.mass(&parameters, &position).as_flattened());
    all.extend(scene.mass_times(&parameters, &position, &qdd));
    all.extend(scene.force(&parameters, &position, &qd, &[], &lambda));
    all.extend(scene.force_q(&parameters, &position, &qd, &[], &lambda).as_flattened());
    all.extend(scene.force_qd(&parameters, &position, &qd, &[], &lambda).as_flattened());
    all.extend(scene.mass_times_q(&parameters, &position, &qdd).as_flattened());
    all.extend(scene.reaction(&parameters, &position, &lambda));
    all.extend(scene.reaction_q(&parameters, &position, &lambda).as_flattened());
    all.extend(scene.powers(&parameters, &position, &qd, &[], &lambda).as_ref());
    all.extend(scene.loads(&parameters, &position, &motion).as_ref());
    all
}

mechanism! {
    /// A shaft that is driven, and two masses that no row and no mass couples to it: forces alone do.
    pub mechanism Separate;
    coord theta: rad = 0.2;
    coord x: m = 0.3;
    coord y: m = 0.4;
    drive shaft: theta == 0.2 + 3 [rad/s]*t;
    body one { mass: 2kg, com: [x, 0] }
    body two { mass: 3kg, com: [0, y] }
    tsda pulls { from: 100mm*unit(theta), to: [x, y], stiffness: 500, length: 0.2, damping: 4 }
}

#[test]
fn a_mass_without_couplings_is_accelerated_by_its_own_force() {
    let separate: Separate = Separate::default();
    const { assert!(<Separate as Partitioned<f64, 3, 1>>::IS_UNCOUPLED) };
    const { assert!(!<Andrews as Partitioned<f64, 7, 6>>::IS_UNCOUPLED) };
    let p = separate.parameters();
    let (q, qd) = ([0.2, 0.3, 0.4], [3.0, -1.0, 2.0]);
    let position = separate.position(&p, &q, 0.0);
    let force = separate.force(&p, &position, &qd, &[], &[0.0]);
    let (factors, _) = separate.partition(&p, &position);
    let found = separate.accelerations(&p, &position, &factors, &force, &[0.7]);
    assert!(found.inert && force.iter().all(|force| force.abs() > 1.0), "{force:?}");
    assert_eq!(found.qdd[0], 0.7);
    // M q̈ + Φ_qᵀ λ = Q
    let left = separate.mass_times(&p, &position, &found.qdd);
    for ((left, row), force) in left.iter().zip([1.0, 0.0, 0.0]).zip(force) {
        assert!(
            (left + row * found.lambda[0] - force).abs() <= 4.0 * f64::EPSILON * force.abs(),
            "{left} {force}"
        );
    }
}

mechanism! {
    /// Two contacts with one gap, whose way to it is long.
    pub mechanism Twice;
    coord x: m = 0.3;
    coord y: m = 0.4;
    coord phi: rad = 0.1;
    body ball { mass: 2kg, com: [x, y], inertia: 1, angle: phi }
    let gap = norm([x, y] - 0.1m*unit(phi + x/1m)) - 1m;
    contact hard { gap: gap, stiffness: 1e6, exponent: 1.5, depth: 1mm, damping: 0.3 }
    contact soft { gap: gap, stiffness: 1e3, exponent: 1.5, depth: 1mm, damping: 0.3 }
}

#[test]
fn contacts_that_share_a_gap_are_left_out_one_by_one() {
    let twice: Twice = Twice::default();
    let force = |evaluated: [bool; 2]| {
        let mut p = twice.parameters();
        <Twice as Dynamic<f64, 3, 0>>::evaluated_mut(&mut p).copy_from_slice(&evaluated);
        let position = twice.position(&p, &[0.3, 0.4, 0.1], 0.0);
        twice.force(&p, &position, &[0.2, 0.1, 0.3], &[], &[])
    };
    let [none, hard, soft, both] = [[false, false], [true, false], [false, true], [true, true]].map(force);
    for index in 0..3 {
        assert_eq!(none[index], 0.0);
        assert!(hard[index] != 0.0 && soft[index] != 0.0);
        assert!((hard[index] / soft[index] / 1e3 - 1.0).abs() < 1e-14, "{hard:?} {soft:?}");
        assert_eq!(both[index], hard[index] + soft[index]);
    }
}
