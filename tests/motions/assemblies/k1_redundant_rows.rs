//! K1: rows that are doubled, scaled and mixed over change points. Their answers to open rows are those of a choice, which changes there.

use core::f64::consts::TAU;

use mbs_runtime::{Kinematic, Real, Scalar, Signal, Stepper, mechanism};

use crate::linkages::follow::*;
use crate::linkages::*;

/// A four-bar with more rows than coordinates.
trait Doubled<T: Scalar, const N: usize, const M: usize>: Kinematic<T, N, M> {
    fn set_lengths(&mut self, lengths: [T; 4], factors: [T; 3]);
    fn command(&mut self, theta: Signal<T>);
    fn start(linkage: &Linkage, theta: f64, b: [f64; 2]) -> [f64; N];
    fn point(linkage: &Linkage, q: [f64; N]) -> [f64; 2];
}

macro_rules! doubled {
    ($name:ident, $n:literal, $m:literal, { $($text:tt)* },
     |$linkage:ident, $theta:ident, $b:ident| $start:expr, |$l:ident, $q:ident| $point:expr) => {
        mechanism! {
            /// A four-bar, its rows typed twice.
            pub mechanism $name;
            param a: m = 1;
            param b: m = 2;
            param c: m = 1;
            param d: m = 2;
            param f: [1; 3] = 1;
            input theta: rad, rates;
            $($text)*
        }
        impl<T: Scalar> Doubled<T, $n, $m> for $name<T> {
            fn set_lengths(&mut self, lengths: [T; 4], factors: [T; 3]) {
                [self.a, self.b, self.c, self.d] = lengths;
                self.f = factors;
            }
            fn command(&mut self, theta: Signal<T>) {
                self.theta = theta;
            }
            fn start($linkage: &Linkage, $theta: f64, $b: [f64; 2]) -> [f64; $n] {
                $start
            }
            fn point($l: &Linkage, $q: [f64; $n]) -> [f64; 2] {
                $point
            }
        }
    };
}

/// Directions (rad) of coupler and rocker.
fn directions(linkage: &Linkage, theta: f64, b: [f64; 2]) -> [f64; 2] {
    let [x, y] = linkage.tip(theta);
    [(b[1] - y).atan2(b[0] - x), b[1].atan2(b[0] - linkage.ground)]
}

doubled!(DoubledAngles, 2, 5, {
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    let open = a*unit(theta) + b*unit(p2) - [d, 0] - c*unit(p3);
    constraint closure redundant { open == [0, 0]; }
    constraint again redundant {
        f[0]*open.0 + f[1]*open.1 == 0;
        f[2]*(a*sin(theta) + b*sin(p2)) == f[2]*c*sin(p3);
        f[1]*(a*cos(theta) + b*cos(p2)) == f[1]*(d + c*cos(p3));
    }
}, |linkage, theta, b| directions(linkage, theta, b), |l, q| {
    [l.ground + l.rocker * q[1].cos(), l.rocker * q[1].sin()]
});
doubled!(DoubledPoints, 4, 7, {
    coord A: [m; 2] = [0.5, 0.5];
    coord B: [m; 2] = [0.5, 0.5];
    constraint crank redundant { A == a*unit(theta); f[0]*dot(A, unit(theta)) == f[0]*a; }
    constraint bars redundant { dot(B - A, B - A) == b^2; norm(B - [d, 0]) == c; }
    constraint again redundant { f[1]*norm(B - A) == f[1]*b; f[2]*dot(B - [d, 0], B - [d, 0]) == f[2]*c^2; }
}, |linkage, theta, b| {
    let tip = linkage.tip(theta);
    [tip[0], tip[1], b[0], b[1]]
}, |_l, q| [q[2], q[3]]);
doubled!(DoubledMixed, 5, 8, {
    coord p1: rad = 0.5;
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    coord B: [m; 2] = [0.5, 0.5];
    drive motor: p1 == theta;
    constraint coupler redundant { B == a*unit(p1) + b*unit(p2); }
    constraint rocker redundant { B == [d, 0] + c*unit(p3); }
    constraint again redundant {
        f[0]*(a*cos(p1) + b*cos(p2) - d) == f[0]*c*cos(p3);
        f[1]*norm(B - [d, 0]) == f[1]*c;
        f[2]*dot(B - a*unit(p1), B - a*unit(p1)) == f[2]*b^2;
    }
}, |linkage, theta, b| {
    let [p2, p3] = directions(linkage, theta, b);
    [theta, p2, p3, b[0], b[1]]
}, |_l, q| [q[3], q[4]]);

