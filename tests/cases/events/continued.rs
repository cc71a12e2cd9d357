//! Motions that go on in another scene, against closed forms.

use mbs_runtime::dynamics::{DormandPrince8, Explicit, Projection, Simulation, Tolerance};
use mbs_runtime::{FailureKind, mechanism};

mechanism! {
    /// A mass on a spring that meets a second one: alone, coupled by a bar, hit by it, and with a motor of its own.
    mechanism Train;
    param gap: m = 0.5;
    param inductance: s = 0.2;
    coord x: m = 0;
    body first { mass: 3, com: [x, 0] }
    tsda spring { from: [-1, 0], to: [x, 0], stiffness: 12, length: 1 }
    start x = 0.4 rate 0;
    out place: m = x;
    effect second {
        coord y: m = 0.5;
        body second { mass: 1, com: [y, 0] }
        start y = 0.5 rate -2;
    }
    effect bar { constraint tie { y - x == gap; } }
    effect motor {
        state current: N = 5;
        der(current) == -current/inductance;
        force push: current on x;
    }
    effect speedometer { out speed: m/s = der(x); }
    scene Alone = motor;
    scene Both = second + motor;
    scene Tied = second + bar;
    scene Bare = speedometer;
}

fn method() -> Explicit<DormandPrince8, Projection> {
    Explicit::new(DormandPrince8, Projection::default())
}

fn is_near(found: f64, expected: f64, bound: f64) {
    assert!((found - expected).abs() < bound, "{found} is not {expected}");
}

#[test]
fn coordinates_rates_states_and_tolerances_come_over_by_name() {
    let alone = Simulation::start_from_text(TrainAlone::<f64>::default(), method(), 0.0).expect("it starts");
    let mut alone = alone.with_tolerance(Tolerance::new(1e-12));
    alone.advance_to(0.3).expect("it moves");
    is_near(alone.states()[0], 5.0 * (-1.5_f64).exp(), 1e-10);
    let both: TrainBoth<f64> = alone.mechanism().scene();
    let both = alone.continue_as(both, method()).expect("nothing contradicts");
    assert_eq!((both.coordinates, both.states), ([true, false], 1));
    let mut run = both.run;
    assert!(run.t() == alone.t() && run.moved_start().is_none());
    assert_eq!((run.q()[0], run.qd()[0], run.states()[0]), (alone.q()[0], alone.qd()[0], alone.states()[0]));
    // The second one begins as the text says.
    assert_eq!((run.q()[1], run.qd()[1]), (0.5, -2.0));
    run.advance_to(1.0).expect("it moves");
    alone.advance_to(1.0).expect("it moves");
    is_near(run.q()[0], alone.q()[0], 1e-10);
    is_near(run.q()[1], 0.5 - 2.0 * 0.7, 1e-10);
    // Back again, without the motor.
    let bare: TrainBare<f64> = run.mechanism().scene();
    let bare = run.continue_as(bare, method()).expect("nothing contradicts");
    assert_eq!((bare.coordinates, bare.states, bare.run.q()[0]), ([true], 0, run.q()[0]));
    assert!(bare.run.balance().defect == 0.0);
}

#[test]
fn rates_that_a_new_row_contradicts_change_as_in_an_inelastic_impact() {
    let both = Simulation::start_from_text(TrainBoth::<f64>::default(), method(), 0.0).expect("it starts");
    let mut both = both.with_tolerance(Tolerance::new(1e-12));
    both.advance_to(0.2).expect("it moves");
    let [x, y] = *both.q();
    let [v, w] = *both.qd();
    let tied = TrainTied { gap: y - x, ..both.mechanism().scene() };
    let tied = both.continue_as(tied, method()).expect("the bar is as long as the gap");
    assert_eq!(tied.coordinates, [true, true]);
    let common = (3.0 * v + w) / 4.0;
    is_near(tied.run.qd()[0], common, 1e-13);
    is_near(tied.run.qd()[1], common, 1e-13);
    let moved = tied.run.moved_start().expect("the rates jump");
    assert!(moved.rate && moved.coordinate.name == "y", "{moved:?}");
    let mut run = tied.run;
    run.advance_to(1.2).expect("it moves");
    // Both together on the spring.
    let omega = (12.0_f64 / 4.0).sqrt();
    is_near(run.q()[0], x * omega.cos() + common / omega * omega.sin(), 1e-10);
}

#[test]
fn a_new_coordinate_meets_the_rows_and_old_ones_stay() {
    let bare = Simulation::start_from_text(TrainBare::<f64>::default(), method(), 0.0).expect("it starts");
    let mut bare = bare.with_tolerance(Tolerance::new(1e-12));
    bare.advance_to(0.25).expect("it moves");
    let tied =
        bare.continue_as::<TrainTied<f64>, _, 2, 1>(bare.mechanism().scene(), method()).expect("it is met");
    assert_eq!(tied.coordinates, [true, false]);
    is_near(tied.run.q()[0], bare.q()[0], 1e-14);
    is_near(tied.run.q()[1], bare.q()[0] + 0.5, 1e-14);
    // It has the rate of the bar from the start on: no impulse acts on the first one.
    is_near(tied.run.qd()[0], bare.qd()[0], 1e-13);
    is_near(tied.run.qd()[1], bare.qd()[0], 1e-13);
}

#[test]
fn positions_that_new_rows_contradict_are_refused() {
    let both = Simulation::start_from_text(TrainBoth::<f64>::default(), method(), 0.0).expect("it starts");
    let tied: TrainTied<f64> = both.mechanism().scene();
    let kind = both.continue_as(tied, method()).expect_err("the bar is too short").kind;
    assert!(matches!(kind, FailureKind::OffConstraints { row, .. } if row.name == "tie"), "{kind:?}");
    let none = TrainTied { gap: f64::NAN, ..both.mechanism().scene() };
    let kind = both.continue_as(none, method()).expect_err("no number").kind;
    assert!(matches!(kind, FailureKind::NonFinite { .. }), "{kind:?}");
}
