//! K1: with short cranks, mean and difference of two joints ended in the other assembly with `Ok`. The difference stands still, so rounding
//! was more than its movement: passages were given up next to the change point, and rounding turned the mechanism back.

use mbs_runtime::{Real, Scalar, mechanism};

use crate::k1_points_at_rest::MeansByTime;
use crate::linkages::follow::*;
use crate::linkages::texts::{By, Case};
use crate::linkages::*;

mechanism! {
    /// Mean and difference of the two joints, the crank driven by a rate.
    pub mechanism MeansByRate;
    param a: m = 1;
    param b: m = 2;
    param c: m = 1;
    param d: m = 2;
    param omega: rad/s = 1;
    coord p1: rad = 0.5;
    coord mean: [m; 2] = [0.5, 0.5];
    coord bar: [m; 2] = [0.5, 0.5];
    let A = mean - bar/2;
    let B = mean + bar/2;
    constraint crank { A == a*unit(p1); }
    constraint bars { norm(B - A) == b; norm(B - [d, 0]) == c; }
    drive motor: rate(p1) == omega;
}

impl<T: Scalar> Case<T, 5> for MeansByRate<T> {
    const BY: By = By::Rate;
    fn set_lengths(&mut self, linkage: &Linkage) {
        let Linkage { crank, coupler, rocker, ground, .. } = *linkage;
        [self.a, self.b, self.c, self.d] = [crank, coupler, rocker, ground].map(T::constant);
    }
    fn command(&mut self, _theta: T, rate: T) {
        self.omega = rate;
    }
    fn start(linkage: &Linkage, theta: f64, b: [f64; 2]) -> [f64; 5] {
        let tip = linkage.tip(theta);
        [theta, (tip[0] + b[0]) / 2.0, (tip[1] + b[1]) / 2.0, b[0] - tip[0], b[1] - tip[1]]
    }
    fn point(_linkage: &Linkage, q: [f64; 5]) -> [f64; 2] {
        [q[1] + q[3] / 2.0, q[2] + q[4] / 2.0]
    }
}

/// Every motion in long steps, on both sides.
fn run<S: Case<R, N> + Copy, R: Real, const N: usize>(mechanism: S, linkage: &Linkage) -> Tally {
    let (mut sum, mut random) = (Tally::default(), Random(5));
    for step in [0.03, 0.3, 1.0, 3.0] {
        for motion in MOTIONS {
            for side in [1.0, -1.0] {
                let angles = samples(motion, linkage, step, 120, &mut random);
                let rates = Rates::Differences;
                sum = sum.and(follow::<S, R, N>(mechanism, linkage, &angles, side, rates, Steps::Advance));
            }
        }
    }
    println!("{} {} {}: {sum:?}", S::NAME, linkage.name, linkage.crank);
    sum
}

/// Both linkages with cranks of each length: none in the other assembly.
fn keep<S: Case<R, N> + Copy, R: Real, const N: usize>(mechanism: S, lengths: &[f64]) {
    for length in lengths {
        for linkage in [parallelogram(*length), stretched(*length)] {
            let tally = run::<S, R, N>(mechanism, &linkage);
            assert!(tally.passages > 100, "{length} {tally:?}");
            assert_eq!((tally.wrong, tally.off), (0, 0), "{length} {tally:?}");
            if R::EPSILON.to_f64() < 1e-10 && 1e-4 <= *length {
                let inside = tally.refused_inside as f64 / tally.steps as f64;
                assert!(tally.refused == 0 && inside < 0.05, "{length} {tally:?}");
            }
        }
    }
}

#[test]
fn means_driven_by_time_keep_the_assembly_of_short_links() {
    keep::<_, f64, 4>(MeansByTime::default(), &[1e-2, 1e-3, 2e-4, 1e-4, 1e-5]);
}

#[test]
fn means_driven_by_a_rate_keep_the_assembly_of_short_links() {
    keep::<_, f64, 5>(MeansByRate::default(), &[1e-2, 1e-3, 2e-4, 1e-4, 1e-5]);
}

#[test]
fn means_keep_the_assembly_of_short_links_in_single_precision() {
    keep::<_, f32, 5>(MeansByRate::default(), &[0.1]);
}
