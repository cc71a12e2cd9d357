//! The Scotch yoke: a crank pin in a crosswise slot moves a yoke as `r cos θ`, exactly.
//!
//! ```text
//!             ┌─┐
//!             │ │
//!          A .[o]           θ: crank against the x axis (rad)
//!        r .' │ │           x: yoke (m)
//!        .'θ  │ │           y: crank pin in the slot (m)
//!    ───o─────┤ ├──────════
//!       O     │ │    guide
//!             └─┘
//!       |← x →|
//! ```
//!
//! Lengths in metres, `q = [θ x y]`. There is one assembly and no singular position. The rod's ends stand `b` to
//! either side of the slot.
//!
//! Numbers: chosen here.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Scotch yoke.
    pub mechanism ScotchYoke;

    param r: m = 60mm;
    param b: m = 130mm;
    param omega: rad/s = 10;

    coord theta: rad = 0;
    coord x: m = 60mm;
    coord y: m = 0;

    constraint slot { [x, y] == r*unit(theta); }
    drive crank: theta == omega*t;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = r*unit(theta);
    out Y: [m; 2] = [x, 0];
    out R: [m; 2] = [x + b, 0];
    out L: [m; 2] = [x - b, 0];
    out slot_top: [m; 2] = [x, 1.25*r];
    out slot_bottom: [m; 2] = [x, -1.25*r];

    title "Scotch yoke";
    about "A crank pin in a crosswise slot: the yoke moves harmonically.";
    preset "one turn" "the crank at constant speed" {}
    span turn(omega);
    draw rail R along [1, 0];
    draw rail L along [1, 0];
    draw slider R along [1, 0];
    draw slider L along [1, 0];
    draw ground O;
    draw link yoke: L, R;
    draw slot slot_bottom, slot_top;
    draw slider A along [0, 1];
    draw link crank: O, A;
    draw joint O, A;
    trace "crank pin": A;
    trace rod: R;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(ScotchYoke::default());
