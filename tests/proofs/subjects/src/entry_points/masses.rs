//! Emitted functions of masses and forces, of any scalar type.

use mbs_runtime::dynamics::Transformed;
use mbs_runtime::{Dynamic, DynamicState, Energy, Margin, Newton, Outcome, Partitioned, Scalar};

/// N rows of N.
pub type Square<T, const N: usize> = [[T; N]; N];

entry_points! {
    /// Start values of the states, start rates.
    fn starts[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters,
    ) -> (S::States, [T; N]) {
        (mechanism.start_states(parameters), mechanism.start_rates(parameters))
    }
    /// M.
    fn mass[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> Square<T, N> {
        mechanism.mass(parameters, position)
    }
    /// M x.
    fn mass_times[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, x: &[T; N],
    ) -> [T; N] {
        mechanism.mass_times(parameters, position, x)
    }
    /// (M x)_q.
    fn mass_times_q[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, x: &[T; N],
    ) -> Square<T, N> {
        mechanism.mass_times_q(parameters, position, x)
    }
    /// Q.
    fn force[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
        motion: &DynamicState<'_, T, N, M, S::States>,
    ) -> [T; N] {
        mechanism.force(parameters, position, motion.qd, motion.states, motion.lambda)
    }
    /// ∂Q/∂q.
    fn force_q[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
        motion: &DynamicState<'_, T, N, M, S::States>,
    ) -> Square<T, N> {
        mechanism.force_q(parameters, position, motion.qd, motion.states, motion.lambda)
    }
    /// ∂Q/∂q̇.
    fn force_qd[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
        motion: &DynamicState<'_, T, N, M, S::States>,
    ) -> Square<T, N> {
        mechanism.force_qd(parameters, position, motion.qd, motion.states, motion.lambda)
    }
    /// Φ_qᵀ λ and (Φ_qᵀ λ)_q.
    fn reactions[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, lambda: &[T; M],
    ) -> ([T; N], Square<T, N>) {
        (mechanism.reaction(parameters, position, lambda), mechanism.reaction_q(parameters, position, lambda))
    }
    /// Φ̇_qᵀ λ and λᵀγ̇.
    fn third_derivative[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[T; N], lambda: &[T; M],
    ) -> Option<([T; N], T)> {
        mechanism.third_derivative(parameters, position, qd, lambda)
    }
    /// Kinetic and potential energy.
    fn energy[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, qd: &[T; N],
    ) -> Energy<T> {
        mechanism.energy(parameters, position, qd)
    }
    /// Powers of the forces and rates of the states.
    fn rates[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
        motion: &DynamicState<'_, T, N, M, S::States>,
    ) -> (S::Powers, S::States) {
        let DynamicState { qd, states, lambda, .. } = motion;
        (
            mechanism.powers(parameters, position, qd, states, lambda),
            mechanism.state_rates(parameters, position, qd, states, lambda),
        )
    }
    /// Outputs of multipliers and states.
    fn loads[S: Dynamic<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
        motion: &DynamicState<'_, T, N, M, S::States>,
    ) -> S::Loads {
        mechanism.loads(parameters, position, motion)
    }
    /// Positions of the dependent coordinates.
    fn solve_dependent[S: Partitioned<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, q: &mut [T; N], t: T,
    ) -> T::Lanes<Outcome> {
        mechanism.solve_dependent(parameters, q, t, &mut Newton::new(T::constant(1.0)))
    }
    /// Factors of the dependent columns.
    fn partition[S: Partitioned<T, N, M>, T: Scalar, const N: usize, const M: usize](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position,
    ) -> (S::Partition, Margin<T>) {
        mechanism.partition(parameters, position)
    }
    /// q̈ and λ in independent coordinates, from what is factorised.
    fn transformed[
        S: Dynamic<T, N, M> + Partitioned<T, N, M>, T: Scalar, const N: usize, const M: usize
    ](
        mechanism: &S, parameters: &S::Parameters, position: &S::Position, partition: &S::Partition,
        force: &[T; N], gamma: &[T; M],
    ) -> Transformed<T, N, M> {
        mechanism.accelerations(parameters, position, partition, force, gamma)
    }
}
