//! K1: homotopies that end before the required position, at a jump or at the end of the budget; functions replaced on the way.

use core::f64::consts::TAU;

use mbs_runtime::{Budget, Failure, FailureKind, Function, Real, Scalar, Step, Stepper, mechanism};

use crate::linkages::follow::*;
use crate::linkages::texts::*;
use crate::linkages::*;

mechanism! {
    /// A four-bar of bars 1, 2.5, 2 on the ground 3.5, its crank led by a function.
    pub mechanism Led;
    function law: rad(s), C2;
    coord p2: rad = 0.5;
    coord p3: rad = 0.5;
    constraint closure { 1m*unit(law(t)) + 2.5m*unit(p2) == [3.5m, 0] + 2m*unit(p3); }
}

/// The time from `start` (rad) on, and a step of `by` (rad) after `at` (s).
#[derive(Clone, Copy, Debug)]
struct Law {
    start: f64,
    at: f64,
    by: f64,
}

impl<T: Scalar> Function<T> for Law {
    const ORDER: usize = 2;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let step = T::select(T::constant(self.at).less(x), T::constant(self.by), T::constant(0.0));
        let all = [T::constant(self.start) + x + step, T::constant(1.0), T::constant(0.0)];
        core::array::from_fn(|order| all.get(order).copied().unwrap_or(T::constant(0.0)))
    }
}

/// Directions of coupler and rocker at crank angle `theta` (rad).
fn bars(theta: f64, side: f64) -> [f64; 2] {
    let (tip, b) = (STRETCHED.tip(theta), STRETCHED.point(theta, side));
    [(b[1] - tip[1]).atan2(b[0] - tip[0]), b[1].atan2(b[0] - STRETCHED.ground)]
}

/// Distance of the point between coupler and rocker from its exact position at crank angle `theta` (rad).
fn error<R: Real>(stepper: &Stepper<Led<Law, R>, R, 2>, theta: f64, side: f64) -> f64 {
    let p3 = stepper.q()[1].to_f64();
    distance([STRETCHED.ground + 2.0 * p3.cos(), 2.0 * p3.sin()], STRETCHED.point(theta, side))
}

fn led<R: Real>(law: Law, side: f64) -> Stepper<Led<Law, R>, R, 2> {
    let guess = bars(law.start, side).map(R::constant);
    Stepper::assemble(Led::new(law), guess, R::constant(0.0)).expect("an assembly")
}

fn a_jump_is_bracketed<R: Real>(open: f64) {
    let mut refused = 0;
    for by in [-2.0, -1.0, -0.6, 0.6, 1.0, 2.0] {
        for share in [0.013, 0.25, 0.5, 0.77, 0.99] {
            for side in [1.0, -1.0] {
                let (start, h) = (0.9, 0.02);
                let law = Law { start, at: 10.0 * h + share * h, by };
                let mut stepper = led::<R>(law, side);
                for k in 1..=10 {
                    stepper.advance_to(R::constant(f64::from(k) * h)).expect("no jump yet");
                }
                let before = *stepper.q();
                let failure = stepper.advance_to(R::constant(11.0 * h)).expect_err("a jump");
                let Failure { kind: FailureKind::Discontinuous { row, part }, time: Some(time) } = failure
                else {
                    panic!("{by} {failure}")
                };
                assert!(row.name.starts_with("closure"), "{row:?}");
                // Found as narrowly as values of the way differ by more than their rounding.
                assert!((part - share).abs() < 1e4 * R::EPSILON.to_f64(), "{part} {share}");
                assert!((time - 11.0 * h).abs() < 1e-6);
                assert_eq!(*stepper.q(), before);
                assert!(error(&stepper, start + 10.0 * h, side) < open);
                refused += 1;
            }
        }
    }
    assert_eq!(refused, 60);
}

#[test]
fn a_function_that_jumps_between_two_instants_is_refused_with_its_place() {
    a_jump_is_bracketed::<f64>(1e-12);
    // 64 roundings of rows of 3.5 m over the margin there, a third.
    a_jump_is_bracketed::<f32>(2e-4);
}

/// The time from 0.9 rad on, at ten times the speed after `at` (s), or lifted by 0.6 rad within some `width` (s) there.
#[derive(Clone, Copy, Debug)]
struct Sudden {
    at: f64,
    width: Option<f64>,
}

impl<T: Scalar> Function<T> for Sudden {
    const ORDER: usize = 2;

