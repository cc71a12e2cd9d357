//! A whole kinematic step: position, velocity, acceleration.

mod block_triangular;
mod casadi;
mod dense;
mod emitted;

use std::f64::consts::TAU;
use std::hint::black_box;

use mbs_runtime::{Lanes, Scalar, Signal};

use crate::measure::Case;
use crate::texts::{Chain10, Chain40, CommandedFourBar, FourBar};

/// Steps of a turn.
const STEPS: u32 = 1000;

/// Time of a step (s); a turn takes a second.
const STEP: f64 = 1.0 / STEPS as f64;

/// Position, velocity, acceleration.
#[derive(Clone, Copy)]
pub struct Motion<const N: usize> {
    pub q: [f64; N],
    pub qd: [f64; N],
    pub qdd: [f64; N],
}

/// One step to time `t`.
pub type Step<const N: usize> = fn(f64, &mut Motion<N>);

/// The lecture's four-bar.
pub fn four_bar() -> Vec<Case> {
    let start = emitted::start(FourBar::default(), [0.0, 0.0, 0.0, 0.9, 1.8]);
    let turn = Turn::new("four_bar_step", start, dense::four_bar);
    vec![
        turn.case("casadi_previous", casadi::four_bar),
        turn.case("casadi_predicted", |t, motion| {
            predict(motion);
            casadi::four_bar(t, motion);
        }),
        turn.case("casadi_factored", |t, motion| {
            predict(motion);
            casadi::factored_four_bar(t, motion);
        }),
        turn.case("nalgebra", dense::four_bar),
        turn.case("by_hand", block_triangular::four_bar),
        emitted::turn(&turn, FourBar::default()),
        emitted::lanes::<_, 8, 5>("emitted_lanes", &turn, FourBar::default()),
        emitted::lanes::<_, 4, 5>("emitted_4_lanes", &turn, FourBar::default()),
        emitted::commanded("emitted_with_inputs", &turn, CommandedFourBar::default(), |stepper, t| {
            stepper.change(|four_bar| four_bar.angle = angle(t));
        }),
        emitted::commanded_lanes::<_, 8, 5>(
            "emitted_lanes_with_inputs",
            &turn,
            CommandedFourBar::default(),
            |batch, times| {
                batch.change(|four_bar| four_bar.angle = angle(Lanes(times)));
            },
        ),
    ]
}

/// Commanded angle of the crank at time `t` (s): the same as in the texts driven by time.
fn angle<T: Scalar>(t: T) -> Signal<T> {
    let rate = T::constant(TAU);
    Signal { value: rate * t, rate, acceleration: T::constant(0.0) }
}

/// Ten loops in natural coordinates, and forty to see the growth.
pub fn chain() -> Vec<Case> {
    let start = emitted::start(Chain10::default(), upright());
    let turn = Turn::new("chain_step", start, dense::chain);
    let mut cases = vec![
        turn.case("casadi_previous", casadi::chain),
        turn.case("casadi_predicted", |t, motion| {
            predict(motion);
            casadi::chain(t, motion);
        }),
        turn.case("casadi_factored", |t, motion| {
            predict(motion);
            casadi::factored_chain(t, motion);
        }),
        turn.case("nalgebra", dense::chain),
        turn.case("by_hand", block_triangular::chain),
        emitted::turn(&turn, Chain10::default()),
        emitted::lanes::<_, 8, 22>("emitted_lanes", &turn, Chain10::default()),
        emitted::lanes::<_, 4, 22>("emitted_4_lanes", &turn, Chain10::default()),
    ];
    cases.push(Case { name: "emitted_40", ..emitted::turn(&turn.longer(), Chain40::default()) });
    cases
}

/// Uprights upright.
fn upright<const N: usize>() -> [f64; N] {
    std::array::from_fn(|k| (k % 2) as f64)
}

/// The position that velocity and acceleration foresee.
#[inline(always)]
fn predict<const N: usize>(motion: &mut Motion<N>) {
    for k in 0..N {
        motion.q[k] += STEP * (motion.qd[k] + 0.5 * STEP * motion.qdd[k]);
    }
}

/// A turn of a mechanism.
struct Turn<const N: usize> {
    group: &'static str,
    start: Motion<N>,
    /// After half a turn, and after the whole one.
    expected: [Motion<N>; 2],
}

impl<const N: usize> Turn<N> {
    fn new(group: &'static str, start: Motion<N>, reference: Step<N>) -> Self {
        let expected = ends(start, reference);
        Turn { group, start, expected }
    }

    fn case(&self, name: &'static str, step: Step<N>) -> Case {
        let error = self.error(&ends(self.start, step));
        let start = self.start;
        let run = move || {
            let mut motion = *black_box(&start);
            for k in 1..=STEPS {
                black_box(step)(f64::from(k) * STEP, &mut motion);
            }
            black_box(&motion);
        };
        Case { group: self.group, name, work: STEPS, error, run: Box::new(run) }
    }

    /// The chain with more loops: all points move alike.
    fn longer<const L: usize>(&self) -> Turn<L> {
        let motion = |motion: &Motion<N>| {
            let [q, qd, qdd] = [motion.q, motion.qd, motion.qdd].map(|x| std::array::from_fn(|k| x[k % 2]));
            Motion { q, qd, qdd }
        };
        Turn { group: self.group, start: motion(&self.start), expected: self.expected.each_ref().map(motion) }
    }

    /// Largest difference from the reference, over the largest value of position, velocity, acceleration.
    fn error(&self, found: &[Motion<N>; 2]) -> f64 {
        let mut largest = 0.0;
        for (expected, found) in self.expected.iter().zip(found) {
            for (expected, found) in
                [(&expected.q, &found.q), (&expected.qd, &found.qd), (&expected.qdd, &found.qdd)]
            {
                let scale = expected.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
                for (expected, found) in expected.iter().zip(found) {
                    let error = (expected - found).abs() / scale.max(1.0);
                    largest = if error <= largest { largest } else { error };
                }
            }
        }
        largest
    }
}

fn ends<const N: usize>(start: Motion<N>, step: Step<N>) -> [Motion<N>; 2] {
    let (mut motion, mut half) = (start, start);
    for k in 1..=STEPS {
        step(f64::from(k) * STEP, &mut motion);
        if 2 * k == STEPS {
            half = motion;
        }
    }
    [half, motion]
}
