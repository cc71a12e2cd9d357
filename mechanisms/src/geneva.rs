//! A Geneva drive with four slots: a quarter turn of the wheel for each turn of the driver.
//!
//! ```text
//!               A (pin)
//!          r1 .·'╲  s
//!          .·'    ╲
//!      O  o · · · · o  D      θ: driver against the line O D (rad)
//!          θ         φ        φ: slot against the line D O, clockwise (rad)
//!         |←── d ──→|         s: from D along the slot to the pin (m)
//! ```
//!
//! Lengths in metres, `q = [θ φ s]`. The pin enters and leaves the slot along its direction, without a jump of the
//! velocity, where `O A` is at right angles to `D A`: at `θ = ∓45°` with `r1 = d sin 45°`. In between the closure
//! `r1 unit(θ) = [d, 0] − s unit(φ)` holds. Outside, the driver's disc locks the wheel, which dwells at `φ = ±45°`:
//! the rows hold with `θ` held at that end. One text has both: the closure is written with
//! `engaged = max(−45°, min(45°, θ))`.
//!
//! The motion is one turn of the driver, from `θ = −180°`: dwell, engagement, dwell. At the two ends of the
//! engagement the acceleration of the wheel jumps, by `ω² r1/s = ω²` there; at those instants it is one of its two
//! values. The text holds for this turn only: a further one would need the wheel's next slot.
//!
//! Numbers: chosen here.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Geneva drive with four slots, one turn of its driver.
    pub mechanism Geneva;

    param d: m = 100mm;
    param omega: rad/s = TAU;

    coord theta: rad = -PI;
    coord phi: rad = 45deg;
    coord s: m = 70mm;

    let r1 = d*sin(45deg);
    let r2 = d*cos(45deg);
    let engaged = max(-45deg, min(45deg, theta));

    constraint pin_in_slot { r1*unit(engaged) == [d, 0] - s*unit(phi); }
    drive turn: theta == omega*t - PI;
    branch slotted: s > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = r1*unit(theta);
    out D: [m; 2] = [d, 0];
    out R: [m; 2] = [d, 0] - r2*unit(phi);

    title "Geneva drive";
    about "A pin on the driver turns the four-slot wheel by a quarter during a quarter of its turn; during \
           the rest the wheel is locked.";
    preset "one turn" "dwell, engagement, dwell" {}
    span turn(omega);
    draw ground O, D;
    draw geneva O pin A wheel D rim R slots 4;
    draw joint O, A, D;
    trace "end of a slot": R;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(Geneva::default());
