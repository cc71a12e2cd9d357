//! Two points on two massless rods, in Cartesian coordinates.
//!
//! ```text
//!   O ━━━━━● P1
//!           ╲           amplitude of P1 (rad) from the vertical at the start,
//!            ● P2       P2 farther by √2: the slow one of two modes where it is small
//! ```
//!
//! Lengths in metres, masses in kg; both rods and both masses are equal.
//!
//! Closed form of small swings: φ₂ = √2 φ₁ with ω² = (2 − √2) g/L (Landau & Lifshitz, Mechanics, §23).

use mbs_runtime::mechanism;

use crate::drawing::Shape;
use crate::masses::boxed_masses;
use crate::registry::{FreeCard, Preset, Usual};

/// In the list of free mechanisms.
pub const CARD: FreeCard = FreeCard {
    name: "double_pendulum",
    title: "Double pendulum",
    description: "Two equal points on two equal rods: a mode of small swings, and a motion that nobody predicts for long.",
    runs: &[
        Preset { label: "large", description: "from far out, at rest", set: &[("amplitude", 1.5)] },
        Preset { label: "small", description: "the slow mode, at rest", set: &[("amplitude", 0.1)] },
    ],
    duration: 6.0,
    usual: Usual::Projection,
    drawing: DRAWING,
    make: boxed_masses::<DoublePendulum, 4, 2>,
};

mechanism! {
    /// A double pendulum: two degrees of freedom in four coordinates.
    pub mechanism DoublePendulum;
    /// Mass of each point.
    param m: kg = 1;
    /// Length of each rod.
    param L: m = 1;
    /// Free fall.
    param g: m/s^2 = 9.81;
    /// Angle of the first rod against the vertical at the start.
    param amplitude: rad = 1.5;
    coord P1: [m; 2] = [0, -1];
    coord P2: [m; 2] = [0, -2];
    let from = L*[sin(amplitude), -cos(amplitude)];
    let to = from + L*[sin(sqrt(2)*amplitude), -cos(sqrt(2)*amplitude)];
    body first { mass: m, com: P1 }
    body second { mass: m, com: P2 }
    gravity weight { acceleration: [0, -g] }
    constraint rods {
        dot(P1, P1) == L^2;
        dot(P2 - P1, P2 - P1) == L^2;
    }
    start P1 = from rate [0, 0];
    start P2 = to rate [0, 0];
    out O: [m; 2] = [0, 0];
    out A: [m; 2] = P1;
    out B: [m; 2] = P2;
    out tension: [N; 2] = [2*L*lambda(rods[0]), 2*L*lambda(rods[1])];
}

/// How the mechanism is drawn.
pub const DRAWING: &[Shape] = &[
    Shape::Ground { at: "O" },
    Shape::Link { points: &["O", "A"], label: "upper rod" },
    Shape::Link { points: &["A", "B"], label: "lower rod" },
    Shape::Joint { at: "O" },
    Shape::Joint { at: "A" },
    Shape::Trace { of: "B", label: "end" },
];

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;
    use crate::analyses::direct::{Approach, Pair, Stabilization, Steps};
    use crate::reference::dynamics_of;
    use crate::registry::instants;

    #[test]
    fn a_large_motion_keeps_its_energy() {
        let found = dynamics_of(&CARD, &CARD.runs[0], 60);
        let forces = found.motion.dynamics.expect("it has masses");
        let most = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        assert!(most(&forces.defect) < 1e-9 * most(&forces.kinetic), "{:e}", most(&forces.defect));
    }

    #[test]
    fn small_swings_have_the_period_of_their_mode() {
        const SMALL: f64 = 1e-3;
        let small = Preset { label: "", description: "", set: &[("amplitude", SMALL)] };
        let mechanism = CARD.instance(&small).expect("a parameter");
        let period = TAU / ((2.0 - 2.0_f64.sqrt()) * 9.81).sqrt();
        let steps = Steps::Adaptive { pair: Pair::Order8, tolerance: 1e-12 };
        let approach = Approach { stabilization: Stabilization::Velocity, steps };
        let dynamics = mechanism.dynamics().expect("it has masses");
        let found = dynamics.simulate(&approach, &instants(period, 4), &mut |_| ()).expect("it starts");
        let x = &found.motion.coordinates[0].q;
        // The quarters of a cosine; the period grows by about the square of the amplitude over 16.
        for (found, quarter) in x.iter().zip([1.0, 0.0, -1.0, 0.0, 1.0]) {
            assert!((found / SMALL - quarter).abs() < 5.0 * SMALL * SMALL, "{x:?}");
        }
    }
}
