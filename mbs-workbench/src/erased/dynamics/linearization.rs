//! Small motions about a position of rest or a moving state, and their eigenvalues.

use mbs_runtime::dynamics::{Instant, IntegratorState, Solved, linearize_with_states};
use mbs_runtime::{Dynamic, Entry};
use nalgebra::Schur;
use serde::Serialize;

use super::first_order::FirstOrder;
use super::modes::{self, Mode};
use crate::erased::facade::Motion;

/// Largest number of QR sweeps for each eigenvalue; two or three are usual.
const SWEEPS: usize = 100;

/// Part of the matrix's norm below which an eigenvalue counts as 0. Rounding moves a double zero, that of a rigid-body motion, by
/// the root of ε.
pub const ZERO: f64 = 1e-6;

/// Eigenvalues of small motions q + R s on the constraints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SmallMotions {
    /// Degrees of freedom.
    pub freedom: usize,
    /// Real and imaginary part (1/s) of the 2·`freedom` eigenvalues of s̈ = −M̄⁻¹ (C̄ ṡ + K̄ s), plus one for each
    /// first-order state. They are sorted by frequency, then by decay; none of them is of multipliers or stabilisation.
    pub eigenvalues: Vec<[f64; 2]>,
    /// Norm of the first-order system (1/s): below [`ZERO`] of it an eigenvalue is 0.
    pub norm: f64,
    /// Modes in the order of the eigenvalues, one for each conjugate pair.
    pub modes: Vec<Mode>,
    /// `true` if the state moves: the eigenvalues are those of one moment (frozen-time).
    pub frozen: bool,
    /// Coordinates whose variations are s, about a moving state; none about an equilibrium.
    pub coordinates: Vec<&'static str>,
    /// Independent coordinates of the text that are not among them, because there they do not determine the others.
    pub passed_over: Vec<&'static str>,
}

/// Stability of small motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stability {
    /// Nothing can move.
    Fixed,
    /// Some grow.
    Unstable {
        /// Time (s) in which the fastest grows by e.
        time_constant: f64,
    },
    /// Number of motions without a restoring force; none of the others grows.
    Indifferent(usize),
    /// They neither grow nor decay.
    Marginal,
    /// All decay.
    Stable,
}

impl SmallMotions {
    /// Stability by the real parts of the eigenvalues.
    pub fn fate(&self) -> Stability {
        let zero = ZERO * self.norm;
        let fastest = self.eigenvalues.iter().map(|[real, _]| *real).fold(f64::NEG_INFINITY, f64::max);
        let idle = self.eigenvalues.iter().filter(|[real, imaginary]| real.hypot(*imaginary) <= zero).count();
        match () {
            () if self.freedom == 0 => Stability::Fixed,
            () if fastest > zero => Stability::Unstable { time_constant: 1.0 / fastest },
            // Two zeros for place and speed of a rigid-body motion; with damping one, for its speed decays.
            () if idle > 0 => Stability::Indifferent(idle.div_ceil(2)),
            () if fastest >= -zero => Stability::Marginal,
            () => Stability::Stable,
        }
    }
}

