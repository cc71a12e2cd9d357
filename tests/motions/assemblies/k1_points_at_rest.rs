//! K1: a difference of two points that stands still while others turn was judged by its own movement, which is none. Ways were followed in
//! thousands of pieces, ended next to a change point, or were given up at regular positions (`NotFollowed`).

use core::f64::consts::TAU;

use mbs_runtime::{Budget, Lanes, Scalar, Signal, Stepper, mechanism};

use crate::linkages::follow::*;
use crate::linkages::texts::{By, Case};
use crate::linkages::*;

mechanism! {
    /// Mean and difference of the two joints: one block of four unknowns.
    pub mechanism Means;
    param a: m = 1;
    param b: m = 2;
    param c: m = 1;
    param d: m = 2;
    input theta: rad, rates;
    coord mean: [m; 2] = [0.5, 0.5];
    coord bar: [m; 2] = [0.5, 0.5];
    let A = mean - bar/2;
    let B = mean + bar/2;
    constraint crank { A == a*unit(theta); }
    constraint bars { dot(B - A, B - A) == b^2; dot(B - [d, 0], B - [d, 0]) == c^2; }
}

mechanism! {
    /// The same with lengths as rows, driven by the time.
    pub mechanism MeansByTime;
    param a: m = 1;
    param b: m = 2;
    param c: m = 1;
    param d: m = 2;
    coord mean: [m; 2] = [0.5, 0.5];
    coord bar: [m; 2] = [0.5, 0.5];
    let A = mean - bar/2;
    let B = mean + bar/2;
    constraint crank { A == a*unit(1*t/1s); }
    constraint bars { norm(B - A) == b; norm(B - [d, 0]) == c; }
}

mechanism! {
    /// Sums and differences of joints and of angles: one block of six unknowns.
    pub mechanism Sums;
    param a: m = 1;
    param b: m = 2;
    param c: m = 1;
    param d: m = 2;
    input theta: rad, rates;
    coord both: [m; 2] = [0.5, 0.5];
    coord bar: [m; 2] = [0.5, 0.5];
    coord e: rad = 0.5;
    coord f: rad = 0.5;
    let A = (both + bar)/2;
    let B = (both - bar)/2;
    let coupler = (e + f)/2;
    let rocker = (e - f)/2;
    constraint crank { A == a*unit(theta); }
    constraint coupler { B == A + b*unit(coupler); }
    constraint rocker { B == [d, 0] + c*unit(rocker); }
}

fn direction(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[1] - from[1]).atan2(to[0] - from[0])
}

fn of_means(tip: [f64; 2], b: [f64; 2]) -> [f64; 4] {
    [(tip[0] + b[0]) / 2.0, (tip[1] + b[1]) / 2.0, b[0] - tip[0], b[1] - tip[1]]
}

macro_rules! case {
    ($name:ident, $n:literal, $by:expr, |$crank:ident, $theta:ident, $rate:ident| $command:expr,
     |$l:ident, $tip:ident, $b:ident| $guess:expr, |$ll:ident, $q:ident| $point:expr) => {
        impl<T: Scalar> Case<T, $n> for $name<T> {
            const BY: By = $by;
            fn set_lengths(&mut self, linkage: &Linkage) {
                let Linkage { crank, coupler, rocker, ground, .. } = *linkage;
                [self.a, self.b, self.c, self.d] = [crank, coupler, rocker, ground].map(T::constant);
            }
            fn command(&mut self, $theta: T, $rate: T) {
                let $crank = self;
                $command
            }
            fn start($l: &Linkage, theta: f64, $b: [f64; 2]) -> [f64; $n] {
                let $tip = $l.tip(theta);
                $guess
            }
            fn point($ll: &Linkage, $q: [f64; $n]) -> [f64; 2] {
                $point
            }
        }
    };
}

