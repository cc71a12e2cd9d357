//! D12: `VelocityTransformation` did not compile for a text with `redundant` rows, though it goes over to `Projection` there.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Formulation, Projection, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::{Partitioned, mechanism};

mechanism! {
    /// A plate on three parallel cranks without mass: one row of their heads follows from the others.
    mechanism Plate;
    param L: m = 0.5;
    param d: m = 0.4;
    coord alpha: [rad; 3] = 1;
    coord p: [m; 2] = [0.67, 0.42];
    coord psi: rad = 0;
    body plate { mass: 3, inertia: 0.2, com: p, angle: psi }
    gravity weight { acceleration: [0, -9.81] }
    constraint heads redundant {
        for i in 0..3 { [i*d, 0] + L*unit(alpha[i]) == p + rot(psi)*[(i - 1)*d, 0]; }
    }
    start alpha = [1, 1, 1] rate [0, 0, 0];
}

mechanism! {
    /// A driven mechanism with a row too many, as square as its kinematics.
    mechanism Twice;
    coord x: m = 0;
    coord y: m = 0;
    body block { mass: 2, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    drive draw: x == 0.1m*sin(t/1s);
    constraint floor redundant { y == 0; 2*y == 0m; }
}

/// Angle and rate of the first crank at `t` (s).
fn swung(formulation: impl Formulation<Plate, f64, 6, 6>, t: f64) -> ([f64; 2], u64) {
    let run = Simulation::start_from_text(Plate::default(), Explicit::new(DormandPrince8, formulation), 0.0);
    let mut run = run.expect("it starts").with_tolerance(Tolerance::new(1e-11));
    run.advance_to(t).expect("it swings");
    ([run.q()[0], run.qd()[0]], run.counts().handed_over)
}

#[test]
fn redundant_rows_go_over_to_projection() {
    const { assert!(!<Plate as Partitioned<f64, 6, 6>>::IS_PARTITIONED) };
    let (projected, none) = swung(Projection::default(), 1.0);
    let (transformed, handed_over) = swung(VelocityTransformation, 1.0);
    assert_eq!((projected, none), (transformed, 0), "the same steps to the same bits");
    assert!(handed_over > 0);
    // A pendulum of length L from 1 rad, at rest: its energy.
    let [alpha, rate] = transformed;
    let energy = 0.5 * 0.25 * rate * rate + 9.81 * 0.5 * (alpha.sin() - 1.0_f64.sin());
    assert!(energy.abs() < 1e-9, "{energy:e}");
}

#[test]
fn a_driven_text_with_a_row_too_many_goes_over_too() {
    let method = Explicit::new(DormandPrince8, VelocityTransformation);
    let mut run =
        Simulation::start(Twice::default(), method, 0.0, [0.0, 0.0], [0.1, 0.0]).expect("it starts");
    run.advance_to(1.0).expect("it moves");
    assert!((run.q()[0] - 0.1 * 1.0_f64.sin()).abs() < 1e-9 && run.counts().handed_over > 0);
    assert!((run.lambda()[1] + 2.0 * run.lambda()[2] + 2.0 * 9.81).abs() < 1e-9, "{:?}", run.lambda());
}
