//! Impacts at one instant: shared, or one after the other.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::mechanism;

mechanism! {
    /// Newton's cradle of three balls that touch, the first one let go.
    pub mechanism Ordered;
    param e: 1 = 1;
    param v: [m/s; 3] = [1, 0, 0];
    coord x: [m; 3] = [0, 0.1, 0.2];
    for i in 0..3 { body ball { mass: 1, com: [x[i], 0] } }
    contact first { gap: x[1] - x[0] - 0.1m, restitution: e, simultaneous: ordered }
    contact second { gap: x[2] - x[1] - 0.1m, restitution: e, simultaneous: ordered }
    start x = [0, 0.1, 0.2] rate v;
}

mechanism! {
    /// The same with impulses that are shared.
    pub mechanism Shared;
    coord x: [m; 3] = [0, 0.1, 0.2];
    for i in 0..3 { body ball { mass: 1, com: [x[i], 0] } }
    contact first { gap: x[1] - x[0] - 0.1m, restitution: 1 }
    contact second { gap: x[2] - x[1] - 0.1m, restitution: 1 }
    start x = [0, 0.1, 0.2] rate [1, 0, 0];
}

fn is(found: &[f64; 3], wanted: [f64; 3]) {
    let near = found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-12);
    assert!(near, "{found:?} {wanted:?}");
}

#[test]
fn a_cradle_of_three_shares_impulses_or_hands_them_on() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start_from_text(Shared::default(), method, 0.0_f64).expect("it starts");
    run.advance_to(0.01).expect("they strike");
    is(run.qd(), [-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]);
    // With 0.5 the first ball strikes again: 1/4, 3/16, 9/16, then 13/64, 15/64, 9/16. Without rebound all end alike.
    for (e, v, wanted) in [
        (1.0, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        (1.0, [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]),
        (1.0, [1.0, 0.0, -2.0], [-2.0, 0.0, 1.0]),
        (0.5, [1.0, 0.0, 0.0], [13.0 / 64.0, 15.0 / 64.0, 9.0 / 16.0]),
        (0.0, [1.0, 0.0, 0.0], [1.0 / 3.0; 3]),
    ] {
        let cradle = Ordered { e, v };
        let mut run = Simulation::start_from_text(cradle, method, 0.0_f64).expect("it starts");
        run.advance_to(0.01).expect("they strike");
        is(run.qd(), wanted);
        assert!(run.balance().defect.abs() < 1e-12, "{:?}", run.balance());
    }
}
