//! Whitworth's quick-return mechanism: a turning slotted lever drives a ram.
//!
//! ```text
//!                  A [o]                θ: crank against the x axis (rad)
//!                r / .'  slotted        φ: lever against the x axis (rad)
//!              O  o .'   lever          s: from D along the slot to the crank pin A (m)
//!                 │.' s                 β: rod against the x axis (rad)
//!                D o────────────[C]──   x: ram (m), on the horizontal line through D
//!                .' ╲       L  .·'
//!           l  .'     ╲   . ·'
//!          E  o─·─·─·──·'  β
//! ```
//!
//! Lengths in metres, `q = [θ φ s β x]`. `D` stands `d` below `O`, within the circle of the crank pin (`d < r`), so
//! that the lever turns fully with the crank: that is Whitworth's mechanism; with `D` outside, the lever swings as in
//! a shaper. The lever's other end `E` drives the ram by the rod.
//!
//! The determinant of the slot's rows with respect to `(φ, s)` is `−s`, never 0 since `s ≥ r − d = 55 mm`; that of the
//! rod's rows is `L cos β`, never 0 since `L > l`. At a constant `ω` the ram goes one way during `π + 2 asin(d/r)` of
//! the crank and back during the rest: 1.85 times as fast.
//!
//! Numbers: chosen here.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Whitworth's quick-return mechanism.
    pub mechanism QuickReturn;

    param r: m = 100mm;
    param d: m = 45mm;
    param l: m = 70mm;
    param L: m = 240mm;
    param omega: rad/s = TAU;

    coord theta: rad = 0;
    coord phi: rad = 0.4;
    coord s: m = 110mm;
    coord beta: rad = 0.1;
    coord x: m = 170mm;

    let pivot = [0, -d];
    let lever = unit(phi);

    constraint slot { r*unit(theta) == pivot + s*lever; }
    constraint rod { pivot - l*lever + L*unit(beta) == [x, -d]; }
    drive crank: theta == omega*t;
    branch slotted: s > 0;
    branch right: cos(beta) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = r*unit(theta);
    out D: [m; 2] = pivot;
    out E: [m; 2] = pivot - l*lever;
    out C: [m; 2] = [x, -d];
    out slot_start: [m; 2] = pivot + 0.3*(r - d)*lever;
    out slot_end: [m; 2] = pivot + 1.15*(r + d)*lever;

    title "Whitworth's quick return";
    about "The crank pin runs in the slot of a lever that turns about a point beside the crank's centre: the \
           ram goes slowly one way and fast the other.";
    preset "one turn" "the ram to the right of the lever" {}
    span turn(omega);
    draw rail C along [1, 0];
    draw slider C along [1, 0];
    draw ground O, D;
    draw slot lever: slot_start, slot_end;
    draw link E, D, slot_start;
    draw link rod: E, C;
    draw slider A along phi;
    draw link crank: O, A;
    draw joint O, A, D, E, C;
    trace ram: C;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(QuickReturn::default());
