//! The lecture's four-bar linkage with a coupler point.
//!
//! ```text
//!                      P = (x2, y2)
//!                    .·' ·
//!              L5 .·'     ·
//!              .·' α       B
//!            A ────────────o
//!            o      L2      \
//!        L1 /  φ2            \ L3
//!          / φ1            φ3 \
//!         o────────────────────o
//!         O         L4         D
//! ```
//!
//! All angles count from the ground line `O D` (rad), lengths are in metres, `q = [x2 y2 φ1 φ2 φ3]`. The coupler
//! point stands at `L5` from `A`, turned by `α` against `A B`. The crank turns at constant `ω`.
//!
//! Rows stand in the order of the lecture's slides and have their signs. The crank is the shortest link and
//! `L1 + L2 = 0.80 m < L3 + L4 = 1.05 m`, so it turns fully (Grashof) in either assembly. `sin(φ3 − φ2)` keeps its
//! sign, positive in the open one (`side = 1`), negative in the crossed one (`side = -1`).
//!
//! Numbers: the reference problem in `tests/data/four_bar.csv`.

use mbs_runtime::mechanism;
use mbs_workbench::card;
use mbs_workbench::card::Card;
use mbs_workbench::erased::facade::AnyEquations;
use mbs_workbench::known_motion::{KnownCourse, KnownMotion, KnownState, parameter};

mechanism! {
    /// Four-bar linkage with a coupler point.
    pub mechanism FourBar;

    param L1: m = 0.20;
    param L2: m = 0.60;
    param L3: m = 0.50;
    param L4: m = 0.55;
    param L5: m = 0.35;
    param alpha: rad = 30deg;
    param omega: rad/s = TAU;
    param side: 1 = 1;

    coord x2: m;
    coord y2: m;
    coord phi1: rad = 0;
    coord phi2: rad = 0.9*side;
    coord phi3: rad = 1.6*side;

    constraint coupler_point {
        x2 == L1*cos(phi1) + L5*cos(alpha + phi2);
        y2 == L1*sin(phi1) + L5*sin(alpha + phi2);
    }
    constraint closure {
        L3*cos(phi3) + L4 == L1*cos(phi1) + L2*cos(phi2);
        L1*sin(phi1) + L2*sin(phi2) == L3*sin(phi3);
    }
    drive crank: phi1 == omega*t;
    branch assembly: side*sin(phi3 - phi2) > 0;

    out O: [m; 2] = [0, 0];
    out A: [m; 2] = L1*unit(phi1);
    out B: [m; 2] = L1*unit(phi1) + L2*unit(phi2);
    out D: [m; 2] = [L4, 0];
    out P: [m; 2] = [x2, y2];
    out transmission_angle: rad = phi3 - phi2;

    title "Four-bar linkage with coupler point";
    about "The lecture's example: a crank turns at constant speed, the coupler carries a point P. Both \
           assemblies of the same links come from one text.";
    preset "open assembly" "coupler and rocker on the upper side" { side: 1 }
    preset "crossed assembly" "coupler and rocker on the lower side" { side: -1 }
    span turn(omega);
    draw ground O, D;
    draw plate coupler: A, B, P;
    draw link crank: O, A;
    draw link rocker: D, B;
    draw joint O, A, B, D;
    trace "coupler curve": P;
}

/// Entry in the list of mechanisms.
pub const CARD: Card = card!(FourBar::default()).known_by(&KNOWN);

/// Positions by the intersection of two circles.
const KNOWN: KnownMotion = KnownMotion {
    source: "closed form: intersection of two circles",
    // Angles next to stretched positions have fewer digits than lengths.
    error: 1e-13,
    course: KnownCourse::Form(closed_form),
};

