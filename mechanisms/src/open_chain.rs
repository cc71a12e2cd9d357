//! The open chain of three links: independent coordinates, each with its time constraint.
//!
//! ```text
//!                       B      L3
//!                      o────────────o P      θ1: link 1 against the x axis
//!                L2  .' θ3                   θ2: link 2 against link 1
//!               A  .'                        θ3: link 3 against link 2
//!              o .'
//!         L1  / θ2
//!            / θ1
//!           o────── x
//!           O
//! ```
//!
//! Angles in rad, lengths in metres. Nothing closes, so that as many coordinates as degrees of freedom suffice,
//! and each of them is a function of the time: `θ1` and `θ2` swing, `θ3` turns.
//!
//! Numbers: chosen here, an arm of 0.75 m whose end draws a closed curve once a turn of `omega`.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;

mechanism! {
    /// Open chain of three links, each joint driven.
    pub mechanism OpenChain;

    param L1: m = 0.35;
    param L2: m = 0.25;
    param L3: m = 0.15;
    param omega: rad/s = TAU;
    param swing1: rad = 0.5;
    param swing2: rad = 0.7;

    coord theta1: rad = 0.9;
    coord theta2: rad = -0.5;
    coord theta3: rad = 0;

    let a = L1*unit(theta1);
    let b = a + L2*unit(theta1 + theta2);

    drive shoulder: theta1 == 0.9rad + swing1*sin(omega*t);
    drive elbow: theta2 == swing2*cos(2*omega*t) - 0.5rad;
    drive wrist: theta3 == -omega*t;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = a;
    out B: [m; 2] = b;
    out P: [m; 2] = b + L3*unit(theta1 + theta2 + theta3);
    out speed: m/s = norm(der(b + L3*unit(theta1 + theta2 + theta3)));

    title "Open chain of three links";
    about "Independent coordinates: three joint angles, each given as a function of the time, move the end \
           point of an arm.";
    preset "one cycle" "two joints swing, the last one turns" {}
    span turn(omega);
    draw ground O;
    draw link "link 1": O, A;
    draw link "link 2": A, B;
    draw link "link 3": B, P;
    draw joint O, A, B;
    trace "end point": P;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(OpenChain::default());

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;
    use crate::reference::one_turn;

    /// The angles of the time laws with first and second derivatives, differentiated by hand.
    fn laws(t: f64) -> [[f64; 3]; 3] {
        let (w, s, c) = (TAU, (TAU * t).sin(), (TAU * t).cos());
        let (s2, c2) = ((2.0 * TAU * t).sin(), (2.0 * TAU * t).cos());
        [
            [0.9 + 0.5 * s, 0.5 * w * c, -0.5 * w * w * s],
            [0.7 * c2 - 0.5, -1.4 * w * s2, -2.8 * w * w * c2],
            [-w * t, -w, 0.0],
        ]
    }

    /// End point with velocity and acceleration: sums over the links by the polar formulas.
    fn end_point(t: f64) -> [[f64; 2]; 3] {
        let mut sum = [[0.0; 2]; 3];
        let mut angle = [0.0; 3];
        for (length, law) in [0.35, 0.25, 0.15].into_iter().zip(laws(t)) {
            angle.iter_mut().zip(law).for_each(|(a, b)| *a += b);
            let ([a, w, e], [s, c]) = (angle, [angle[0].sin(), angle[0].cos()]);
            debug_assert!(a.is_finite());
            let terms = [[c, s], [-w * s, w * c], [-e * s - w * w * c, e * c - w * w * s]];
            for (total, term) in sum.iter_mut().zip(terms) {
                total.iter_mut().zip(term).for_each(|(x, y)| *x += length * y);
            }
        }
        sum
    }

    #[test]
    fn the_angles_follow_their_time_laws() {
        let motion = one_turn(&CARD, 0, 48);
        for (step, t) in motion.time.iter().enumerate() {
            for (coordinate, law) in motion.coordinates.iter().zip(laws(*t)) {
                let found = [coordinate.q[step], coordinate.qd[step], coordinate.qdd[step]];
                for ((found, expected), bound) in found.into_iter().zip(law).zip([1e-14, 1e-13, 1e-12]) {
                    assert!(
                        (found - expected).abs() <= bound,
                        "{} at {t}: {found} {expected}",
                        coordinate.name
                    );
                }
            }
        }
    }

    #[test]
    fn the_end_point_moves_as_the_polar_formulas_say() {
        let motion = one_turn(&CARD, 0, 48);
        for (step, t) in motion.time.iter().enumerate() {
            let [place, velocity, acceleration] = end_point(*t);
            for (axis, output) in motion.outputs[6..8].iter().enumerate() {
                assert!((output.value[step] - place[axis]).abs() < 1e-14);
                assert!((output.rate.as_ref().expect("a rate")[step] - velocity[axis]).abs() < 1e-13);
                let found = output.acceleration.as_ref().expect("an acceleration")[step];
                assert!((found - acceleration[axis]).abs() < 1e-11, "at {t}: {found}");
            }
            let speed = &motion.outputs[8];
            assert!((speed.value[step] - velocity[0].hypot(velocity[1])).abs() < 1e-13);
            assert!(speed.rate.is_some() && speed.acceleration.is_none());
        }
    }
}
