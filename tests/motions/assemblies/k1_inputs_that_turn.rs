//! K1: an encoder that wraps from π to −π drove its crank all the way back, over the change points there.

use core::f64::consts::{PI, TAU};

use mbs_runtime::{Batch, Budget, Lanes, Real, Signal, Step, Stepper, mechanism};

use crate::linkages::follow::*;
use crate::linkages::texts::*;
use crate::linkages::*;

/// Such angles (rad) with each one on the short way from the one before.
pub fn the_short_way(angles: &[f64]) -> Vec<f64> {
    let mut all = vec![angles[0]];
    for angle in &angles[1..] {
        let last = all[all.len() - 1];
        all.push(last + (angle - last) - TAU * ((angle - last) / TAU).round());
    }
    all
}

/// Every motion of every linkage in steps that wrap many times.
fn wrapped<S: Case<R, N> + Copy, R: Real, const N: usize>(mechanism: S) -> Tally {
    let mut sum = Tally::default();
    let mut random = Random(7);
    for linkage in LINKAGES {
        for motion in MOTIONS {
            for step in [0.01, 0.1, 0.3, 1.0, 3.0] {
                for (side, rates) in [(1.0, Rates::Differences), (-1.0, Rates::Zero)] {
                    let count = if step < 0.02 { 300 } else { 60 };
                    let angles = the_short_way(&samples(motion, &linkage, step, count, &mut random));
                    let tally = follow::<S, R, N>(mechanism, &linkage, &angles, side, rates, Steps::Advance);
                    if tally.wrong + tally.off + tally.refused > 0 {
                        println!("  {} {motion:?} {step} {rates:?} {side}: {tally:?}", linkage.name);
                    }
                    sum = sum.and(tally);
                }
            }
        }
    }
    sum
}

/// Jumps of up to 6 rad either way, from and to anywhere.
fn jumped<S: Case<R, N> + Copy, R: Real, const N: usize>(mechanism: S) -> Tally {
    let mut sum = Tally::default();
    let mut random = Random(11);
    for linkage in LINKAGES {
        for side in [1.0, -1.0] {
            let start = linkage.centres.first().unwrap_or(&1.0) + 1.3;
            let mut angles = vec![start];
            for _ in 0..100 {
                angles.push(angles[angles.len() - 1] + random.between(-6.0, 6.0));
            }
            let angles = the_short_way(&angles);
            sum = sum.and(follow::<S, R, N>(mechanism, &linkage, &angles, side, Rates::Zero, Steps::Advance));
        }
    }
    sum
}

fn is_kept(tally: Tally) {
    println!("{tally:?}");
    assert!(tally.passages > 100, "{tally:?}");
    assert_eq!((tally.wrong, tally.off, tally.refused), (0, 0, 0), "{tally:?}");
}

#[test]
fn an_encoder_that_wraps_next_to_a_change_point_keeps_the_assembly() {
    is_kept(wrapped::<_, f64, 2>(AnglesByTurnInARow::default()));
    is_kept(wrapped::<_, f64, 4>(NaturalByTurn::default()));
}

#[test]
fn an_encoder_that_wraps_keeps_the_assembly_in_single_precision() {
    is_kept(wrapped::<_, f32, 2>(AnglesByTurnInARow::default()));
    is_kept(wrapped::<_, f32, 4>(NaturalByTurn::default()));
}

#[test]
fn jumps_of_an_input_that_turns_go_the_short_way_round() {
    is_kept(jumped::<_, f64, 2>(AnglesByTurnInARow::default()));
    is_kept(jumped::<_, f64, 4>(NaturalByTurn::default()));
}

#[test]
fn encoders_that_wrap_in_lanes_keep_their_assemblies() {
    let mut random = Random(13);
    let mut sum = Tally::default();
    for linkage in LINKAGES {
        for motion in MOTIONS {
            for step in [0.03, 0.3, 3.0] {
                let mut run = |side| (the_short_way(&samples(motion, &linkage, step, 60, &mut random)), side);
                let runs = [run(1.0), run(-1.0), run(1.0), run(-1.0)];
                let mechanism = AnglesByTurnInARow::<Lanes<f64, 4>>::default();
                sum = sum.and(follow_in_lanes::<_, f64, 2>(mechanism, &linkage, &runs, Rates::Differences));
            }
        }
    }
    assert_eq!((sum.wrong, sum.off, sum.refused), (0, 0, 0), "{sum:?}");
}

mechanism! {
    /// Two cranks, and two rods from their tips to one point.
    pub mechanism TwoCranks;
    input alpha: turn, rates;
    input beta: turn, rates;
    coord B: [m; 2] = [1, 0.7];
    constraint rods { norm(B - 1m*unit(alpha)) == 1.2m; norm(B - [2m, 0] - 1m*unit(beta)) == 1.2m; }
}

/// Cranks at such angles (rad).
fn turned(value: f64) -> Signal<f64> {
    Signal { value, ..Signal::default() }
}

/// The point with both cranks at `angle` (rad): the rods are 2 m apart there.
fn above(angle: f64) -> [f64; 2] {
    [1.0 + angle.cos(), 0.44_f64.sqrt() + angle.sin()]
}

