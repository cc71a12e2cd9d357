//! Tests of `mechanisms::loop_length`.

use core::f64::consts::TAU;

use crate::reference::{angle_difference, one_turn};
use mechanisms::loop_length::*;

const L1: f64 = 0.05;
const L3: f64 = 0.03;
const OD: f64 = 0.12;

/// A value with its first and second time derivatives.
type Jet = [f64; 3];

/// `ψ3` by Pythagoras in the right-angled triangle `A B D`: `ψ3² = |AD|² − L3²`.
fn length(psi1: f64, omega: f64) -> Jet {
    let s = (L1 * L1 + OD * OD - 2.0 * L1 * OD * psi1.cos() - L3 * L3).sqrt();
    let rate = L1 * OD * omega * psi1.sin() / s;
    [s, rate, (L1 * OD * omega * omega * psi1.cos() - rate * rate) / s]
}

/// Direction of the line `A D`.
fn direction(psi1: f64, omega: f64) -> Jet {
    let d = [OD - L1 * psi1.cos(), -L1 * psi1.sin()];
    let v = [L1 * omega * psi1.sin(), -L1 * omega * psi1.cos()];
    let a = [L1 * omega * omega * psi1.cos(), L1 * omega * omega * psi1.sin()];
    let square = d[0] * d[0] + d[1] * d[1];
    let rate = (d[0] * v[1] - d[1] * v[0]) / square;
    let turning = (d[0] * a[1] - d[1] * a[0]) / square;
    [d[1].atan2(d[0]), rate, turning - 2.0 * rate * (d[0] * v[0] + d[1] * v[1]) / square]
}

/// The guide's angle is that of `A D` plus the angle `atan(L3/ψ3)` of the triangle at `A`.
fn guide(psi1: f64, omega: f64) -> Jet {
    let ([s, v, a], [delta, rate, turning]) = (length(psi1, omega), direction(psi1, omega));
    let square = s * s + L3 * L3;
    [
        delta + (L3 / s).atan(),
        rate - L3 * v / square,
        turning - L3 * (a * square - 2.0 * s * v * v) / (square * square),
    ]
}

#[test]
fn the_motion_equals_the_closed_form() {
    let motion = one_turn(&CARD, 0, 72);
    let [_, psi2, psi3] = &motion.coordinates[..] else { unreachable!("three coordinates") };
    for (step, t) in motion.time.iter().enumerate() {
        let (s, beta) = (length(TAU * t, TAU), guide(TAU * t, TAU));
        assert!((psi3.q[step] - s[0]).abs() < 1e-13, "ψ3 at {t}");
        assert!((psi3.qd[step] - s[1]).abs() < 1e-12, "ψ̇3 at {t}");
        assert!((psi3.qdd[step] - s[2]).abs() < 1e-11, "ψ̈3 at {t}");
        assert!(angle_difference(psi2.q[step], beta[0] - TAU * t) < 1e-12, "ψ2 at {t}");
        assert!((psi2.qd[step] - (beta[1] - TAU)).abs() < 1e-11, "ψ̇2 at {t}");
        assert!((psi2.qdd[step] - beta[2]).abs() < 1e-9, "ψ̈2 at {t}");
    }
}

#[test]
fn the_length_stays_within_the_documented_range() {
    let motion = one_turn(&CARD, 0, 360);
    let shortest = motion.coordinates[2].q.iter().copied().fold(f64::INFINITY, f64::min);
    let longest = motion.coordinates[2].q.iter().copied().fold(0.0, f64::max);
    assert!((shortest - 0.0632).abs() < 5e-5 && (longest - 0.1673).abs() < 5e-5, "{shortest} … {longest}");
}
