//! A pole on a cart that is a million times lighter: a mass matrix next to singular.
//!
//! ```text
//!   cart  [o]━━━━━━━● bob     φ: pole against the x axis (rad), level at the start
//!   ───────────────────       the cart slides along x without friction
//! ```
//!
//! Lengths in metres, masses in kg. The bob falls nearly straight down and the cart shoots through below it: for a
//! fraction of a millisecond the pole turns at 4429 rad/s.
//!
//! Source: benchmark "light cart-pole". Closed form at the bottom, from momentum and energy: with the cart's speed
//! v² = 2 g L/(μ (1 + μ)), μ the ratio of the masses, the pole turns at (1 + μ) v/L.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

/// In the list of free mechanisms.
pub const CARD: Card = card!(CartPole::default());

mechanism! {
    /// A pole on a cart: two degrees of freedom in four coordinates.
    pub mechanism CartPole;
    /// Mass of the cart.
    param cart_mass: kg = 1e-6;
    /// Mass of the bob.
    param m: kg = 1;
    /// Length of the pole.
    param L: m = 1;
    /// Free fall.
    param g: m/s^2 = 9.81;
    /// Place of the cart.
    coord x: m = 0;
    /// Direction of the pole.
    coord phi: rad = 0;
    /// Place of the bob.
    coord P: [m; 2];
    body cart { mass: cart_mass, com: [x, 0] }
    body bob { mass: m, com: P }
    gravity weight { acceleration: [0, -g] }
    constraint pole { P == [x, 0] + L*unit(phi); }
    start x = 0 rate 0;
    start phi = 0 rate 0;
    out S: [m; 2] = [x, 0];
    out bob: [m; 2] = P;

    title "Pole on a light cart";
    about "A bob of 1 kg on a pole whose cart has a milligram: the bob falls and rises, the cart shoots \
           through below it.";
    preset "4 s" "released level, at rest" {}
    span 4s;
    draw rail S along [1, 0];
    draw slider S along [1, 0];
    draw link pole: S, bob;
    draw joint S;
    trace bob;
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use mbs_runtime::dynamics::{Direction, DormandPrince8, Explicit, Projection, Simulation, Tolerance};

    use mbs_runtime::{Failure, FailureKind};

    use super::*;

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
}
