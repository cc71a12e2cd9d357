//! A disc cam with a flat-faced follower.
//!
//! ```text
//!               │
//!               │ stem
//!       ────────┴───P────   flat face at the height y
//!              .··'''··.
//!            .'    |    '.      P = (x, y): point of contact
//!           (   O  o      )     θ: cam (rad)
//!            '.          .'
//!              `··...··'
//! ```
//!
//! The motion law is `lift(c) = h ((1 − cos c)/2)²`: periodic, smooth, with a slow start at the bottom. For a flat face
//! the point of the profile that touches at the cam angle `c` has the coordinates `[lift′(c), rb + lift(c)]` in the
//! ground; turned back by `c` it is the profile in the cam's own frame. The mechanism knows only this profile. Its rows
//! say that a point of the profile with the parameter `c` is at `(x, y)` and that its tangent lies in the face. That
//! `c` follows `θ` and `y` the motion law is the outcome.
//!
//! Angles in rad, lengths in metres, `q = [θ c x y]`. The radius of curvature `rb + lift + lift″ ≥ 30 mm` is positive:
//! the profile is convex and touches a line on either side; `upper` picks the follower's.
//!
//! Numbers: chosen here. Source of the profile: Norton, Cam Design and Manufacturing Handbook, ch. 7 (flat-faced
//! follower).

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Disc cam with a flat-faced follower.
    pub mechanism CamFlat;

    param rb: m = 30mm;
    param h: m = 15mm;
    param omega: rad/s = TAU;

    coord theta: rad = 0;
    coord c: rad = 0;
    coord x: m = 0;
    coord y: m = 30mm;

    let u = (1 - cos(c))/2;
    let lift = h*u^2;
    let lift_d = h*u*sin(c);
    let lift_dd = h*(sin(c)^2/2 + u*cos(c));
    let curvature_radius = rb + lift + lift_dd;

    constraint contact { [x, y] == rot(theta - c)*[lift_d, rb + lift]; }
    constraint tangent { cross([1, 0], curvature_radius*unit(theta - c)) == 0; }
    drive turn: theta == omega*t;
    branch upper: cos(theta - c) > 0;

    out O: [m; 2] = [0, 0];
    out P: [m; 2] = [x, y];
    out face_left: [m; 2] = [-0.6*rb, y];
    out face_right: [m; 2] = [0.6*rb, y];
    out G: [m; 2] = [0, y + 1.6*rb];
    out radius_of_curvature: m = curvature_radius;

    title "Cam with a flat follower";
    about "A disc cam lifts a flat-faced follower. The point of contact runs to and fro under the face as the \
           derivative of the motion law.";
    preset "one turn" "the cam at constant speed" {}
    span turn(omega);
    draw rail G along [0, 1];
    draw slider G along [0, 1];
    draw ground O;
    draw face follower: face_left, face_right back G;
    draw cam cam: O contact P turn theta;
    draw joint O;
    trace "point of contact": P;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(CamFlat::default());
