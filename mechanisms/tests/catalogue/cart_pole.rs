//! Tests of `mechanisms::cart_pole`.

use core::f64::consts::FRAC_PI_2;

use mbs_runtime::dynamics::{Direction, DormandPrince8, Explicit, Projection, Simulation, Tolerance};

use mbs_runtime::{Failure, FailureKind};

use mechanisms::cart_pole::*;

#[test]
fn the_pole_turns_as_fast_as_momentum_and_energy_ask_and_swings_back_in_the_known_time() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let run = Simulation::start_near(CartPole::default(), method, 0.0, [0.0, 0.0, 1.0, 0.0], [0.0; 4]);
    let mut run = run.expect("it starts").with_tolerance(Tolerance::new(1e-12));
    let bottom = run.advance_until_event(2.0, Direction::Falling, |_, q, _| q[1] + FRAC_PI_2);
    assert!(bottom.expect("it falls"));
    assert!((run.qd()[1].abs() - 4429.449).abs() < 1e-3, "{:?}", run.qd());
    // The pole stands still at the other side, then again where it started.
    assert!(run.advance_until_event(2.0, Direction::Rising, |_, _, qd| qd[1]).expect("it rises"));
    assert!((run.t() - 1.8061 / 2.0).abs() < 1e-4, "{}", run.t());
    run.advance_to(run.t() + 0.2).expect("it falls again");
    assert!(run.advance_until_event(3.0, Direction::Falling, |_, _, qd| qd[1]).expect("it comes back"));
    assert!((run.t() - 1.8061).abs() < 1e-4, "{}", run.t());
    let balance = run.balance();
    assert!(balance.defect.abs() < 1e-8 * 9.81, "{balance:?}");
}

#[test]
fn a_negative_mass_is_named_with_the_parameter_that_makes_it() {
    let method = Explicit::new(DormandPrince8, Projection::default());
    let start = |cart_pole| Simulation::start_from_text(cart_pole, method, 0.0);
    let failure = start(CartPole { m: -1.0, ..CartPole::default() }).expect_err("no mass");
    let Failure { kind: FailureKind::Negative { name, parameter, value, line }, .. } = failure else {
        panic!("{failure}")
    };
    assert_eq!((name, parameter, value), ("bob.mass", "m", -1.0));
    assert!(line > 0 && failure.to_string().contains("`bob.mass` (line "), "{failure}");
    let mut run = start(CartPole::default()).expect("it starts");
    run.change(|cart_pole| cart_pole.cart_mass = -1e-6);
    let before = *run.instant();
    let failure = run.advance_to(0.01).expect_err("no mass");
    assert!(
        matches!(failure, Failure { kind: FailureKind::Negative { name: "cart.mass", .. }, .. }),
        "{failure}"
    );
    assert_eq!(before, *run.instant());
    run.change(|cart_pole| cart_pole.cart_mass = 0.0);
    run.advance_to(0.01).expect("nothing is a mass too");
}