#[test]
fn two_inputs_at_once_go_straight_through_their_wraps() {
    for (from, to) in [(3.0, 5.5 - TAU), (-2.0, 2.0), (0.2, 2.9), (PI - 1e-3, 1e-2 - PI)] {
        let mechanism = TwoCranks { alpha: turned(from), beta: turned(from) };
        let stepper: Stepper<_, f64, 2> = Stepper::assemble(mechanism, above(from), 0.0).unwrap();
        let mut both = stepper;
        both.change(|cranks| (cranks.alpha.value, cranks.beta.value) = (to, to));
        both.advance(1e-3).unwrap();
        assert!(distance(*both.q(), above(to)) < 1e-12, "{from} {to}");
        // Whatever whole turns the numbers count.
        let mut counted = stepper;
        counted.change(|cranks| (cranks.alpha.value, cranks.beta.value) = (to + 3.0 * TAU, to - 2.0 * TAU));
        counted.advance(1e-3).unwrap();
        assert!(distance(*counted.q(), above(to)) < 1e-12, "{from} {to}");
    }
    // One after the other they come too far apart, which the way notices though its end does not.
    let mechanism = TwoCranks { alpha: turned(0.2), beta: turned(0.2) };
    let mut one: Stepper<_, f64, 2> = Stepper::assemble(mechanism, above(0.2), 0.0).unwrap();
    one.change(|cranks| cranks.alpha.value = 2.9);
    assert!(one.advance(1e-3).is_err());
    one.change(|cranks| cranks.beta.value = 2.9);
    one.advance(1e-3).unwrap();
    assert!(distance(*one.q(), above(2.9)) < 1e-12);
}

mechanism! {
    /// A wiper whose crank has a coordinate of its own.
    pub mechanism DrivenCrank;
    input theta: turn, rates;
    coord crank: rad = 0;
    coord rod: rad = 0.9;
    coord arm: rad = 1.8;
    constraint motor { sin(crank - theta) == 0; }
    constraint closure { 0.10m*unit(crank) + 0.25m*unit(rod) == [0.30m, 0] + 0.20m*unit(arm); }
    branch motor_ahead: cos(crank - theta) > 0;
}

mechanism! {
    /// The same without that coordinate.
    pub mechanism PrescribedCrank;
    input theta: turn, rates;
    coord rod: rad = 0.9;
    coord arm: rad = 1.8;
    constraint closure { 0.10m*unit(theta) + 0.25m*unit(rod) == [0.30m, 0] + 0.20m*unit(arm); }
}

/// The form that the message on `drive motor: crank == theta` names.
#[test]
fn a_coordinate_held_to_an_input_that_turns_follows_it() {
    for step in [0.006, 0.3, -1.3, 2.5] {
        let mut driven: Stepper<_, f64, 3> =
            Stepper::assemble(DrivenCrank::default(), [0.0, 0.9, 1.8], 0.0).unwrap();
        let mut prescribed: Stepper<_, f64, 2> =
            Stepper::assemble(PrescribedCrank::default(), [0.9, 1.8], 0.0).unwrap();
        for tick in 1..=1000 {
            let angle = step * f64::from(tick);
            let theta = Signal { value: angle.rem_euclid(TAU), rate: 6.0, acceleration: 2.0 };
            driven.change(|wiper| wiper.theta = theta);
            prescribed.change(|wiper| wiper.theta = theta);
            driven.advance(1e-3).unwrap();
            prescribed.advance(1e-3).unwrap();
            assert!((driven.q()[0] - angle).abs() < 1e-11, "{step} {tick}");
            let (q, qd, qdd) = (driven.q(), driven.qd(), driven.qdd());
            assert!(distance([q[1], q[2]], *prescribed.q()) < 1e-11, "{step} {tick}");
            assert!(distance([qd[1], qd[2]], *prescribed.qd()) < 1e-10, "{step} {tick}");
            assert!(distance([qdd[1], qdd[2]], *prescribed.qdd()) < 1e-9, "{step} {tick}");
        }
    }
}

mechanism! {
    /// The driven crank, its angle without winding of its own.
    pub mechanism TurningCrank;
    input theta: turn, rates;
    coord crank: turn = 0;
    coord rod: rad = 0.9;
    coord arm: rad = 1.8;
    constraint motor { sin(crank - theta) == 0; }
    constraint closure { 0.10m*unit(crank) + 0.25m*unit(rod) == [0.30m, 0] + 0.20m*unit(arm); }
    branch motor_ahead: cos(crank - theta) > 0;
}

/// Largest distance between directions of such angles (rad).
fn off(angles: [f64; 3], exact: [f64; 3]) -> f64 {
    let chord = |(a, b): (f64, f64)| 2.0 * ((a - b) / 2.0).sin().abs();
    angles.into_iter().zip(exact).map(chord).fold(0.0, f64::max)
}

/// The exact angles at a crank angle, from the text without the crank's coordinate.
fn wiper(stepper: &mut Stepper<PrescribedCrank<f64>, f64, 2>, angle: f64) -> [f64; 3] {
    stepper.change(|wiper| wiper.theta = turned(angle));
    stepper.advance(1e-3).unwrap();
    [angle, stepper.q()[0], stepper.q()[1]]
}

