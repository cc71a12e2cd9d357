//! Rows written in other units, or times a number.

use core::f64::consts::PI;

use mbs_runtime::{Kinematic, Stepper, mechanism};

/// A crank-rocker whose rows are written so many times over.
macro_rules! crank_rocker {
    ($name:ident, $across:literal, $up:literal) => {
        mechanism! {
            /// A crank-rocker.
            mechanism $name;
            coord crank: rad;
            coord rod: rad = 0.9;
            coord rocker: rad = 1.8;
            drive motor: crank == t*1rad/1s;
            constraint across { $across*(0.1*cos(crank) + 0.25*cos(rod)) == $across*(0.3 + 0.2*cos(rocker)); }
            constraint up { $up*(0.1*sin(crank) + 0.25*sin(rod)) == $up*0.2*sin(rocker); }
        }
    };
}

crank_rocker!(Plain, 1, 1);
crank_rocker!(Across, 1e3, 1);
crank_rocker!(Up, 1, 1e6);
crank_rocker!(Small, 1e-4, 1e-9);
crank_rocker!(Apart, 1e8, 1e-8);

/// Largest distance (rad) from the plain text over two turns.
fn off_plain<S: Kinematic<f64, 3>>(mechanism: S) -> f64 {
    let guess = [0.0, 0.9, 1.8];
    let mut plain = Stepper::assemble(Plain::<f64>::default(), guess, 0.0).expect("it can be assembled");
    let mut stepper = Stepper::assemble(mechanism, guess, 0.0).expect("so can this");
    let mut largest = 0.0_f64;
    for step in 1..=2_000 {
        let t = f64::from(step) * (4.0 * PI / 2_000.0);
        plain.advance_to(t).expect("a step");
        let statistics = stepper.advance_to(t).expect("a step");
        assert!(!statistics.fallback && statistics.evaluations <= 3, "{t}: {statistics:?}");
        let margin = stepper.margin() / plain.margin();
        assert!((1.0 / MARGIN..MARGIN).contains(&margin), "{t}: {margin} of the plain one's");
        let apart = stepper.q().iter().zip(plain.q()).map(|(a, b)| (a - b).abs());
        largest = apart.fold(largest, f64::max);
    }
    assert_eq!(stepper.passages(), 0);
    largest
}

/// Times that margins may differ: the plain rows, a quarter as steep as their unit, are measured by it, the others by powers of two.
const MARGIN: f64 = 4.0;

#[test]
fn rows_times_a_number_are_the_same_mechanism() {
    let across = off_plain(Across::<f64>::default());
    let (up, small) = (off_plain(Up::<f64>::default()), off_plain(Small::<f64>::default()));
    let apart = off_plain(Apart::<f64>::default());
    println!("off by {across:.1e}, {up:.1e}, {small:.1e}, {apart:.1e} rad");
    assert!([across, up, small, apart].iter().all(|off| *off < 1e-13));
}