/// Small motions about the last instant of `motion`, which has multipliers. About a moving state the coordinates are
/// `independent`, as far as they determine the others.
///
/// # Errors
/// Reason in words: those of [`linearize`](fn@mbs_runtime::dynamics::linearize), or eigenvalues that do not converge.
pub(crate) fn small_motions<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    independent: &[u16],
    motion: &Motion,
) -> Result<SmallMotions, String> {
    let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
    let t = last(&motion.time);
    let column = |order: fn(&crate::erased::facade::CoordinateCurve) -> &Vec<f64>| -> [f64; N] {
        core::array::from_fn(|i| motion.coordinates.get(i).map_or(f64::NAN, |curve| last(order(curve))))
    };
    let (q, qd, qdd) = (column(|c| &c.q), column(|c| &c.qd), column(|c| &c.qdd));
    let multipliers = motion.dynamics.iter().flat_map(|forces| &forces.multipliers);
    let mut lambda = [0.0; M];
    lambda.iter_mut().zip(multipliers).for_each(|(slot, curve)| *slot = last(&curve.value));
    let mut mechanism = mechanism.clone();
    mechanism.start_phases(&q, t);
    let mut states = mechanism.start_states(&mechanism.parameters());
    let known = motion.dynamics.iter().flat_map(|forces| &forces.states);
    states.as_mut().iter_mut().zip(known).for_each(|(state, known)| *state = *known);
    let y = IntegratorState { q, qd, states, work: 0.0 };
    let rate = IntegratorState { q: qd, qd: qdd, states, work: 0.0 };
    let instant = Instant { t, y, solved: Solved { rate, lambda, margin: 1.0 }, carried: qdd };
    let found = linearize_with_states(&mechanism, &instant, independent);
    let (linear, slopes) = found.map_err(|failure| failure.to_string())?;
    let equations = FirstOrder::of(&linear, slopes.as_ref().map_or(&[], AsRef::as_ref))
        .ok_or_else(|| "the masses of the free motions are not positive definite".to_string())?;
    let mut small = solved(&equations, linear.frozen)
        .ok_or_else(|| "the iteration for the eigenvalues does not end".to_string())?;
    small.modes = modes::modes(&equations, &small, &linear.basis)
        .into_iter()
        .map(|mode| mode.shown(&mechanism, &q, t))
        .collect();
    if linear.frozen {
        let marked = |index: usize| linear.independent.get(index).copied().unwrap_or(false);
        let named = |(_, entry): (usize, &Entry)| entry.name;
        let entries = || S::COORDINATES.iter().enumerate();
        let wanted = |index: usize| independent.iter().any(|known| usize::from(*known) == index);
        small.coordinates = entries().filter(|(index, _)| marked(*index)).map(named).collect();
        small.passed_over =
            entries().filter(|(index, _)| wanted(*index) && !marked(*index)).map(named).collect();
    }
    Ok(small)
}

/// Eigenvalues and modes of the equations of small motions; none if their iteration does not converge.
fn solved(linear: &FirstOrder, frozen: bool) -> Option<SmallMotions> {
    let nothing = SmallMotions {
        freedom: linear.freedom(),
        eigenvalues: Vec::new(),
        norm: 0.0,
        frozen,
        modes: Vec::new(),
        coordinates: Vec::new(),
        passed_over: Vec::new(),
    };
    let system = linear.system();
    if system.nrows() == 0 {
        return Some(nothing);
    }
    let schur = Schur::try_new(system.clone(), f64::EPSILON, SWEEPS * system.nrows())?;
    let mut found: Vec<[f64; 2]> = schur.complex_eigenvalues().iter().map(|z| [z.re, z.im]).collect();
    found.sort_by(|a, b| {
        a[1].abs().total_cmp(&b[1].abs()).then(a[0].total_cmp(&b[0])).then(a[1].total_cmp(&b[1]))
    });
    Some(SmallMotions { eigenvalues: found, norm: system.norm(), ..nothing })
}

#[cfg(test)]
mod tests {
    use mbs_runtime::mechanism;

    use super::*;
    use crate::erased::dynamics::direct_dynamics::{Approach, Pair, Stabilization, Steps};
    use crate::erased::erase::erase;
    use crate::erased::facade::AnyEquations;

    /// Deviation from a closed form, relative to the norm.
    const BOUND: f64 = 1e-9;

    mechanism! {
        /// A point on a rod, damped, near the bottom.
        pub mechanism Hanging;
        param L: m = 0.7;
        coord P: [m; 2] = [0.05, -0.69];
        coord phi: rad = 0;
        body bob { mass: 2, com: P }
        gravity weight { acceleration: [0, -9.81] }
        rsda bearing { angle: phi, damping: 0.3 }
        constraint rod { P == L*[sin(phi), -cos(phi)]; }
        start phi = 0.1 rate 0;
    }

