//! Contacts of a given restitution: the damping by the exact relation, and rebounds of a free ball.

use super::seen_tests::{derived, value_at};
use crate::symbolic::Leaf;

/// Restitution of the dimensionless damping c: the root of e c + ln(1 − e c) = ln(1 + c) − c between 0 and 1/c, by bisection.
fn restitution(c: f64) -> f64 {
    let wanted = c.ln_1p() - c;
    let (mut low, mut high) = (0.0, (1.0 / c).min(1.0 + 1e-6));
    for _ in 0..200 {
        let e: f64 = 0.5 * (low + high);
        let found = e * c + (-e * c).ln_1p();
        if found > wanted { low = e } else { high = e }
    }
    0.5 * (low + high)
}

#[test]
fn the_damping_of_a_restitution_fulfils_the_exact_relation() {
    let (_, equations) = derived(
        "mechanism M; param e: 1 = 0.5; param v: m/s = 2; coord x: m = 0.1; body ball { mass: 1, com: [x, 0] }
         contact wall { gap: x, stiffness: 1e3, restitution: e, approach: v } out push: N = force(wall);",
    );
    let push = equations.outputs.first().expect("an output").value;
    let (depth, closing, v) = (0.5, 3.0, 2.0);
    let mut last = f64::INFINITY;
    for step in 1..=1000 {
        let e = f64::from(step) / 1000.0;
        let force = value_at(&equations.graph, push, |leaf| match leaf {
            Leaf::Parameter(0) => e,
            Leaf::Parameter(_) => v,
            Leaf::Position(_) => -depth,
            _ => -closing,
        });
        // k p (1 + d ṗ)
        let c = (force / (1e3 * depth) - 1.0) / closing * v;
        assert!(c < last && c >= 0.0, "e = {e}: c = {c} behind {last}");
        last = c;
        if step < 1000 {
            assert!((restitution(c) - e).abs() < 1e-8, "e = {e}: c = {c} gives {}", restitution(c));
        } else {
            assert!(c < 1e-9, "{c}");
        }
    }
}

/// Speed of a ball behind the contact, by Runge and Kutta's method on the force that the equations have.
fn rebound(law: &str, e: f64, approach: f64) -> f64 {
    let (_, equations) = derived(&format!(
        "mechanism M; coord x: m = 0; body ball {{ mass: 2, com: [x, 0] }}
         contact wall {{ gap: x, stiffness: 1e4, {law} restitution: {e}, approach: {approach} }}"
    ));
    let force = equations.dynamics.as_ref().expect("forces").force[0].expect("a force");
    let rates = |[x, v]: [f64; 2]| {
        let push = value_at(&equations.graph, force, |leaf| match leaf {
            Leaf::Position(_) => x,
            _ => v,
        });
        [v, push / 2.0]
    };
    let (h, mut y) = (1e-4, [0.0, -approach]);
    for _ in 0..20_000 {
        let moved = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
        let first = rates(y);
        let second = rates(moved(first, 0.5));
        let third = rates(moved(second, 0.5));
        let fourth = rates(moved(third, 1.0));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
        if y[0] >= 0.0 {
            return y[1];
        }
    }
    panic!("{law} {e}: it does not leave")
}

#[test]
fn a_free_ball_rebounds_with_the_restitution_whatever_the_exponent() {
    for law in ["", "exponent: 1.5, depth: 1mm,", "exponent: 2.5, depth: 10mm,"] {
        for (e, approach) in [(1.0, 0.5), (0.9, 1.0), (0.5, 0.5), (0.2, 2.0)] {
            let found = rebound(law, e, approach) / approach;
            assert!((found - e).abs() < 1e-3, "{law} {found} instead of {e}");
        }
    }
}
