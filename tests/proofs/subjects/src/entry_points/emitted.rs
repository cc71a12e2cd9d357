//! Emitted functions of kinematics, of any scalar type.

use mbs_runtime::{Evaluation, Kinematic, Margin, Mechanism, Newton, Outcome, Scalar};

entry_points! {
    /// Sets every parameter and input to what it is.
    fn access[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](mechanism: &mut S) -> bool {
        (0..=S::VARIABLES.len()).fold(true, |all, index| match mechanism.get(index) {
            Some(value) => all & mechanism.set(index, value),
            None => all & (index == S::VARIABLES.len()),
        })
    }
    /// The design in one lane.
    fn lane[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](mechanism: &S, lane: usize) -> S::Lane {
        mechanism.lane(lane)
    }
    /// Phases of prescribed rates, started and moved on.
    fn phases[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &mut S, q: &[T; N], from: T, to: T,
    ) -> () {
        mechanism.start_phases(q, from);
        mechanism.advance_phases(from, to);
    }
    /// Stage 0.
    fn parameters[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](mechanism: &S) -> S::Parameters {
        mechanism.parameters()
    }
    /// The text's guess.
    fn guess[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters,
    ) -> [T; N] {
        mechanism.guess(parameters)
    }
    /// Metric of the coordinates.
    fn coordinate_scales[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters,
    ) -> [T; N] {
        mechanism.coordinate_scales(parameters)
    }
    /// Metric of the rows.
    fn row_scales[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters,
    ) -> [T; M] {
        mechanism.row_scales(parameters)
    }
    /// Stage 1.
    fn position[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, q: &[T; N], t: T,
    ) -> S::Position {
        mechanism.position(parameters, q, t)
    }
    /// Φ.
    fn phi[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> [T; M] {
        mechanism.phi(parameters, position)
    }
    /// Φ_q.
    fn phi_q[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> [[T; N]; M] {
        mechanism.phi_q(parameters, position)
    }
    /// Φ_t.
    fn phi_t[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> [T; M] {
        mechanism.phi_t(parameters, position)
    }
    /// Φ_tt.
    fn phi_tt[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> [T; M] {
        mechanism.phi_tt(parameters, position)
    }
    /// Φ_qt q̇.
    fn phi_qt_qd[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[T; N],
    ) -> [T; M] {
        mechanism.phi_qt_qd(parameters, position, qd)
    }
    /// γ.
    fn gamma[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[T; N],
    ) -> [T; M] {
        mechanism.gamma(parameters, position, qd)
    }
    /// Branch conditions.
    fn branches[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> S::Branches {
        mechanism.branches(parameters, position)
    }
    /// Working ranges.
    fn limits[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> S::Limits {
        mechanism.limits(parameters, position)
    }
    /// Outputs.
    fn outputs[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[T; N], qdd: &[T; N],
    ) -> S::Outputs {
        mechanism.outputs(parameters, position, qd, qdd)
    }
    /// Φ, Φ_q, Φ_t, γ in one call.
    fn evaluate[S: Mechanism<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, q: &[T; N], t: T, qd: &[T; N],
    ) -> Evaluation<T, S::Entries, M> {
        mechanism.evaluate(parameters, q, t, qd)
    }
    /// Positions of all lanes at once.
    fn solve_blocks[S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, q: &mut [T; N], t: T,
    ) -> T::Lanes<Outcome> {
        mechanism.solve_blocks(parameters, q, t, &mut Newton::new(T::constant(1.0)))
    }
    /// Factors of all lanes at once.
    fn factorize_blocks[S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> (S::Factors, Margin<T>) {
        mechanism.factorize(parameters, position)
    }
    /// Φ_q x = b.
    fn solve_linear[S: Kinematic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, factors: &S::Factors, b: &[T; M],
    ) -> [T; N] {
        mechanism.solve_linear(factors, b)
    }
}
