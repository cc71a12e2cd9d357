//! Static equilibrium: where a mechanism rests under its forces.

use mbs_runtime::dynamics::{
    Counts, Equilibrium, Formulation, Metric, Model, State, Unstabilized, equilibrium,
};
use mbs_runtime::{Dynamic, Failure, Motion as Moving};

use super::determined;
use crate::facade::Motion;
use crate::motion::{Forces, Instant};

/// The equilibrium next to `q` (N) at time 0, with its loads and multipliers, as a motion of one instant.
pub(crate) fn rest<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    q: &[f64; N],
) -> Result<Motion, Failure> {
    let mut mechanism = mechanism.clone();
    mechanism.start_phases(q, 0.0);
    let found = equilibrium(&mechanism, 0.0, q)?;
    let (parameters, none) = (mechanism.parameters(), [0.0; N]);
    let position = mechanism.position(&parameters, &found.q, 0.0);
    let outputs = mechanism.outputs(&parameters, &position, &none, &none);
    let scales = Metric::<f64, N, M>::of(&mechanism, &parameters).rows;
    let residuals = mechanism.phi(&parameters, &position);
    let closure = residuals.iter().zip(scales).map(|(residual, scale)| (residual / scale).abs());
    let mut motion = Motion::of(S::COORDINATES, S::OUTPUTS, outputs.as_ref());
    motion.push(&Instant {
        t: 0.0,
        q: [&found.q, &none, &none],
        outputs: outputs.as_ref(),
        closure: closure.fold(0.0, f64::max),
        iterations: found.iterations,
        margin: margin(&mechanism, &found),
    });
    let states = mechanism.start_states(&parameters);
    let moving = Moving { qd: &none, qdd: &none, lambda: &found.lambda, states: &states };
    let loads = mechanism.loads(&parameters, &position, &moving);
    let mut forces = Forces::of(S::LOADS, S::ROWS);
    let energy = mechanism.energy(&parameters, &position, &none);
    forces.push(energy, loads.as_ref(), &found.lambda);
    determined::push(&mut forces, &mechanism, (&parameters, &position), 0.0, &moving)?;
    motion.dynamics = Some(forces);
    Ok(motion)
}

/// How near Φ_q is to losing rank; not a number where the masses leave the accelerations open.
fn margin<S: Dynamic<f64, N, M>, const N: usize, const M: usize>(
    mechanism: &S,
    found: &Equilibrium<f64, N, M>,
) -> f64 {
    let parameters = mechanism.parameters();
    let metric = Metric::of(mechanism, &parameters);
    let model = Model { mechanism, parameters: &parameters, metric: &metric, balanced: false };
    let states = mechanism.start_states(&parameters);
    let y = State { q: found.q, qd: [0.0; N], states, work: 0.0 };
    let solved = Unstabilized.solve(&model, 0.0, &y, &found.lambda, &mut Counts::default());
    solved.map_or(f64::NAN, |solved| solved.margin)
}
