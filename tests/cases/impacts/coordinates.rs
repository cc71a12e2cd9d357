//! A rod that is thrown onto a rough floor, in coordinates without rows and with rows.

use mbs_runtime::dynamics::{
    DormandPrince8, Explicit, Formulation, Projection, Simulation, Tolerance, VelocityTransformation,
};
use mbs_runtime::mechanism;

mechanism! {
    /// By one end and the angle.
    pub mechanism Free;
    coord p: [m; 2] = [0, 0.3];
    coord a: rad = 0.6;
    let other = p + 1m*unit(a);
    body rod { mass: 2kg, com: p + 0.5m*unit(a), inertia: 1/6, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    contact one { gap: p[1], restitution: 0.4 }
    contact two { gap: other[1], restitution: 0.4 }
    friction rub_one { along: p[0], normal: normal(one), coefficient: 0.3, sticks: 0.4 }
    friction rub_two { along: other[0], normal: normal(two), coefficient: 0.3, sticks: 0.4 }
    start p = [0, 0.3] rate [1, 0];
    start a = 0.6 rate -2;
    out ends: [m; 4] = [p[0], p[1], other[0], other[1]];
}

mechanism! {
    /// By both ends and the centre, with rows.
    pub mechanism Rows;
    coord p: [m; 2] = [0, 0.3];
    coord c: [m; 2] = [0.4, 0.6];
    coord other: [m; 2] = [0.8, 0.9];
    coord a: rad = 0.6;
    body rod { mass: 2kg, com: c, inertia: 1/6, angle: a }
    gravity weight { acceleration: [0, -9.81] }
    constraint half { c == p + 0.5m*unit(a); }
    constraint whole { other == p + 1m*unit(a); }
    contact one { gap: p[1], restitution: 0.4 }
    contact two { gap: other[1], restitution: 0.4 }
    friction rub_one { along: p[0], normal: normal(one), coefficient: 0.3, sticks: 0.4 }
    friction rub_two { along: other[0], normal: normal(two), coefficient: 0.3, sticks: 0.4 }
    start p = [0, 0.3] rate [1, 0];
    start a = 0.6 rate -2;
    start c = [0.5*cos(0.6), 0.3 + 0.5*sin(0.6)] rate [1 + sin(0.6), -cos(0.6)];
    start other = [cos(0.6), 0.3 + sin(0.6)] rate [1 + 2*sin(0.6), -2*cos(0.6)];
    out ends: [m; 4] = [p[0], p[1], other[0], other[1]];
}

fn agrees<F: Formulation<Rows<f64>, f64, 7, 4>>(formulation: F) {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let free = Simulation::start_from_text(Free::default(), method, 0.0_f64).expect("it starts");
    let mut free = free.with_tolerance(Tolerance::new(1e-11));
    let rows =
        Simulation::start_from_text(Rows::default(), Explicit::new(DormandPrince8, formulation), 0.0_f64);
    let mut rows = rows.expect("it starts").with_tolerance(Tolerance::new(1e-11));
    // Impacts of both ends, sliding and sticking, until it lies still. A closed end whose rate was rounding once took no part.
    for part in 1..=50 {
        let t = 0.02 * f64::from(part);
        free.advance_to(t).expect("it bounces");
        rows.advance_to(t).expect("it bounces");
        for (one, other) in free.outputs().iter().zip(rows.outputs()) {
            assert!(
                (one.value - other.value).abs() < 1e-11,
                "{t}: {:?} {:?}",
                free.outputs(),
                rows.outputs()
            );
        }
        assert!(rows.balance().defect.abs() < 1e-8, "{t}: {:?}", rows.balance());
    }
}

#[test]
fn a_thrown_rod_moves_alike_in_both_coordinates() {
    agrees(Projection::default());
    agrees(VelocityTransformation);
}
