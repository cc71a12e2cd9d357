//! A disc cam whose motion law is given at run time: the text says what the law must be, a type says what it is.
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
//! A flat face touches the cam at `P = [lift′(θ), rb + lift(θ)]`, whatever the law. Because the row of `P` uses the
//! first derivative, its acceleration needs the third: the law is declared `C3`. The radius of curvature
//! `rb + lift + lift″` keeps one time derivative, for there is no fourth.
//!
//! Angles in rad, lengths in metres, `q = [θ x y]`. The law here rises by 8 mm within 2 rad, dwells, and returns, each
//! motion by the polynomial 4-5-6-7; its acceleration falls to −17.4 mm/rad² at the most, so that the profile stays convex.
//!
//! Numbers: chosen here. Source of the contact: Norton, Cam Design and Manufacturing Handbook, ch. 7 (flat-faced
//! follower); of the law: ch. 3 (4-5-6-7 polynomial).

use core::f64::consts::{PI, TAU};

use mbs_runtime::driver::{Polynomial4567, Segment, Segments};
use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::erased::erase::erase;
use mbs_workbench::verify::StandIn;

mechanism! {
    /// Disc cam with a flat-faced follower, the motion law from outside.
    pub mechanism CamLaw;

    param rb: m = 30mm;
    param omega: rad/s = TAU;
    /// Lift of the follower above the base circle.
    function lift: m(rad), C3, periodic TAU;

    coord theta: rad;
    coord x: m;
    coord y: m;

    constraint contact { [x, y] == [lift.d1(theta), rb + lift(theta)]; }
    drive turn: theta == omega*t;

    out O: [m; 2] = [0, 0];
    out P: [m; 2] = [x, y];
    out face_left: [m; 2] = [-0.6*rb, y];
    out face_right: [m; 2] = [0.6*rb, y];
    out G: [m; 2] = [0, y + 1.6*rb];
    out radius_of_curvature: m = rb + lift(theta) + lift.d2(theta);

    title "Cam with a law given at run time";
    about "A disc cam lifts a flat-faced follower by 8 mm, lets it dwell and takes it back, by a law that the \
           text declares and the caller supplies.";
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

/// The law of the follower that `mbs` shows.
pub type Law = Segments<Polynomial4567, 4>;

/// Height of the lift (m).
pub const HEIGHT: f64 = 0.008;
/// Angle at which the rise ends (rad).
pub const RISEN: f64 = 2.0;
/// Angle at which the dwell ends (rad).
pub const LEAVES: f64 = PI;
/// Angle at which the return ends (rad).
pub const BACK: f64 = 5.0;

/// The law that `mbs` shows.
pub const LAW: Law = {
    let parts =
        [Segment::to(HEIGHT, RISEN), Segment::dwell(LEAVES), Segment::to(0.0, BACK), Segment::dwell(TAU)];
    match Law::new(0.0, parts) {
        Ok(law) => law,
        Err(_) => panic!("four segments, one behind the other"),
    }
};

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(CamLaw::new(LAW)).compared_as(|| erase(CamLaw::new(StandIn::<0>)));