fn prescribed() -> Stepper<PrescribedCrank<f64>, f64, 2> {
    Stepper::assemble(PrescribedCrank::default(), [0.9, 1.8], 0.0).unwrap()
}

macro_rules! held_to_an_input {
    ($($test:ident: $mechanism:ident, $real:ident, $open:literal;)*) => {
        $(#[test]
        fn $test() {
            let guess = [0.0, 0.9, 1.8].map(|angle: f64| angle as $real);
            for step in [0.006, 0.3, -1.3, 2.5] {
                let reading = |tick: i32, step: f64| (step * f64::from(tick)).rem_euclid(TAU) as $real;
                let signal = |value: $real| Signal { value, rate: 6.0, acceleration: 2.0 };
                for budget in [None, Some(Budget { newton: 300, fallback: 0 })] {
                    let mechanism = $mechanism::<$real>::default();
                    let mut driven: Stepper<_, $real, 3> = Stepper::assemble(mechanism, guess, 0.0).unwrap();
                    let mut exact = prescribed();
                    for tick in 1..=500 {
                        let theta = reading(tick, step);
                        driven.change(|wiper| wiper.theta = signal(theta));
                        match budget {
                            None => driven.advance(1e-3).map(|_| ()).unwrap(),
                            Some(budget) => match driven.step(1e-3, budget) {
                                Step::Done(_) => {}
                                other => panic!("{step} {tick}: {other:?}"),
                            },
                        }
                        let error = off(driven.q().map(Real::to_f64), wiper(&mut exact, theta.to_f64()));
                        assert!(error < $open, "{step} {tick} {budget:?}: {error:e}");
                    }
                }
                let lanes = $mechanism::<Lanes<$real, 2>>::default();
                let mut batch: Batch<_, $real, 2, 3> = Batch::assemble(lanes, &[guess; 2], [0.0; 2]).unwrap();
                let mut exact = [prescribed(), prescribed()];
                for tick in 1..=500 {
                    let theta = [reading(tick, step), reading(tick, -0.7 * step)];
                    let of = |number: $real| Lanes([number; 2]);
                    batch.change(|wiper| {
                        wiper.theta = Signal { value: Lanes(theta), rate: of(6.0), acceleration: of(2.0) };
                    });
                    let t = batch.t().0.map(|t| t + 1e-3);
                    for (lane, done) in batch.advance_to(t).into_iter().enumerate() {
                        done.unwrap_or_else(|failure| panic!("{step} {tick} {lane}: {failure}"));
                        let q = batch.q().map(|q| q.0[lane].to_f64());
                        let error = off(q, wiper(&mut exact[lane], theta[lane].to_f64()));
                        assert!(error < $open, "{step} {tick} {lane}: {error:e}");
                    }
                }
            }
        })*
    };
}

// In `f32` a crank of ten turns and more has the rounding of its numbers, 64 ε of rows that are a third of the reference length.
held_to_an_input! {
    a_crank_of_radians_follows_its_encoder: DrivenCrank, f64, 1e-10;
    a_crank_that_turns_follows_its_encoder: TurningCrank, f64, 1e-11;
    a_crank_of_radians_follows_its_encoder_in_single_precision: DrivenCrank, f32, 1e-3;
    a_crank_that_turns_follows_its_encoder_in_single_precision: TurningCrank, f32, 1e-4;
}

#[test]
fn changes_that_wait_for_a_step_add_up_in_lanes_too() {
    let start = 3.0;
    let mechanism = TwoCranks { alpha: turned(start), beta: turned(start) };
    let mut stepper: Stepper<_, f64, 2> = Stepper::assemble(mechanism, above(start), 0.0).unwrap();
    let lanes = TwoCranks::<Lanes<f64, 2>> {
        alpha: Signal { value: Lanes([start; 2]), ..Signal::default() },
        beta: Signal { value: Lanes([start; 2]), ..Signal::default() },
    };
    let mut batch: Batch<_, f64, 2, 2> = Batch::assemble(lanes, &[above(start); 2], [0.0; 2]).unwrap();
    // No number on the way, and back: 3 rad, −2 rad the short way, then on to 0.5 rad.
    for angle in [-2.0, f64::NAN, 0.5] {
        stepper.change(|cranks| (cranks.alpha.value, cranks.beta.value) = (angle, angle));
        batch.change(|cranks| {
            (cranks.alpha.value, cranks.beta.value) = (Lanes([angle; 2]), Lanes([angle; 2]));
        });
        if angle.is_nan() {
            assert!(stepper.advance(1e-3).is_err());
        }
    }
    stepper.advance(1e-3).unwrap();
    assert!(distance(*stepper.q(), above(0.5)) < 1e-12);
    for (lane, step) in batch.advance_to([1e-3; 2]).into_iter().enumerate() {
        step.unwrap();
        assert!(distance(batch.q().map(|q| q.0[lane]), above(0.5)) < 1e-12);
    }
}
