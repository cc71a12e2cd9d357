//! One mechanism through all its entry points of kinematics.

use core::hint::black_box;

use mbs_runtime::{Budget, Failure, FailureKind, Kinematic, Lanes, Mechanism, Real, Scalar};

use crate::entry_points::{batch, emitted as entry, solvers};

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
    pub fn of<S: Mechanism<T, N, M>, const M: usize>(mechanism: &S) -> Self {
        let zero = T::constant(0.0);
        Start { q: mechanism.guess(&mechanism.parameters()), qd: [zero; N], qdd: [zero; N], t: zero }
    }
}

/// The emitted functions of any text, of any scalar type, lanes included.
pub fn exercise_functions<S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize>(
    mut mechanism: S,
    start: &Start<T, N>,
) {
    let Start { q, qd, qdd, t } = *black_box(start);
    entry::phases(black_box(&mut mechanism), &q, t, t);
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
    black_box(entry::limits(&mechanism, &parameters, &position));
    black_box(entry::outputs(&mechanism, &parameters, &position, &qd, &qdd));
    black_box(entry::evaluate(&mechanism, &parameters, &q, t, &qd));
}

/// The emitted functions of a text whose rows fix every coordinate, of any scalar type.
pub fn exercise_emitted<S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize>(
    mechanism: S,
    start: &Start<T, N>,
) {
    exercise_functions(mechanism.clone(), start);
    let Start { q, t, .. } = *black_box(start);
    let parameters = black_box(entry::parameters(&mechanism));
    let mut solution = q;
    black_box(entry::solve_blocks(&mechanism, &parameters, &mut solution, t));
    let position = entry::position(&mechanism, &parameters, &solution, t);
    let (factors, margin) = entry::factorize_blocks(&mechanism, &parameters, &position);
    black_box(margin);
    black_box(entry::solve_linear(&mechanism, &factors, &entry::phi_t(&mechanism, &parameters, &position)));
}

/// The solvers, from `start` on; `variable` is changed on the way.
///
/// # Errors
/// Those of the solvers.
pub fn exercise_solvers<S: Kinematic<R, N, M> + Copy, R: Real, const N: usize, const M: usize>(
    mechanism: S,
    start: &Start<R, N>,
    variable: &str,
) -> Result<(), Failure> {
    let mechanism = black_box(mechanism);
    let Start { q, t, .. } = *black_box(start);
    let assembled = solvers::assemble(&mechanism, q, t)?;
    let parameters = entry::parameters(&mechanism);
    let (q, statistics) = solvers::solve_position(&mechanism, &parameters, &assembled.q, t)?;
    black_box(statistics);
    black_box(solvers::newton_raphson(&mechanism, q, t)?);
    let position = entry::position(&mechanism, &parameters, &q, t);
    let factors = solvers::factorize(&mechanism, &parameters, &position, t)?;
    let qd = solvers::solve_velocity(&mechanism, &parameters, &position, &factors)?;
    black_box(solvers::solve_acceleration(&mechanism, &parameters, &position, &qd, &factors)?);

    let mut stepper = solvers::stepper(mechanism, q, t)?;
    black_box(solvers::advance(&mut stepper, black_box(R::constant(1e-3)))?);
    let index = S::variable(variable);
    let value = index.and_then(|index| stepper.mechanism().get(index)).unwrap_or(R::constant(0.0));
    black_box(solvers::change(&mut stepper, black_box(variable), value));
    black_box(solvers::sweep(&mut stepper, black_box(R::constant(0.1)), black_box(10))?);
    black_box(solvers::frame(&stepper));
    black_box(solvers::redundancy(&stepper));
    black_box(solvers::warnings(&stepper));
    black_box(solvers::open(&stepper));
    black_box(solvers::ill_scaled(&stepper));
    black_box(solvers::stop(&stepper, black_box(R::constant(1.0))));
    black_box(solvers::reach_of(&stepper, black_box(0), black_box(R::constant(1e3))));

    let budget = black_box(Budget { newton: 4, fallback: 4 });
    let _ = black_box(solvers::step(&mut stepper, black_box(R::constant(1e-3)), budget));
    let _ = black_box(solvers::skip(&mut stepper, black_box(R::constant(1e-3)), black_box(3), budget));
    // Room for 60 coordinates and 30 values.
    let mut bytes = [0; 1968];
    let written = solvers::save(&stepper, black_box(&mut bytes)).unwrap_or(0);
    if let Some(saved) = solvers::saved::<N, _>(black_box(bytes.get(..written).unwrap_or(&[]))) {
        let t = stepper.t();
        black_box(solvers::assemble_near(*stepper.mechanism(), &saved, t)?);
    }
    Ok(())
}

/// Two lanes of a mechanism side by side, from `start` on.
///
/// # Errors
/// Those of the lanes.
pub fn exercise_batch<S, R: Real, const N: usize, const M: usize>(
    mechanism: S,
    start: &Start<R, N>,
) -> Result<(), Failure>
where
    S: Kinematic<Lanes<R, 2>, N, M> + Clone,
    S::Lane: Kinematic<R, N, M>,
{
    let Start { q, t, .. } = *black_box(start);
    black_box(batch::assemble_each(mechanism.clone(), &[q; 2], [t; 2]).is_ok());
    let assembled = batch::assemble(black_box(mechanism), &[q; 2], [t; 2]);
    let mut pair = assembled.map_err(|(_, failure)| failure)?;
    for step in [1e-3, 3e-3, 0.2] {
        let [first, second] = [0.5, 1.0].map(|share| t + R::constant(share * step));
        for lane in batch::advance_to(&mut pair, black_box([first, second])) {
            black_box(lane?);
        }
    }
    black_box(batch::change(&mut pair, black_box(0), black_box(Lanes([R::constant(0.1); 2]))));
    black_box(batch::stepper(&pair, black_box(1)));
    black_box(batch::retire(
        &mut pair,
        black_box(0),
        FailureKind::NonFinite { name: "t", line: 0 }.without_time(),
    ));
    black_box(batch::revive(&mut pair, black_box(0), &q, t).is_ok());
    Ok(())
}
