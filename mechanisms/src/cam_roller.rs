//! A disc cam with an offset roller follower.
//!
//! ```text
//!                 │ stem, e beside the centre
//!               .─┴─.
//!              (  S  )    roller of radius rr, centre S = (e, y)
//!               `─P─'
//!            .··'''··.    P: point of contact
//!          .'   |     '.
//!         (     o O    )  θ: cam (rad)
//!          `··.....··'
//! ```
//!
//! The motion law is `lift(c) = h ((1 − cos c)/2)³`: periodic, smooth, nearly at rest at the bottom. The roller's centre
//! draws the pitch curve on the cam: `[e, Y(c)]` turned back by `c`, with `Y = √((rb + rr)² − e²) + lift`. The mechanism
//! knows only this curve: its rows say that the point with the parameter `c` is at `(e, y)`. The profile is the pitch
//! curve less `rr` along its normal.
//!
//! Angles in rad, lengths in metres, `q = [θ c y]`. The determinant with respect to `(c, y)` is the height `Y > 0`.
//! A vertical line meets the pitch curve above and below: `upper` and `same_turn` pick the meeting above. The pitch
//! curve is convex with radii of at least 37 mm: the profile has no undercut.
//!
//! Numbers: chosen here. Source of the profile: Norton, Cam Design and Manufacturing Handbook, ch. 7 (translating
//! roller follower).

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Disc cam with an offset roller follower.
    pub mechanism CamRoller;

    param rb: m = 30mm;
    param rr: m = 8mm;
    param e: m = 8mm;
    param h: m = 15mm;
    param omega: rad/s = TAU;

    coord theta: rad = 0;
    coord c: rad = 0;
    coord y: m = 37mm;

    let u = (1 - cos(c))/2;
    let slope = 3/2*h*u^2*sin(c);
    let height = sqrt((rb + rr)^2 - e^2) + h*u^3;
    let normal = rot(theta - c)*[e - slope, height];

    constraint contact { [e, y] == rot(theta - c)*[e, height]; }
    drive turn: theta == omega*t;
    branch upper: y > 0;
    branch same_turn: cos(theta - c) > 0;

    out O: [m; 2] = [0, 0];
    out S: [m; 2] = [e, y];
    out P: [m; 2] = [e, y] - rr*normal/norm(normal);
    out G: [m; 2] = [e, y + 1.6*rb];
    out pressure_angle: rad = atan2(slope - e, height);

    title "Cam with a roller follower";
    about "A disc cam lifts a roller whose stem runs beside the cam's centre. The pressure angle is an \
           output.";
    preset "one turn" "the cam at constant speed" {}
    span turn(omega);
    draw rail G along [0, 1];
    draw slider G along [0, 1];
    draw ground O;
    draw cam cam: O contact P turn theta;
    draw link follower: S, G;
    draw wheel roller: S rim P;
    draw joint O, S;
    trace roller: S;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(CamRoller::default());
