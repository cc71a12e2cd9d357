//! K1: links much shorter than the reference length turned far within one step, and ended in the other assembly with `Ok`.

use mbs_runtime::{Budget, Real};

use crate::k1_inputs_that_turn::the_short_way;
use crate::linkages::follow::*;
use crate::linkages::texts::*;
use crate::linkages::*;

/// Every motion in such steps, with rates and without.
fn run<S: Case<R, N> + Copy, R: Real, const N: usize>(mechanism: S, linkage: &Linkage, by: Steps) -> Tally {
    let (mut sum, mut random) = (Tally::default(), Random(5));
    for step in [0.03, 0.1, 0.3, 1.0, 3.0] {
        for motion in MOTIONS {
            for (rates, side) in [(Rates::Differences, 1.0), (Rates::Zero, -1.0)] {
                // An input that turns goes the short way.
                let angles = the_short_way(&samples(motion, linkage, step, 120, &mut random));
                let tally = follow::<S, R, N>(mechanism, linkage, &angles, side, rates, by);
                if tally.wrong + tally.off > 0 {
                    println!("  {} {} {motion:?} {step} {rates:?} {side}: {tally:?}", S::NAME, linkage.name);
                }
                sum = sum.and(tally);
            }
        }
    }
    println!("{} {} {}: {sum:?}", S::NAME, linkage.name, linkage.crank);
    sum
}

fn is_kept(tally: Tally) {
    assert!(tally.passages > 100, "{tally:?}");
    assert_eq!((tally.wrong, tally.off, tally.refused), (0, 0, 0), "{tally:?}");
}

#[test]
fn points_of_short_links_keep_the_assembly() {
    for linkage in [parallelogram(0.1), stretched(0.1)] {
        is_kept(run::<_, f64, 4>(NaturalByTurn::default(), &linkage, Steps::Advance));
        is_kept(run::<_, f64, 4>(NaturalByTimeInARow::default(), &linkage, Steps::Advance));
    }
}

#[test]
fn angles_led_by_short_links_keep_the_assembly() {
    for linkage in [parallelogram(0.1), stretched(0.1)] {
        is_kept(run::<_, f64, 2>(AnglesByTurnInARow::default(), &linkage, Steps::Advance));
    }
}

#[test]
fn short_links_keep_the_assembly_in_single_precision() {
    for linkage in [parallelogram(0.3), stretched(0.3)] {
        let tally = run::<_, f32, 4>(NaturalByTurn::default(), &linkage, Steps::Advance);
        assert!(tally.passages > 100, "{tally:?}");
        assert_eq!((tally.wrong, tally.off), (0, 0), "{tally:?}");
    }
}

#[test]
fn points_of_links_shorter_than_single_precision_resolves_are_refused() {
    for length in [0.1, 0.05, 0.02] {
        for linkage in [parallelogram(length), stretched(length)] {
            let turn = run::<_, f32, 4>(NaturalByTurn::default(), &linkage, Steps::Advance);
            let time = run::<_, f32, 4>(NaturalByTimeInARow::default(), &linkage, Steps::Advance);
            for tally in [turn, time] {
                println!("{} {tally:?}", linkage.name);
                assert!(tally.passages > 100, "{tally:?}");
                assert_eq!((tally.wrong, tally.off), (0, 0), "{length} {tally:?}");
            }
        }
    }
}

#[test]
fn bounded_steps_keep_the_assembly_of_short_links() {
    let ample = Steps::Within(Budget { newton: 3_000, fallback: 0 });
    let small = Steps::Within(Budget { newton: 10, fallback: 20 });
    for length in [0.3, 0.1] {
        for linkage in [parallelogram(length), stretched(length)] {
            is_kept(run::<_, f64, 4>(NaturalByTurn::default(), &linkage, ample));
            is_kept(run::<_, f64, 2>(AnglesByTurnInARow::default(), &linkage, ample));
            // Steps for which the budget does not suffice are refused.
            let tally = run::<_, f64, 4>(NaturalByTurn::default(), &linkage, small).and(run::<_, f64, 2>(
                AnglesByTurnInARow::default(),
                &linkage,
                small,
            ));
            assert!(tally.passages > 100, "{tally:?}");
            assert_eq!((tally.wrong, tally.off), (0, 0), "{tally:?}");
        }
    }
}
