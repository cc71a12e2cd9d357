//! Small motions about a motion: the equation of its neighbours.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Linearization, Projection, Simulation, Tolerance, linearize, linearize_in,
};
use mbs_runtime::{Dynamic, mechanism};

type Run<S, const N: usize, const M: usize> = Simulation<S, Explicit<DormandPrince8, Projection>, f64, N, M>;

fn started<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(mechanism: S) -> Run<S, N, M> {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_from_text(mechanism, method, 0.0).expect("it starts");
    run.with_tolerance(Tolerance::new(1e-13))
}

fn about<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    run: &Run<S, N, M>,
    independent: &[u16],
) -> Linearization<f64, N> {
    let state = (run.q(), run.qd(), run.qdd());
    linearize_in(run.mechanism(), run.t(), state, run.lambda(), independent).expect("it is regular")
}

mechanism! {
    /// A damped pendulum on a shaken pivot, in its angle.
    pub mechanism ByAngle;
    const d: N*s/m = 0.7;
    coord phi: rad = 0.4;
    let bob = [0.2m*sin(3*t/1s), 0.1m*cos(5*t/1s)] + 0.8m*unit(phi);
    body mass { mass: 2, inertia: 0.3, com: bob, angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    force drag: -d*der(bob) on bob;
    start phi = 0.4 rate 2;
}

mechanism! {
    /// The same with the place of its bob, which a row ties to the angle.
    pub mechanism ByPoint;
    const d: N*s/m = 0.7;
    coord P: [m; 2] = [0.74, 0.41];
    coord phi: rad = 0.4;
    body mass { mass: 2, inertia: 0.3, com: P, angle: phi }
    gravity weight { acceleration: [0, -9.81] }
    force drag: -d*der(P) on P;
    constraint rod { P == [0.2m*sin(3*t/1s), 0.1m*cos(5*t/1s)] + 0.8m*unit(phi); }
    start phi = 0.4 rate 2;
}

#[test]
fn one_motion_in_two_sets_of_coordinates_has_one_equation_of_its_neighbours() {
    /// Of the largest entry: what both integrations and the differences of order 6 leave.
    const BOUND: f64 = 1e-9;
    let (mut angle, mut point) = (started(ByAngle::<f64>::default()), started(ByPoint::<f64>::default()));
    for t in [0.3, 0.9, 1.6] {
        angle.advance_to(t).expect("it moves");
        point.advance_to(t).expect("it moves");
        let (one, other) = (about(&angle, &[]), about(&point, &[2]));
        assert_eq!((one.freedom, other.freedom), (1, 1));
        assert_eq!((one.independent, other.independent), ([true], [false, false, true]));
        assert!(one.frozen && other.frozen);
        let pairs = [
            (one.mass[0][0], other.mass[0][0]),
            (one.damping[0][0], other.damping[0][0]),
            (one.stiffness[0][0], other.stiffness[0][0]),
        ];
        let size = pairs.iter().fold(1.0, |size: f64, (one, _)| size.max(one.abs()));
        for (one, other) in pairs {
            assert!((one - other).abs() < BOUND * size, "at {t} s: {pairs:?}");
        }
    }
}

mechanism! {
    /// A slider-crank on a spring, from any angle and speed.
    pub mechanism Crank;
    param a: rad = 1;
    param w: rad/s = 6;
    coord theta: rad = 1;
    coord phi: rad = -0.2;
    coord x: m = 0.6;
    body crank { mass: 1, inertia: 0.02, com: 0.1m*unit(theta), angle: theta }
    body rod { mass: 2, inertia: 0.05, com: 0.2m*unit(theta) + 0.25m*unit(phi), angle: phi }
    body piston { mass: 1.5, com: [x, 0] }
    gravity weight { acceleration: [0, -9.81] }
    tsda spring { from: [0, 0.3], to: [x, 0], stiffness: 400, length: 0.4, damping: 3 }
    constraint closure { 0.2m*unit(theta) + 0.5m*unit(phi) == [x, 0]; }
    start theta = a rate w;
}

const UNTIL: f64 = 0.4;

/// Angle and speed of the crank at the end.
fn end(a: f64, w: f64) -> [f64; 2] {
    let mut run = started(Crank { a, w });
    run.advance_to(UNTIL).expect("it moves");
    [run.q()[0], run.qd()[0]]
}

/// Variation of angle and speed at the end, from that at the start, by RK4 on M̄ s̈ + C̄ ṡ + K̄ s = 0 along the motion.
fn varied(start: [f64; 2]) -> [f64; 2] {
    const STEPS: u32 = 400;
    let mut run = started(Crank::<f64>::default());
    let rate = |linear: &Linearization<f64, 3>, [s, sd]: [f64; 2]| {
        let (damping, stiffness) = (linear.damping[0][0], linear.stiffness[0][0]);
        [sd, -(damping * sd + stiffness * s) / linear.mass[0][0]]
    };
    let (mut s, mut first) = (start, about(&run, &[0]));
    let h = UNTIL / f64::from(STEPS);
    for step in 0..STEPS {
        let mut next = |share: f64| {
            run.advance_to((f64::from(step) + share) * h).expect("it moves");
            about(&run, &[0])
        };
        let (middle, last) = (next(0.5), next(1.0));
        let moved = |k: [f64; 2], share: f64| [s[0] + share * h * k[0], s[1] + share * h * k[1]];
        let k1 = rate(&first, s);
        let k2 = rate(&middle, moved(k1, 0.5));
        let k3 = rate(&middle, moved(k2, 0.5));
        let k4 = rate(&last, moved(k3, 1.0));
        s = core::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        first = last;
    }
    s
}

#[test]
fn neighbouring_motions_part_as_the_equation_says() {
    /// Of the largest component: the distance of the neighbours squared, and RK4.
    const BOUND: f64 = 1e-6;
    const DISTANCE: f64 = 2e-5;
    let (a, w) = (1.0, 6.0);
    let parted = |[ahead, behind]: [[f64; 2]; 2]| {
        core::array::from_fn::<f64, 2, _>(|i| (ahead[i] - behind[i]) / (2.0 * DISTANCE))
    };
    let by_angle = parted([end(a + DISTANCE, w), end(a - DISTANCE, w)]);
    let by_speed = parted([end(a, w + DISTANCE), end(a, w - DISTANCE)]);
    for (start, expected) in [([1.0, 0.0], by_angle), ([0.0, 1.0], by_speed)] {
        let found = varied(start);
        let size = expected.iter().fold(0.0, |size: f64, part| size.max(part.abs()));
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < BOUND * size, "{found} instead of {expected}");
        }
    }
}

#[test]
fn coordinates_that_do_not_determine_the_others_give_way_to_such_that_do() {
    // In line, the piston's place says nothing of the crank.
    let mut run = started(Crank { a: 0.0, w: 6.0 });
    run.step(1e-12).expect("a step");
    assert_eq!(about(&run, &[0]).independent, [true, false, false]);
    let found = about(&run, &[2]);
    assert!(found.freedom == 1 && !found.independent[2], "{:?}", found.independent);
    let state = (run.q(), run.qd(), run.qdd());
    let best = linearize(run.mechanism(), run.t(), state, run.lambda()).expect("it is regular");
    assert!(!best.independent[2] && best.mass[0][0] > 0.0);
}
