//! The formulations that need no independent coordinates as one type: each integrator is compiled once for all of them.

use mbs_runtime::dynamics::{
    Baumgarte, Counts, Doubt, Formulation, Model, Penalty, Projection, Solved, State, Unstabilized,
};
use mbs_runtime::{Dynamic, Failure};

/// A formulation chosen at run time.
#[derive(Clone, Copy, Debug)]
pub(super) enum Chosen {
    /// Φ̈ = 0 alone.
    None,
    /// Damped oscillators of the violations.
    Baumgarte(Baumgarte),
    /// Stiff springs and dampers on them.
    Penalty(Penalty),
    /// Positions and velocities put back.
    Projection(Projection),
}

/// Calls the same function of whichever formulation it is.
macro_rules! each {
    ($chosen:expr, $formulation:ident => $call:expr) => {
        match $chosen {
            Chosen::None => {
                let $formulation = &Unstabilized;
                $call
            }
            Chosen::Baumgarte($formulation) => $call,
            Chosen::Penalty($formulation) => $call,
            Chosen::Projection($formulation) => $call,
        }
    };
}

impl<S: Dynamic<f64, N, M>, const N: usize, const M: usize> Formulation<S, f64, N, M> for Chosen {
    fn solve(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &State<f64, N, S::States>,
        lambda: &[f64; M],
        counts: &mut Counts,
    ) -> Result<Solved<f64, N, M, S::States>, Failure> {
        each!(self, formulation => formulation.solve(model, t, y, lambda, counts))
    }

    fn solve_as_it_is(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &State<f64, N, S::States>,
        lambda: &[f64; M],
        counts: &mut Counts,
    ) -> Result<Solved<f64, N, M, S::States>, Failure> {
        each!(self, formulation => formulation.solve_as_it_is(model, t, y, lambda, counts))
    }

    fn settle(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &mut State<f64, N, S::States>,
        counts: &mut Counts,
    ) -> Result<(), Failure> {
        each!(self, formulation => formulation.settle(model, t, y, counts))
    }

    fn settle_and_solve(
        &self,
        model: &Model<'_, S, f64, N, M>,
        t: f64,
        y: &mut State<f64, N, S::States>,
        lambda: &[f64; M],
        counts: &mut Counts,
    ) -> Result<Solved<f64, N, M, S::States>, Failure> {
        each!(self, formulation => formulation.settle_and_solve(model, t, y, lambda, counts))
    }

    fn admit(&self, h: f64, t: f64) -> Result<(), Failure> {
        each!(self, formulation => Formulation::<S, f64, N, M>::admit(formulation, h, t))
    }

    fn doubt(&self, h: f64, span: f64) -> Option<Doubt> {
        each!(self, formulation => Formulation::<S, f64, N, M>::doubt(formulation, h, span))
    }
}