    fn jet<const K: usize>(&self, x: T) -> [T; K] {
        let (zero, one) = (T::constant(0.0), T::constant(1.0));
        let late = x - T::constant(self.at);
        let all = match self.width {
            None => {
                let faster = T::select(zero.less(late), T::constant(9.0), zero);
                [T::constant(0.9) + x + faster * late, one + faster, zero]
            }
            Some(width) => {
                let (width, lift) = (T::constant(width), T::constant(0.3));
                let high = (late / width).tanh();
                let slope = lift * (one - high * high) / width;
                let bend = T::constant(-2.0) * high * slope / width;
                [T::constant(0.9) + x + lift * high, one + slope, bend]
            }
        };
        core::array::from_fn(|order| all.get(order).copied().unwrap_or(zero))
    }
}

#[test]
fn a_kink_and_a_steep_function_are_no_jumps() {
    for width in [None, Some(1e-3), Some(1e-5), Some(1e-8)] {
        for share in [0.013, 0.25, 0.5, 0.99] {
            for side in [1.0, -1.0] {
                let at = 0.2 + 0.02 * share;
                let low = 0.9 - if width.is_some() { 0.3 } else { 0.0 };
                let guess = bars(low, side);
                let mut stepper: Stepper<_, f64, 2> =
                    Stepper::assemble(Led::new(Sudden { at, width }), guess, 0.0).expect("an assembly");
                for k in 1..=20 {
                    let t = 0.02 * f64::from(k);
                    stepper
                        .advance_to(t)
                        .unwrap_or_else(|failure| panic!("{width:?} {share} {k}: {failure}"));
                    let late = t - at;
                    let law = match width {
                        None => 0.9 + t + 9.0 * late.max(0.0),
                        Some(width) => 0.9 + t + 0.3 * (late / width).tanh(),
                    };
                    let p3 = stepper.q()[1];
                    let point = [STRETCHED.ground + 2.0 * p3.cos(), 2.0 * p3.sin()];
                    assert!(distance(point, STRETCHED.point(law, side)) < 1e-12, "{width:?} {share} {k}");
                }
            }
        }
    }
}

#[test]
fn a_function_replaced_between_steps_keeps_the_assembly() {
    for side in [1.0, -1.0] {
        for change in [-0.5, -0.05, 0.05, 0.5, 0.9] {
            let law = Law { start: 1.2, at: 1e9, by: 0.0 };
            let mut stepper = led::<f64>(law, side);
            stepper.advance(0.01).unwrap();
            stepper.change(|linkage| linkage.law = Law { start: 1.2 + change, ..law });
            stepper.advance(0.01).unwrap();
            assert!(error(&stepper, 1.22 + change, side) < 1e-12, "{side} {change}");
            // And over the change point at π from there.
            for k in 3..400 {
                stepper.advance_to(0.01 * f64::from(k)).unwrap();
            }
            assert!(error(&stepper, 1.2 + change + 3.99, side) < 1e-12, "{side} {change}");
        }
    }
}

/// Number of steps of a small budget that a jump of the crank takes.
fn resumed(linkage: &Linkage, from: f64, to: f64, side: f64, newton: u32) -> u32 {
    let mut stepper: Stepper<_, f64, 2> =
        assembled(AnglesByInputInARow::<f64>::default(), linkage, from, side);
    stepper.change(|crank| crank.theta.value = to);
    let mut last = -1.0;
    for count in 1..1_000 {
        match stepper.step(1e-3, Budget { newton, fallback: 0 }) {
            Step::Refused(Failure { kind: FailureKind::OverBudget { part, .. }, .. }) => {
                // Each continues where the one before ended, so none stays in place for long.
                assert!((0.0..1.0).contains(&part), "{part}");
                last = part;
            }
            Step::Refused(Failure { kind: FailureKind::NotConverged { .. }, .. }) if count == 1 => {}
            Step::Refused(failure) => panic!("{failure}"),
            Step::Degraded { .. } => {}
            Step::Done(_) => {
                let point = AnglesByInputInARow::<f64>::point(linkage, *stepper.q());
                let right = distance(point, linkage.point(to, side));
                assert!(right < 1e-9, "{} {from} {to} {side}: {right}", linkage.name);
                return count;
            }
        }
    }
    panic!("{} {from} {to} {side}: not there, last at {last}", linkage.name)
}

