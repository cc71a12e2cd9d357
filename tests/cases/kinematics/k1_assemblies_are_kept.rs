//! K1, K2, K4: an assembly lost silently where time, an input, a parameter or a phase drives the crank.

use core::f64::consts::TAU;

use mbs_runtime::Real;

use crate::linkages::follow::*;
use crate::linkages::texts::*;
use crate::linkages::*;

/// Steps (rad).
const STEPS: [f64; 7] = [0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0];

/// Every motion of every linkage in every step, once.
fn matrix<S, R, const N: usize>(mechanism: S, by: By2) -> Tally
where
    S: Case<R, N> + Copy,
    R: Real,
{
    let mut sum = Tally::default();
    let mut random = Random(N as u64);
    for linkage in LINKAGES {
        let mut of_linkage = Tally::default();
        for motion in MOTIONS {
            for step in STEPS {
                for rates in [Rates::Differences, Rates::Zero] {
                    for side in [1.0, -1.0] {
                        let seed = random.0;
                        // Numbers of seven digits tell angles apart for some turns.
                        let turns = if R::EPSILON.to_f64() > 1e-10 { 2.0 } else { 1e3 };
                        let count = if step < 0.02 { 300 } else { 60.min((turns * TAU / step) as usize + 2) };
                        let angles = samples(motion, &linkage, step, count, &mut random);
                        let tally = follow::<S, R, N>(mechanism, &linkage, &angles, side, rates, by);
                        if tally.wrong + tally.off + tally.refused > 0 {
                            println!("  {} {motion:?} {step} {rates:?} {side} seed {seed}: {tally:?}", linkage.name);
                        }
                        of_linkage = of_linkage.and(tally);
                    }
                }
            }
        }
        println!("{} {}: {of_linkage:?}", S::NAME, linkage.name);
        sum = sum.and(of_linkage);
    }
    sum
}

fn holds(tally: Tally) {
    assert!(tally.passages > 100, "{tally:?}");
    assert_eq!((tally.wrong, tally.off, tally.refused), (0, 0, 0), "{tally:?}");
}

macro_rules! kept {
    ($($test:ident: $mechanism:expr, $real:ty;)*) => {
        $(#[test]
        fn $test() {
            holds(matrix::<_, $real, _>($mechanism, By2::Advance));
        })*
    };
}

kept! {
    angles_driven_by_time: AnglesByTime::default(), f64;
    time_in_a_vector_row_keeps_the_assembly: AnglesByTimeInARow::default(), f64;
    a_function_in_a_vector_row_keeps_the_assembly: AnglesByFunctionInARow::new(Twice), f64;
    angles_driven_by_an_input: AnglesByInput::default(), f64;
    an_input_in_a_vector_row_keeps_the_assembly: AnglesByInputInARow::default(), f64;
    angles_driven_by_a_rate: AnglesByRate::default(), f64;
    relative_angles_driven_by_time: RelativeByTime::default(), f64;
    relative_angles_driven_by_an_input: RelativeByInput::default(), f64;
    natural_time_in_a_row: NaturalByTimeInARow::default(), f64;
    natural_input_in_a_row: NaturalByInputInARow::default(), f64;
    natural_driven_by_an_input: NaturalByInput::default(), f64;
    natural_driven_by_a_rate: NaturalByRate::default(), f64;
    reference_points_driven_by_an_input: ReferencePointsByInput::default(), f64;
    mixed_input_in_a_row: MixedByInputInARow::default(), f64;
    mixed_driven_by_time: MixedByTime::default(), f64;
    single_time_in_a_vector_row: AnglesByTimeInARow::default(), f32;
    single_angles_driven_by_an_input: AnglesByInput::default(), f32;
    single_natural_input_in_a_row: NaturalByInputInARow::default(), f32;
    single_relative_driven_by_time: RelativeByTime::default(), f32;
    single_angles_driven_by_a_rate: AnglesByRate::default(), f32;
}

#[test]
fn debug_one() {
    if std::env::var("DEBUG1").is_ok() {
        let mut random = Random(5437537040113416599);
        let angles = samples(Motion::Jitter(10), &STRETCHED, 0.3, 43, &mut random);
        follow::<_, f32, 3>(AnglesByInput::default(), &STRETCHED, &angles, 1.0, Rates::Differences, By2::Advance);
    }
    if std::env::var("DEBUG2").is_ok() {
        let mut random = Random(16633418754873375773);
        let angles = samples(Motion::Steady, &PARALLELOGRAM, 3.0, 6, &mut random);
        follow::<_, f32, 3>(AnglesByInput::default(), &PARALLELOGRAM, &angles, -1.0, Rates::Differences, By2::Advance);
    }
    if std::env::var("DEBUG3").is_ok() {
        let mut random = Random(1985944718278646371);
        let angles = samples(Motion::Steady, &STRETCHED, 3.0, 6, &mut random);
        follow::<_, f32, 3>(RelativeByTime::default(), &STRETCHED, &angles, 1.0, Rates::Zero, By2::Advance);
    }
}
