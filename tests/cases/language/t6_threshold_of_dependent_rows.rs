//! T6: no test noticed a threshold of `Stepper::redundancy` that is 1000 times as large.

use mbs_runtime::{Real, Stepper, mechanism};

mechanism! {
    /// Two rows that differ by the slope `off`, and a third that holds where both do.
    mechanism Nearly;
    param off: 1 = 0;
    coord x: m = 0.5;
    coord y: m = 0.5;
    constraint first { x + y == 1m; }
    constraint second { x + (1 + off)*y == 1m + 0.5m*off; }
    constraint third redundant { x - y == 0m; }
}

/// The rows that follow from others. The independent part of the second row is `share` times √ε of its length.
fn dependent<R: Real>(share: f64) -> Vec<&'static str> {
    // Of (1, 1 + δ) the part across (1, 1) is δ/2 of its length, to first order.
    let off = R::constant(2.0 * share) * R::EPSILON.sqrt();
    let nearly = Nearly::<R> { off };
    let half = R::constant(0.5);
    let stepper = Stepper::assemble(nearly, [half, half], R::constant(0.0)).expect("all rows hold");
    let redundancy = stepper.redundancy();
    assert_eq!(redundancy.rank, 2);
    redundancy.rows().map(|row| row.name).collect()
}

#[test]
fn rows_are_dependent_below_the_root_of_epsilon_and_not_above() {
    for share in [0.0, 0.01, 0.1, 0.8] {
        assert_eq!(dependent::<f64>(share), ["second"], "{share}");
        assert_eq!(dependent::<f32>(share), ["second"], "{share}");
    }
    for share in [1.25, 10.0, 100.0] {
        assert_eq!(dependent::<f64>(share), ["third"], "{share}");
        assert_eq!(dependent::<f32>(share), ["third"], "{share}");
    }
}