#[test]
fn a_way_longer_than_the_budget_is_resumed_by_the_next_step() {
    let mut random = Random(23);
    let (mut all, mut most) = (0, 0);
    for linkage in LINKAGES {
        for side in [1.0, -1.0] {
            for _ in 0..20 {
                let centre = *linkage.centres.first().unwrap_or(&1.0);
                let from = centre + random.between(0.6, 2.5);
                let to = centre - random.between(0.6, 2.5);
                let count = resumed(&linkage, from, to, side, 60);
                (all, most) = (all + count, most.max(count));
            }
        }
    }
    println!("{all} steps, {most} at most");
    // 160 ways, of which many take more than one step.
    assert!(all > 200, "{all}");
}

#[test]
fn a_way_that_once_stood_still_is_resumed() {
    let count = resumed(&STRETCHED, 5.385_474_539_955_038, 2.025_504_462_598_203, -1.0, 60);
    assert!(count < 40, "{count}");
}

/// A crank commanded to advance by `turns` whole turns, then by a tenth of a radian.
fn too_far<R: Real>(linkage: &Linkage, turns: f64, side: f64)
where
    AnglesByInputInARow<R>: Case<R, 2>,
{
    let from = linkage.centres.first().unwrap_or(&1.0) + 1.3;
    let mut stepper: Stepper<_, R, 2> = assembled(AnglesByInputInARow::<R>::default(), linkage, from, side);
    let before = (*stepper.q(), *stepper.qd(), *stepper.qdd(), stepper.t());
    stepper.change(|crank| crank.theta.value = R::constant(from + turns * TAU));
    let failure = stepper.advance(R::constant(1e-3)).expect_err("more pieces than a way has");
    let name = linkage.name;
    let Failure { kind: FailureKind::NotFollowed { part, .. }, time: Some(time) } = failure else {
        panic!("{name} {turns} {side}: {failure}")
    };
    println!("{name} {turns} {side}: {part}");
    assert!((0.0..1.0).contains(&part), "{name} {turns} {side}: {part}");
    assert!((time - 1e-3).abs() < 1e-9, "{time}");
    assert_eq!((*stepper.q(), *stepper.qd(), *stepper.qdd(), stepper.t()), before);
    stepper.change(|crank| crank.theta.value = R::constant(from + 0.1));
    stepper.advance(R::constant(1e-3)).expect("a step next to where it stood");
    let point = AnglesByInputInARow::<R>::point(linkage, stepper.q().map(R::to_f64));
    let right = distance(point, linkage.point(from + 0.1, side));
    // Sixty-four roundings over the margin, a third.
    assert!(right < 200.0 * R::EPSILON.to_f64(), "{name} {turns} {side}: {right}");
}

#[test]
fn a_way_of_more_pieces_than_are_followed_is_refused_and_changes_nothing() {
    for linkage in LINKAGES {
        for side in [1.0, -1.0] {
            // From a turn a piece of rounding in single precision on, the pieces end before the evaluations do.
            too_far::<f64>(&linkage, 3e3, side);
            too_far::<f64>(&linkage, -3e5, side);
            too_far::<f32>(&linkage, 3e3, side);
        }
    }
}

#[test]
fn a_budget_too_small_for_any_part_of_a_way_says_so() {
    let mut stepper: Stepper<_, f64, 2> =
        assembled(AnglesByInputInARow::<f64>::default(), &STRETCHED, 1.0, 1.0);
    stepper.change(|crank| crank.theta.value = 2.5);
    let Step::Refused(Failure { kind: FailureKind::OverBudget { evaluations: 3, required: 9, .. }, .. }) =
        stepper.step(1e-3, Budget { newton: 3, fallback: 0 })
    else {
        panic!("refused with what is missing");
    };
}

#[test]
fn a_small_budget_refuses_passages_and_loses_no_assembly() {
    let mut sum = Tally::default();
    let mut random = Random(29);
    for linkage in LINKAGES {
        for motion in MOTIONS {
            for step in [0.003, 0.03, 0.3] {
                for side in [1.0, -1.0] {
                    let angles = samples(motion, &linkage, step, 200, &mut random);
                    let budget = Steps::Within(Budget { newton: 10, fallback: 20 });
                    let mechanism = AnglesByInputInARow::default();
                    let rates = Rates::Differences;
                    sum = sum.and(follow::<_, f64, 2>(mechanism, &linkage, &angles, side, rates, budget));
                }
            }
        }
    }
    println!("{sum:?}");
    assert_eq!((sum.wrong, sum.off), (0, 0), "{sum:?}");
    assert!(sum.passages > 100, "{sum:?}");
}