/// Follows `angles` (rad) with one stepper.
fn run<S, R, const N: usize, const M: usize>(
    linkage: &Linkage,
    angles: &[f64],
    side: f64,
    factors: [f64; 3],
) -> Tally
where
    S: Doubled<R, N, M> + Default,
    R: Real,
{
    let exact = |angle: f64| R::constant(angle).to_f64();
    let still = |theta: f64| Signal {
        value: R::constant(theta),
        rate: R::constant(0.0),
        acceleration: R::constant(0.0),
    };
    let start = exact(angles[0]);
    let mut mechanism = S::default();
    let Linkage { crank, coupler, rocker, ground, .. } = *linkage;
    mechanism.set_lengths([crank, coupler, rocker, ground].map(R::constant), factors.map(R::constant));
    mechanism.command(still(start));
    let guess = S::start(linkage, start, linkage.point(start, side)).map(R::constant);
    let mut stepper: Stepper<S, R, N, M> = Stepper::assemble(mechanism, guess, R::constant(0.0))
        .unwrap_or_else(|failure| panic!("{} {} {start}: {failure}", S::NAME, linkage.name));
    let (mut tally, mut stands) = (Tally::default(), start);
    for angle in angles.iter().skip(1) {
        let theta = exact(*angle);
        stepper.change(|mechanism| mechanism.command(still(theta)));
        let done = stepper.advance(R::constant(1.0)).map(|_| ());
        let q = stepper.q().map(R::to_f64);
        let epsilon = R::EPSILON.to_f64();
        if tally.take(linkage, theta, side, epsilon, done.map(|()| S::point(linkage, q))) {
            let turn = |angle: f64, centre: f64| ((angle - centre) / TAU).floor();
            let passed = linkage.centres.iter().filter(|c| turn(stands, **c) != turn(theta, **c));
            tally.passages += passed.count() as u64;
            stands = theta;
        }
    }
    tally
}

/// Runs of every linkage with factors at random, of rows and of the reference length.
fn at_random<S, R, const N: usize, const M: usize>(count: usize) -> Tally
where
    S: Doubled<R, N, M> + Default,
    R: Real,
{
    let (mut sum, mut random) = (Tally::default(), Random(M as u64));
    for linkage in LINKAGES {
        for motion in MOTIONS {
            for step in [0.03, 0.3, 1.0, 3.0] {
                for side in [1.0, -1.0] {
                    let factors = [0; 3].map(|_| 10.0_f64.powf(random.between(-1.0, 1.0)));
                    let angles = samples(motion, &linkage, step, count, &mut random);
                    let tally = run::<S, R, N, M>(&linkage, &angles, side, factors);
                    if tally.wrong + tally.off + tally.refused > 0 {
                        println!("  {} {motion:?} {step} {side} {factors:?}: {tally:?}", linkage.name);
                    }
                    sum = sum.and(tally);
                }
            }
        }
    }
    println!("{} {}: {sum:?}", S::NAME, if R::EPSILON.to_f64() < 1e-10 { "f64" } else { "f32" });
    sum
}

/// No position in the other assembly, and no refusal at regular positions.
fn keeps(tally: Tally) {
    assert!(tally.passages > 200, "{tally:?}");
    assert_eq!((tally.wrong, tally.off, tally.refused), (0, 0, 0), "{tally:?}");
}

#[test]
fn doubled_rows_in_angles_keep_the_assembly() {
    keeps(at_random::<DoubledAngles, f64, 2, 5>(40));
}

#[test]
fn doubled_rows_of_points_keep_the_assembly() {
    keeps(at_random::<DoubledPoints, f64, 4, 7>(40));
}

#[test]
fn doubled_rows_in_mixed_coordinates_keep_the_assembly() {
    keeps(at_random::<DoubledMixed, f64, 5, 8>(40));
}

#[test]
fn doubled_rows_in_single_precision_are_right_or_refused() {
    for tally in [
        at_random::<DoubledAngles<f32>, f32, 2, 5>(40),
        at_random::<DoubledPoints<f32>, f32, 4, 7>(40),
        at_random::<DoubledMixed<f32>, f32, 5, 8>(40),
    ] {
        assert!(tally.passages > 200, "{tally:?}");
        assert_eq!((tally.wrong, tally.off), (0, 0), "{tally:?}");
    }
}
