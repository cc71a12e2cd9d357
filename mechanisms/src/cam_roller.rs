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

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;
    use crate::closed_form::{Jet, assert_moves_as};
    use crate::reference::one_turn;

    /// The motion law as a Fourier sum: `((1 − cos)/2)³ = (10 − 15 cos + 6 cos 2 − cos 3)/32`.
    fn law(angle: Jet) -> [Jet; 2] {
        let h = 0.015 / 32.0;
        let lift = (angle.cos() * -15.0 + (angle * 2.0).cos() * 6.0 - (angle * 3.0).cos() + 10.0) * h;
        let slope = (angle.sin() * 15.0 - (angle * 2.0).sin() * 12.0 + (angle * 3.0).sin() * 3.0) * h;
        [lift, slope]
    }

    fn columns(t: Jet) -> Vec<Jet> {
        let (angle, rb, rr, e) = (t * TAU, 0.03_f64, 0.008, 0.008);
        let [lift, slope] = law(angle);
        let y = lift + ((rb + rr) * (rb + rr) - e * e).sqrt();
        // At the point of contact the cam's velocity along the normal is the follower's: the normal passes through
        // the pole at `[−slope, 0]` to the left of the centre, in the sense of rotation.
        let way = (-slope + e, y);
        let length = (way.0.square() + way.1.square()).sqrt();
        vec![angle, angle, y, -(way.0 / length * rr) + e, y - way.1 / length * rr]
    }

    #[test]
    fn the_follower_obeys_the_motion_law() {
        let motion = one_turn(&CARD, 0, 180);
        assert_moves_as(&motion, &["theta", "c", "y", "P.0", "P.1"], 1e-12, columns);
    }

    /// The usual bound of the trade for a translating follower.
    #[test]
    fn the_pressure_angle_stays_below_30_degrees() {
        let motion = one_turn(&CARD, 0, 360);
        let angle = motion.outputs.last().expect("the pressure angle");
        assert!(angle.value.iter().all(|angle| angle.abs() < 30.0_f64.to_radians()));
    }
}