    mechanism! {
        /// Two equal points on two equal rods, near the bottom.
        pub mechanism Double;
        param L: m = 1;
        coord P1: [m; 2] = [0.05, -1];
        coord P2: [m; 2] = [0.1, -2];
        body first { mass: 1, com: P1 }
        body second { mass: 1, com: P2 }
        gravity weight { acceleration: [0, -9.81] }
        constraint rods { dot(P1, P1) == L^2; dot(P2 - P1, P2 - P1) == L^2; }
        start P1 = [0.05, -0.99874921777190895] rate [0, 0];
    }

    mechanism! {
        /// An inverted pendulum on a cart.
        pub mechanism Standing;
        param M: kg = 3;
        param m: kg = 0.5;
        param L: m = 0.8;
        coord x: m = 0;
        coord phi: rad = 90deg;
        coord P: [m; 2] = [0, 0.8];
        body cart { mass: M, com: [x, 0] }
        body bob { mass: m, com: P }
        gravity weight { acceleration: [0, -9.81] }
        constraint pole { P == [x, 0] + L*unit(phi); }
        start x = 0 rate 0;
        start phi = 90deg rate 0;
    }

    mechanism! {
        /// A point on springs on a turntable: the table carries it by the time, so that rest on it is rest.
        pub mechanism Turntable;
        param k: N/m = 50;
        param omega: rad/s = 3;
        coord p: [m; 2] = [0, 0];
        body point { mass: 2, com: rot(omega*t)*p }
        potential springs = k*dot(p, p)/2;
        start p = [0, 0] rate [0, 0];
    }

    mechanism! {
        /// A point on a spring with an actuator that lags its command and depends on the point.
        pub mechanism Lagging;
        coord x: m = 0.1;
        state z: N = 1;
        body point { mass: 2, com: [x, 0] }
        potential spring = 0.5*100N/1m*x^2;
        force actuator: z on x;
        der(z) == (2N - 300N/1m*x - 10N*1s/1m*der(x) - z)/0.3s;
        start x = 0.1 rate 0;
    }

    #[test]
    fn first_order_states_add_an_eigenvalue_each() {
        let lagging = erase(Lagging::default()).into_equations();
        let dynamics = lagging.dynamics().expect("it has masses");
        let rest = dynamics.rest(&[]).expect("it rests");
        assert!((rest.motion.coordinates[0].q[0] - 0.005).abs() < 1e-12);
        let found = dynamics.small_motions(&rest.motion).expect("it moves");
        assert_eq!((found.eigenvalues.len(), found.freedom, found.frozen), (3, 1, false));
        // 2 s³ + 2/0.3 s² + (100 + 10/0.3) s + (100 + 300)/0.3 = 0.
        for [re, im] in &found.eigenvalues {
            let z = nalgebra::Complex::new(*re, *im);
            let value = z * z * z * 2.0 + z * z * (2.0 / 0.3) + z * (100.0 + 10.0 / 0.3) + 400.0 / 0.3;
            assert!(value.norm() < 1e-9 * found.norm.powi(3), "{found:?}");
        }
        let sum: f64 = found.eigenvalues.iter().map(|[re, _]| re).sum();
        assert!((sum + 1.0 / 0.3).abs() < BOUND * found.norm, "{found:?}");
    }

    fn about_start(mechanism: &dyn AnyEquations, t: f64) -> SmallMotions {
        let steps = Steps::Adaptive { pair: Pair::Order8, tolerance: 1e-11 };
        let approach = Approach { stabilization: Stabilization::Projection, steps };
        let dynamics = mechanism.dynamics().expect("it has masses");
        let times = if t > 0.0 { vec![0.0, t] } else { vec![0.0] };
        let found = dynamics.simulate(&approach, &times, &mut |_| ()).expect("it starts");
        dynamics.small_motions(&found.motion).expect("it moves")
    }

    #[track_caller]
    fn assert_eigenvalues(found: &SmallMotions, expected: &[[f64; 2]]) {
        assert_eq!(found.eigenvalues.len(), expected.len(), "{found:?}");
        assert_eq!(found.eigenvalues.len(), 2 * found.freedom);
        for ([re, im], [real, imaginary]) in found.eigenvalues.iter().zip(expected) {
            let error = (re - real).hypot(im - imaginary);
            assert!(error < BOUND * found.norm, "{found:?} instead of {expected:?}");
        }
    }

