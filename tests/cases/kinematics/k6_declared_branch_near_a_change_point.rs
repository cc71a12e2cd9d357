//! K6: a declared branch was refused step after step after a position at which two assemblies nearly meet.

use mbs_cases::every;
use mbs_runtime::{Real, Stepper, mechanism};

mechanism! {
    /// A quick return whose pin passes the pivot of its lever at a tenth of a millimetre: the lever turns by half a turn there.
    pub mechanism QuickReturn;
    param d: m = 0.1001;
    coord p1: rad = 0;
    coord s: m = 0.14;
    coord psi: rad = 0.8;
    constraint closure { 0.1m*unit(p1) == [0, -d] + s*unit(psi); }
    drive crank: p1 == t*1/1s;
    branch pos: s > 0;
}

mechanism! {
    /// The same by an input.
    pub mechanism MeasuredReturn;
    param d: m = 0.1001;
    input theta: rad, rates;
    coord p1: rad = 0;
    coord s: m = 0.14;
    coord psi: rad = 0.8;
    constraint closure { 0.1m*unit(p1) == [0, -d] + s*unit(psi); }
    drive crank: p1 == theta;
    branch pos: s > 0;
}

mechanism! {
    /// The same with the end of the lever as a point.
    pub mechanism PointedReturn;
    param d: m = 0.1001;
    coord s: m = 0.14;
    coord u: [m; 2] = [0.7, 0.7];
    constraint lever { norm(u) == 1m; }
    constraint closure { 0.1m*unit(t*1/1s) == [0, -d] + s*u/1m; }
    branch pos: s > 0;
}

/// Distance of the pin from the pivot.
fn exact(d: f64, theta: f64) -> f64 {
    (0.1 * theta.cos()).hypot(0.1 * theta.sin() + d)
}

/// Steps (rad), of which three turns are made, from such as resolve the half turn of the lever to such as pass it in one.
const STEPS: [f64; 7] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0];

/// Distances of the pivot (m): the pin passes it at 1 mm to 1 µm, on one side and the other.
const PIVOTS: [f64; 6] = [0.101, 0.1001, 0.100001, 0.0999, 0.09999, 0.099999];

/// The first step after which the lever is wrong, or that fails.
fn wrong<R: Real>(
    d: f64,
    step: f64,
    tolerance: f64,
    mut advance: impl FnMut(f64) -> Result<R, mbs_runtime::Failure>,
) -> Option<(f64, Result<f64, mbs_runtime::Failure>)> {
    let count = (19.0 / step) as u32;
    (1..=count).map(|k| 5e-4 + step * f64::from(k)).find_map(|theta| {
        let found = advance(theta).map(R::to_f64);
        let right = found.is_ok_and(|s| (s - exact(d, theta)).abs() < tolerance);
        (!right).then_some((theta, found))
    })
}

#[test]
fn a_declared_branch_is_kept_past_a_near_change_point_with_any_step() {
    for d in PIVOTS.into_iter().step_by(every(2)) {
        for step in STEPS {
            let timed = QuickReturn::<f64> { d };
            let mut timed = Stepper::assemble(timed, [0.0, 0.14, 0.8], 0.0).unwrap();
            let found = wrong(d, step, 1e-9, |theta| timed.advance_to(theta).map(|_| timed.q()[1]));
            assert_eq!(found, None, "by time: {d} {step}");
            let measured = MeasuredReturn::<f64> { d, ..MeasuredReturn::default() };
            let mut measured = Stepper::assemble(measured, [0.0, 0.14, 0.8], 0.0).unwrap();
            let found = wrong(d, step, 1e-9, |theta| {
                measured.change(|m| m.theta.value = theta);
                measured.advance(1e-3).map(|_| measured.q()[1])
            });
            assert_eq!(found, None, "by an input: {d} {step}");
        }
    }
}

#[test]
fn a_declared_branch_is_kept_there_with_the_lever_as_a_vector() {
    for d in PIVOTS.into_iter().step_by(every(2)) {
        for step in STEPS {
            let mut run = Stepper::assemble(PointedReturn::<f64> { d }, [0.14, 0.7, 0.7], 0.0).unwrap();
            let found = wrong(d, step, 1e-9, |theta| run.advance_to(theta).map(|_| run.q()[0]));
            assert_eq!(found, None, "{d} {step}");
        }
    }
}