fn closed_form(four_bar: &dyn AnyEquations, t: f64) -> Option<KnownState> {
    let [crank, coupler, rocker, ground] = ["L1", "L2", "L3", "L4"].map(|name| parameter(four_bar, name));
    let [point, alpha, omega, side] = ["L5", "alpha", "omega", "side"].map(|name| parameter(four_bar, name));
    let angle = omega * t;
    let a = [crank * angle.cos(), crank * angle.sin()];
    let way = [ground - a[0], -a[1]];
    let square = way[0] * way[0] + way[1] * way[1];
    // B along and across the way from A to D.
    let along = (square + coupler * coupler - rocker * rocker) / (2.0 * square);
    let across = side.signum() * (coupler * coupler / square - along * along).sqrt();
    if across.is_nan() {
        return None;
    }
    let to_b = [along * way[0] - across * way[1], along * way[1] + across * way[0]];
    let coupler_angle = to_b[1].atan2(to_b[0]);
    let rocker_angle = (a[1] + to_b[1]).atan2(a[0] + to_b[0] - ground);
    let p = [a[0] + point * (alpha + coupler_angle).cos(), a[1] + point * (alpha + coupler_angle).sin()];
    Some(KnownState { t, q: vec![p[0], p[1], angle, coupler_angle, rocker_angle], qd: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::{assert_follows, assert_near, table};
    use mbs_workbench::erased::facade::State;

    /// The lecture's numbers of one state, `q = [x2 y2 φ1 φ2 φ3]`.
    struct Slide {
        l: [f64; 5],
        alpha: f64,
        omega: f64,
        state: State,
    }

    const SLIDE_STATES: [([f64; 5], [f64; 5], f64); 3] = [
        ([0.31, -0.22, 0.4, 0.9, 1.7], [0.5, -1.25, 6.0, -2.5, 3.5], 0.07),
        ([-0.1, 0.6, -2.9, 2.2, -0.6], [-3.0, 2.0, -4.0, 7.5, 1.5], -0.3),
        ([0.0, 0.0, 3.0, -3.0, 0.1], [1.0, 1.0, 1.0, 1.0, 1.0], 2.0),
    ];

    fn slides() -> impl Iterator<Item = Slide> {
        SLIDE_STATES.into_iter().map(|(q, qd, t)| Slide {
            l: [0.20, 0.60, 0.50, 0.55, 0.35],
            alpha: core::f64::consts::FRAC_PI_6,
            omega: core::f64::consts::TAU,
            state: State { q: q.to_vec(), qd: qd.to_vec(), qdd: vec![0.0; 5], t },
        })
    }

    #[test]
    fn phi_equals_the_slides_residuals() {
        for Slide { l: [l1, l2, l3, l4, l5], alpha, omega, state } in slides() {
            let [x2, y2, p1, p2, p3] = state.q[..] else { unreachable!("five coordinates") };
            let expected = [
                x2 - l1 * p1.cos() - l5 * (alpha + p2).cos(),
                y2 - l1 * p1.sin() - l5 * (alpha + p2).sin(),
                -l1 * p1.cos() - l2 * p2.cos() + l3 * p3.cos() + l4,
                l1 * p1.sin() + l2 * p2.sin() - l3 * p3.sin(),
                p1 - omega * state.t,
            ];
            assert_near(&CARD.equations().evaluate(&state).phi, &expected, 1e-14);
        }
    }

    #[test]
    fn phi_q_equals_the_slides_matrix() {
        for Slide { l: [l1, l2, l3, _, l5], alpha, state, .. } in slides() {
            let [_, _, p1, p2, p3] = state.q[..] else { unreachable!("five coordinates") };
            #[rustfmt::skip] // as the slide prints it
            let expected = [
                1.0, 0.0, l1 * p1.sin(), l5 * (alpha + p2).sin(), 0.0,
                0.0, 1.0, -l1 * p1.cos(), -l5 * (alpha + p2).cos(), 0.0,
                0.0, 0.0, l1 * p1.sin(), l2 * p2.sin(), -l3 * p3.sin(),
                0.0, 0.0, l1 * p1.cos(), l2 * p2.cos(), -l3 * p3.cos(),
                0.0, 0.0, 1.0, 0.0, 0.0,
            ];
            assert_near(&CARD.equations().evaluate(&state).phi_q, &expected, 1e-15);
        }
    }

    #[test]
    fn time_derivatives_equal_the_slides() {
        for Slide { omega, state, .. } in slides() {
            let functions = CARD.equations().evaluate(&state);
            assert_near(&functions.phi_t, &[0.0, 0.0, 0.0, 0.0, -omega], 1e-15);
            assert_eq!(functions.phi_tt, [0.0; 5]);
            assert_eq!(functions.phi_qt_qd, [0.0; 5]);
        }
    }

    /// The slide's example heads its matrix `(Φ_qt)_q q̇`; what it prints, and what its derivation before has, is
    /// `(Φ_q q̇)_q q̇`. γ is the negative of it.
    #[test]
    fn gamma_is_the_negative_of_the_slides_vector() {
        for Slide { l: [l1, l2, l3, _, l5], alpha, state, .. } in slides() {
            let [_, _, p1, p2, p3] = state.q[..] else { unreachable!("five coordinates") };
            let [_, _, d1, d2, d3] = state.qd[..] else { unreachable!("five coordinates") };
            let slide = [
                d1 * d1 * l1 * p1.cos() + d2 * d2 * l5 * (alpha + p2).cos(),
                d1 * d1 * l1 * p1.sin() + d2 * d2 * l5 * (alpha + p2).sin(),
                d1 * d1 * l1 * p1.cos() + d2 * d2 * l2 * p2.cos() - d3 * d3 * l3 * p3.cos(),
                -d1 * d1 * l1 * p1.sin() - d2 * d2 * l2 * p2.sin() + d3 * d3 * l3 * p3.sin(),
                0.0,
            ];
            assert_near(&CARD.equations().evaluate(&state).gamma, &slide.map(|value| -value), 1e-13);
        }
    }

    #[test]
    fn the_motion_follows_the_reference() {
        let rows = table(include_str!("../tests/data/four_bar.csv"));
        assert_eq!(rows.len(), 8);
        assert_follows(&CARD, 0, 0.005, &rows, 1e-11);
    }

    #[test]
    fn either_assembly_keeps_its_side_for_a_turn() {
        for (run, side) in [1.0, -1.0].into_iter().enumerate() {
            let motion = crate::reference::one_turn(&CARD, run, 360);
            let angle = motion.outputs.last().expect("the transmission angle");
            assert!(angle.value.iter().all(|angle| side * angle.sin() > 0.3), "{}", run);
        }
    }

    #[test]
    fn the_coupler_point_moves_as_its_coordinates() {
        let motion = crate::reference::one_turn(&CARD, 0, 50);
        for (component, coordinate) in [(8, 0), (9, 1)] {
            let output = &motion.outputs[component];
            assert_near(&output.value, &motion.coordinates[coordinate].q, 1e-15);
            assert_near(output.rate.as_ref().expect("a rate"), &motion.coordinates[coordinate].qd, 1e-15);
            let acceleration = output.acceleration.as_ref().expect("an acceleration");
            assert_near(acceleration, &motion.coordinates[coordinate].qdd, 1e-15);
        }
    }
}