    #[test]
    fn a_damped_pendulum_swings_about_its_rest_as_known() {
        let hanging = erase(Hanging::default()).into_equations();
        let dynamics = hanging.dynamics().expect("it has masses");
        let rest = dynamics.rest(&[]).expect("it rests");
        let (stiffness, decay) = (9.81_f64 / 0.7, 0.3_f64 / (2.0 * 0.49) / 2.0);
        let frequency = (stiffness - decay * decay).sqrt();
        let found = dynamics.small_motions(&rest.motion).expect("it moves");
        assert!(!found.frozen);
        assert_eigenvalues(&found, &[[-decay, -frequency], [-decay, frequency]]);
    }

    #[test]
    fn a_double_pendulum_has_its_two_modes() {
        let double = erase(Double::default()).into_equations();
        let dynamics = double.dynamics().expect("it has masses");
        let rest = dynamics.rest(&[]).expect("it rests");
        let [slow, fast] = [-1.0, 1.0].map(|sign| ((2.0 + sign * 2.0_f64.sqrt()) * 9.81).sqrt());
        let found = dynamics.small_motions(&rest.motion).expect("it moves");
        assert_eigenvalues(&found, &[[0.0, -slow], [0.0, slow], [0.0, -fast], [0.0, fast]]);
    }

    #[test]
    fn a_standing_pole_falls_and_its_cart_goes_where_it_likes() {
        let found = about_start(erase(Standing::default()).into_equations().as_ref(), 0.0);
        let growth = (3.5 / 3.0 * 9.81 / 0.8_f64).sqrt();
        let mut values = found.eigenvalues.clone();
        values.sort_by(|a, b| a[0].total_cmp(&b[0]));
        for ([re, im], expected) in values.iter().zip([-growth, 0.0, 0.0, growth]) {
            let bound = if expected == 0.0 { ZERO } else { BOUND };
            assert!((re - expected).hypot(*im) < bound * found.norm, "{found:?}");
        }
        assert_eq!(found.freedom, 2);
        assert!(!found.frozen);
    }

    #[test]
    fn a_turning_table_splits_the_modes_by_its_speed() {
        let found = about_start(erase(Turntable::default()).into_equations().as_ref(), 0.0);
        let [slow, fast] = [5.0 - 3.0, 5.0 + 3.0];
        assert_eigenvalues(&found, &[[0.0, -slow], [0.0, slow], [0.0, -fast], [0.0, fast]]);
    }

    #[test]
    fn a_state_that_moves_says_that_its_eigenvalues_are_of_one_moment() {
        let found = about_start(erase(Hanging::default()).into_equations().as_ref(), 0.2);
        assert!(found.frozen && found.freedom == 1 && found.eigenvalues.len() == 2);
        assert_eq!(found.coordinates, ["phi"]);
        assert!(found.passed_over.is_empty());
    }

    mechanism! {
        /// A point on a rod that passes the height of its pin, at which x does not determine its motion.
        pub mechanism Rising;
        coord x: m = 1;
        coord y: m = 0;
        independent x;
        body bob { mass: 2, com: [x, y] }
        gravity weight { acceleration: [0, -9.81] }
        constraint rod { x^2 + y^2 == 1 [m^2]; }
        start x = 1 rate 0;
        start y = 0 rate 3;
    }

    #[test]
    fn independent_coordinates_of_the_text_are_kept_where_they_determine_the_others() {
        let found = |t: f64| about_start(erase(Rising::default()).into_equations().as_ref(), t);
        let (level, above) = (found(0.0), found(0.1));
        assert_eq!((level.coordinates, level.passed_over), (vec!["y"], vec!["x"]));
        assert_eq!(above.coordinates, ["x"]);
        assert!(above.passed_over.is_empty());
    }
}
