//! Runs to an event whose function is known at run time alone: their search is compiled once a simulation, not once a function.

use mbs_runtime::dynamics::{Direction, Embedded, Explicit, Formulation, Method, Simulation};
use mbs_runtime::{Dynamic, Failure};

/// Function of time, coordinates and velocities.
pub type Event<'a, const N: usize> = dyn FnMut(f64, &[f64; N], &[f64; N]) -> f64 + 'a;

/// [`Simulation::advance_until_event`].
pub trait ToEvent<const N: usize> {
    /// To `until` (s), or to the event.
    fn to_event(
        &mut self,
        until: f64,
        direction: Direction,
        event: &mut Event<'_, N>,
    ) -> Result<bool, Failure>;
}

impl<S, I, F, const N: usize, const M: usize> ToEvent<N> for Simulation<S, Explicit<I, F>, f64, N, M>
where
    S: Dynamic<f64, N, M>,
    I: Embedded,
    F: Formulation<S, f64, N, M>,
{
    fn to_event(
        &mut self,
        until: f64,
        direction: Direction,
        event: &mut Event<'_, N>,
    ) -> Result<bool, Failure> {
        self.advance_until_event(until, direction, event)
    }
}

/// [`Simulation::step_until_event`].
pub trait StepsToEvent<const N: usize> {
    /// To `until` (s) in `steps` steps, or to the event.
    fn steps_to_event(
        &mut self,
        until: f64,
        steps: u32,
        direction: Direction,
        event: &mut Event<'_, N>,
    ) -> Result<bool, Failure>;
}

impl<S, X, const N: usize, const M: usize> StepsToEvent<N> for Simulation<S, X, f64, N, M>
where
    S: Dynamic<f64, N, M>,
    X: Method<S, f64, N, M>,
{
    fn steps_to_event(
        &mut self,
        until: f64,
        steps: u32,
        direction: Direction,
        event: &mut Event<'_, N>,
    ) -> Result<bool, Failure> {
        self.step_until_event(until, steps, direction, event)
    }
}
