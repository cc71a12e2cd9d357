//! One mechanism through all its entry points.

use core::hint::black_box;

use mbs_runtime::{Budget, Failure, Kinematic, Real, Scalar};

use crate::entry_points as entry;

/// A state to start from; not known to the compiler.
#[derive(Clone, Copy, Debug)]
pub struct Start<T, const N: usize> {
    /// Coordinates.
    pub q: [T; N],
    /// Velocities.
    pub qd: [T; N],
    /// Accelerations.
    pub qdd: [T; N],
    /// Time (s).
    pub t: T,
}

impl<T: Scalar, const N: usize> Start<T, N> {
    /// At rest in the mechanism's guess at time 0.
    pub fn of<S: Kinematic<T, N>>(mechanism: &S) -> Self {
        let zero = T::constant(0.0);
        Start { q: mechanism.guess(&mechanism.parameters()), qd: [zero; N], qdd: [zero; N], t: zero }
    }
}

/// The emitted functions, of any scalar type, lanes included.
pub fn exercise_emitted<S: Kinematic<T, N>, T: Scalar, const N: usize>(
    mut mechanism: S,
    start: &Start<T, N>,
) {
    let Start { q, qd, qdd, t } = *black_box(start);
    black_box(entry::access(black_box(&mut mechanism)));
    black_box(entry::lane(&mechanism, black_box(0)));
    let parameters = black_box(entry::parameters(&mechanism));
    black_box(entry::guess(&mechanism, &parameters));
    black_box(entry::coordinate_scales(&mechanism, &parameters));
    black_box(entry::row_scales(&mechanism, &parameters));
    let position = black_box(entry::position(&mechanism, &parameters, &q, t));
    black_box(entry::phi(&mechanism, &parameters, &position));
    black_box(entry::phi_q(&mechanism, &parameters, &position));
    black_box(entry::phi_t(&mechanism, &parameters, &position));
    black_box(entry::phi_tt(&mechanism, &parameters, &position));
    black_box(entry::phi_qt_qd(&mechanism, &parameters, &position, &qd));
    black_box(entry::gamma(&mechanism, &parameters, &position, &qd));
    black_box(entry::branches(&mechanism, &parameters, &position));
    black_box(entry::outputs(&mechanism, &parameters, &position, &qd, &qdd));
    black_box(entry::evaluate(&mechanism, &parameters, &q, t, &qd));
    let mut solution = q;
    black_box(entry::solve_blocks(&mechanism, &parameters, &mut solution, t));
    let (factors, margin) = entry::factorize_blocks(&mechanism, &parameters, &position);
    black_box(margin);
    black_box(entry::solve_linear(&mechanism, &factors, &solution));
}

/// The solvers, from `start` on; `variable` is changed on the way.
///
/// # Errors
/// Those of the solvers.
pub fn exercise_solvers<S: Kinematic<R, N> + Copy, R: Real, const N: usize>(
    mechanism: S,
    start: &Start<R, N>,
    variable: &str,
) -> Result<(), Failure> {
    let mechanism = black_box(mechanism);
    let Start { q, t, .. } = *black_box(start);
    let assembled = entry::assemble(&mechanism, q, t)?;
    let parameters = entry::parameters(&mechanism);
    let (q, statistics) = entry::solve_position(&mechanism, &parameters, &assembled.q, t)?;
    black_box(statistics);
    black_box(entry::newton_raphson(&mechanism, q, t)?);
    let position = entry::position(&mechanism, &parameters, &q, t);
    let factors = entry::factorize(&mechanism, &parameters, &position, t)?;
    let qd = entry::solve_velocity(&mechanism, &parameters, &position, &factors)?;
    black_box(entry::solve_acceleration(&mechanism, &parameters, &position, &qd, &factors)?);

    let mut stepper = entry::stepper(mechanism, q, t)?;
    black_box(entry::advance(&mut stepper, black_box(R::constant(1e-3)))?);
    let index = S::variable(variable);
    let value = index.and_then(|index| stepper.mechanism().get(index)).unwrap_or(R::constant(0.0));
    black_box(entry::change(&mut stepper, black_box(variable), value));
    black_box(entry::sweep(&mut stepper, black_box(R::constant(0.1)), black_box(10))?);
    black_box(entry::frame(&stepper));
    black_box(entry::ill_scaled(&stepper));
    black_box(entry::stop(&stepper, black_box(R::constant(1.0))));
    black_box(entry::stop_of(&stepper, black_box(0), black_box(R::constant(1e3))));

    let budget = black_box(Budget { newton: 4, fallback: 4 });
    black_box(entry::step(&mut stepper, black_box(R::constant(1e-3)), budget));
    black_box(entry::skip(&mut stepper, black_box(R::constant(1e-3)), black_box(3), budget));
    // Room for 60 coordinates.
    let mut bytes = [0; 512];
    let written = entry::save(&stepper, black_box(&mut bytes)).unwrap_or(0);
    if let Some(saved) = entry::saved::<N>(black_box(bytes.get(..written).unwrap_or(&[]))) {
        let t = stepper.t();
        black_box(entry::assemble_near(*stepper.mechanism(), &saved, t)?);
    }
    Ok(())
}