case!(
    Means,
    4,
    By::Input,
    |crank, theta, rate| crank.theta = Signal::new(theta, rate, T::constant(0.0)),
    |_l, tip, b| of_means(tip, b),
    |_l, q| [q[0] + q[2] / 2.0, q[1] + q[3] / 2.0]
);
case!(MeansByTime, 4, By::Time(1.0), |_crank, _theta, _rate| (), |_l, tip, b| of_means(tip, b), |_l, q| [
    q[0] + q[2] / 2.0,
    q[1] + q[3] / 2.0
]);
case!(
    Sums,
    6,
    By::Input,
    |crank, theta, rate| crank.theta = Signal::new(theta, rate, T::constant(0.0)),
    |l, tip, b| {
        let [coupler, rocker] = [direction(tip, b), direction([l.ground, 0.0], b)];
        [tip[0] + b[0], tip[1] + b[1], tip[0] - b[0], tip[1] - b[1], coupler + rocker, coupler - rocker]
    },
    |l, q| {
        let rocker = (q[4] - q[5]) / 2.0;
        [l.ground + l.rocker * rocker.cos(), l.rocker * rocker.sin()]
    }
);

/// More than any step takes.
const AMPLE: Steps = Steps::Within(Budget { newton: 3_000, fallback: 0 });

/// Every motion of every linkage in long steps and short ones.
fn run<S: Case<f64, N> + Copy, const N: usize>(mechanism: S, by: Steps) -> Tally {
    let (mut sum, mut random) = (Tally::default(), Random(81));
    for linkage in LINKAGES {
        for motion in MOTIONS {
            for step in [0.03, 0.3, 1.0, 3.0] {
                for (rates, side) in [(Rates::Differences, 1.0), (Rates::Zero, 1.0), (Rates::Zero, -1.0)] {
                    let angles = samples(motion, &linkage, step, 120, &mut random);
                    sum = sum.and(follow::<S, f64, N>(mechanism, &linkage, &angles, side, rates, by));
                }
            }
        }
    }
    println!("{}: {sum:?}", S::NAME);
    sum
}

fn is_kept(tally: Tally) {
    assert!(tally.passages > 100, "{tally:?}");
    assert_eq!((tally.wrong, tally.off, tally.refused), (0, 0, 0), "{tally:?}");
}

#[test]
fn mean_and_difference_of_two_joints_keep_the_assembly() {
    is_kept(run(Means::default(), Steps::Advance));
    is_kept(run(MeansByTime::default(), Steps::Advance));
    is_kept(run(MeansByTime::default(), AMPLE));
}

#[test]
fn sums_of_joints_and_angles_keep_the_assembly() {
    is_kept(run(Sums::default(), Steps::Advance));
    is_kept(run(Sums::default(), AMPLE));
}

#[test]
fn lanes_keep_the_assembly_of_sums() {
    let mut random = Random(9);
    let mut sum = Tally::default();
    for linkage in LINKAGES {
        for step in [0.3, 3.0] {
            let mut run = |side| (samples(Motion::Steady, &linkage, step, 60, &mut random), side);
            let runs = [run(1.0), run(-1.0), run(1.0), run(-1.0)];
            let sums = Sums::<Lanes<f64, 4>>::default();
            sum = sum.and(follow_in_lanes::<_, f64, 6>(sums, &linkage, &runs, Rates::Differences));
        }
    }
    assert!(sum.steps > 1000, "{sum:?}");
    assert_eq!((sum.wrong, sum.off, sum.refused), (0, 0, 0), "{sum:?}");
}

/// A coupler that keeps its direction stands still as a difference. A turn over both change points was given up after 30 000 evaluations.
#[test]
fn a_turn_takes_hundreds_of_evaluations() {
    let means: Means = Means { theta: Signal::at_rest(0.5), ..Means::default() };
    let start = of_means(PARALLELOGRAM.tip(0.5), PARALLELOGRAM.point(0.5, 1.0));
    let mut stepper: MeansStepper<f64> = Stepper::assemble(means, start, 0.0).expect("an assembly");
    stepper.change(|means| means.theta = Signal::at_rest(0.5 + TAU));
    let statistics = stepper.advance(1.0).expect("a whole turn");
    assert!(statistics.evaluations < 1000, "{statistics:?}");
}
