//! Motion from forces, forces from motion, rest.

use mbs_runtime::dynamics::{
    Balance, Determinacy, Direction, Driven, Embedded, Equilibrium, Explicit, Formulation, Instant, Method,
    MethodWarning, Simulation, Simulations, Tolerance, WithStates,
};
use mbs_runtime::{Dynamic, Failure, Real};

entry_points! {
    /// A motion from positions and rates that are consistent.
    fn start[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: S, method: X, t: R, q: [R; N], qd: [R; N],
    ) -> Result<Simulation<S, X, R, N, M>, Failure> {
        Simulation::start(mechanism, method, t, q, qd)
    }
    /// A motion from what is nearest to given positions and rates.
    fn start_near[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: S, method: X, t: R, q: [R; N], qd: [R; N],
    ) -> Result<Simulation<S, X, R, N, M>, Failure> {
        Simulation::start_near(mechanism, method, t, q, qd)
    }
    /// A motion from the text's start.
    fn start_from_text[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: S, method: X, t: R,
    ) -> Result<Simulation<S, X, R, N, M>, Failure> {
        Simulation::start_from_text(mechanism, method, t)
    }
    /// A step.
    fn step[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        simulation: &mut Simulation<S, X, R, N, M>, h: R,
    ) -> Result<(), Failure> {
        simulation.step(h)
    }
    /// Several steps.
    fn step_to[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        simulation: &mut Simulation<S, X, R, N, M>, until: R, steps: u32,
    ) -> Result<(), Failure> {
        simulation.step_to(until, steps)
    }
    /// A change of a variable.
    fn change[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        simulation: &mut Simulation<S, X, R, N, M>, index: usize, value: R,
    ) -> bool {
        simulation.change(|mechanism| mechanism.set(index, value))
    }
    /// Energies and violations; what is doubtful.
    fn balance[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        simulation: &Simulation<S, X, R, N, M>, h: R,
    ) -> (Balance<R>, Option<MethodWarning>) {
        (simulation.balance(), simulation.doubt(h))
    }
    /// Outputs.
    fn outputs[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        simulation: &Simulation<S, X, R, N, M>,
    ) -> (S::Outputs, S::Loads) {
        (simulation.outputs(), simulation.loads())
    }
    /// Multipliers and loads that are determined.
    fn determinacy[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        simulation: &Simulation<S, X, R, N, M>, unique: &mut [bool],
    ) -> Result<Determinacy<R, M>, Failure> {
        simulation.mark_unique_loads(unique)?;
        simulation.determinacy()
    }
    /// Other limits of the adaptive steps.
    fn limited[
        S: Dynamic<R, N, M>, I: Embedded, F: Formulation<S, R, N, M>, R: Real, const N: usize, const M: usize
    ](
        simulation: Simulation<S, Explicit<I, F>, R, N, M>, tolerance: f64, step: R,
    ) -> Simulation<S, Explicit<I, F>, R, N, M> {
        simulation.with_tolerance(Tolerance::new(tolerance)).with_largest_step(step)
    }
    /// A step of simulations side by side, of which some sleep.
    fn step_lanes[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        lanes: &mut Simulations<S, X, R, 2, N, M>, h: R,
    ) -> [Result<(), Failure>; 2] {
        lanes.step(h)
    }
    /// A change of a variable that wakes one of them, and the forces of another one.
    fn wake[S: Dynamic<R, N, M>, X: Method<S, R, N, M>, R: Real, const N: usize, const M: usize](
        lanes: &mut Simulations<S, X, R, 2, N, M>, lane: usize, value: R,
    ) -> (Option<bool>, [Option<R>; 2], Option<R>) {
        let changed = lanes.change(lane, |mechanism| mechanism.set(0, value));
        (changed, lanes.asleep_until(), lanes.read(1).and_then(Result::ok).map(Simulation::t))
    }
    /// Adaptive steps of simulations side by side.
    fn advance_lanes_to[
        S: Dynamic<R, N, M>, I: Embedded, F: Formulation<S, R, N, M>, R: Real, const N: usize, const M: usize
    ](
        lanes: &mut Simulations<S, Explicit<I, F>, R, 2, N, M>, until: R,
    ) -> [Result<(), Failure>; 2] {
        lanes.advance_to(until)
    }
    /// Adaptive steps.
    fn advance_to[
        S: Dynamic<R, N, M>, I: Embedded, F: Formulation<S, R, N, M>, R: Real, const N: usize, const M: usize
    ](
        simulation: &mut Simulation<S, Explicit<I, F>, R, N, M>, until: R,
    ) -> Result<(), Failure> {
        simulation.advance_to(until)
    }
    /// Adaptive steps that end at a breakpoint.
    fn advance_through[
        S: Dynamic<R, N, M>, I: Embedded, F: Formulation<S, R, N, M>, R: Real, const N: usize, const M: usize
    ](
        simulation: &mut Simulation<S, Explicit<I, F>, R, N, M>, until: R, breakpoint: R,
    ) -> Result<(), Failure> {
        simulation.advance_through(until, |t| (t < breakpoint).then_some(breakpoint))
    }
    /// Adaptive steps until the first velocity is passed.
    fn advance_until_event[
        S: Dynamic<R, N, M>, I: Embedded, F: Formulation<S, R, N, M>, R: Real, const N: usize, const M: usize
    ](
        simulation: &mut Simulation<S, Explicit<I, F>, R, N, M>, until: R, direction: Direction, passed: R,
    ) -> Result<bool, Failure> {
        simulation.advance_until_event(until, direction, |_, _, qd| {
            qd.first().copied().unwrap_or(passed) - passed
        })
    }
    /// Adaptive steps with samples: how many there were.
    fn sample[
        S: Dynamic<R, N, M>, I: Embedded, F: Formulation<S, R, N, M>, R: Real, const N: usize, const M: usize
    ](
        simulation: &mut Simulation<S, Explicit<I, F>, R, N, M>, until: R, samples: u32,
    ) -> Result<u32, Failure> {
        let mut seen = 0_u32;
        simulation.sample(until, samples, |instant: &Instant<R, N, M, S::States>| {
            seen = seen.saturating_add(u32::from(instant.t.is_finite()));
        })?;
        Ok(seen)
    }
    /// Adaptive steps with the whole simulation shown at instants: the sum of what is missing in their energy.
    fn watch[
        S: Dynamic<R, N, M>, I: Embedded, F: Formulation<S, R, N, M> + Clone, R: Real, const N: usize, const M: usize
    ](
        simulation: &mut Simulation<S, Explicit<I, F>, R, N, M>, until: R, samples: u32,
    ) -> Result<R, Failure> {
        let mut missing = R::constant(0.0);
        simulation.watch(until, samples, |shown| missing = missing + shown.balance().defect)?;
        Ok(missing)
    }
    /// Adaptive steps with the whole simulation shown at parts of each: the sum of what is missing in their energy.
    fn watch_steps[
        S: Dynamic<R, N, M>, I: Embedded, F: Formulation<S, R, N, M> + Clone, R: Real, const N: usize, const M: usize
    ](
        simulation: &mut Simulation<S, Explicit<I, F>, R, N, M>, until: R, parts: u32,
    ) -> Result<R, Failure> {
        let mut missing = R::constant(0.0);
        simulation.watch_steps(until, parts, |shown| missing = missing + shown.balance().defect)?;
        Ok(missing)
    }
    /// Forces from motion.
    fn inverse[S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, t: R, q: &[R; N], states: &S::States,
    ) -> Result<Driven<R, N, M, S::Loads>, Failure> {
        mbs_runtime::dynamics::inverse_with_states(mechanism, t, q, states)
    }
    /// A position of rest.
    fn equilibrium[S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, t: R, q: &[R; N],
    ) -> Result<Equilibrium<R, N, M>, Failure> {
        mbs_runtime::dynamics::equilibrium(mechanism, t, q)
    }
    /// First-order states that rest with the coordinates.
    fn states_at_rest[S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, t: R, q: &[R; N], lambda: &[R; M],
    ) -> Result<S::States, Failure> {
        mbs_runtime::dynamics::states_at_rest(mechanism, t, q, lambda)
    }
    /// Small motions.
    fn linearize[S: Dynamic<R, N, M>, R: Real, const N: usize, const M: usize](
        mechanism: &S, instant: &Instant<R, N, M, S::States>,
    ) -> Result<WithStates<R, N, S::StateSlopes>, Failure> {
        mbs_runtime::dynamics::linearize_with_states(mechanism, instant, &[])
    }
}
