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
