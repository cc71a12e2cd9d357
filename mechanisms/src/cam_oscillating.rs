//! A disc cam with an oscillating roller follower.
//!
//! ```text
//!              S
//!         .──( o )──────── l ────────.
//!        .·`--P--·.              ψ    `o D
//!      .'     |     '.
//!     (       o O     )                θ: cam, ψ: arm D S against the line D O, clockwise (rad)
//!      `·..........·'
//!             |←────────── d ─────────→|
//! ```
//!
//! The motion law is `Ψ(c) = psi0 + swing ((1 − cos c)/2)²`: periodic and smooth. The roller's centre draws the pitch
//! curve on the cam: `D + l unit(π − Ψ(c))` turned back by `c`. The mechanism knows only this curve: its rows say that
//! the point with the parameter `c` is the end of the arm at `ψ`. The profile is the pitch curve less the roller's
//! radius `rr` along its normal.
//!
//! Angles in rad, lengths in metres, `q = [θ c ψ]`. The determinant with respect to `(c, ψ)` is `l d sin ψ`: never 0
//! with the arm above the line `D O` (`above`). The pitch curve is convex with radii of at least 39 mm: the profile has
//! no undercut.
//!
//! Numbers: chosen here. Source of the profile: Norton, Cam Design and Manufacturing Handbook, ch. 7 (oscillating
//! roller follower).

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Disc cam with an oscillating roller follower.
    pub mechanism CamOscillating;

    param d: m = 90mm;
    param l: m = 80mm;
    param rr: m = 8mm;
    param psi0: rad = 26deg;
    param swing: rad = 20deg;
    param omega: rad/s = TAU;

    coord theta: rad = 0;
    coord c: rad = 0;
    coord psi: rad = 26deg;

    let u = (1 - cos(c))/2;
    let law = psi0 + swing*u^2;
    let law_d = swing*u*sin(c);
    let pivot = [d, 0];
    let pitch = pivot + l*unit(PI - law);
    let tangent = law_d*l*[sin(law), cos(law)] + [pitch.1, -pitch.0];
    let normal = rot(theta - c)*[-tangent.1, tangent.0];
    let centre = pivot + l*unit(PI - psi);

    constraint contact { centre == rot(theta - c)*pitch; }
    drive turn: theta == omega*t;
    branch above: sin(psi) > 0;
    branch same_turn: cos(theta - c) > 0;

    out O: [m; 2] = [0, 0];
    out D: [m; 2] = pivot;
    out S: [m; 2] = centre;
    out P: [m; 2] = centre - rr*normal/norm(normal);

    title "Cam with an oscillating follower";
    about "A disc cam swings an arm with a roller at its end.";
    preset "one turn" "the cam at constant speed" {}
    span turn(omega);
    draw ground O, D;
    draw cam cam: O contact P turn theta;
    draw link arm: D, S;
    draw wheel roller: S rim P;
    draw joint O, D, S;
    trace roller: S;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(CamOscillating::default());
