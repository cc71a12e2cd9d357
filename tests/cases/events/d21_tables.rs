//! D21: a run to the present time.

use mbs_runtime::dynamics::{Direction, DormandPrince8, Explicit, Projection, Simulation};
use mbs_runtime::{Failure, FailureKind, mechanism};

mechanism! {
    pub mechanism Thrown;
    input push: N;
    coord y: m = 0;
    body ball { mass: 2, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    force hand: [0, push] on [0, y];
}

#[test]
fn a_table_from_the_start_needs_no_special_case() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start(Thrown::<f64>::default(), method, 0.0, [0.0], [3.0]).expect("a start");
    for row in 0..=10 {
        let t = 0.1 * f64::from(row);
        run.advance_to(t).expect("it runs");
        assert_eq!(run.t(), t);
        assert!((run.q()[0] - (3.0 * t - 0.5 * 9.81 * t * t)).abs() < 1e-12);
    }
    let (state, counts) = (*run.instant(), run.counts());
    run.advance_through(1.0, |_| None).expect("nowhere");
    assert!(!run.advance_until_event(1.0, Direction::Any, |_, q, _| q[0]).expect("nowhere"));
    run.step_to(1.0, 5).expect("nowhere");
    assert_eq!((*run.instant(), run.counts()), (state, counts));
    let mut shown = 0;
    run.sample(1.0, 3, |instant| {
        assert_eq!(*instant, state);
        shown += 1;
    })
    .expect("nowhere");
    run.watch(1.0, 2, |run| {
        assert_eq!(*run.instant(), state);
        shown += 1;
    })
    .expect("nowhere");
    assert_eq!(shown, 5);
    assert!(
        matches!(run.advance_to(0.9), Err(Failure { kind: FailureKind::InvalidStep { .. }, .. })),
        "time does not run back"
    );
}

#[test]
fn a_run_of_no_length_solves_with_changed_inputs_and_reports_what_is_wrong_with_them() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let mut run = Simulation::start(Thrown::<f64>::default(), method, 0.0, [0.0], [3.0]).expect("a start");
    run.change(|thrown| thrown.push = 19.62);
    run.advance_to(0.0).expect("nowhere");
    assert!(run.qdd()[0].abs() < 1e-14);
    run.change(|thrown| thrown.push = f64::NAN);
    assert!(run.advance_to(0.0).is_err());
    run.change(|thrown| thrown.push = 0.0);
    run.advance_to(0.0).expect("nowhere");
    assert!((run.qdd()[0] + 9.81).abs() < 1e-14);
}
